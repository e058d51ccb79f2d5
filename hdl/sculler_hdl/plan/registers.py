"""The registers of NAME_bus: one table, of which hardware, C header and SystemRDL are made.

Addresses are those of bytes; a register has 32 bits.  The registers stand from 0 on, the oldest
result that waits from `WINDOW` on.  An address has the same meaning in every design; what a design
has not is an address without a register, which answers with an error.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from sculler_hdl.plan.front import front_counter_ports
from sculler_hdl.plan.result_window import ResultWindow
from sculler_model.design import Design, scales_hash

Access = Literal["r", "rw", "w1c", "pulse"]
"""How software sees a field: read only; read and write; read, and cleared where a one is written;
reads as 0, and a one that is written acts once."""

ADDRESS_BITS = 12
"""Of a byte's address: 4 KiB, the least that an AXI interconnect gives."""

WINDOW = 0x800
"""Where the result that is read stands."""

IDENTITY = int.from_bytes(b"SCUL", "big")
VERSION = 1 << 16
"""Of this table: the major number in the upper half, the minor one in the lower."""

FRONT_COUNTERS = tuple((port.name, port.told) for port in front_counter_ports())
"""The outputs of a sensor front end that count, of 32 bits each, and what they count."""


def status_faults(design: Design) -> tuple[str, ...]:
    """The bits of a result's status, by the names they have in the register `faults`."""
    return ("short_history", "fault", "rail", "lost", "upset")[: design.status_bits]


@dataclass(frozen=True)
class Field:
    """Bits of a register.

    Attributes:
        name: in small letters.
        low, bits: its lowest bit, and how many it has.
        access: how software sees it.
        meaning: in words, without a full stop.
        reset: its value after reset; None where that is the hardware's to say.
    """

    name: str
    low: int
    bits: int
    access: Access
    meaning: str
    reset: int | None = None

    @property
    def mask(self) -> int:
        """Its bits in the register."""
        return (1 << self.bits) - 1 << self.low


@dataclass(frozen=True)
class Register:
    """A register of 32 bits.

    Attributes:
        name: in small letters.
        address: of its first byte.
        meaning: in words, without a full stop.
        fields: from the lowest bit up; bits of none read as 0.
    """

    name: str
    address: int
    meaning: str
    fields: tuple[Field, ...]

    @property
    def writable(self) -> bool:
        """Whether a write to it does anything; to others a write is an error."""
        return any(field.access != "r" for field in self.fields)


def _whole(
    name: str, address: int, meaning: str, access: Access = "r", reset: int | None = None
) -> Register:
    return Register(name, address, meaning, (Field("value", 0, 32, access, meaning, reset),))


