"""The memories of the vector engine: a bank for each axis."""

from __future__ import annotations

from collections.abc import Sequence

from amaranth import C, Cat, Module, Mux, Signal, Value, signed, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.lib.layout import vector
from sculler_hdl.lib.memory import BlockMemory
from sculler_hdl.plan.arrival import at_once
from sculler_hdl.plan.vector.engine import VectorEnginePlan
from sculler_hdl.plan.vector.page import Form


def word_layout(plan: VectorEnginePlan) -> data.StructLayout:
    """A word of the program."""
    return data.StructLayout({name: unsigned(bits) for name, bits in plan.fields})


def sample_members(plan: VectorEnginePlan) -> dict[str, wiring.Member]:
    """How samples come to the vector engine, and that a minor interval's are whole."""
    words = plan.design.words
    return {
        "taken": In(1),
        "ends_minor": In(1),
        "phase": In(range(plan.design.algorithm.samples)),
        "gyro": In(vector(words.gyro)),
        "accel": In(vector(words.accel)),
        "start": In(1),
    }


def load_members(plan: VectorEnginePlan) -> dict[str, wiring.Member]:
    """The words that are loaded."""
    return {
        f"{side}_words": In(data.ArrayLayout(signed(plan.load_bits(side)), 3))
        for side in plan.loads
    }


