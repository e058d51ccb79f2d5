"""Timing diagrams of a core's ports, of a real run (`port_watch`): clocks and levels shown."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from sculler_model.design import Design
from sculler_model.golden import WORD_BITS
from sculler_sim.package.bus_watch import ACCESSES, watched_read
from sculler_sim.package.port_watch import RESET_CLOCK, Clock, watched

GAP = None
"""In the place of a column: clocks that are left out."""


@dataclass(frozen=True)
class Lane:
    """A signal, or ports that together are one number.

    Attributes:
        name: of the port, or what the ports are.
        cells: for each column a level 0 or 1, the text of a number, "" where it means nothing, or
            GAP.  The clock has no cells.
    """

    name: str
    cells: tuple[int | str | None, ...] = ()


@dataclass(frozen=True)
class Diagram:
    """A timing diagram.

    Attributes:
        title: what happens.
        told: what is to be seen, in sentences.
        clocks: number of each column's clock in the run, or GAP.
        lanes: the signals; the first is the clock.
    """

    title: str
    told: str
    clocks: tuple[int | None, ...]
    lanes: tuple[Lane, ...]

    def as_wavejson(self) -> dict[str, Any]:
        """As WaveDrom reads it."""
        return {
            "signal": [_wave(lane, len(self.clocks)) for lane in self.lanes],
            "head": {"text": self.title},
            "foot": {"text": _columns(self.clocks)},
        }


def diagrams(design: Design) -> list[Diagram]:
    """The diagrams of a design: the core's, out of reset, and to a result; a read of registers.

    Raises:
        ToolError: the simulated core is not as the cycle model says.
    """
    run = watched(design)
    taken = [i for i, clock in enumerate(run) if clock.takes_sample and i > RESET_CLOCK]
    shown = [_after_reset(design, run, taken[0])]
    valid = [i for i, clock in enumerate(run) if clock.result_valid]
    if valid:
        shown.append(_result(design, run, taken[design.samples_per_major - 1], valid[0]))
    if valid and design.hardware.handover == "stream":
        shown.append(_last_words(design, run, len(run) - 4))
    bus = design.hardware.bus
    return [*shown, _read(design)] if bus is not None and bus.result in ACCESSES else shown


def _read(design: Design) -> Diagram:
    """A read of the bus's registers."""
    seen = watched_read(design)
    bus = design.hardware.bus
    clock = "clk" if bus is None or bus.clock == "same" else "bus_clk"
    lanes = [Lane(clock)]
    for name in seen[0]:
        number = max(now[name] for now in seen) > 1 or name.endswith(("addr", "adr"))
        cells = (f"{now[name]:x}" if number else now[name] for now in seen)
        lanes.append(Lane(name, tuple(cells)))
    return Diagram(
        "A read of a register",
        "The host reads identity, which has the letters SCUL; numbers are hexadecimal.",
        tuple(range(len(seen))),
        tuple(lanes),
    )


def _after_reset(design: Design, run: Sequence[Clock], first: int) -> Diagram:
    wait = first - RESET_CLOCK
    return _diagram(
        design,
        run,
        "Out of reset",
        f"The first sample after the reset is taken {wait} clocks after the clock in which reset is"
        " held. A sample is taken in each clock in which sample_valid and sample_ready are high.",
        [*range(RESET_CLOCK + 3), *range(max(first - 2, RESET_CLOCK + 3), first + 5)],
        result=False,
    )


def _result(design: Design, run: Sequence[Clock], last: int, valid: int) -> Diagram:
    one = "word of the result" if design.hardware.handover == "stream" else "result"
    return _diagram(
        design,
        run,
        "From a major interval's last sample to its result",
        f"The last sample is taken in clock {last}; {valid - last} clocks later result_valid rises."
        f" The host is late: the {one} waits, unchanged, until result_ready is high.",
        [*range(last - 2, last + 3), *range(max(valid - 1, last + 3), min(valid + 7, len(run)))],
    )


def _last_words(design: Design, run: Sequence[Clock], last: int) -> Diagram:
    return _diagram(
        design,
        run,
        "The last words of a result",
        "result_last marks the last word of the result.",
        list(range(last - 8, len(run))),
    )


def _diagram(
    design: Design,
    run: Sequence[Clock],
    title: str,
    told: str,
    numbers: Sequence[int],
    *,
    result: bool = True,
) -> Diagram:
    columns: list[int | None] = [numbers[0]]
    for before, number in pairwise(numbers):
        columns += [number] if number == before + 1 else [GAP, number]

    def lane(name: str, cell: Callable[[Clock], int | str]) -> Lane:
        return Lane(name, tuple(GAP if i is GAP else cell(run[i]) for i in columns))

    low = design.hardware.reset_active == "low"
    lanes = [
        Lane("clk"),
        lane("rst_n" if low else "rst", lambda clock: clock.rst ^ low),
        lane("sample_valid", lambda clock: clock.sample_valid),
        lane("sample_ready", lambda clock: clock.sample_ready),
        lane("sample_*", lambda clock: f"s{clock.sample}" if clock.sample_valid else ""),
    ]
    if result:
        lanes += [
            lane("result_valid", lambda clock: clock.result_valid),
            lane("result_ready", lambda clock: clock.result_ready),
            *_result_lanes(design, lane),
        ]
    return Diagram(title, told, tuple(columns), tuple(lanes))


def _result_lanes(
    design: Design, lane: Callable[[str, Callable[[Clock], int | str]], Lane]
) -> list[Lane]:
    if design.hardware.handover != "stream":
        return [lane("result_*", lambda clock: "r0" if clock.result_valid else "")]
    word = (1 << WORD_BITS) - 1
    digits = WORD_BITS // 4
    return [
        lane(
            "result_data",
            lambda clock: f"{clock.result[0] & word:0{digits}x}" if clock.result_valid else "",
        ),
        lane("result_last", lambda clock: clock.result[1] if clock.result_valid else ""),
    ]


def _wave(lane: Lane, columns: int) -> dict[str, Any]:
    """A lane as WaveDrom has it: a character a column, `.` for no change, `|` for a gap."""
    if not lane.cells:
        return {"name": lane.name, "wave": "p" + "." * (columns - 1)}
    wave, data = "", []
    before: int | str | None = GAP
    for cell in lane.cells:
        if cell is GAP:
            wave += "|"
        elif cell == before:
            wave += "."
        elif isinstance(cell, int):
            wave += str(cell)
        else:
            wave += "=" if cell else "x"
            data += [cell] if cell else []
        before = cell
    return {"name": lane.name, "wave": wave, **({"data": data} if data else {})}


def _columns(clocks: Sequence[int | None]) -> str:
    """Which clocks are shown."""
    runs: list[list[int]] = [[]]
    for clock in clocks:
        if clock is GAP:
            runs.append([])
        else:
            runs[-1].append(clock)
    return "clocks " + ", ".join(f"{run[0]} to {run[-1]}" for run in runs)