@dataclass(frozen=True)
class RegisterMap:
    """The registers of a design's bus.

    Attributes:
        design: the design, which has a bus.
    """

    design: Design

    @cached_property
    def registers(self) -> tuple[Register, ...]:
        """All registers but the window, by address."""
        return (
            *self._identity(),
            *self._control(),
            *self._counters(),
            *self._times(),
            *self._injection(),
        )

    @cached_property
    def window(self) -> ResultWindow:
        """What stands from `WINDOW` on."""
        return ResultWindow(self.design)

    @property
    def window_address(self) -> int:
        """Of the first byte of the window."""
        return WINDOW

    @property
    def has_front(self) -> bool:
        """Whether there is a sensor front end."""
        return self.design.front is not None

    def __getitem__(self, name: str) -> Register:
        return next(register for register in self.registers if register.name == name)

    def _identity(self) -> Iterator[Register]:
        design, bus, window = self.design, self.design.hardware.bus, self.window
        assert bus is not None, "no [hardware.bus]"
        yield _whole("identity", 0x000, "the letters SCUL", reset=IDENTITY)
        yield _whole(
            "version", 0x004, "of this table of registers: major << 16 | minor", reset=VERSION
        )
        yield _whole(
            "scales",
            0x008,
            "hash of all that turns results into rad and m/s: the manifest's scales_hash",
            reset=scales_hash(design),
        )
        yield _whole(
            "design",
            0x00C,
            "the first 32 bits of the design's SHA-256",
            reset=int(design.digest[:8], 16),
        )
        facts = (
            ("columns", 0, 8, "columns of a result", len(design.columns)),
            ("words", 8, 8, "registers that a column takes", window.words_per_column),
            ("depth_log2", 16, 4, "results that can wait, as a power of two", bus.depth_log2),
            (
                "drops_results",
                24,
                1,
                "a late host costs results, not samples",
                design.drops_results,
            ),
            ("time_stamps", 25, 1, "there are time stamps", bus.time_stamps),
            ("front", 26, 1, "there is a sensor front end", self.has_front),
        )
        yield Register(
            "format",
            0x010,
            "what the results are like",
            tuple(
                Field(name, low, bits, "r", meaning, int(value))
                for name, low, bits, meaning, value in facts
            ),
        )

    def _control(self) -> Iterator[Register]:
        front = [
            Field("reset_front", 9, 1, "pulse", "resets the sensor front end and its counters", 0)
        ]
        yield Register(
            "control",
            0x014,
            "control",
            (
                Field("enable", 0, 1, "rw", "samples go to the core; 0: they are thrown away", 1),
                Field("inject", 1, 1, "rw", "the core gets the samples pushed by inject_push", 0),
                Field("reset_core", 8, 1, "pulse", "resets the core; results wait on", 0),
                *(front if self.has_front else ()),
                Field("clear", 10, 1, "pulse", "clears the counters samples and results", 0),
            ),
        )
        yield Register(
            "status",
            0x018,
            "status",
            (
                Field("result_waits", 0, 1, "r", "a result stands in the window"),
                Field("full", 1, 1, "r", "there is no room for another result"),
                Field("injecting", 2, 1, "r", "a pushed sample has not been taken by the core"),
                Field("waiting", 16, 11, "r", "results that wait"),
            ),
        )
        yield Register(
            "faults",
            0x01C,
            "what has happened since a one was written to each bit",
            (
                *(
                    Field(name, bit, 1, "w1c", f"a result had status bit {bit}", 0)
                    for bit, name in enumerate(status_faults(self.design))
                ),
                Field("injection", 8, 1, "w1c", "a sample was pushed before the last was taken", 0),
            ),
        )
        yield from self._interrupts()
        yield Register(
            "pop",
            0x028,
            "frees the result in the window; the next one stands there, if there is one",
            (Field("pop", 0, 1, "pulse", "frees the result; nothing, where none waits", 0),),
        )

    def _interrupts(self) -> Iterator[Register]:
        pulse = ("pulse", "a pulse came; cleared where a one is written")
        kinds = [("result", "a result waits"), ("fault", "a bit of faults is set")]
        kinds += [pulse] if self.window.time_stamps else []
        yield Register(
            "interrupt_enable",
            0x020,
            "what drives the output irq",
            tuple(
                Field(name, bit, 1, "rw", meaning.partition(";")[0], 0)
                for bit, (name, meaning) in enumerate(kinds)
            ),
        )
        yield Register(
            "interrupt",
            0x024,
            "what would drive the output irq, enabled or not",
            tuple(
                Field(name, bit, 1, "w1c" if name == "pulse" else "r", meaning)
                for bit, (name, meaning) in enumerate(kinds)
            ),
        )

    def _counters(self) -> Iterator[Register]:
        yield _whole("samples", 0x030, "samples that the core took, modulo 2^32")
        yield _whole("results", 0x034, "results that were put into the window's queue, modulo 2^32")
        lost = "since the core's reset; at its highest: so many or more"
        for address, name, meaning, there in (
            (0x038, "samples_lost", "samples offered to the core and not taken", True),
            (0x03C, "results_dropped", "results dropped", self.design.drops_results),
        ):
            if there:
                field = Field("value", 0, 16, "r", f"{meaning}, {lost}")
                yield Register(name, address, f"{meaning}, {lost}", (field,))
        if self.has_front:
            for number, (name, meaning) in enumerate(FRONT_COUNTERS):
                yield _whole(
                    name, 0x040 + 4 * number, f"{meaning}; at its highest: so many or more"
                )

    def _times(self) -> Iterator[Register]:
        if not self.window.time_stamps:
            return
        holds = "reading it holds the upper half for the next read of it"
        yield _whole("time_low", 0x060, f"clocks since reset, lower half; {holds}")
        yield _whole("time_high", 0x064, "clocks since reset, upper half, as time_low left it")
        yield _whole("pulse_low", 0x068, f"the time of the last pulse, lower half; {holds}")
        yield _whole("pulse_high", 0x06C, "the time of the last pulse, as pulse_low left it")
        yield _whole("pulses", 0x070, "pulses since reset, modulo 2^32")

    def _injection(self) -> Iterator[Register]:
        words = self.design.words
        for number, (sensor, axis) in enumerate((s, a) for s in ("gyro", "accel") for a in "xyz"):
            bits = getattr(words, sensor).bits
            meaning = f"the {sensor} count, {axis} axis, of the sample to push"
            field = Field("value", 0, bits, "rw", meaning, 0)
            yield Register(f"inject_{sensor}_{axis}", 0x080 + 4 * number, meaning, (field,))
        yield Register(
            "inject_push",
            0x098,
            "pushes a sample to the core, where control.inject is set",
            (
                Field("push", 0, 1, "pulse", "pushes the sample of the registers inject_*", 0),
                Field("fault", 1, 1, "pulse", "with push: the sample is marked faulty", 0),
            ),
        )
