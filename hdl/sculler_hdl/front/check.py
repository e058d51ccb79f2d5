"""The check of a frame, byte by byte."""

from __future__ import annotations

from amaranth import Cat, Const, Module, Mux, Signal, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.plan.front import crc_terms
from sculler_model.front import Check


class FrameCheck(wiring.Component):
    """A CRC, sum or XOR over bytes, one in each clock at most.

    Members:
        start (in): begin anew; no byte comes in this clock.
        valid, data (in): a byte that is covered.
        high (in): the byte is the high one of a word of 16 bits.
        value (out): over all bytes before this clock.

    Args:
        check: what it is.
    """

    def __init__(self, check: Check) -> None:
        self.check = check
        super().__init__(
            {
                "start": In(1),
                "valid": In(1),
                "data": In(unsigned(8)),
                "high": In(1),
                "value": Out(unsigned(check.bits)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, check = Module(), self.check
        if check.kind == "crc":
            self._crc(m)
            return m
        total = Signal(unsigned(check.bits), init=check.initial)
        part = Signal(unsigned(min(8 * check.word_bytes, check.bits)))
        word = Cat(Mux(self.high, 0, self.data), Mux(self.high, self.data, 0))
        m.d.comb += [
            part.eq(self.data if check.word_bytes == 1 else word),
            self.value.eq(total ^ Const(check.final, check.bits)),
        ]
        with m.If(self.start):
            m.d.sync += total.eq(check.initial)
        with m.Elif(self.valid):
            following = total + part if check.kind == "sum" else total ^ part
            m.d.sync += total.eq(following[: check.bits])
        return m

    def _crc(self, m: Module) -> None:
        """Each bit is the parity of some bits of register and byte."""
        check = self.check
        register = Signal(unsigned(check.bits), name="crc", init=check.initial)
        data = Signal(unsigned(8))
        m.d.comb += data.eq(self.data[::-1] if check.reflected else self.data)
        following = []
        for of_register, of_data in crc_terms(check.bits, check.polynomial):
            bits = [register[i] for i in range(check.bits) if of_register >> i & 1]
            bits += [data[i] for i in range(8) if of_data >> i & 1]
            following.append(Cat(bits).xor())
        with m.If(self.start):
            m.d.sync += register.eq(check.initial)
        with m.Elif(self.valid):
            m.d.sync += register.eq(Cat(following))
        value = register[::-1] if check.reflected else register
        m.d.comb += self.value.eq(value ^ Const(check.final, check.bits))
