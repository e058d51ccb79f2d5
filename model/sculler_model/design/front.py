"""The design file's [hardware.front]: the sensor's wire, read by the hardware itself."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import Field

from sculler_model.design.custom_frame import CustomFrame
from sculler_model.design.sensor import Sensor
from sculler_model.front import (
    ADIS_BOTH,
    ADIS_BURST,
    ADIS_PAUSE_S,
    ADIS_RATES,
    ADIS_REGISTERS,
    STIM300_IDENTIFIERS,
    Layout,
    Link,
    Spi,
    Uart,
    adis,
    adis_registers,
    adis_requests,
    hg4930,
    stim300,
)
from sculler_model.schema import Part

SensorName = Literal[
    "stim300",
    "hg4930",
    "adis16465",
    "adis16467",
    "adis16470",
    "adis16475",
    "adis16477",
    "adis16480",
    "adis16485",
    "adis16488",
    "adis16500",
    "adis16501",
    "adis16505",
    "adis16507",
    "custom",
]
_NAMES = ", ".join(f'"{name}"' for name in get_args(SensorName))
_BAUD = {"stim300": 921_600.0, "hg4930": 1_000_000.0}
_SCK_HZ = 1e6  # burst reads, all parts
_REGISTER_SCK_HZ = 5e6  # of at most 15 MHz
_STIM300_HZ = 2000  # its counter
_PATIENCE = 4
LEAST_CLOCKS_PER_BIT = 16


class Front(Part):
    """The sensor's wire.

    Attributes:
        sensor: whose frames come: a part, or "custom", which `frame` describes.
        clock_hz: of the core's clock.
        baud: of an asynchronous line; left out, what the sensor has from the maker.
        parity: of the line.
        sck_hz: of the SPI clock, at most; left out, 1 MHz for bursts and 5 MHz for registers.
        time_out: sample intervals without a sample before placeholders come unasked.  Left out, 4,
            or fewer where the frame's counter tells fewer lost ones, or 1 without a counter.
        datagram: identifier of the one STIM300 datagram to take; left out, all that hold both
            gyro and accelerometer.
        frame: a table, with sensor = "custom".
    """

    sensor: Annotated[SensorName, Field(description=f"one of {_NAMES}")]
    clock_hz: Annotated[float, Field(ge=1e3, le=1e10, description="a number from 1e3 to 1e10")]
    baud: Annotated[float | None, Field(ge=300, le=1e8, description="a number from 300 to 1e8")] = (
        None
    )
    parity: Annotated[
        Literal["even", "odd"] | None, Field(description='"even" or "odd", or leave it out')
    ] = None
    sck_hz: Annotated[
        float | None, Field(ge=1e3, le=1e8, description="a number from 1e3 to 1e8")
    ] = None
    time_out: Annotated[
        int | None, Field(ge=1, le=1000, description="a whole number from 1 to 1000")
    ] = None
    datagram: Annotated[
        Literal[0x91, 0x93, 0x99, 0x9B, 0xA5, 0xA7, 0xAD, 0xAF] | None,
        Field(description="0x91, 0x93, 0x99, 0x9B, 0xA5, 0xA7, 0xAD or 0xAF"),
    ] = None
    frame: Annotated[
        CustomFrame | None,
        Field(description="a table with sync, length, gyro, accel and check"),
    ] = None

    @property
    def is_spi(self) -> bool:
        """Whether the front end asks for samples over SPI."""
        return self.sensor in ADIS_RATES + ADIS_BOTH + ADIS_REGISTERS


def link_of(front: Front, sensor: Sensor) -> Link:
    """The sensor on its wire.

    Raises:
        ValueError: the keys do not fit together, or not the sensor; the message begins with the
            key's name and a colon.
    """
    _require_own_keys(front)
    layout = _layout(front, sensor)
    _require_widths(layout, sensor)
    wire: Uart | Spi
    if front.sensor in ADIS_REGISTERS:
        requests = adis_requests(sensor.kind == "increment", _is_long(sensor))
        wire = Spi(front.sck_hz or _REGISTER_SCK_HZ, requests, ADIS_PAUSE_S)
    elif front.is_spi:
        wire = Spi(front.sck_hz or _SCK_HZ, (ADIS_BURST,))
    else:
        baud = front.baud or _BAUD.get(front.sensor)
        if baud is None:
            raise ValueError('baud: missing, give bits a second with sensor = "custom"')
        wire = Uart(baud, front.parity or "none")
    tells = _PATIENCE if layout.counter is None else layout.counter.samples - 1
    usual = 1 if layout.counter is None else min(_PATIENCE, tells)
    patience = front.time_out or usual
    if layout.counter is not None and patience > tells:
        raise ValueError(f"time_out: {patience} is more than the counter can tell, give {tells}")
    link = Link(layout, wire, front.clock_hz, sensor.sample_rate_hz, patience)
    _require_rates(link)
    return link


def _require_own_keys(front: Front) -> None:
    """No key that means nothing with this sensor."""
    custom = front.sensor == "custom"
    if custom != (front.frame is not None):
        raise ValueError('frame: goes with sensor = "custom", and that needs it')
    if front.datagram is not None and front.sensor != "stim300":
        raise ValueError('datagram: goes with sensor = "stim300"')
    if front.is_spi and (front.baud is not None or front.parity is not None):
        raise ValueError(f"baud: {front.sensor} is read over SPI, give sck_hz or leave it out")
    if not front.is_spi and front.sck_hz is not None:
        raise ValueError(f"sck_hz: {front.sensor} sends on an asynchronous line, give baud")


def _is_long(sensor: Sensor) -> bool:
    """Whether its counts take more than a word of 16 bits."""
    return max(sensor.gyro.bits, sensor.accel.bits) > 16


def _layout(front: Front, sensor: Sensor) -> Layout:
    if front.frame is not None:
        try:
            return front.frame.layout
        except ValueError as error:
            raise ValueError(f"frame: {error}") from error
    if front.sensor == "hg4930":
        return hg4930()
    if front.sensor == "stim300":
        step = _STIM300_HZ / sensor.sample_rate_hz
        if step not in (1, 2, 4, 8, 16):
            raise ValueError(
                "sensor: a STIM300 has a sample rate of 2000, 1000, 500, 250 or 125 Hz, not"
                f" {sensor.sample_rate_hz:g}"
            )
        identifiers = STIM300_IDENTIFIERS if front.datagram is None else (front.datagram,)
        return stim300(identifiers, int(step))
    if front.sensor in ADIS_RATES and sensor.kind != "rate":
        raise ValueError(
            f'sensor: the burst of {front.sensor} holds rates, give sensor.kind = "rate"'
        )
    if front.sensor in ADIS_REGISTERS:
        return adis_registers(_is_long(sensor))
    long = _is_long(sensor)
    if long and front.sensor in ADIS_RATES:
        raise ValueError(f"sensor: the burst of {front.sensor} has counts of 16 bits")
    return adis(long)


def _require_widths(layout: Layout, sensor: Sensor) -> None:
    """Counts hold what the frame says."""
    for name in ("gyro", "accel"):
        number = getattr(layout, name)[0]
        least = number.bits + (not number.signed)
        bits = getattr(sensor, name).bits
        if bits < least:
            raise ValueError(
                f"sensor: its frame has {name} counts of {least} bits, sensor.{name}.bits is {bits}"
            )


def _require_rates(link: Link) -> None:
    """The wire is fast enough for the sensor, the core for the wire."""
    wire, longest = link.wire, link.layout.longest
    if isinstance(wire, Spi):
        per_bit = link.clock_hz / wire.sck_hz
        if per_bit < 4:
            raise ValueError(f"sck_hz: {wire.sck_hz:g} is more than a quarter of clock_hz")
        words = longest // 2 + 1
        seconds = (16 * words + 4) / wire.sck_hz + words * wire.pause_s * 1.5
    else:
        per_bit = link.clock_hz / wire.baud
        if per_bit < LEAST_CLOCKS_PER_BIT:
            raise ValueError(
                f"baud: {wire.baud:g} is more than a {LEAST_CLOCKS_PER_BIT}th of clock_hz"
            )
        # so that a frame is looked through before the next byte is whole
        need = (2 * longest + 16) / wire.bits_per_byte
        if per_bit < need:
            raise ValueError(
                f"clock_hz: frames of {longest} bytes at {wire.baud:g} baud need"
                f" {need * wire.baud:.4g} or more"
            )
        # the shortest frame that holds a sample must fit
        shortest = min(kind.length for kind in link.layout.kinds if kind.sample)
        seconds = shortest * wire.bits_per_byte / wire.baud
    if seconds * link.sample_rate_hz > 1:
        key = "sck_hz" if isinstance(wire, Spi) else "baud"
        raise ValueError(
            f"{key}: a frame takes {seconds * 1e6:.4g} us, more than the sample interval"
        )
