"""What a sensor front end is built of: its ports, the rate of its wire, its memory."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from sculler_hdl.plan.ports import Port, sample_ports
from sculler_model.design import AXES, Design
from sculler_model.front import Layout, Link, Number, Spi, Uart

FRONT_COUNTER_BITS = 32
"""Of the counters; at their highest they stay."""

LATENCY_BITS = 16

_COUNTERS = {
    "frames_taken": "frames whose samples were handed over, since reset",
    "frames_bad": "frames not used, since reset: wrong check, or after their placeholder",
    "frames_missed": "placeholders for frames that the counter told to be missing, since reset",
    "frames_late": "placeholders by time-outs, since reset",
    "sensor_faults": "samples with a status flag raised, or whose counter had jumped, since reset",
}


def front_counter_ports() -> list[Port]:
    """The ports of a front end that count."""
    return [
        Port(name, FRONT_COUNTER_BITS, output=True, told=told) for name, told in _COUNTERS.items()
    ]


def pin_ports(design: Design) -> list[Port]:
    """The ports of the sensor's wire; none without a front end."""
    link = design.front
    if link is None:
        return []
    if isinstance(link.wire, Uart):
        return [Port("rx", 1, told="the sensor's line, high while idle; synchronised inside")]
    return [
        Port("sck", 1, output=True, told="SPI clock, high while idle (mode 3)"),
        Port("cs_n", 1, output=True, told="SPI chip select, low in a burst"),
        Port("mosi", 1, output=True, told="SPI data to the sensor"),
        Port("miso", 1, told="SPI data from the sensor; synchronised inside"),
        Port("data_ready", 1, told="rises when a sample is ready; synchronised inside"),
    ]


def front_ports(design: Design) -> list[Port]:
    """All ports of NAME_front in their order, `clk` and `rst` apart; none without a front end.

    Those of a sample have the names of the core's, which they are wired to.
    """
    link = design.front
    if link is None:
        return []
    latency = Port(
        "sample_latency",
        LATENCY_BITS,
        output=True,
        told="age of the sample as its frame tells, in the sensor's unit",
    )
    instant = Port(
        "sample_instant",
        1,
        output=True,
        told="a frame begins: the moment of the time stamp of the sample that follows",
    )
    return [
        *pin_ports(design),
        Port("sample_valid", 1, output=True),
        Port("sample_ready", 1),
        *(port._replace(output=True) for port in sample_ports(design)),
        *([] if link.layout.latency is None else [latency]),
        instant,
        *front_counter_ports(),
    ]


@dataclass(frozen=True)
class BaudPlan:
    """The clocks of a bit: a phase that goes on by `step` a clock, modulo 2^`bits`, a turn a bit.

    Attributes:
        bits: of the phase.
        step: a clock.
        error: how much faster the receiver is than the line, as a share.
    """

    bits: int
    step: int
    error: float

    @classmethod
    def of(cls, clock_hz: float, baud: float) -> BaudPlan:
        """As near to the rate as a phase of 24 bits comes."""
        bits = 24
        step = round(baud / clock_hz * (1 << bits))
        return cls(bits, step, step * clock_hz / (1 << bits) / baud - 1)

    @property
    def votes(self) -> tuple[int, int, int]:
        """Phases past which a bit is looked at: around its middle."""
        sixteenth = 1 << (self.bits - 4)
        return 6 * sixteenth, 8 * sixteenth, 10 * sixteenth


def crc_terms(bits: int, polynomial: int) -> list[tuple[int, int]]:
    """What each bit of a CRC register is once it has taken a byte, most significant bit first.

    Returns:
        For each bit the masks of those bits of register and byte whose parity it is.
    """
    top, mask = 1 << (bits - 1), (1 << bits) - 1

    def after(value: int) -> int:
        for _ in range(8):
            value = (value << 1 & mask) ^ (polynomial if value & top else 0)
        return value

    of_register = [after(1 << bit) for bit in range(bits)]
    of_byte = [after(1 << (bits - 8 + bit)) for bit in range(8)]
    return [
        (
            sum(1 << i for i, word in enumerate(of_register) if word >> bit & 1),
            sum(1 << i for i, word in enumerate(of_byte) if word >> bit & 1),
        )
        for bit in range(bits)
    ]


@dataclass(frozen=True)
class FrontPlan:
    """What a front end is built of.

    Attributes:
        link: the sensor on its wire.
    """

    link: Link

    @property
    def layout(self) -> Layout:
        """Of its frames."""
        return self.link.layout

    @cached_property
    def fields(self) -> dict[str, Number]:
        """The numbers of a frame that are kept, by name."""
        layout = self.layout
        found = {
            f"{sensor}_{axis}": number
            for sensor in ("gyro", "accel")
            for axis, number in zip(AXES, getattr(layout, sensor), strict=True)
        }
        if layout.counter is not None:
            found["count"] = layout.counter.number
        if layout.latency is not None:
            found["latency"] = layout.latency
        return found

    @cached_property
    def field_bits(self) -> dict[str, int]:
        """Bits of each of them that are kept."""
        found = {name: number.bits for name, number in self.fields.items()}
        if self.layout.counter is not None:
            found["count"] = self.layout.counter.bits
        return found

    @cached_property
    def baud(self) -> BaudPlan:
        """Of an asynchronous line."""
        assert isinstance(self.link.wire, Uart)
        return BaudPlan.of(self.link.clock_hz, self.link.wire.baud)

    @property
    def half_period(self) -> int:
        """Clocks of half a period of the SPI clock."""
        assert isinstance(self.link.wire, Spi)
        return max(2, -int(-self.link.clock_hz // (2 * self.link.wire.sck_hz)))

    @property
    def pause(self) -> int:
        """Clocks between two words over SPI; 0 for a burst in one."""
        assert isinstance(self.link.wire, Spi)
        return -int(-self.link.clock_hz * self.link.wire.pause_s // 1)

    @property
    def ring(self) -> int:
        """Bytes of the memory: a frame and what comes while it is looked through, a power of 2."""
        return 1 << (self.layout.longest + 3).bit_length()

    @property
    def latency(self) -> int:
        """Clocks from a frame's last byte, whole in the receiver, to `sample_valid`.

        It is counted for a frame that comes after one that was whole, on an idle core.
        """
        zeros = max(kind.zeros for kind in self.layout.kinds)
        return 8 + zeros - 2 * (self.layout.counter is None)
