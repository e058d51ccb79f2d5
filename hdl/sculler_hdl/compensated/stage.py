"""What takes known errors out of samples before the core: exact integers, one product a clock."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from amaranth import C, Cat, Module, Mux, Signal, Value, signed
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.accumulator import Accumulator
from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.lib.memory import BlockMemory
from sculler_hdl.lib.multiplier import Multiplier
from sculler_hdl.lib.rails import differ_from_sign
from sculler_hdl.plan.arrival import last_clock
from sculler_hdl.plan.compensation import COUNTS, FIRST_STEP, PLACES, CompensationStage, Kind


class Compensator(wiring.Component):
    """Takes a sample of the sensor, and offers the sample of the core that is made of it.

    The counts are written into a memory of the last samples, one a clock.  Then the products of the
    plan's steps run through one multiplier and one accumulator.  A sum goes to the end of the row
    of outputs when it is whole.

    Latency: `plan.clocks`, from the clock that takes a sample to the first in which the other is
    offered.  One sample at a time: the next is taken in the clock after the other was, at the
    earliest.  Counts before the first sample after reset are zero.

    Members:
        sample_valid, sample_ready: the handshake of the sensor's sample.
        gyro, accel, fault (in): its counts and its mark.
        lost (in): a sample was lost before it.
        made_valid, made_ready: the handshake of the core's sample.
        made (out): its six numbers, gyro x, y, z and accelerometer x, y, z.
        made_fault, made_rail (out): a sample that it is made of had the mark, a count at its rail.
        made_lost (out): a sample was lost before the newest of them.

    Args:
        plan: the plan.
        primitive: whether to instantiate the target's own blocks.
    """

    def __init__(self, plan: CompensationStage, *, primitive: bool = True) -> None:
        self.plan = plan
        self.primitive = primitive
        words = plan.design.words
        super().__init__(
            {
                "sample_valid": In(1),
                "sample_ready": Out(1, init=1),
                "gyro": In(data.ArrayLayout(signed(words.gyro.bits), 3)),
                "accel": In(data.ArrayLayout(signed(words.accel.bits), 3)),
                "fault": In(1),
                "lost": In(1),
                "made_valid": Out(1),
                "made_ready": In(1),
                "made": Out(data.ArrayLayout(signed(plan.sums.bits), COUNTS)),
                "made_fault": Out(1),
                "made_rail": Out(1),
                "made_lost": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        take, given = Signal(), Signal()
        m.d.comb += [
            take.eq(self.sample_valid & self.sample_ready),
            given.eq(self.made_valid & self.made_ready),
        ]
        m.d.sync += self.sample_ready.eq((self.sample_ready & ~take) | given)
        slot = Signal(self.plan.slot_bits)
        age = Signal(range(self.plan.reach + 1))  # samples since reset but the newest, as it counts
        begun = Signal()
        with m.If(take):
            m.d.sync += [slot.eq(slot + 1), begun.eq(1)]
            with m.If(begun & (age != self.plan.reach)):
                m.d.sync += age.eq(age + 1)
        m.submodules.samples = samples = BlockMemory(
            self.plan.target,
            self.plan.counts.bits,
            [0] * (PLACES << self.plan.slot_bits),
            primitive=self.primitive,
        )
        count, loads, is_gyro = self._load(m, take, slot, samples)
        self._marks(m, take, count, loads, is_gyro)
        whole = self._sums(m, take, slot, age, samples)
        with m.If(whole):
            m.d.sync += self.made_valid.eq(1)
        with m.If(given):
            m.d.sync += self.made_valid.eq(0)
        return m

    def _load(
        self, m: Module, take: Value, slot: Value, samples: BlockMemory
    ) -> tuple[Signal, Signal, Value]:
        """Write the counts, one a clock: the one that is, whether one is, whether it's a gyro's."""
        bits = self.plan.counts.bits
        counts = [Signal(signed(bits), name=f"count{i}", reset_less=True) for i in range(COUNTS)]
        sample = [sensor[i] for sensor in (self.gyro, self.accel) for i in range(3)]
        loads, place = Signal(), Signal(range(COUNTS))
        with m.If(take):
            m.d.sync += [count.eq(new) for count, new in zip(counts, sample, strict=True)]
            m.d.sync += [loads.eq(1), place.eq(0)]
        with m.Elif(loads):
            m.d.sync += [count.eq(new) for count, new in pairwise(counts)]
            m.d.sync += place.eq(place + 1)
            with m.If(place == COUNTS - 1):
                m.d.sync += [loads.eq(0), place.eq(0)]
        m.d.comb += [
            samples.write.eq(loads),
            samples.write_address.eq(_address(place, slot)),
            samples.write_data.eq(counts[0]),
        ]
        return counts[0], loads, place < COUNTS // 2

    def _marks(self, m: Module, take: Value, count: Signal, loads: Signal, is_gyro: Value) -> None:
        """Faults and rails of the samples that one is made of, the newest first."""
        kept = self.plan.reach + 1
        faults, rails = Signal(kept), Signal(kept)
        parts = differ_from_sign(count, is_gyro, self.plan.design.words)
        few = Signal(len(parts))
        loaded = Signal()
        m.d.sync += loaded.eq(loads)
        m.d.sync += [bit.eq(differ) for bit, differ in zip(few, parts, strict=True)]
        with m.If(loaded & few.all()):
            m.d.sync += rails[0].eq(1)
        with m.If(take):
            m.d.sync += [
                faults.eq(Cat(self.fault, faults[:-1])),
                rails.eq(Cat(C(0, 1), rails[:-1])),
                self.made_lost.eq(self.lost),
            ]
        m.d.comb += [self.made_fault.eq(faults.any()), self.made_rail.eq(rails.any())]

    def _sums(self, m: Module, take: Value, slot: Value, age: Value, samples: BlockMemory) -> Value:
        """Run the steps; high in the clock in which the last of the outputs is whole."""
        plan = self.plan
        m.submodules.multiplier = multiplier = Multiplier(
            plan.multiplier, plan.limb, primitive=self.primitive
        )
        m.submodules.accumulator = accumulator = Accumulator(plan.accumulator)
        started = ControlDelay(m, "started", take).at_clock(FIRST_STEP)
        runs, number = Signal(), Signal(range(len(plan.steps)))
        final = number == len(plan.steps) - 1
        steps = Signal()  # this clock has a step: its number
        m.d.comb += steps.eq(runs | started)
        with m.If(steps):
            m.d.sync += [runs.eq(~final), number.eq(Mux(final, 0, (number + 1)[: len(number)]))]

        done = ControlDelay(m, "begun", steps).at_clock(1)
        told = self._told(m, number, slot, age, samples)
        ends = ControlDelay(m, "ends", told.last & done, 1)
        adds = ControlDelay(m, "adds", told.adds & done, 1)
        m.d.comb += multiplier.left.eq(self._operands(m, told, samples, multiplier, done))
        m.d.comb += accumulator.input.eq(multiplier.output)
        assert multiplier.arrival == plan.product.arrival
        finals = ControlDelay(m, "final", final & steps)
        clock = plan.operands + plan.accumulator.clock
        m.d.comb += [
            accumulator.step.eq(adds.at_clock(clock)),
            accumulator.last.eq(ends.at_clock(clock)),
        ]
        total = SkewedSignal(m, "sum", accumulator.newest, plan.accumulator.arrival)
        made = [Signal(plan.sums.bits, name=f"made{i}", reset_less=True) for i in range(COUNTS)]
        with_sum = total.at_clock(last_clock(plan.accumulator.arrival))
        moves, whole = ends.at_clock(plan.summed), finals.at_clock(plan.summed)
        with m.If(moves):
            m.d.sync += [one.eq(then) for one, then in pairwise([*made, with_sum])]
        m.d.comb += [self.made[i].eq(one) for i, one in enumerate(made)]
        return whole

    def _told(
        self, m: Module, number: Value, slot: Value, age: Value, samples: BlockMemory
    ) -> _Told:
        """What a step is, a clock after it began; the word it reads is asked for then."""
        plan = self.plan
        told = _Told(plan)
        address = Signal(len(samples.address))
        m.d.sync += [signal.eq(0) for signal in told if signal is not told.factor]
        with m.Switch(number):
            for i, step in enumerate(plan.steps):
                with m.Case(i):
                    m.d.sync += [told.factor.eq(step.factor), told.last.eq(step.last)]
                    m.d.sync += told.adds.eq(step.adds)
                    if step.kind in (Kind.COUNT, Kind.HOLD):
                        back = (slot - step.lag)[: len(slot)]
                        m.d.sync += address.eq(_address(C(step.source, 3), back))
                        m.d.sync += told.counts.eq(C(step.lag, len(age) + 1) <= age)
                    if step.kind == Kind.CONSTANT:
                        m.d.sync += told.constant.eq(1 << step.power)
                    if step.kind == Kind.HOLD:
                        m.d.sync += told.holds.eq(1)
                    if step.kind == Kind.PAIR:
                        m.d.sync += [told.first.eq(1 << step.pair[0])]
                        m.d.sync += [told.second.eq(1 << step.pair[1])]
                    if step.kind == Kind.PRODUCT:
                        m.d.sync += told.product.eq(1 << step.product)
        m.d.comb += [samples.step.eq(1), samples.address.eq(address)]
        return told

    def _operands(
        self, m: Module, told: _Told, samples: BlockMemory, multiplier: Multiplier, done: Value
    ) -> Value:
        """Both operands, `plan.operands` clocks after the step; the right one is connected."""
        plan = self.plan
        read, bits = plan.operands - 1, plan.counts.bits

        def then(value: Signal) -> Value:
            """What a step is, when the word it reads is there."""
            word = SkewedSignal(m, value.name, value, ((len(value), 1),))
            return word.at_clock(read)

        counts = then(told.counts)
        word = Signal(signed(bits), name="word")
        m.d.comb += word.eq(samples.data & counts.replicate(bits))
        left: Value = word | then(told.constant)
        right: Value = then(told.factor).as_signed()
        if plan.pairs:
            held = [Signal(signed(bits), name=f"held{i}", reset_less=True) for i in range(3)]
            with m.If(then(told.holds)):
                m.d.sync += [one.eq(following) for one, following in pairwise([*held, word])]
            first, second = then(told.first), then(told.second)
            products = self._products(m, told, multiplier, done)
            chosen = [(first[i], one) for i, one in enumerate(held)] + list(
                zip(then(told.product), products, strict=True)
            )
            is_held = first.any() | then(told.product).any()
            left = Mux(is_held, _one_of(chosen), left.as_signed())
            right = Mux(second.any(), _one_of(list(zip(second, held, strict=True))), right)
        operand = Signal(signed(plan.left.bits), reset_less=True)
        factor = Signal(signed(plan.right.bits), name="right", reset_less=True)
        m.d.sync += [operand.eq(left.as_signed()), factor.eq(right)]
        m.d.comb += multiplier.right.eq(factor)
        return operand

    def _products(
        self, m: Module, told: _Told, multiplier: Multiplier, done: Value
    ) -> list[Signal]:
        """The products of two counts, held from when they are there."""
        plan = self.plan
        pair = ControlDelay(m, "pair", told.first.any() & done, 1)
        arrival = plan.product.arrival
        whole = SkewedSignal(m, "product", multiplier.output, arrival).at_clock(last_clock(arrival))
        bits = plan.left.bits
        products = [
            Signal(signed(bits), name=f"product{i}", reset_less=True)
            for i in range(len(plan.pairs))
        ]
        with m.If(pair.at_clock(plan.operands + last_clock(arrival))):
            following = [*products[1:], whole[:bits].as_signed()]
            m.d.sync += [one.eq(then) for one, then in zip(products, following, strict=True)]
        return products


class _Told:
    """What a step is.

    Attributes:
        factor: that its operand is multiplied by.
        constant: its operand, where that is one.
        counts: it reads a count, which is not before the first.
        last, adds: as in `Step`.
        holds: the count that is read is held.
        first, second: of a pair, one bit a gyro.
        product: which held product it multiplies, one bit each.
    """

    def __init__(self, plan: CompensationStage) -> None:
        self.factor = Signal(signed(plan.factor_bits), name="factor")
        self.constant = Signal(plan.counts.bits, name="constant")
        self.counts, self.last, self.adds = (Signal(name=n) for n in ("counts", "last", "adds"))
        self.holds = Signal(name="holds")
        self.first, self.second = Signal(3, name="first"), Signal(3, name="second")
        self.product = Signal(max(len(plan.pairs), 1), name="product_number")
        self._pairs = bool(plan.pairs)

    def __iter__(self) -> Iterator[Signal]:
        yield from (self.factor, self.constant, self.counts, self.last, self.adds)
        if self._pairs:
            yield from (self.holds, self.first, self.second, self.product)


def _one_of(choices: list[tuple[Value, Signal]]) -> Value:
    """The one whose flag is high, signed; 0 for none."""
    bits = max(len(value) for _, value in choices)
    total: Value = C(0, bits)
    for flag, value in choices:
        wide = Cat(value, value[-1].replicate(bits - len(value)))
        total = total | (wide & flag.replicate(bits))
    return total.as_signed()


def _address(place: Value, slot: Value) -> Value:
    """Of a count in the memory of samples."""
    return Cat(place, C(0, 3 - len(place)), slot)
