"""The engine: a multiplier, an accumulator, their memories and the program that drives them.

    program ─▶ addresses ─▶ left memory ───────────┐
                       │                           ├─▶ DigitMultiplier ─▶ ± ─▶ accumulator ─▶ store
                       └──▶ right | sample memory ─┘                       (0 | same | >> 16)

Each column of the figure is a stage of `Pipeline`; the program word of a clock holds what each
stage does in it (`microcode`).
"""

from __future__ import annotations

from amaranth import C, Cat, Module, Mux, Signal, Value, signed
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.compact.control import CONDITIONS
from sculler_hdl.compact.multiplier import DigitMultiplier
from sculler_hdl.lib.delay import ControlDelay
from sculler_hdl.lib.memory import BlockMemory
from sculler_hdl.plan.compact.digits import OPERAND
from sculler_hdl.plan.compact.instructions import When
from sculler_hdl.plan.compact.plan import CompactPlan
from sculler_hdl.plan.ports import channel_bits
from sculler_model.design import STATUS_BITS, STATUS_LOST, STATUS_RAIL
from sculler_model.golden import WORD_BITS, words_per_column, words_per_result

BITS = OPERAND.bits
STATUS = range(STATUS_BITS)
RAIL, LOST = (mark.bit_length() - 1 for mark in (STATUS_RAIL, STATUS_LOST))


