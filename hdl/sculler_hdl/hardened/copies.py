"""What both hardened cores have: copies, what they agree on, what comes of a difference."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from operator import or_
from typing import TypeVar

from amaranth import Cat, Module, Signal, Value

from sculler_hdl.compact.core import CompactCore
from sculler_hdl.pipelined.core import PipelinedCore
from sculler_hdl.plan.ports import counter_ports, sample_ports
from sculler_model.design import Design
from sculler_model.golden import Timing

COPIES = {"detect": 2, "recover": 3}
"""By `hardware.hardening`."""

Core = TypeVar("Core", CompactCore, PipelinedCore)


def copies_of(kind: type[Core], design: Design, primitive: bool) -> list[Core]:
    """As many cores of a kind as the design's hardening takes, tied."""
    assert design.hardware.hardening is not None
    return [
        kind(design, primitive=primitive, tied=True)
        for _ in range(COPIES[design.hardware.hardening])
    ]


_TOGETHER = 2
"""Bits that one look-up table of four inputs compares."""


def agreed(values: Sequence[Value]) -> Value:
    """Of three values the majority, bit by bit; of two the first."""
    if len(values) == 2:
        return values[0]
    a, b, c = (Value.cast(value).as_unsigned() for value in values)
    return a & b | a & c | b & c


def handshake(values: Sequence[Value]) -> Value:
    """Of three levels the majority; two have to be high both."""
    return values[0] & values[1] if len(values) == 2 else agreed(values)


def any_of(values: Sequence[Value]) -> Value:
    """Whether one of them is high."""
    return reduce(or_, values)


class Copies:
    """Copies of a core in a module.

    Args:
        m: the module.
        core: the component that the module is of, with the ports of a core.
        copies: two or three cores, tied.
        timing: of the core that they are.
    """

    def __init__(
        self,
        m: Module,
        core: object,
        copies: Sequence[CompactCore] | Sequence[PipelinedCore],
        design: Design,
        timing: Timing,
    ) -> None:
        self.m = m
        self.core = core
        self.copies = copies
        self.design = design
        self.timing = timing
        self.pair = len(copies) == 2  # which does not know which is right: each keeps to its own
        self.counters = [port.name for port in counter_ports(design)]
        for i, copy in enumerate(copies):
            m.submodules[f"copy{i}"] = copy

    def every(self, name: str) -> list[Value]:
        """An output of each copy."""
        return [getattr(copy, name) for copy in self.copies]

    def common(self, name: str) -> Value:
        """What they agree on."""
        return agreed(self.every(name))

    def connect_samples(self, hold: Value) -> None:
        """The sample port; while `hold` is high nothing is taken."""
        m, ready = self.m, Signal()
        m.d.comb += [
            ready.eq(handshake(self.every("sample_ready")) & ~hold),
            self.core.sample_ready.eq(ready),  # type: ignore[attr-defined]
        ]
        for copy in self.copies:
            m.d.comb += [
                copy.sample_valid.eq(self.core.sample_valid),  # type: ignore[attr-defined]
                copy.agreed_ready.eq(ready),
            ]
            for port in sample_ports(self.design):
                m.d.comb += getattr(copy, port.name).eq(getattr(self.core, port.name))

    def connect(self, name: str) -> Value:
        """What the copies agree on of an output, which goes back to all of them, but of a pair."""
        common = Signal(len(self.every(name)[0]), name=f"common_{name}")
        self.m.d.comb += common.eq(self.common(name))
        for copy in self.copies:
            given = getattr(copy, name) if self.pair else common
            self.m.d.comb += getattr(copy, f"agreed_{name}").eq(given)
        return common

    def differences(self, looked: dict[str, Value]) -> list[Value]:
        """Whether each copy differs, but the first of a pair, two clocks later.

        Args:
            looked: by name of an output whether it means anything in this clock.
        """
        found: list[list[Value]] = [[] for _ in self.copies[self.pair :]]
        for name, where in looked.items():
            for place, each in zip(found, self._parts(name, where), strict=True):
                place.append(each)
        differ = []
        for i, each in enumerate(found):
            differs = Signal(name=f"differs{i}")
            self.m.d.sync += differs.eq(any_of(each))
            differ.append(differs)
        return differ

    def _parts(self, name: str, where: Value) -> list[Value]:
        """Whether each copy's output differs, in registers of a few bits each."""
        m, values = self.m, self.every(name)
        common = Signal(len(values[0]), name=f"agreed_{name}")
        looked = Signal(name=f"{name}_counts")
        m.d.comb += common.eq(agreed(values))
        m.d.sync += looked.eq(where)
        found = []
        for i, value in enumerate(values[self.pair :]):
            bits = Value.cast(value).as_unsigned() ^ common
            parts = [bits[low : low + _TOGETHER].any() for low in range(0, len(common), _TOGETHER)]
            held = Signal(len(parts), name=f"{name}_differs{i}")
            m.d.sync += held.eq(Cat(*parts))
            found.append(held.any() & looked)
        return found

    def restarts(self, differ: Sequence[Value], ended: Value, hold: Signal) -> list[Value]:
        """Starts copies again that differ; returns which are seen to differ and should not.

        Args:
            differ: which do.
            ended: a major interval's last sample was taken in this clock, or lately.
            hold: high from the next clock on while a copy starts.
        """
        m = self.m
        # it may differ until its history has filled, and the results of that are shown
        intervals = max(1, self.design.short_majors) + self.timing.under_way
        clocks = self.timing.startup + 2
        held = Signal(range(clocks + 1))
        m.d.sync += hold.eq(held != 0)
        with m.If(held != 0):
            m.d.sync += held.eq(held - 1)
        seen = []
        others = Value.cast(0)  # of two at once the first one is started again first
        for i, (differs, copy) in enumerate(zip(differ, self.copies, strict=True)):
            ill, restart = Signal(name=f"ill{i}"), Signal(name=f"restarts{i}")
            young = Signal(range(intervals + 1), name=f"young{i}")
            strange = differs & (young == 0)
            m.d.comb += copy.restart.eq(restart)
            m.d.sync += restart.eq(ill & ended & ~others)
            with m.If(strange):
                m.d.sync += ill.eq(1)
            with m.If(ended & (young != 0)):
                m.d.sync += young.eq(young - 1)
            with m.If(ill & ended & ~others):
                m.d.sync += [ill.eq(0), young.eq(intervals), held.eq(clocks), hold.eq(1)]
            others = others | ill
            seen.append(strange)
        return seen

    def tell(self, seen: Value, taken: Value) -> Value:
        """Whether an upset was seen whose results may not all have been taken; a register.

        Args:
            seen: one is.
            taken: the host takes a result whole.
        """
        left = Signal(range(self.timing.under_way + 1))
        with self.m.If(seen):
            self.m.d.sync += left.eq(self.timing.under_way)
        with self.m.Elif(taken & (left != 0)):
            self.m.d.sync += left.eq(left - 1)
        return left != 0
