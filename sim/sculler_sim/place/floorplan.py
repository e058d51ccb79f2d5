"""Where the multiplier blocks of an ECP5 go: those that work together stand side by side.

A device's blocks stand in a few rows across it, and nextpnr puts those of one sum into different
rows, or at both ends of one, from which no register on the way makes up for the wires.  So each
group of an array's blocks (`Crossing.blocks`) gets a row, or a part of one; all else is nextpnr's
choice.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import NamedTuple

from sculler_sim.place.devices import Device

_FOUR = ((0, "MULT18_0"), (1, "MULT18_1"), (4, "MULT18_4"), (5, "MULT18_5"))
"""Columns, from the first, and names of the four multiplier blocks that stand together."""


class _Grid(NamedTuple):
    """Where fours of blocks stand in nextpnr's grid: rows, those in the middle first; columns."""

    rows: tuple[int, ...]
    columns: tuple[int, ...]


# as nextpnr places a netlist that takes every block of the device
_SMALL = _Grid((13,), (4, 13, 22, 33, 42, 51, 60))
_GRIDS = {
    "LFE5U-12F": _SMALL,
    "LFE5U-25F": _SMALL,
    "LFE5U-45F": _Grid((22, 46), (4, 13, 22, 31, 42, 51, 60, 69, 78)),
    "LFE5U-85F": _Grid((34, 58, 10), (*range(4, 59, 9), *range(69, 115, 9))),
}


def sites(device: Device, counts: Sequence[int]) -> list[list[str]] | None:
    """nextpnr's names of the blocks for groups of so many blocks each.

    Returns:
        For each group its blocks, from left to right, in the row that has fewest others, behind
        those that came there before; None if no row takes them.
    """
    if device.name not in _GRIDS or not counts:
        return None
    grid = _GRIDS[device.name]
    found: dict[int, list[str]] = {}
    rows: dict[int, list[int]] = {y: [] for y in grid.rows}
    for group in range(len(counts)):
        emptiest = min(rows.values(), key=lambda row: sum(counts[other] for other in row))
        emptiest.append(group)
    for y, row in ((y, row) for y, row in rows.items() if row):
        every = [f"X{x + dx}/Y{y}/{name}" for x in grid.columns for dx, name in _FOUR]
        total = sum(counts[group] for group in row)
        if total > len(every):
            return None
        start = _narrowest(grid.columns, -(-total // len(_FOUR))) * len(_FOUR)
        for group in row:
            found[group] = every[start : start + counts[group]]
            start += counts[group]
    return [found[group] for group in range(len(counts))]


def _narrowest(columns: Sequence[int], count: int) -> int:
    """The first of so many neighbouring columns: the closest ones, of these those in the middle."""
    starts = range(len(columns) - count + 1)
    middle = (len(columns) - count) / 2
    return min(starts, key=lambda i: (columns[i + count - 1] - columns[i], abs(i - middle), i))


def fix_blocks(netlist: str, top: str, groups: Sequence[Sequence[str]], device: Device) -> str:
    """Give the blocks of a netlist (Yosys, JSON) their places, as attributes that nextpnr obeys.

    Args:
        netlist: the netlist.
        top: its module.
        groups: the instances of blocks, as the manifest's `resources.blocks`.
        device: the device.

    Returns:
        The netlist; as it was if the device has no such blocks, or not in rows that take them.
    """
    cells = json.loads(netlist)
    found = sites(device, [len(group) for group in groups])
    if found is None:
        return netlist
    for group, places in zip(groups, found, strict=True):
        for name, place in zip(group, places, strict=True):
            cells["modules"][top]["cells"][f"{name}.dsp"]["attributes"]["BEL"] = place
    return json.dumps(cells)
