"""The registers that `plan.registers` tells of."""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce
from operator import or_

from amaranth import C, Cat, Module, Mux, Signal, Value, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.plan.bus_ports import own_bus_ports
from sculler_hdl.plan.registers import ADDRESS_BITS, WINDOW, Field, Register, RegisterMap

REQUEST_BITS = 1 + ADDRESS_BITS + 32 + 4
ANSWER_BITS = 33
"""As bits in a row, the way a clock crossing carries them."""


_OWN = ("interrupt_result", "interrupt_fault", "status_result_waits")
"""Fields that the file knows by itself."""


class Request(wiring.Signature):
    """What a bus asks of the registers, one at a time: valid until ready."""

    def __init__(self) -> None:
        super().__init__(
            {
                "valid": Out(1),
                "ready": In(1),
                "write": Out(1),
                "address": Out(unsigned(ADDRESS_BITS)),
                "data": Out(unsigned(32)),
                "strobe": Out(unsigned(4)),
            }
        )


class Answer(wiring.Signature):
    """What the registers say to it: data of a read, and whether there was no such register."""

    def __init__(self) -> None:
        super().__init__(
            {"valid": Out(1), "ready": In(1), "data": Out(unsigned(32)), "error": Out(1)}
        )


def slave_members(kind: str) -> dict[str, wiring.Member]:
    """Of a bus's adapter: the bus's own (`plan.bus_ports`), and request and answer of registers."""
    return {
        "request": Out(Request()),
        "answer": In(Answer()),
        **{port.name: (Out if port.output else In)(port.bits) for port in own_bus_ports(kind)},
    }


def bits_of(port: wiring.PureInterface) -> Value:
    """The payload of a request or an answer as bits in a row."""
    members = [name for name in port.signature.members if name not in ("valid", "ready")]
    return Cat(*(getattr(port, name) for name in members))