class VectorBanks(wiring.Component):
    """Left and right factors and running sums, three components each; and the samples.

    Clock 0 is the one in which a step's operands are given.  Of `fields`, those of a step and those
    of what is stored are there at clock `plan.fetched`.

    Members:
        fields: of a word of the program; what acts is 0 where there is none.
        turn (clock 0): bit i is high while the lane works on axis i; not looked at where each has
            a lane of its own.
        first: the present minor interval is the first of its major interval.
        loading: the loaded words are written; load: to this address.
        left_words, right_words: those words.
        totals (clock `plan.whole`): what is stored.
        taken, ends_minor, phase, gyro, accel, start: as those of `VectorEngine`.
        left, right (clock 0): the operands of each lane.
        initial (clock `plan.accumulator.clock`): what its sum starts from.

    Args:
        plan: of the engine.
    """

    def __init__(self, plan: VectorEnginePlan) -> None:
        self.plan = plan
        page = plan.page
        total = plan.accumulator.total.bits
        super().__init__(
            {
                "fields": In(word_layout(plan)),
                "turn": In(3),
                "first": In(1),
                "loading": In(1),
                "load": In(2),
                **load_members(plan),
                "totals": In(data.ArrayLayout(signed(total), plan.lanes)),
                **sample_members(plan),
                "left": Out(data.ArrayLayout(signed(page.left_range.bits), plan.lanes)),
                "right": Out(data.ArrayLayout(signed(page.right_range.bits), plan.lanes)),
                "initial": Out(data.ArrayLayout(signed(total), plan.lanes)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        samples = self._samples(m)
        self._factors(m, samples)
        self._sums(m)
        return m

    def _word(self, m: Module, name: str, clock: int, bits: int | None = None) -> Value:
        """A field at a clock, or its lowest bits."""
        field = Value.cast(self.fields[name])[:bits]
        return SkewedSignal(m, name, field, at_once(len(field), self.plan.fetched)).at_clock(clock)

    def _flag(self, m: Module, name: str, clock: int) -> Value:
        """A field of one bit that acts, at a clock."""
        return ControlDelay(m, name, self.fields[name], self.plan.fetched).at_clock(clock)

    def _axes(self, lane: int, clock: int) -> list[Value]:
        """Whether a lane works on each axis, for a thing done at a clock in its step."""
        if self.plan.lanes == 3:
            return [C(axis == lane, 1) for axis in range(3)]
        return [self.turn[(axis + clock) % 3] for axis in range(3)]

    def _chosen(self, lane: int, clock: int, banks: Sequence[Value]) -> Value:
        """What the bank of a lane's axis shows."""
        if self.plan.lanes == 3:
            return banks[lane]
        axes = self._axes(lane, clock)
        return Mux(axes[0], banks[0], Mux(axes[1], banks[1], banks[2]))

    def _memory(self, m: Module, name: str, bits: int, words: int) -> BlockMemory:
        memory = BlockMemory(self.plan.target, bits, [0] * words, primitive=False)
        m.submodules[name] = memory
        m.d.comb += memory.step.eq(1)
        return memory

    def _samples(self, m: Module) -> list[Value]:
        """The samples of the banks, at clock -1: written as they come, read an interval later."""
        plan, counts = self.plan, self.plan.design.words
        if not plan.has_samples:
            return []
        half, other = Signal(), Signal()  # that is written, that is read
        taken = ControlDelay(m, "taken", self.taken)
        ends = ControlDelay(m, "ends_minor", self.ends_minor)
        with m.If(ends.at_clock(1)):
            m.d.sync += half.eq(~half)
        with m.If(self.start):
            m.d.sync += other.eq(~half)
        phase_bits = (plan.phases - 1).bit_length()
        phase = SkewedSignal(m, "phase", self.phase, at_once(len(self.phase)))
        number = Signal(phase_bits)
        m.d.comb += number.eq(Mux(self.taken, phase.at_clock(0), phase.at_clock(1)))
        bits = max(counts.gyro.bits, counts.accel.bits)
        shown = []
        for axis in range(3):
            memory = self._memory(m, f"samples_{axis}", bits, plan.sample_words)
            count = Signal(signed(bits), name=f"count_{axis}")
            m.d.comb += [
                count.eq(Mux(self.taken, self.gyro[axis], self.accel[axis])),
                memory.write.eq(self.taken | taken.at_clock(1)),
                memory.write_address.eq(Cat(number, ~self.taken, half)),
                memory.write_data.eq(count),
                memory.address.eq(Cat(self.fields.left[: phase_bits + 1], other)),
            ]
            shown.append(memory.data.as_signed())
        return shown

    def _factors(self, m: Module, samples: Sequence[Value]) -> None:
        """The operands, and what is written to their memories."""
        plan, page = self.plan, self.plan.page
        lefts, rights = (
            self._written(m, side, getattr(page, f"{side}_range").bits, vectors)
            for side, vectors in (("left", plan.left), ("right", plan.right))
        )
        form = self._word(m, "form", -1)
        forms = {each: form == each.value for each in Form}
        counts = ~(self._word(m, "old", -1) & self.first)
        is_constant = self._word(m, "constant", -1)
        constant = self._constant(m)
        for lane in range(plan.lanes):
            axis = [
                self._chosen(lane, -1, [Value.cast(each) for each in (lefts[i:] + lefts[:i])])
                for i in range(3)
            ]
            left = Mux(forms[Form.FORWARD], axis[1], Mux(forms[Form.BACKWARD], axis[2], axis[0]))
            if samples:
                sample = self._chosen(lane, -1, samples)
                left = Mux(self._word(m, "sample", -1), sample, left.as_signed())
            axis = [self._chosen(lane, -1, rights[i:] + rights[:i]) for i in range(3)]
            right = Mux(forms[Form.BACKWARD], axis[1], axis[2])
            left_bits, right_bits = page.left_range.bits, page.right_range.bits
            for name, value, bits in (("left", left, left_bits), ("right", right, right_bits)):
                register = Signal(signed(bits), name=f"{name}_{lane}", reset_less=True)
                if name == "left":
                    gated = Signal(signed(bits), name=f"gated_{lane}")
                    m.d.comb += gated.eq(value)
                    m.d.sync += register.eq(gated.as_unsigned() & counts.replicate(bits))
                else:
                    m.d.sync += register.eq(Mux(is_constant, constant, value.as_signed()))
                m.d.comb += getattr(self, name)[lane].eq(register)

    def _constant(self, m: Module) -> Value:
        """The whole number that a step names, at clock -1."""
        constants, bits = self.plan.page.constants, self.plan.page.right_range.bits
        number = self._word(m, "right", -2, (len(constants) - 1).bit_length())
        is_each = [number == i for i in range(len(constants))]
        register = Signal(signed(bits), name="constant", reset_less=True)
        # not a Switch: linters take the words of one that is short for overlapping
        m.d.sync += register.eq(
            Cat(
                Cat(
                    here for here, each in zip(is_each, constants, strict=True) if each >> bit & 1
                ).any()
                for bit in range(bits)
            )
        )
        return register

    def _written(self, m: Module, side: str, bits: int, vectors: Sequence[str]) -> list[Value]:
        """The banks of the left or right factors, at clock -1; they are read as the fields say."""
        plan = self.plan
        loads = len(plan.loads.get(side, ()))
        clock = plan.fetched + plan.store_delay
        stores = self._flag(m, f"store_{side}", clock)
        address_bits = (max(len(vectors), 2) - 1).bit_length()
        address = self._word(m, "store", clock, address_bits)
        loading = Signal(name=f"loads_{side}")
        if loads:
            m.d.comb += loading.eq(self.loading & (self.load < loads))
        loaded = getattr(self, f"{side}_words") if loads else [C(0, 1)] * 3
        shown = []
        for axis in range(3):
            memory = self._memory(m, f"{side}_{axis}", bits, max(len(vectors), 2))
            lane = axis if plan.lanes == 3 else 0
            total = self.totals[lane]
            if side == "right":
                total = self._digit(m, total, clock)
            word = Signal(signed(bits), name=f"{side}_loaded_{axis}")
            m.d.comb += [
                word.eq(loaded[axis]),
                memory.write.eq(loading | (stores & self._axes(lane, plan.whole)[axis])),
                memory.write_address.eq(Mux(loading, self.load, address)),
                memory.write_data.eq(Mux(loading, word.as_unsigned(), total[:bits])),
                memory.address.eq(self.fields[side][:address_bits]),
            ]
            shown.append(memory.data.as_signed())
        return shown

    def _digit(self, m: Module, total: Value, clock: int) -> Value:
        """What of a total is stored on the right: its lowest bits, or a digit."""
        page = self.plan.page
        bits = page.right_range.bits
        if page.digit_count == 1:
            return total[:bits]
        wide = Signal(signed(page.digit_count * page.digit_bits + bits))
        m.d.comb += wide.eq(total)
        number, stored = self._word(m, "store_digit", clock), total[:bits]
        for digit in range(page.digit_count):
            low = digit * page.digit_bits
            top = digit + 1 == page.digit_count
            piece = wide[low : low + (bits if top else page.digit_bits)]
            stored = Mux(number == digit + 1, piece, stored)
        return stored

    def _sums(self, m: Module) -> None:
        """The running sums: what a total starts from, and what it ends with."""
        plan = self.plan
        bits, first_clock = plan.accumulator.total.bits, plan.accumulator.clock
        clock = plan.fetched + plan.store_delay
        stores = self._flag(m, "store_sum", clock)
        stored_at = self._word(m, "store_sum_at", clock)
        address = self._word(m, "sum", first_clock - 1 - plan.latency)
        grows = self._flag(m, "grows", first_clock - 1) & ~self.first
        shown = []
        for axis in range(3):
            memory = self._memory(m, f"sums_{axis}", bits, max(len(plan.sums), 2))
            lane = axis if plan.lanes == 3 else 0
            m.d.comb += [
                memory.write.eq(stores & self._axes(lane, plan.whole)[axis]),
                memory.write_address.eq(stored_at),
                memory.write_data.eq(self.totals[lane]),
                memory.address.eq(address),
            ]
            shown.append(memory.data)
        for lane in range(plan.lanes):
            register = Signal(bits, name=f"initial_{lane}", reset_less=True)
            chosen = self._chosen(lane, first_clock - 1, shown)
            m.d.sync += register.eq(chosen & grows.replicate(bits))
            m.d.comb += self.initial[lane].eq(register)
