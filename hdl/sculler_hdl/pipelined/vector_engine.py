"""The vector engine: third and fourth order, by a program that runs once a minor interval.

    program ─▶ VectorBanks ─▶ VectorLane ─┬▶ results
                ▲    ▲  ▲                 │
          samples    │  └──── stored ◀────┘
              loaded words

`sculler_hdl.plan.vector` has the algebra, the program and the clocks.
"""

from __future__ import annotations

from amaranth import Cat, Module, Signal, Value, signed
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.lib.memory import BlockMemory
from sculler_hdl.pipelined.vector_banks import (
    VectorBanks,
    load_members,
    sample_members,
    word_layout,
)
from sculler_hdl.pipelined.vector_lane import VectorLane
from sculler_hdl.plan.arrival import at_once
from sculler_hdl.plan.vector.engine import VectorEnginePlan

ACTING = ("step", "last", "grows", "store_left", "store_right", "store_sum", "result")
"""The fields that do something; the others say what with."""


class VectorEngine(wiring.Component):
    """The running sums of third and fourth order, a minor interval after the other.

    Members:
        taken, ends_minor, phase, gyro, accel (clock 0 of a sample): a sample, whether it is its
            minor interval's last, and its number there; accel comes a clock later.
        start (clock 0 of the program): all words of a minor interval are there.
        first, ends_major (with start): it is the first, the last of its major interval.
        left_words, right_words: what is loaded, the first at clock 1, three components each; the
            next one in the clock after each with `shift`.
        finishing (clock `plan.result_clock`): the results of a major interval come.
        totals: of each lane; at `plan.whole_clock` a component of a result.

    One start every `plan.period` clocks at most, three clocks or more after the minor interval's
    last sample.

    Args:
        plan: the plan.
        primitive: whether to instantiate the target's multiplier and memory blocks.
    """

    def __init__(self, plan: VectorEnginePlan, *, primitive: bool = True) -> None:
        self.plan, self.primitive = plan, primitive
        super().__init__(
            {
                **sample_members(plan),
                "first": In(1),
                "ends_major": In(1),
                **load_members(plan),
                "shift": Out(1),
                "finishing": Out(1),
                "totals": Out(data.ArrayLayout(signed(plan.accumulator.total.bits), plan.lanes)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        turn = Signal(3, init=1)  # of three axes, the one that the program's row is at
        fields = self._program(m, turn)
        first, last_major = Signal(), Signal()
        with m.If(self.start):
            m.d.sync += [first.eq(self.first), last_major.eq(self.ends_major)]
        # a row stands for a clock for each of its turns
        begins = turn[plan.latency % 3] if plan.turns == 3 else 1
        m.d.comb += self.finishing.eq(fields.result & last_major & begins)

        m.submodules.banks = banks = VectorBanks(plan)
        at = plan.operand_clock - 1  # from the row's clock to the operands'
        m.d.comb += [
            banks.fields.eq(fields),
            banks.turn.eq(Cat(turn[(axis + at) % 3] for axis in range(3))),
            banks.first.eq(first),
            *(
                getattr(banks, name).eq(getattr(self, name))
                for name in ("taken", "ends_minor", "phase", "start")
            ),
            *(
                getattr(banks, name)[axis].eq(getattr(self, name)[axis])
                for name in ("gyro", "accel", *(f"{side}_words" for side in plan.loads))
                for axis in range(3)
            ),
        ]
        self._load(m, banks)
        self._lanes(m, banks, fields)
        return m

    def _program(self, m: Module, turn: Signal) -> data.View:
        """The word of the program; what acts is 0 where none is read."""
        plan = self.plan
        m.submodules.program = words = BlockMemory(
            plan.target,
            sum(bits for _, bits in plan.fields),
            plan.words,
            written=False,
            primitive=self.primitive,
            logic=not plan.design.has_initial_values,
        )
        row, running = Signal(range(len(plan.words))), Signal()
        m.d.comb += [words.address.eq(row), words.step.eq(1)]
        m.d.sync += turn.eq(turn.rotate_left(1))
        with m.If(self.start):
            m.d.sync += [row.eq(0), running.eq(1), turn.eq(1)]
        with m.Elif(running & (turn[2] if plan.turns == 3 else 1)):
            m.d.sync += row.eq(row + 1)
            with m.If(row == len(plan.words) - 1):
                m.d.sync += [row.eq(0), running.eq(0)]
        active = ControlDelay(m, "running", running).at_clock(words.latency)
        read, fields = data.View(word_layout(plan), words.data), Signal(word_layout(plan))
        for name, _ in plan.fields:
            value = Value.cast(read[name])
            m.d.comb += fields[name].eq(value & active if name in ACTING else value)
        return fields

    def _load(self, m: Module, banks: VectorBanks) -> None:
        """The loaded words, one after another."""
        number, loading = Signal(2), Signal()
        count = max(map(len, self.plan.loads.values()))
        with m.If(self.start):
            m.d.sync += [number.eq(0), loading.eq(1)]
        with m.Elif(loading):
            m.d.sync += [number.eq(number + 1), loading.eq(number != count - 1)]
        m.d.comb += [self.shift.eq(loading), banks.loading.eq(loading), banks.load.eq(number)]

    def _lanes(self, m: Module, banks: VectorBanks, fields: data.View) -> None:
        """The lanes between the banks' operands and the totals that go back there."""
        plan = self.plan
        flags = {
            name: ControlDelay(m, name, fields[name], plan.fetched).at_clock(0)
            for name in ("subtract", "step", "last")
        }
        digit = None
        if plan.page.digit_count > 1:
            word = Value.cast(fields.digit)
            digit = SkewedSignal(m, "digit", word, at_once(len(word), plan.fetched)).at_clock(0)
        for number in range(plan.lanes):
            m.submodules[f"lane{number}"] = lane = VectorLane(plan, primitive=self.primitive)
            m.d.comb += [
                lane.left.eq(banks.left[number]),
                lane.right.eq(banks.right[number]),
                lane.initial.eq(banks.initial[number]),
                self.totals[number].eq(lane.output),
                banks.totals[number].eq(lane.output),
                *(getattr(lane, name).eq(flag) for name, flag in flags.items()),
            ]
            if digit is not None:
                m.d.comb += lane.digit.eq(digit)
