"""Block memory with one write and one read port."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from operator import or_
from typing import Any

from amaranth import C, Cat, ClockSignal, Const, Instance, Module, Mux, Signal, Value, unsigned
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.block_memory import memory_attributes
from sculler_hdl.lib.layout import chosen
from sculler_hdl.targets import Target

_DEPTHS = {18: 1024, 9: 2048, 4: 4096, 2: 8192, 1: 16384}
"""Words of a DP16KD, by their bits."""

_TABLE_WORDS = 64
"""Of a table of logic: the Verilog text has lines as wide as a table has words."""


class BlockMemory(wiring.Component):
    """Words in block memory.

    `data` shows the word of `address`, `latency` steps later, a step being a clock in which
    `step` is high; between, it keeps.  `write` puts `write_data` at `write_address`, from the next
    clock on.  Reading a word in the very clock it is written gives nothing to rely on.

    Args:
        target: the family of devices; its own block is instantiated where it has one and the
            memory fits.
        width, initial: bits of a word, and what the words hold at first (not after reset).
        written: whether the write port is used.
        primitive: False infers the memory for every target.
        logic: make words that are never written of logic, which needs no initial contents.
    """

    def __init__(
        self,
        target: Target,
        width: int,
        initial: Sequence[int],
        *,
        written: bool = True,
        primitive: bool = True,
        logic: bool = False,
    ) -> None:
        self.width = width
        self.logic = logic and not written
        self.initial = [value & (1 << width) - 1 for value in initial]
        self.written = written
        self.latency = target.memory_latency
        self.instantiated = (
            primitive
            and not self.logic
            and target.memory_cell == "DP16KD"
            and (len(self.initial) <= _DEPTHS[9] or (written and not any(self.initial)))
        )
        address = range(max(len(self.initial), 2))
        super().__init__(
            {
                "step": In(1),
                "address": In(address),
                "data": Out(unsigned(width)),
                "write": In(1),
                "write_address": In(address),
                "write_data": In(unsigned(width)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        if self.logic:
            self._logic(m)
        elif self.instantiated:
            self._blocks(m)
        else:
            self._inferred(m)
        return m

    def _inferred(self, m: Module) -> None:
        depth = max(len(self.initial), 2)
        m.submodules.words = words = memory.Memory(
            shape=unsigned(self.width),
            depth=depth,
            init=self.initial,
            attrs=memory_attributes(depth, self.width),
        )
        read = words.read_port()
        m.d.comb += [read.addr.eq(self.address), read.en.eq(self.step)]
        if self.written:
            write = words.write_port()
            m.d.comb += [
                write.addr.eq(self.write_address),
                write.data.eq(self.write_data),
                write.en.eq(self.write),
            ]
        self._later(m, read.data, self.latency - 1)

    def _logic(self, m: Module) -> None:
        """A word for each address, as tables of a few words each; others give 0."""
        tables = []
        for first in range(0, len(self.initial), _TABLE_WORDS):
            tables.append(table := Signal(unsigned(self.width), name=f"table_{first}"))
            with m.Switch(self.address):
                for address, value in enumerate(self.initial[first : first + _TABLE_WORDS], first):
                    with m.Case(address):
                        m.d.comb += table.eq(value)
        word = reduce(or_, tables)
        self._later(m, word, self.latency)

    def _later(self, m: Module, data: Value, steps: int) -> None:
        """Show data some steps later."""
        for _ in range(steps):
            register = Signal(unsigned(self.width), name="output_reg", reset_less=True)
            with m.If(self.step):
                m.d.sync += register.eq(data)
            data = register
        m.d.comb += self.data.eq(data)

    def _blocks(self, m: Module) -> None:
        """Banks of as many blocks side by side as the width asks for."""
        shares = bank_shares(len(self.initial), self.width)
        if len(shares) == 1:
            self._bank(m, "block", shares[0], self.write, self.data)
            return
        firsts = [sum(_DEPTHS[share] for share in shares[:bank]) for bank in range(len(shares))]
        written, read = (_bank_of(each, firsts) for each in (self.write_address, self.address))
        data = [Signal(self.width, name=f"bank{bank}_data") for bank in range(len(shares))]
        for bank, share in enumerate(shares):
            write = self.write & (written == bank)
            self._bank(m, f"bank{bank}_block", share, write, data[bank])
        for step in range(self.latency):
            register = Signal(range(len(shares)), name=f"bank_{step}", reset_less=True)
            with m.If(self.step):
                m.d.sync += register.eq(read)
            read = register
        m.d.comb += self.data.eq(chosen(read, data))

    def _bank(self, m: Module, name: str, share: int, write: Value, shown: Value) -> None:
        """Blocks of so many bits, side by side."""
        bits = (_DEPTHS[share] - 1).bit_length()
        large = len(self.initial) > _DEPTHS[9]
        for number, low in enumerate(range(0, self.width, share)):
            initial = [value >> low & (1 << share) - 1 for value in self.initial]
            piece = self.write_data[low : low + share]
            data = Signal(18, name=f"data{number}_unused_above")  # so linters let it pass
            m.submodules[f"{name}{number}"] = _dp16kd(
                share,
                None if large else initial,
                self.step,
                self.address[:bits],
                data,
                write,
                self.write_address[:bits],
                piece,
            )
            m.d.comb += shown[low : low + share].eq(data)


def bank_shares(words: int, width: int) -> list[int]:
    """The bits of a block in each bank of a memory, the deepest bank first.

    The last words stand in one bank or in two, by which of these takes fewer blocks.
    """
    deepest = _DEPTHS[1]
    if words > deepest:
        return [1, *bank_shares(words - deepest, width)]
    alone = max(share for share, depth in _DEPTHS.items() if depth >= words)
    below = [share for share, depth in _DEPTHS.items() if depth < words]
    if words <= _DEPTHS[9] or not below:
        return [alone]
    most = min(below)
    rest = max(share for share, depth in _DEPTHS.items() if depth >= words - _DEPTHS[most])
    fewer = -(-width // most) - (-width // rest) < -(-width // alone)
    return [most, rest] if fewer else [alone]


def _bank_of(address: Value, firsts: Sequence[int]) -> Value:
    """The number of the bank that an address is in, by the first address of each."""
    bank: Value = C(0, (len(firsts) - 1).bit_length())
    for number, first in enumerate(firsts[1:], start=1):
        bank = Mux(address >= first, number, bank)
    return bank


def _dp16kd(
    width: int,
    initial: Sequence[int] | None,
    step: Value,
    address: Value,
    data: Signal,
    write: Value,
    write_address: Value,
    write_data: Value,
) -> Instance:
    """A block that is written through port A and read through port B with its output register.

    Without `initial` it begins with zeros, which is what the block does by itself.
    """
    shift = (16 * 1024 // _DEPTHS[width] - 1).bit_length()
    ports: dict[str, Any] = {}
    # byte enables stand in the lowest address bits
    addresses = {
        "A": Cat(C(3 if width == 18 else 0, shift), write_address),
        "B": Cat(C(0, shift), address),
    }
    for side, value in addresses.items():
        bits = Cat(value, C(0, 14 - len(value)))
        ports |= {f"i_AD{side}{bit}": bits[bit] for bit in range(14)}
    inputs = Cat(write_data, C(0, 18 - len(write_data)))
    ports |= {f"i_DIA{bit}": inputs[bit] for bit in range(18)}
    ports |= {f"i_DIB{bit}": Const(0) for bit in range(18)}
    ports |= {f"o_DOB{bit}": data[bit] for bit in range(18)}
    for side, enable, register, writes in (
        ("A", write, Const(1), write),
        ("B", step, step, Const(0)),
    ):
        ports |= {
            f"i_CLK{side}": ClockSignal(),
            f"i_CE{side}": enable,
            f"i_OCE{side}": register,
            f"i_WE{side}": writes,
            f"i_RST{side}": Const(0),
            **{f"i_CS{side}{bit}": Const(0) for bit in range(3)},
            f"p_DATA_WIDTH_{side}": width,
            f"p_REGMODE_{side}": "NOREG" if side == "A" else "OUTREG",
            f"p_WRITEMODE_{side}": "NORMAL",
            f"p_CSDECODE_{side}": "0b000",
        }
    for row in range(0 if initial is None else 64):
        # 16 words of 18 bits in each, 20 bits apart; narrower words fill those 18 bits
        ports[f"p_INITVAL_{row:02X}"] = Const(_initial_row(width, initial or (), row), 320)
    return Instance("DP16KD", p_RESETMODE="SYNC", p_GSR="DISABLED", **ports)


def _initial_row(width: int, initial: Sequence[int], row: int) -> int:
    per_place = 18 // width
    value = 0
    for i, word in enumerate(initial[row * 16 * per_place : (row + 1) * 16 * per_place]):
        place, part = divmod(i, per_place)
        value |= word << 20 * place + width * part
    return value
