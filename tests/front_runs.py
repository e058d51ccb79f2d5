"""A front end in Amaranth's simulator, on a line that the test draws."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import astuple, dataclass, field
from typing import Any

from amaranth_runs import drive
from sculler_hdl.front.front_end import FrontEnd
from sculler_model.design import Design
from sculler_model.front import FrontCounters, FrontModel, Uart

Shown = tuple[tuple[int, ...], int]
"""A sample's six counts and its fault."""

PORTS = [f"sample_{sensor}_{axis}" for sensor in ("gyro", "accel") for axis in "xyz"]
COUNTERS = list(FrontCounters.__dataclass_fields__)


@dataclass
class Run:
    """What a front end handed over.

    Attributes:
        samples: in order.
        taken_at: the clock of each.
        instants: clocks of `sample_instant`.
        counters: at the end.
    """

    samples: list[Shown] = field(default_factory=list)
    taken_at: list[int] = field(default_factory=list)
    instants: list[int] = field(default_factory=list)
    counters: dict[str, int] = field(default_factory=dict)


def edges(design: Design, stream: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Levels of the line and the clock of each, of bytes and the clocks of their start bits."""
    link = design.front
    assert link is not None
    assert isinstance(link.wire, Uart)
    per_bit = link.clock_hz / link.wire.baud
    found = []
    for clock, byte in stream:
        bits = [0, *(byte >> i & 1 for i in range(8))]
        if link.wire.parity != "none":
            bits.append(byte.bit_count() % 2 ^ (link.wire.parity == "odd"))
        for i, bit in enumerate([*bits, 1]):
            found.append((clock + round(i * per_bit), bit))
    return found


def whole_at(design: Design, clock: int) -> int:
    """The clock in which the receiver has the byte whole whose start bit begins in a clock."""
    link = design.front
    assert link is not None
    assert isinstance(link.wire, Uart)
    step = round(link.wire.baud / link.clock_hz * 2**24)
    sixteenths = 16 * (link.wire.bits_per_byte - 1) + 10  # the last look at the stop bit
    return clock + 2 + -(-sixteenths * 2**20 // step)


def run_line(
    design: Design,
    levels: Iterable[tuple[int, int]],
    clocks: int,
    ready: Callable[[int], int] = lambda clock: 1,
) -> Run:
    """What the hardware hands over in Amaranth's simulator."""
    front, run = FrontEnd(design), Run()

    async def bench(ctx: Any) -> None:
        line = dict(levels)
        ctx.set(front.rx, 1)
        ctx.set(front.sample_ready, ready(0))
        ports = [getattr(front, name) for name in (*PORTS, "sample_fault")]
        ticks = ctx.tick().sample(
            *(front.sample_valid, front.sample_ready, front.sample_instant),
            *(getattr(front, name) for name in COUNTERS),
            *ports,
        )
        now = 0
        if 0 in line:
            ctx.set(front.rx, line[0])
        async for _, _, valid, taken, instant, *shown in ticks:
            if valid and taken:
                run.samples.append((tuple(shown[-7:-1]), shown[-1]))
                run.taken_at.append(now)
            if instant:
                run.instants.append(now)
            now += 1
            if now in line:
                ctx.set(front.rx, line[now])
            ctx.set(front.sample_ready, ready(now))
            if now == clocks:
                run.counters.update(zip(COUNTERS, shown, strict=False))
                break

    drive(front, bench)
    return run


def run_model(design: Design, stream: Iterable[tuple[int, int]], clocks: int) -> Run:
    """The same of the model, which is told the clocks in which bytes are whole."""
    assert design.front is not None
    model = FrontModel(design.front)
    found = []
    for clock, byte in stream:
        found += model.take(byte, clock)
    found += model.until(clocks)
    shown: list[Shown] = [((*s.gyro, *s.accel), int(s.fault)) for s in found]
    return Run(shown, counters=dict(zip(COUNTERS, astuple(model.counters), strict=True)))
