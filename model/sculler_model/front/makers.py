"""The makers' frames, as their data sheets and maintained drivers have them."""

from __future__ import annotations

from sculler_model.front.layout import Check, Counter, Flags, Kind, Layout, Number

_ACCEL, _INCLINATION, _TEMPERATURE, _AUXILIARY = 1, 2, 4, 8

STIM300_IDENTIFIERS = (0x91, 0x93, 0x99, 0x9B, 0xA5, 0xA7, 0xAD, 0xAF)
"""Of the datagrams that hold both gyro and accelerometer."""

ADIS_RATES = ("adis16465", "adis16467", "adis16470", "adis16475")
"""Parts whose burst has 16-bit rates and specific forces, and nothing else."""

ADIS_BOTH = ("adis16477", "adis16500", "adis16501", "adis16505", "adis16507")
"""Parts whose burst may have numbers of 32 bits, and delta angles and velocities instead."""

ADIS_REGISTERS = ("adis16480", "adis16485", "adis16488")
"""Parts without a burst: their registers are read one by one."""

ADIS_PAUSE_S = 2e-6
"""Between two words of those."""

ADIS_BURST = 0x6800
"""The word that asks for a burst."""


def _big(first: int, count: int, size: int) -> tuple[Number, ...]:
    """Signed numbers one after the other, most significant byte first."""
    return tuple(
        Number(tuple(range(begin, begin + size)), signed=True)
        for begin in range(first, first + count * size, size)
    )


def _little(first: int, count: int, size: int) -> tuple[Number, ...]:
    """The same, least significant byte first."""
    return tuple(Number(each.places[::-1], signed=True) for each in _big(first, count, size))


def _stim300_kind(identifier: int) -> Kind:
    contents = identifier & 0x0F
    if identifier >= 0xA0:
        contents |= _TEMPERATURE
    triples = 1 + bool(contents & _ACCEL) + bool(contents & _INCLINATION)
    length = 1 + 10 * triples + 4 * bool(contents & _AUXILIARY) + 3 + 4
    length += 7 * triples * bool(contents & _TEMPERATURE)
    return Kind(bytes([identifier]), length, zeros=-(length - 4) % 4)


def stim300(identifiers: tuple[int, ...], step: int) -> Layout:
    """Sensonor STIM300 (STIM318, STIM320 alike): datagrams of the normal mode.

    Most significant byte first: the identifier; gyro x, y, z (3 bytes each) and their status; the
    same of the accelerometers; inclinometers, temperatures and auxiliary input as the identifier
    tells; the counter of internal samples at 2000 Hz; the latency (2 bytes, µs); the CRC (4), over
    the bytes before and as many zeros as make them a multiple of 4.  Whether the numbers are rates
    or increments is a setting of the sensor and changes nothing here.  Source: Sensonor's data
    sheet TS1524, tables of the normal mode; constants of vortexntnu/stim300-driver agree.

    Args:
        identifiers: those to take, of `STIM300_IDENTIFIERS`.
        step: of the counter from datagram to datagram.
    """
    crc = Check(
        "crc", 32, Number((-4, -3, -2, -1)), 0, -5, polynomial=0x04C11DB7, initial=0xFFFFFFFF
    )
    return Layout(
        tuple(map(_stim300_kind, identifiers)),
        _big(1, 3, 3),
        _big(11, 3, 3),
        crc,
        Counter(Number((-7,)), 8, step),
        (Flags(10), Flags(20)),
        latency=Number((-6, -5)),
    )


def hg4930() -> Layout:
    """Honeywell HG4930: messages of the asynchronous protocol.

    Least significant byte first: address 0E and the message's number; six numbers of rates for
    control (2 bytes each); status words 1 and 2; in the inertial message (02) delta angles x, y, z
    and delta velocities x, y, z (4 bytes each); the sum of all 16-bit words before it.  Five of six
    messages at 600 Hz are control messages (01, CA), which hold no sample; the sixth is inertial.
    Bits 0 and 1 of status word 1 count all of them, so that they go on by 6 = 2 modulo 4 from
    sample to sample.  Until the power-up test is done (bit 9 of status word 2) there is a fixed
    pattern in place of data.  Source: HG4930 Performance and Installation Manual; the drivers
    bolderflight/hg4930 and Honeywell's HGuideAPI agree.
    """
    return Layout(
        (
            Kind(b"\x0e\x02", 44),
            Kind(b"\x0e\x01", 20, sample=False),
            Kind(b"\x0e\xca", 20, sample=False),
        ),
        _little(18, 3, 4),
        _little(30, 3, 4),
        Check("sum", 16, Number((-1, -2)), 0, -3, word_bytes=2, little=True),
        Counter(Number((14,)), 2, 6),
        (Flags(14, 0xF0), Flags(15, 0x87), Flags(17, 0x7D)),
        absent=(Flags(17, 0x02),),
    )


def adis(long: bool) -> Layout:
    """Analog Devices ADIS16465 ... ADIS16477, ADIS16500 ... ADIS16507: a burst, after its request.

    16-bit words, most significant byte first: DIAG_STAT; gyro x, y, z and accelerometer x, y, z;
    temperature; the counter of samples; the sum of all bytes before it.  In a burst of 32-bit
    numbers (BURST32 of MSC_CTRL) the low word goes first.  BURST_SEL chooses delta angles and
    velocities.  Source: data sheets of ADIS16470, ADIS16477 and ADIS16505, burst read function; the
    kernel's driver adis16475 agrees.

    Args:
        long: numbers of 32 bits.
    """
    size, step = (16, 4) if long else (10, 2)
    order = (2, 3, 0, 1) if long else (0, 1)
    numbers = tuple(
        Number(tuple(2 + step * axis + place for place in order), signed=True) for axis in range(6)
    )
    return Layout(
        (Kind(b"", 2 * size),),
        numbers[:3],
        numbers[3:],
        Check("sum", 16, Number((-2, -1)), 0, -3),
        Counter(Number((-4, -3)), 16),
        (Flags(0), Flags(1)),
        some_set=True,
    )


def adis_requests(increments: bool, long: bool) -> tuple[int, ...]:
    """What asks an ADIS16480, ADIS16485 or ADIS16488 for a sample: reads of page 0.

    SYS_E_FLAG (08); then for gyro x, y, z and accelerometer x, y, z the low word and the high word
    of rates (from 10 on) or of delta angles and velocities (from 40 on).

    Args:
        increments: delta angles and velocities.
        long: numbers of 32 bits; else the high words alone.
    """
    begin = 0x40 if increments else 0x10
    addresses = range(begin, begin + 24, 2)
    return tuple(address << 8 for address in (0x08, *(addresses if long else addresses[1::2])))


def adis_registers(long: bool) -> Layout:
    """Analog Devices ADIS16480, ADIS16485, ADIS16488: the answers to `adis_requests`.

    There is neither a check nor a counter of samples.  Source: data sheets of ADIS16485 and
    ADIS16488, reading sensor data; the kernel's driver adis16480 agrees in the addresses.
    """
    step = 4 if long else 2
    order = (2, 3, 0, 1) if long else (0, 1)
    numbers = tuple(
        Number(tuple(2 + step * axis + place for place in order), signed=True) for axis in range(6)
    )
    return Layout(
        (Kind(b"", 2 + 6 * step),),
        numbers[:3],
        numbers[3:],
        None,
        faults=(Flags(0), Flags(1)),
        some_set=True,
    )
