"""What the cores need to know of the device family they are built for, and its blocks' models.

Every fact about a family stands in `TARGETS`; nothing else in this package compares a target's
name.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files

__all__ = ["BLOCK_ATTRIBUTES", "TARGETS", "Target", "cell_models"]


@dataclass(frozen=True)
class Target:
    """A family of devices.

    Attributes:
        name: as in the design file's hardware.target.
        multiplier_bits: widths of the two signed operands of one multiplier block.
        limb_bits: longest addition that is done in one clock; after it shorter ones, for where
            there is time to cut additions into more pieces.
        long_limb: bits of an addition that takes longer than a carry's way to the next limb: where
            there are longer ones, carries have no clock for themselves.  None: they keep it.
        two_results: whether there are flip-flops to spare for a second result, which gives that
            time where major intervals are short.
        multiplier_cell: the vendor's multiplier block that is instantiated; None leaves the
            choice to synthesis.
        memory_cell: the same for block memory.
        memory_latency: clocks from a block memory's address to its data.  2 uses the output
            register inside the block, without which it is slow; the iCE40 has none.
    """

    name: str
    multiplier_bits: tuple[int, int]
    limb_bits: tuple[int, ...]
    long_limb: int | None = None
    two_results: bool = False
    multiplier_cell: str | None = None
    memory_cell: str | None = None
    memory_latency: int = 2


TARGETS = {
    target.name: target
    for target in (
        Target("generic", (18, 18), (64,)),
        Target(
            "ecp5",
            (18, 18),
            (42, 32, 26, 21, 16, 12),
            long_limb=26,
            two_results=True,
            multiplier_cell="MULT18X18D",
            memory_cell="DP16KD",  # its output register is not inferred by synthesis
        ),
        Target("ice40", (16, 16), (20,), multiplier_cell="SB_MAC16", memory_latency=1),
        Target("xilinx", (25, 18), (42,)),
        Target("nexus", (18, 18), (32, 26, 21, 16, 12), multiplier_cell="MULTPREADD18X18"),
        Target("gowin", (18, 18), (32, 26, 21, 16, 12), multiplier_cell="MULT18X18"),
    )
}
"""By the design file's name."""


BLOCK_ATTRIBUTES = {
    "ram": '(* ram_style = "block", ramstyle = "M10K", syn_ramstyle = "block_ram" *)',
    "rom": '(* rom_style = "block", romstyle = "M10K", syn_romstyle = "EBR" *)',
}
"""Of memories that are meant for block memory, for Vivado, Quartus, and Synplify and its like."""


def cell_models() -> dict[str, str]:
    """Behavioural Verilog of every vendor block that some target's parts instantiate, by name.

    No two makers' blocks have one name here, so that cores for different devices stand in one
    project; hence Nexus's MULTPREADD18X18, for its MULT18X18 is called as Gowin's.

    Each models the block in the modes we use it in, for simulators and linters.  A file that is
    read twice, with two cores, declares its module once.
    """
    folder = files(__name__) / "cells"
    return {
        entry.name.removesuffix(".v"): entry.read_text(encoding="utf-8")
        for entry in sorted(folder.iterdir(), key=lambda entry: entry.name)
        if entry.name.endswith(".v")
    }
