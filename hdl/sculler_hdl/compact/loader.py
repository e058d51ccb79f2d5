"""Writes each sample's digits into the sample memory."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from amaranth import C, Cat, Module, Mux, Signal, Value, signed, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.rails import differ_from_sign
from sculler_hdl.plan.compact.digits import OPERAND, digit_count
from sculler_hdl.plan.compact.plan import CompactPlan
from sculler_model.golden import WORD_BITS


class Loader(wiring.Component):
    """Takes a sample in one clock and writes its digits in the clocks after, one each.

    A sample has a slot of the memory, the next one for each sample, round and round.  In a slot
    stand the digits of gyro x, y, z, then of accelerometer x, y, z, least significant first.
    After reset every slot is written with zeros, because samples before the first are zero.

    Members:
        take (in): a sample is taken in this clock; not while `busy`.
        gyro, accel (in): its counts.
        busy (out): writing.
        loaded (out): a sample's last digit is written in this clock.
        rail (out): the count whose digit was being written two clocks before is at its rail.
        slot (out): the newest sample's.
        write, address, data (out): to the sample memory; the address is the index in the slot,
            then the slot.
        told_rail (in), where the rail is `told`: that of the sample that is taken.

    Args:
        plan: the plan.
        told: whether a sample comes with its own mark of a count at its rail.
        further: more members.
    """

    def __init__(
        self,
        plan: CompactPlan,
        *,
        told: bool = False,
        further: Mapping[str, wiring.Member] | None = None,
    ) -> None:
        self.told = told
        self.design = plan.design
        self.digits = plan.sizes.digits_per_count
        self.slots = plan.sizes.kept_samples
        self.words = plan.sizes.sample_words
        index_bits, slot_bits = plan.sizes.index_bits, plan.sizes.slot_bits
        words = self.design.words
        super().__init__(
            {
                "take": In(1),
                "gyro": In(data.ArrayLayout(signed(words.gyro.bits), 3)),
                "accel": In(data.ArrayLayout(signed(words.accel.bits), 3)),
                "busy": Out(1, init=int(further is None)),
                "loaded": Out(1),
                "rail": Out(1),
                "slot": Out(slot_bits),
                "write": Out(1),
                "address": Out(index_bits + slot_bits),
                "data": Out(unsigned(OPERAND.bits)),
                **({"told_rail": In(1)} if told else {}),
                **(further or {}),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        counts = self._counts()
        index = Signal(range(self.words))
        clearing = Signal(init=1)
        last = Signal()
        m.d.comb += [
            last.eq(index == self.words - 1),
            self.loaded.eq(self.busy & last & ~clearing),
            self.write.eq(self.busy),
            self.address.eq(Cat(index, self.slot)),
        ]

        self._move(m, counts, self._top(m, index))
        m.d.comb += self.data.eq(self._digit(counts[0], index))
        if self.told:
            at_rail = Signal()
            with m.If(self.take):
                m.d.sync += at_rail.eq(self.told_rail)
            m.d.comb += self.rail.eq(self.busy & ~clearing & at_rail)
        else:
            self._find_rail(m, counts[0], self.busy & ~clearing, index)

        with m.If(self.busy):
            m.d.sync += index.eq(index + 1)
            with m.If(last):
                m.d.sync += index.eq(0)
                with m.If(clearing):
                    m.d.sync += self.slot.eq(self.slot + 1)
                with m.If(~clearing | (self.slot == self.slots - 1)):
                    m.d.sync += [self.busy.eq(0), clearing.eq(0)]
        with m.If(self.take):
            m.d.sync += [self.busy.eq(1), self.slot.eq(self.slot + 1)]
        return m

    def _counts(self) -> list[Signal]:
        """Registers of the sample's counts."""
        words = self.design.words
        bits = max(words.gyro.bits, words.accel.bits)
        return [Signal(signed(bits), name=f"count{i}") for i in range(6)]

    def _move(self, m: Module, counts: list[Signal], written: Value) -> None:
        """The counts are taken, and move up by one as each has been written."""
        sample = [self.gyro[i] for i in range(3)] + [self.accel[i] for i in range(3)]
        with m.If(self.take):
            m.d.sync += [count.eq(new) for count, new in zip(counts, sample, strict=True)]
        with m.Elif(written):
            m.d.sync += [count.eq(new) for count, new in pairwise(counts)]

    def _top(self, m: Module, index: Signal) -> Value:
        """The word of this index is a count's last."""
        if self.digits < 3:
            return C(1) if self.digits == 1 else index[0]
        self.digit = Signal(range(self.digits))
        top = self.digit == self.digits - 1
        with m.If(self.take):
            m.d.sync += self.digit.eq(0)
        with m.Elif(self.busy):
            m.d.sync += self.digit.eq(Mux(top, 0, self.digit + 1))
        return top

    def _find_rail(self, m: Module, count: Signal, loads: Value, index: Signal) -> None:
        """At a rail every bit differs from the sign, which fills up a narrower count."""
        parts = differ_from_sign(count, index < self.words // 2, self.design.words)
        few = Signal(len(parts))
        loaded = Signal()
        m.d.sync += [loaded.eq(loads), self.rail.eq(loaded & few.all())]
        m.d.sync += [bit.eq(differ) for bit, differ in zip(few, parts, strict=True)]

    def _digit(self, count: Signal, index: Signal) -> Value:
        """The digit to write: signed if it is its count's only or top one."""
        words = self.design.words
        if self.digits == 1:
            return count
        if self.digits > 2:
            gyro, accel = (
                self._of_many(count, digit_count(w.bits)) for w in (words.gyro, words.accel)
            )
            return Mux(index < self.words // 2, gyro, accel)
        low = Cat(count[:WORD_BITS], C(0, OPERAND.bits - WORD_BITS)).as_signed()
        gyro_single, accel_single = (
            digit_count(counts.bits) == 1 for counts in (words.gyro, words.accel)
        )
        if gyro_single or accel_single:
            single = index < 6 if gyro_single else index >= 6
            low = Mux(single, count[: OPERAND.bits].as_signed(), low)
        return Mux(index[0], count[WORD_BITS:].as_signed(), low)

    def _of_many(self, count: Signal, needed: int) -> Value:
        """The same of a count that needs so many digits; those above it nobody reads."""
        digits = [
            Cat(count[WORD_BITS * i : WORD_BITS * (i + 1)], C(0, OPERAND.bits - WORD_BITS))
            for i in range(needed - 1)
        ]
        top = count[WORD_BITS * (needed - 1) :][: OPERAND.bits].as_signed()
        chosen: Value = top
        for i, digit in enumerate(digits):
            chosen = Mux(self.digit == i, digit.as_signed(), chosen)
        return chosen