class Engine(wiring.Component):
    """Runs the program of one phase after another, each when it is launched.

    Members:
        launch (in): the newest sample is loaded and has work; not before the program of the one
            before has ended.
        conditions, slot (in): of the newest sample, looked at in the clock of `launch`.
        at_rail (in): a count of its major interval stood at its rail; looked at two clocks later.
        busy (out): from launch until the next sample with work may be taken.
        publish (out): the last of a major interval's words is being stored.
        starting (out): from reset until the constants stand in their memories.
        step (out): a clock in which the pipeline moves on.
        sample_address (out), sample_data (in): to the sample memory, slot above index.
        store, store_address, store_data (out): to the result memory.
        bank (out): of the result memory, that goes to, counted from the one being filled.
        channel, phase (in), owner (out), where there are channels: whose the newest sample is and
            its phase, looked at in the clock of `launch`; whose that is which it works on.
        storing, digit (out), agreed_digit (in), where it is `tied`: a digit is stored, what it is,
            and what is stored for it instead, unless `starting`.

    Latency: `plan.timing`; an instruction every `plan.pipeline.step` clocks.

    Args:
        plan: the plan.
        primitive: whether to instantiate the target's own blocks.
        tied: whether it is one of several that agree on what they store.
    """

    def __init__(self, plan: CompactPlan, *, primitive: bool = True, tied: bool = False) -> None:
        self.plan = plan
        self.tied = tied
        self.design = design = plan.design
        self.primitive = primitive
        self.index_bits = plan.sizes.index_bits
        self.slot_bits = plan.sizes.slot_bits
        self.banks = plan.microcode.banks
        self.left, self.right = (
            BlockMemory(plan.target, BITS, [0] * words, primitive=primitive)
            for words in (self.banks.words, len(plan.program.right.names))
        )
        # of the sample that is worked on
        self.newest = Signal(self.slot_bits)
        self.present = Signal(CONDITIONS)
        self.rail = Signal()
        # two bits of the status, put in where it is stored, so that they need no instruction
        self.marks = {RAIL: Signal(name="rail_mark"), LOST: Signal(name="lost_mark")}
        number = channel_bits(design)
        channels = (
            {
                "channel": In(number),
                "phase": In(range(design.algorithm.samples)),
                "owner": Out(number),
            }
            if self.banks.own
            else {}
        )
        ties = {"storing": Out(1), "digit": Out(BITS), "agreed_digit": In(BITS)} if tied else {}
        super().__init__(
            {
                "launch": In(1),
                "conditions": In(CONDITIONS),
                "at_rail": In(1),
                "slot": In(self.slot_bits),
                "busy": Out(1),
                "publish": Out(1),
                "starting": Out(1, init=1),
                "step": Out(1),
                "sample_address": Out(self.index_bits + self.slot_bits),
                "sample_data": In(signed(BITS)),
                "store": Out(1),
                "store_address": Out(range(words_per_result(design))),
                "store_data": Out(WORD_BITS),
                "bank": Out(plan.sizes.bank_bits),
                **channels,
                **ties,
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        operands, word = self._fetch(m)
        left, right = self._operands(m, operands, word)
        constant = operands.as_value()[: self.plan.program.constant_bits].as_signed()
        digit = self._accumulate(m, word, left, right, constant)
        if self.tied:
            stores = word.store_left | word.store_right | word.store_result
            stored = Signal(BITS)
            m.d.comb += [
                self.storing.eq(stores & self.step),
                self.digit.eq(digit),
                stored.eq(Mux(self.starting, digit, self.agreed_digit)),
            ]
            digit = stored
        bank_bits = (word.sample, word.release)[: len(self.bank)]
        for memory, store in ((self.left, word.store_left), (self.right, word.store_right)):
            m.d.comb += [
                memory.write.eq(store & self.step),
                memory.write_address.eq(word.address),
                memory.write_data.eq(digit),
            ]
        if self.banks.own:
            address = word.address[: self.banks.bank_bits]
            m.d.comb += self.left.write_address.eq(Cat(address, self._bank(word.store_own)))
        m.d.comb += [
            self.store.eq(word.store_result & self.step),
            self.store_address.eq(word.address),
            self.store_data.eq(
                digit[:WORD_BITS] | Cat(self.marks.get(bit, C(0, 1)) for bit in STATUS)
            ),
            self.bank.eq(Cat(self.starting & bit for bit in bank_bits)),
        ]
        return m

    def _bank(self, own: Value) -> Value:
        """The bank of the left memory where a word stands: the channel's own, or the common one."""
        number = len(self.left.address) - self.banks.bank_bits
        return Mux(own, self.owner, self.banks.common_bank)[:number]

    def _fetch(self, m: Module) -> tuple[data.View, data.View]:
        """The program counter and memory; returns the halves of words that act in this step."""
        code = self.plan.microcode
        halves = {"operands": code.operands, "actions": code.actions}
        layout = data.StructLayout({k: data.StructLayout(v) for k, v in halves.items()})
        m.submodules.program = words = BlockMemory(
            self.plan.target,
            layout.size,
            code.packed(),
            written=False,
            primitive=self.primitive,
            logic=not self.design.has_initial_values,
        )
        fetched = data.View(layout, words.data)
        word = Signal(layout["actions"].shape)
        status = self.design.columns.index("status") * words_per_column(self.design)
        is_status = fetched.actions.address == status
        # until then it is unknown what the memory shows; words that act come later in any case
        settling = Signal(range(words.latency + 1), init=words.latency)
        with m.If(self.step):
            m.d.sync += [
                word.eq(fetched.actions),
                self.marks[RAIL].eq(self.rail & is_status),
                self.marks[LOST].eq(self.present.lost & is_status),
            ]
            with m.If(settling != 0):
                m.d.sync += [word.eq(0), settling.eq(settling - 1)]
        counter = Signal(range(len(code.words)))
        running = Signal(init=1)
        m.d.comb += [words.address.eq(counter), words.step.eq(self.step)]

        self._pace(m)
        with m.If(self.step & running):
            m.d.sync += counter.eq(counter + 1)
            with m.If(counter == len(code.words) - 1):
                m.d.sync += counter.eq(code.startup)
        with m.If(self.step & word.last):
            m.d.sync += [running.eq(0), self.starting.eq(0)]
        with m.If(self.step & word.release):
            m.d.sync += self.busy.eq(0)
        with m.If(self.launch):
            m.d.sync += [
                running.eq(1),
                self.busy.eq(1),
                self.newest.eq(self.slot),
                self.present.eq(self.conditions),
            ]
            if self.banks.own:
                (_, start), *others = code.starts.items()
                for phase, another in others:
                    start = Mux(self.phase == phase - 1, another, start)
                m.d.sync += [self.owner.eq(self.channel), counter.eq(start)]
        with m.If(ControlDelay(m, "launched", self.launch).at_clock(2)):
            m.d.sync += self.rail.eq(self.at_rail)
        m.d.comb += self.publish.eq(self.step & word.publish & self.present.major_end)
        return fetched.operands, word

    def _pace(self, m: Module) -> None:
        """The clocks in which a step ends."""
        if self.plan.pipeline.step == 1:
            m.d.comb += self.step.eq(1)
            return
        clock = Signal(range(self.plan.pipeline.step))
        # constants need no multiplication
        m.d.comb += self.step.eq((clock == self.plan.pipeline.step - 1) | self.starting)
        m.d.sync += clock.eq(clock + 1)
        with m.If(self.step | self.launch):
            m.d.sync += clock.eq(0)

    def _operands(self, m: Module, operands: data.View, word: data.View) -> tuple[Value, Value]:
        """From the addresses in the word to the two operands."""
        m.submodules.left, m.submodules.right = self.left, self.right
        zero = self.banks.within(self.plan.program.idle.left.address)
        zero |= self.banks.common_bank << self.banks.bank_bits
        left_address = Signal(len(self.left.address))
        right_address = Signal(len(self.right.address))
        sample_address = Signal(len(self.sample_address))
        index = operands.right[: self.index_bits]
        distance = operands.right[self.index_bits : self.index_bits + self.slot_bits]
        counts = Signal()
        with m.If(self.step):
            m.d.sync += [
                counts.eq(self._counts(operands.when)),
                left_address.eq(
                    Cat(operands.left, self._bank(operands.own))
                    if self.banks.own
                    else operands.left
                ),
                right_address.eq(operands.right),
                sample_address.eq(Cat(index, (self.newest - distance)[: self.slot_bits])),
            ]
            with m.If(~counts):
                m.d.sync += left_address.eq(zero)
        m.d.comb += [
            self.left.step.eq(self.step),
            self.right.step.eq(self.step),
            self.left.address.eq(left_address),
            self.right.address.eq(right_address),
            self.sample_address.eq(sample_address),
        ]
        right = Mux(word.sample, self.sample_data, self.right.data.as_signed())
        return self.left.data, right

    def _counts(self, when: Value) -> Value:
        """Whether the next step's left operand counts."""
        present = self.present
        choices = {
            When.ALWAYS: C(1),
            When.CONTINUED: ~present.first_minor,
            When.LATER_MAJOR: ~present.first_major,
            When.NEXT_MAJOR: present.first_minor & ~present.first_major,
            When.FAULT: present.fault,
            When.SHORT: present.short,
        }
        if self.design.high_resolution:
            choices |= {When.FIRST_MINOR: present.first_minor, When.MAJOR_END: present.major_end}
        return Cat(choice & (when == value) for value, choice in choices.items()).any()

    def _accumulate(
        self, m: Module, word: data.View, left: Value, right: Value, constant: Value
    ) -> Value:
        """Add or subtract the product; returns the accumulator's low digit, 16 or 18 bits of it.

        While `starting` a constant takes the product's place.

        To keep the addition short, the carry out of the low digit waits a step.  Then it goes
        where its weight is: into the high part, or, when that moves down, into the low digit.
        """
        m.submodules.product = product = DigitMultiplier(self.plan, primitive=self.primitive)
        addend = Signal(signed(2 * BITS), reset_less=True)  # - product = ~product + 1
        one = Signal(reset_less=True)
        low = Signal(WORD_BITS, reset_less=True)
        high_bits = self.plan.program.accumulator.bits - WORD_BITS
        high = Signal(signed(high_bits), reset_less=True)
        carry = Signal(reset_less=True)
        m.d.comb += [
            product.step.eq(self.step),
            product.left.eq(left),
            product.right.eq(right),
        ]

        def base(same: Value, shifted: Value) -> Value:
            return Mux(word.keep, same, Mux(word.shift, shifted, 0))

        # a product that the accumulator is shifted for is never subtracted: `one` is 0
        added = Mux(word.subtract, ~product.output, product.output)
        low_sum = base(low, high[:WORD_BITS]) + addend[:WORD_BITS] + Mux(word.shift, carry, one)
        high_sum = (base(high, high >> WORD_BITS) + addend[WORD_BITS:].as_signed())[:high_bits]
        with m.If(self.step):
            m.d.sync += [
                addend.eq(Mux(self.starting, constant, added)),
                one.eq(word.subtract),
                Cat(low, carry).eq(low_sum[: WORD_BITS + 1]),
                high.eq((high_sum.as_signed() + (word.keep & carry))[:high_bits]),
            ]
        top = [high[0] ^ carry, high[1] ^ (high[0] & carry)]
        return Cat(low, *(bit & word.signed for bit in top))
