"""Hands a result over from the result memory, word by word."""

from __future__ import annotations

from amaranth import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.memory import BlockMemory
from sculler_hdl.plan.compact.plan import CompactPlan
from sculler_model.golden import words_per_column, words_per_result


class Reader(wiring.Component):
    """Streams one bank of the result memory while the engine fills another.

    There are two banks.  Where the design drops results there are four: one is shown, one holds a
    result that waits, one is filled, one is never used; a bank that is filled while another waits
    takes its place, and what waited is dropped.

    Members:
        publish (in): the bank being filled is complete; it is shown, if it can be, from the next
            clock on, and another is filled.
        filling (out): the bank being filled.
        address (out): of the result memory: the word, then the bank.
        valid, last (out), ready (in): the stream's, its data being the memory's.
        taken (out): the last word is taken in this clock.
        dropped (out): a result was dropped two clocks ago.
        at_status (out), where it is `tied`: the word is the lowest of the status.

    Latency: a word is valid `Target.memory_latency` + 1 clocks after the one before was taken, and
    that latency after the clock following `publish`.

    Args:
        plan: the plan.
        tied: see `at_status`.
    """

    def __init__(self, plan: CompactPlan, *, tied: bool = False) -> None:
        self.tied = tied
        self.status = plan.design.columns.index("status") * words_per_column(plan.design)
        self.words = words_per_result(plan.design)
        self.wait = plan.target.memory_latency
        # with many channels none is ever dropped: no sample is launched that would do it
        self.drops = plan.sizes.result_banks > 2
        self.bank_bits = plan.sizes.bank_bits
        super().__init__(
            {
                "publish": In(1),
                "filling": Out(self.bank_bits),
                "address": Out((self.words - 1).bit_length() + self.bank_bits),
                "valid": Out(1),
                "last": Out(1),
                "ready": In(1),
                "taken": Out(1),
                "dropped": Out(1),
                **({"at_status": Out(1)} if tied else {}),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        word = Signal(range(self.words))
        waiting = Signal()  # a result is shown that is not yet taken whole
        ahead = Signal(range(self.wait + 1))  # clocks until the word is there
        begin, shown = self._begin(m, waiting) if self.drops else (self.publish, ~self.filling)
        direct = (
            []
            if self.tied
            else [
                self.valid.eq(waiting & (ahead == 0)),
                self.last.eq(word == self.words - 1),
            ]
        )
        m.d.comb += [
            self.address.eq(Cat(word, shown)),
            *direct,
            self.taken.eq(self.valid & self.ready & self.last),
        ]
        if self.tied:
            self._show_from_registers(m, word, waiting, ahead)
        with m.If(ahead != 0):
            m.d.sync += ahead.eq(ahead - 1)
        with m.If(self.valid & self.ready):
            m.d.sync += [word.eq(word + 1), ahead.eq(self.wait)]
        with m.If(self.taken):
            m.d.sync += [word.eq(0), waiting.eq(0)]
        with m.If(begin):
            m.d.sync += [waiting.eq(1), ahead.eq(self.wait)]
        if not self.drops:
            with m.If(begin):
                m.d.sync += self.filling.eq(~self.filling)
        return m

    def _show_from_registers(self, m: Module, word: Value, waiting: Value, ahead: Value) -> None:
        """The same levels on the same clocks, from registers: copies have to agree on them."""
        m.d.sync += [
            self.last.eq(word == self.words - 1),
            self.at_status.eq(word == self.status),
        ]
        with m.If(ahead == 1):
            m.d.sync += self.valid.eq(waiting)
        with m.If(self.valid & self.ready):
            m.d.sync += self.valid.eq(0)

    def _begin(self, m: Module, waiting: Value) -> tuple[Value, Value]:
        """Whether a result is shown from the next clock on, and the bank that is now."""
        shown, behind = Signal(2, init=1), Signal(2, init=2)
        full = Signal()  # there is a result in `behind`
        free, begin, dropped = Signal(), Signal(), Signal()
        m.d.comb += [
            free.eq(~waiting | self.taken),
            begin.eq(free & (full | self.publish)),
        ]
        m.d.sync += [
            dropped.eq(self.publish & full & ~free),
            self.dropped.eq(dropped),
            full.eq((full & ~free) | (self.publish & (full | ~free))),
        ]
        with m.If(begin):
            m.d.sync += shown.eq(Mux(full, behind, self.filling))
        with m.If(self.publish & (full | ~free)):
            m.d.sync += behind.eq(self.filling)
        with m.Elif(begin & full):
            m.d.sync += behind.eq(shown)
        with m.If(self.publish):
            m.d.sync += self.filling.eq(Mux(free, shown, behind))
        return begin, shown


def read_results(
    core: wiring.Component, engine: wiring.Component, results: BlockMemory, reader: Reader
) -> list[object]:
    """What goes from the engine through the result memory and the reader to the core's ports."""
    return [
        results.write.eq(engine.store),
        results.write_address.eq(Cat(engine.store_address, reader.filling ^ engine.bank)),
        results.write_data.eq(engine.store_data),
        # the result is read
        reader.publish.eq(engine.publish),
        reader.ready.eq(core.result_ready),
        results.step.eq(1),
        results.address.eq(reader.address),
        core.result_valid.eq(reader.valid),
        core.result_data.eq(results.data),
        core.result_last.eq(reader.last),
    ]
