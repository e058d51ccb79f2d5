"""What the parts need to know of the device they are built for."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files


@dataclass(frozen=True)
class Target:
    """A family of devices.

    Attributes:
        name: as in the design file's hardware.target.
        tile_bits: widths of the two signed operands of one multiplier block.
        carry_bits: longest addition that is done in one clock.
        sample_bits: the same for multiples of a sample, whose bits each go to many adders.
    """

    name: str
    tile_bits: tuple[int, int]
    carry_bits: int
    sample_bits: int


TARGETS = {
    target.name: target
    for target in (
        Target("generic", (18, 18), 64, 64),
        Target("ecp5", (18, 18), 42, 21),
        Target("ice40", (16, 16), 20, 20),
        Target("xilinx", (25, 18), 42, 24),
    )
}
"""By the design file's name."""


def cell_models() -> dict[str, str]:
    """Behavioural Verilog of every vendor block that some target's parts instantiate, by name.

    Each models the block in the modes we use it in, for simulators and linters.
    """
    folder = files("sculler_hdl") / "cells"
    return {
        entry.name.removesuffix(".v"): entry.read_text(encoding="utf-8")
        for entry in sorted(folder.iterdir(), key=lambda entry: entry.name)
        if entry.name.endswith(".v")
    }
