"""Results as packets of words, and samples from packets."""

from __future__ import annotations

from amaranth import Cat, Module, Mux, Signal, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.plan.result_window import ResultWindow


class PacketSender(wiring.Component):
    """Sends each result that waits as a packet of words, from the store.

    The status is read ahead of the words, so that it can stand beside all of them.

    Members:
        waits (in): a result waits; pop (out): it has been sent.
        address, read (out), data (in): its words; data come two steps
            later, a step being a clock in which it is read.
        valid, ready, word, last, status: the packets; all stay as they are until taken.

    Latency: five clocks from `waits` to a packet's first word; then a word a clock.

    Args:
        window: the words of a result.
    """

    def __init__(self, window: ResultWindow) -> None:
        self.window = window
        self.index_bits = (window.words - 1).bit_length()
        super().__init__(
            {
                "waits": In(1),
                "pop": Out(1),
                "address": Out(unsigned(self.index_bits)),
                "read": Out(1),
                "data": In(unsigned(32)),
                "valid": Out(1),
                "ready": In(1),
                "word": Out(unsigned(32)),
                "last": Out(1),
                "status": Out(unsigned(window.design.status_bits)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        last = self.window.words - 1
        move = Signal()
        busy = Signal()  # a result is being sent
        ask = Signal()  # words are asked for, the status before all
        first = Signal(init=1)  # it is the status's turn
        index = Signal(range(self.window.words))
        coming = Signal(3)  # what comes next from the memory: status, word, last word
        told = Signal()  # the status stands at the output
        m.d.comb += [
            move.eq(~self.valid | self.ready),
            self.read.eq(move),
            self.address.eq(Mux(first, self.window.words_per_column, index)),
            self.word.eq(self.data),
        ]
        m.d.sync += self.pop.eq(self.valid & self.ready & self.last)
        with m.If(self.waits & ~busy):
            m.d.sync += [busy.eq(1), ask.eq(1)]
        with m.If(self.pop):
            m.d.sync += busy.eq(0)
        with m.If(move):
            m.d.sync += [
                coming.eq(Cat(ask & first, ask & ~first, ask & ~first & (index == last))),
                Cat(told, self.valid, self.last).eq(coming),
            ]
            with m.If(ask):
                m.d.sync += first.eq(0)
                with m.If(~first):
                    m.d.sync += index.eq(index + 1)
                with m.If(~first & (index == last)):
                    m.d.sync += [index.eq(0), first.eq(1), ask.eq(0)]
        with m.If(told):
            m.d.sync += self.status.eq(self.data)
        return m


class SampleReceiver(wiring.Component):
    """Makes samples of packets of six words, a count each, extended by its sign.

    A packet of another length, or with a number too large for its count, is thrown away and
    counted.

    Members:
        valid, ready, word, last, fault (in): the packets; the fault mark goes with the last word.
        sample_valid, sample_ready, sample: the sample; counts and fault mark as bits.
        bad (out): packets thrown away; at its highest: so many or more.

    Latency: a sample is valid in the clock after the packet's last word is taken.

    Args:
        bits: of the six counts.
    """

    def __init__(self, bits: tuple[int, ...]) -> None:
        self.bits = bits
        super().__init__(
            {
                "valid": In(1),
                "ready": Out(1),
                "word": In(unsigned(32)),
                "last": In(1),
                "fault": In(1),
                "sample_valid": Out(1),
                "sample_ready": In(1),
                "sample": Out(unsigned(sum(bits) + 1)),
                "bad": Out(unsigned(16)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        counts = [Signal(width, name=f"count{i}") for i, width in enumerate(self.bits)]
        fault = Signal()
        place = Signal(range(len(counts)))
        wrong = Signal()  # nothing more can make it right
        odd = Signal()  # this word is no number of its count's width
        bad = Signal()
        end = Signal()
        m.d.comb += [
            self.sample.eq(Cat(*counts, fault)),
            self.ready.eq(~self.sample_valid),
            end.eq(place == len(counts) - 1),
        ]
        for number, count in enumerate(counts):
            with m.If(place == number):
                sign = self.word[len(count) - 1 :]
                m.d.comb += odd.eq(sign.any() & ~sign.all())
        m.d.sync += bad.eq(0)
        with m.If(bad & ~self.bad.all()):
            m.d.sync += self.bad.eq(self.bad + 1)
        with m.If(self.sample_ready):
            m.d.sync += self.sample_valid.eq(0)
        with m.If(self.valid & self.ready):
            m.d.sync += [wrong.eq(wrong | odd | end), fault.eq(self.fault)]
            with m.If(~end):
                m.d.sync += place.eq(place + 1)
            for number, count in enumerate(counts):
                with m.If(place == number):
                    m.d.sync += count.eq(self.word)
            with m.If(self.last):
                right = end & ~wrong & ~odd
                m.d.sync += [
                    place.eq(0),
                    wrong.eq(0),
                    self.sample_valid.eq(right),
                    bad.eq(~right),
                ]
        return m
