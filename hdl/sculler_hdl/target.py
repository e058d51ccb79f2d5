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
        limb_bits: longest addition that is done in one clock; after it shorter ones, for where
            there is time to cut additions into more pieces.
        two_results: whether there are flip-flops to spare for a second result, which gives that
            time where major intervals are short.
    """

    name: str
    tile_bits: tuple[int, int]
    limb_bits: tuple[int, ...]
    two_results: bool = False


TARGETS = {
    target.name: target
    for target in (
        Target("generic", (18, 18), (64,)),
        Target("ecp5", (18, 18), (42, 32, 26, 21, 16, 12), two_results=True),
        Target("ice40", (16, 16), (20,)),
        Target("xilinx", (25, 18), (42,)),
    )
}
"""By the design file's name."""


def cell_models() -> dict[str, str]:
    """Behavioural Verilog of every vendor block that some target's parts instantiate, by name.

    Each models the block in the modes we use it in, for simulators and linters.  A file that is
    read twice, with two cores, declares its module once.
    """
    folder = files("sculler_hdl") / "cells"
    return {
        entry.name.removesuffix(".v"): entry.read_text(encoding="utf-8")
        for entry in sorted(folder.iterdir(), key=lambda entry: entry.name)
        if entry.name.endswith(".v")
    }
