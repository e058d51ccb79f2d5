"""Paths inside multiplier and memory blocks, which nextpnr does not check.

Where a block has registers of its own, nextpnr checks the way to the first and from the last, and
takes whatever lies between them for done in a clock.  What lies between follows from the block's
parameters.

ECP5, MULT18X18D: with nextpnr's own figures (`--report` of a multiplier between registers: A to P
without registers, clock to P with input registers, A to clock with output registers), input
register to output register takes (clock to P) + (A to clock) - (A to P); with the pipeline register
between them, the longer half is that from the input registers, (A to clock of the pipeline
register) instead of (A to clock).  In ns:

    speed grade   A to P   clock to P   A to clock   A to pipeline
    6             3.927    3.864        3.486        2.627
    7             3.497    3.455        3.061        2.305
    8             3.066    3.045        2.635        (7's half is used, it is slower)

ECP5, DP16KD: the clock must be high and low for 2.359, 1.967 and 1.842 ns (speed grades 6, 7, 8;
Project Trellis' timing database).

iCE40 UltraPlus, SB_MAC16: no way inside is longer than the whole multiplication without registers,
8.81 ns from B to O (Project IceStorm's timing database); what its registers in the middle win is
not published, so it is not counted.  SB_RAM40_4K has no output register: nextpnr checks all of it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from sculler_sim.place.devices import Device
from sculler_sim.place.synthesis import Cell

_MULTIPLY_NS = {6: 3.864 + 3.486 - 3.927, 7: 3.455 + 3.061 - 3.497, 8: 3.045 + 2.635 - 3.066}
_HALF_MULTIPLY_NS = {
    6: 2.627 + 3.864 - 3.927,
    7: 2.305 + 3.455 - 3.497,
    8: 2.305 + 3.455 - 3.497,
}
_MEMORY_NS = {6: 2 * 2.359, 7: 2 * 1.967, 8: 2 * 1.842}
_MAC16_NS = 9.0  # with the setup of the register behind it


@dataclass(frozen=True)
class Limit:
    """What some blocks of the netlist allow.

    Attributes:
        block: the block's type.
        count: how many are as slow as this.
        mhz: clock rate.
        reason: the way inside that takes so long.
    """

    block: str
    count: int
    mhz: float
    reason: str

    def describe(self) -> str:
        """In a sentence."""
        return f"{self.count} {self.block}, {self.reason}: {self.mhz:.1f} MHz"


def limits(cells: Iterable[Cell], device: Device, speed: int | None) -> list[Limit]:
    """What the blocks of a netlist allow, the slowest first; empty if they have no such paths."""
    slow: dict[tuple[str, float, str], int] = {}
    for cell in cells:
        found = _inside(cell, device, speed)
        if found is not None:
            ns, reason = found
            key = (cell.type, ns, reason)
            slow[key] = slow.get(key, 0) + 1
    return sorted(
        (Limit(block, count, 1000 / ns, reason) for (block, ns, reason), count in slow.items()),
        key=lambda limit: limit.mhz,
    )


def _inside(cell: Cell, device: Device, speed: int | None) -> tuple[float, str] | None:
    """Time (ns) of the slowest unchecked path inside a block, and which; None if there is none."""
    parameters = cell.parameters
    if cell.type == "MULT18X18D" and speed is not None:
        registers = [
            parameters.get(f"REG_{name}_CLK", "NONE") != "NONE"
            for name in ("INPUTA", "PIPELINE", "OUTPUT")
        ]
        if not (registers[0] and registers[2]):
            return None  # nextpnr has the whole way
        if registers[1]:
            return _HALF_MULTIPLY_NS[speed], "input register to pipeline register"
        return _MULTIPLY_NS[speed], "input register to output register"
    if cell.type in ("DP16KD", "PDPW16KD") and speed is not None:
        return _MEMORY_NS[speed], "shortest clock pulses"
    if cell.type == "SB_MAC16":
        registers = [bool(int(parameters.get(f"{name}_REG", "0"), 2)) for name in "AB"]
        return (_MAC16_NS, "input register to output register") if any(registers) else None
    return None
