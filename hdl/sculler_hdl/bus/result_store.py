"""Results that wait for the host, in block memory."""

from __future__ import annotations

from functools import reduce
from operator import or_

from amaranth import Cat, Module, Mux, Signal, unsigned
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.block_memory import memory_attributes
from sculler_hdl.plan.result_window import ResultWindow
from sculler_model.golden import WORD_BITS
from sculler_model.golden import words_per_column as core_words_per_column


class ResultStore(wiring.Component):
    """A queue of whole results in block memory.

    Words of 16 bits come from the core; pairs of them, and the time stamps behind the last, are
    written to the first free place.  A result counts when it is whole, and the oldest one stays as
    it is until `pop`.  Where there is no free place the core's words wait: the core's own rule
    then says what gives way.

    Members:
        restart (in): the core begins anew; what has come of a result is forgotten.
        core_valid, core_ready, core_data, core_last: the core's stream of words.
        begins (out), number (out): a result's first word is shown, for the first clock; that word,
            the low bits of the result's number.
        stamps (in): the words behind the columns, as many bits as the window has for them.
        stored (out), status (out): a result counts from the next clock on; its status.
        waiting (out): results that count.
        address, read (in), data (out): a word of the oldest result, two steps later, a step being
            a clock in which `read` is high; between, it keeps.
        pop (in): frees the oldest result; nothing where none waits.

    Throughput: a word of 16 bits a clock, and a clock a word of the stamps between results.

    Args:
        window: the words of a result.
        depth: places, a power of two.
    """

    def __init__(self, window: ResultWindow, depth: int) -> None:
        self.window = window
        self.depth = depth
        self.column_words = core_words_per_column(window.design)
        columns = len(window.design.columns) * window.words_per_column
        self.stamp_words = window.words - columns
        self.index_bits = (window.words - 1).bit_length()
        super().__init__(
            {
                "restart": In(1),
                "core_valid": In(1),
                "core_ready": Out(1),
                "core_data": In(unsigned(WORD_BITS)),
                "core_last": In(1),
                "begins": Out(1),
                "number": Out(unsigned(WORD_BITS)),
                "stamps": In(unsigned(32 * max(self.stamp_words, 1))),
                "stored": Out(1),
                "status": Out(unsigned(window.design.status_bits)),
                "waiting": Out(range(depth + 1)),
                "address": In(unsigned(self.index_bits)),
                "read": In(1),
                "data": Out(unsigned(32)),
                "pop": In(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        depth = self.depth << self.index_bits
        m.submodules.places = places = memory.Memory(
            shape=unsigned(32), depth=depth, init=[], attrs=memory_attributes(depth, 32)
        )
        write, read = places.write_port(), places.read_port()
        data = Signal(32)  # behind the memory, whose own register is slow to show a word
        with m.If(self.read):
            m.d.sync += data.eq(read.data)
        head = Signal(range(self.depth))
        tail = Signal(range(self.depth))
        freed = Signal()
        m.d.comb += [
            read.addr.eq(Cat(self.address, head)),
            read.en.eq(self.read),
            self.data.eq(data),
            freed.eq(self.pop & (self.waiting != 0)),
        ]
        with m.If(freed):
            m.d.sync += head.eq(head + 1)
        with m.If(self.stored):
            m.d.sync += tail.eq(tail + 1)
        with m.If(self.stored & ~freed):
            m.d.sync += self.waiting.eq(self.waiting + 1)
        with m.If(freed & ~self.stored):
            m.d.sync += self.waiting.eq(self.waiting - 1)

        index = Signal(self.index_bits)  # of the word that is written next
        m.d.sync += write.en.eq(0)
        with m.If(write.en):
            m.d.sync += index.eq(index + 1)
        with m.If(self.stored | self.restart):
            m.d.sync += index.eq(0)
        m.d.comb += write.addr.eq(Cat(index, tail))
        self._each = Signal(range(self.column_words), name="each")  # word of a column
        self._column = Signal(range(3), name="column")  # 0, 1, or later
        self._fill(m, write)
        with m.If(self.restart):
            m.d.sync += [self._each.eq(0), self._column.eq(0)]
        return m

    def _fill(self, m: Module, write: memory.WritePort) -> None:
        """Words of a result to the write port, one after another."""
        first = Signal(init=1)  # the next word is the first of a result
        seen = Signal()
        stamping = Signal()
        whole = Signal()
        taken = Signal()
        room = Signal()
        m.d.comb += [
            room.eq(self.waiting != self.depth),
            self.begins.eq(self.core_valid & first & ~seen),
            self.number.eq(self.core_data),
            # room is looked at before the first word only: the place stays free from then on
            self.core_ready.eq(~stamping & ~whole & (~first | room)),
            taken.eq(self.core_valid & self.core_ready),
            self.stored.eq(whole),  # while the last word is being written
        ]
        m.d.sync += whole.eq(0)
        with m.If(self.begins):
            m.d.sync += seen.eq(1)
        with m.If(taken):
            m.d.sync += [first.eq(self.core_last), seen.eq(0)]
            with m.If(self.core_last):
                m.d.sync += (stamping if self.stamp_words else whole).eq(1)
            self._pair(m, write)
        if self.stamp_words:
            self._stamp(m, write, stamping, whole)
        with m.If(self.restart):
            m.d.sync += [first.eq(1), seen.eq(0), stamping.eq(0), whole.eq(0), write.en.eq(0)]

    def _pair(self, m: Module, write: memory.WritePort) -> None:
        """A word of the core: kept, or written with the one before."""
        each, low = self._each, Signal(WORD_BITS)
        column, end = self._column, Signal()
        m.d.comb += end.eq(each == self.column_words - 1)
        m.d.sync += each.eq(each + 1)
        with m.If(end):
            m.d.sync += [each.eq(0), column.eq(Mux(column == 0, 1, 2))]
        with m.If(self.core_last):
            m.d.sync += column.eq(0)
        with m.If((column == 1) & (each == 0)):
            m.d.sync += self.status.eq(self.core_data)
        with m.If(each[0]):
            m.d.sync += [write.en.eq(1), write.data.eq(Cat(low, self.core_data))]
        with m.Elif(end):
            sign = self.core_data[-1].replicate(32 - WORD_BITS)
            m.d.sync += [write.en.eq(1), write.data.eq(Cat(self.core_data, sign))]
        m.d.sync += low.eq(self.core_data)

    def _stamp(self, m: Module, write: memory.WritePort, stamping: Signal, whole: Signal) -> None:
        """The stamps behind a result's columns."""
        place = Signal(self.stamp_words, init=1)  # one bit at a time
        words = [self.stamps.word_select(i, 32) for i in range(self.stamp_words)]
        chosen = (word & bit.replicate(32) for word, bit in zip(words, place, strict=True))
        with m.If(stamping):
            m.d.sync += [
                write.en.eq(1),
                write.data.eq(reduce(or_, chosen)),
                place.eq(place.rotate_left(1)),
            ]
            with m.If(place[-1]):
                m.d.sync += [stamping.eq(0), whole.eq(1)]
        with m.If(self.restart):
            m.d.sync += place.eq(1)