class RegisterFile(wiring.Component):
    """Registers, and the window to the oldest result.

    A read of an address without a register, or of the window while no result waits, is an error,
    and so are a write to what cannot be written and an address that four does not divide.  An
    error changes nothing.  Bytes that are not written keep their value.

    Members:
        request (in), answer (out): the bus.
        window_address, window_read (out), window_data (in): the oldest result's words; data come
            two steps later, a step being a clock in which it is read.
        results_wait (in): there is a result in the window.
        irq (out): something that is enabled waits.
        And for each field of the table, REGISTER_FIELD: of kind "r" an input with its value, of
        "rw" an output, of "pulse" an output that is high for a clock, of "w1c" an input that sets
        it.  What never changes, and what this file itself knows, has none.

    Latency: an answer is valid three clocks after its request.

    Args:
        table: the registers.
    """

    def __init__(self, table: RegisterMap) -> None:
        self.table = table
        self.window_bits = (table.window.words - 1).bit_length()
        members: dict[str, wiring.Member] = {
            "request": In(Request()),
            "answer": Out(Answer()),
            "window_address": Out(unsigned(self.window_bits)),
            "window_read": Out(1),
            "window_data": In(unsigned(32)),
            "results_wait": In(1),
            "irq": Out(1),
        }
        for register, field in self._fields():
            name = f"{register.name}_{field.name}"
            if field.access in ("rw", "pulse"):
                members[name] = Out(unsigned(field.bits), init=field.reset or 0)
            elif field.reset is None or field.access == "w1c":
                members[name] = In(unsigned(field.bits))
        for own in _OWN:
            members.pop(own, None)
        super().__init__(members)

    def _fields(self) -> Iterator[tuple[Register, Field]]:
        return ((register, field) for register in self.table.registers for field in register.fields)

    def elaborate(self, platform: object) -> Module:
        m = Module()
        request, answer = self.request, self.answer
        look = Signal()  # which register it is, is found
        act = Signal()  # what it does, is done
        in_window = Signal()
        known = Signal()
        address = Signal(ADDRESS_BITS)
        data = Signal(32)
        write = Signal()
        strobe = Signal(4)
        word = Signal(32)
        from_window = Signal()
        aligned = address[:2] == 0
        end = (WINDOW >> 2) + self.table.window.words
        inside = (address >= WINDOW) & (address[2:] < end)
        m.d.comb += [
            request.ready.eq(~look & ~act & ~answer.valid),
            self.window_address.eq(address[2:]),
            self.window_read.eq(look | act),
            answer.data.eq(Mux(from_window, self.window_data, word)),
        ]
        m.d.sync += [
            look.eq(request.valid & request.ready),
            act.eq(look),
            in_window.eq(inside & aligned & self.results_wait & ~write),
        ]
        with m.If(request.valid & request.ready):
            m.d.sync += [
                address.eq(request.address),
                data.eq(request.data),
                write.eq(request.write),
                strobe.eq(request.strobe),
            ]
        with m.If(answer.ready):
            m.d.sync += answer.valid.eq(0)
        self._emit_sticky(m)
        for register, field in self._fields():
            if field.access == "pulse":
                m.d.sync += getattr(self, f"{register.name}_{field.name}").eq(0)
        lanes = Cat(lane.replicate(8) for lane in strobe)
        words, found = [], []
        for register in self.table.registers:
            here = Signal(name=f"at_{register.name}")
            m.d.sync += here.eq((address[2:] == register.address >> 2) & aligned)
            words.append(self._value_of(register) & here.replicate(32))
            found.append(here if register.writable else here & ~write)
            with m.If(act & here):
                self._access(m, register, write, data, lanes)
        m.d.comb += known.eq(Cat(*found).any())
        with m.If(act):
            m.d.sync += [
                answer.valid.eq(1),
                answer.error.eq(~known & ~in_window),
                from_window.eq(in_window),
                word.eq(reduce(or_, words)),
            ]
        return m

    def _emit_sticky(self, m: Module) -> None:
        """The bits that stay until they are cleared, and the interrupt."""
        self._sticky: dict[str, Signal] = {}
        for register, field in self._fields():
            if field.access == "w1c":
                name = f"{register.name}_{field.name}"
                self._sticky[name] = Signal(name=f"{name}_held")
                # an event in the very clock of the clearing counts: see `_write`
                with m.If(getattr(self, name)):
                    m.d.sync += self._sticky[name].eq(1)
        faults = [held for name, held in self._sticky.items() if name.startswith("faults_")]
        raw = {"result": self.results_wait, "fault": Cat(*faults).any()}
        if "interrupt_pulse" in self._sticky:
            raw["pulse"] = self._sticky["interrupt_pulse"]
        enabled = [
            raw[field.name] & getattr(self, f"interrupt_enable_{field.name}")
            for field in self.table["interrupt_enable"].fields
        ]
        m.d.sync += self.irq.eq(Cat(*enabled).any())
        self._known = {
            "interrupt_result": raw["result"],
            "interrupt_fault": raw["fault"],
            "status_result_waits": self.results_wait,
        }
        for name in ("time_high_value", "pulse_high_value"):
            if hasattr(self, name):
                self._known[name] = Signal(32, name=f"{name}_held")

    def _value(self, register: Register, field: Field) -> Value:
        """What a read of a field gives."""
        name = f"{register.name}_{field.name}"
        if name in self._known:
            return self._known[name]
        if name in self._sticky:
            return self._sticky[name]
        if field.access == "pulse":
            return C(0, field.bits)
        if field.access == "r" and field.reset is not None:
            return C(field.reset, field.bits)
        return Value.cast(getattr(self, name))

    def _value_of(self, register: Register) -> Value:
        """What a read of a register gives."""
        parts, at = [], 0
        for field in register.fields:
            value = self._value(register, field)
            parts += [C(0, field.low - at), value]
            at = field.low + field.bits
        return Cat(*parts, C(0, 32 - at))

    def _access(
        self, m: Module, register: Register, write: Signal, data: Value, lanes: Value
    ) -> None:
        """What a read or a write of a register does."""
        if register.name.endswith("_low"):
            upper = register.name.replace("_low", "_high_value")
            with m.If(~write):
                m.d.sync += self._known[upper].eq(getattr(self, upper))
        if register.writable:
            with m.If(write):
                self._write(m, register, data, lanes)

    def _write(self, m: Module, register: Register, data: Value, lanes: Value) -> None:
        for field in register.fields:
            name, stop = f"{register.name}_{field.name}", field.low + field.bits
            new, lane = data[field.low : stop], lanes[field.low : stop]
            if field.access == "pulse":
                m.d.sync += getattr(self, name).eq(new & lane)
            elif field.access == "rw":
                old = getattr(self, name)
                m.d.sync += old.eq((old & ~lane) | (new & lane))
            elif field.access == "w1c":
                with m.If(new & lane & ~getattr(self, name)):
                    m.d.sync += self._sticky[name].eq(0)
