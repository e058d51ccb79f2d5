"""From one clock to another: two flip-flops, and a queue with Gray pointers."""

from __future__ import annotations

from amaranth import Module, Signal, Value, unsigned
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out


class Synchroniser(wiring.Component):
    """Bits of another clock, through two flip-flops in a row.

    The first may hang between 0 and 1 for a moment; the second hides that.  Where more than one
    bit may change at once the bits do not arrive together.

    Members:
        data_in: the bits; data_out: they, two clocks later.

    Args:
        width: bits.
        domain: the clock that they go to.
        init: what they are after reset.
    """

    def __init__(self, width: int, domain: str = "sync", init: int = 0) -> None:
        self.width = width
        self.domain = domain
        self.init = init
        super().__init__({"data_in": In(unsigned(width)), "data_out": Out(unsigned(width))})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        unsettled = Signal(self.width, name="unsettled", init=self.init)
        settled = Signal(self.width, name="settled", init=self.init)
        m.d[self.domain] += [unsettled.eq(self.data_in), settled.eq(unsettled)]
        m.d.comb += self.data_out.eq(settled)
        return m


class CrossingQueue(wiring.Component):
    """A queue of words from one clock to another that has nothing to do with it.

    Each side counts in Gray code, of which one bit changes at a time, so that the other side
    sees either the old number or the new one.  The words stand in registers that do not change
    while the reading side knows of them.  Reset both sides together, each for three of the slower
    clock's periods.

    Members:
        data_in, valid_in (in), ready_in (out): the writing side's handshake.
        data_out, valid_out (out), ready_out (in): the reading side's.

    Latency: a word is shown to the reading side two or three of its clocks after it was taken.

    Args:
        width: bits of a word.
        depth: words, a power of two from 2 on.
        write_domain, read_domain: the clocks.

    Raises:
        ValueError: the depth is no power of two, or the domains are one.
    """

    def __init__(self, width: int, depth: int, write_domain: str, read_domain: str) -> None:
        if depth < 2 or depth & (depth - 1):
            raise ValueError(f"depth {depth} is not allowed, give a power of two from 2 on")
        if write_domain == read_domain:
            raise ValueError(f"both sides have the clock of {write_domain}, give two")
        self.width = width
        self.depth = depth
        self.write_domain = write_domain
        self.read_domain = read_domain
        super().__init__(
            {
                "data_in": In(unsigned(width)),
                "valid_in": In(1),
                "ready_in": Out(1),
                "data_out": Out(unsigned(width)),
                "valid_out": Out(1),
                "ready_out": In(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        bits = self.depth.bit_length()  # one more than an address has
        address = bits - 1
        m.submodules.read_gray_crossing = to_write = Synchroniser(bits, self.write_domain)
        m.submodules.write_gray_crossing = to_read = Synchroniser(bits, self.read_domain)
        words = memory.Memory(shape=unsigned(self.width), depth=self.depth, init=[])
        m.submodules.words = words
        write = words.write_port(domain=self.write_domain)
        read = words.read_port(domain="comb")

        put, take = Signal(), Signal()
        m.d.comb += [
            put.eq(self.valid_in & self.ready_in),
            take.eq(self.valid_out & self.ready_out),
        ]
        written, written_gray = _gray_counter(m, self.write_domain, put, bits, "written")
        taken, taken_gray = _gray_counter(m, self.read_domain, take, bits, "taken")
        full = Signal(bits)  # the writer's Gray number when it is `depth` ahead of the reader's
        m.d.comb += [
            to_write.data_in.eq(taken_gray),
            to_read.data_in.eq(written_gray),
            full.eq(to_write.data_out ^ (0b11 << bits - 2)),
            self.ready_in.eq(written_gray != full),
            self.valid_out.eq(taken_gray != to_read.data_out),
            write.en.eq(put),
            write.addr.eq(written[:address]),
            write.data.eq(self.data_in),
            read.addr.eq(taken[:address]),
            self.data_out.eq(read.data),
        ]
        return m


def _gray_counter(
    m: Module, domain: str, step: Value, bits: int, name: str
) -> tuple[Signal, Signal]:
    """A counter, and a register with its number in Gray code."""
    count, gray = Signal(bits, name=name), Signal(bits, name=f"{name}_gray")
    after = Signal(bits, name=f"{name}_after")
    m.d.comb += after.eq(count)
    with m.If(step):
        m.d.comb += after.eq(count + 1)
    m.d[domain] += [count.eq(after), gray.eq(after ^ (after >> 1))]
    return count, gray
