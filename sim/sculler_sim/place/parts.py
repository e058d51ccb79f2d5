"""The parts of a core by the names of its registers, and what would help the slowest path."""

from __future__ import annotations

import re
from collections.abc import Mapping

from sculler_model.design import Design
from sculler_sim.place.devices import Device
from sculler_sim.place.nextpnr import WorstPath

PARTS = ("multipliers", "sums", "samples and sequence", "hand-over", "shift register")
"""What a floor plan is coloured by; the last is not the core's."""

_PATTERNS: tuple[tuple[str, str], ...] = (
    ("shift register", r"^harness\."),
    ("hand-over", r"^(handover|reader|result|losses|samples_lost)"),
    ("sums", r"sum\d|total|grown|newest"),
    ("multipliers", r"tile|dsp|product|row\d|fringe|_left|_right|held\d|block_"),
    (
        "samples and sequence",
        r"^(sequencer|control|loader|samples|sample_)|phase|load\d|program|index",
    ),
)


def part_of(name: str) -> str:
    """The part of the core that a register belongs to.

    Args:
        name: in the words of the design (`Names.register`).
    """
    for part, pattern in _PATTERNS:
        if re.search(pattern, name):
            return part
    return "sums"


def in_words(path: WorstPath) -> str:
    """Where the slowest path goes, by parts."""
    start, end = part_of(path.start), part_of(path.end)
    where = f"within the {start}" if start == end else f"from the {start} to the {end}"
    share = path.routing_ns / path.total_ns if path.total_ns else 0.0
    return f"{where}; {share:.0%} of it is wire"


def what_helps(path: WorstPath, design: Design, device: Device, speed: int | None) -> list[str]:
    """What would make the slowest path shorter, most promising first."""
    hardware = design.hardware
    found = []
    if hardware.target == "generic" and device.family in device.targets:
        found.append(
            f'hardware.target = "{device.family}": additions cut for it, its own multipliers'
        )
    if part_of(path.end) == "shift register" or part_of(path.start) == "shift register":
        found.append("nothing in the core: the path is in the shift register around it")
    if path.blocks and path.logic_ns > path.routing_ns:
        found.append("the path is a block's own: only a faster speed grade makes it shorter")
    if path.routing_ns > path.logic_ns:
        if hardware.core == "pipelined" and hardware.multipliers is None:
            found.append("hardware.multipliers: fewer blocks stand closer together")
        found.append("more seeds (--seeds) or a larger device: wires are as the placer has them")
    if path.carries > 12 and not path.routing_ns > path.logic_ns:
        found.append("fewer bits or minors: the carry chain is as long as the sum is wide")
    faster = [grade for grade in device.speeds if grade > (speed or 0)]
    if faster:
        found.append(f"a faster part (--speed {faster[-1]})")
    return found or ["more seeds (--seeds)"]


def floor_parts(places: Mapping[str, tuple[int, int]]) -> dict[str, list[tuple[int, int]]]:
    """Where the cells of each part stand.

    Args:
        places: column and row of each register, by its name in the words of the design.
    """
    found: dict[str, list[tuple[int, int]]] = {}
    for name, place in sorted(places.items()):
        found.setdefault(part_of(name), []).append(place)
    return found
