"""A log through the whole chip: datagrams in, telemetry out, in Verilator."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from sculler.soc.firmware import Firmware
from sculler.soc.plan import SocPlan
from sculler.soc.telemetry import ChipRecord, read_chip
from sculler.soc.texts import soc_texts
from sculler_hdl import Generated
from sculler_model.errors import InputError
from sculler_model.front import Link, Uart, frame_of
from sculler_sim.chip import Chip, Sent, fly

BEGIN_S = 1e-3
"""From the reset to the first byte."""

Row = Sequence[int]
Wire = Callable[[int, bytes], bytes]
"""What becomes of a datagram on its way: number and bytes; nothing where it is lost."""


@dataclass(frozen=True)
class Flight:
    """A log that went through a chip.

    Attributes:
        sent: the bytes of its telemetry, with the clocks of each.
        record: what they tell.
        clocks: that were simulated.
    """

    sent: Sent
    record: ChipRecord
    clocks: int


def fly_log(
    plan: SocPlan,
    generated: Generated,
    firmware: Firmware,
    counts: Sequence[Row],
    faults: Sequence[int] | None = None,
    wire: Wire = lambda number, frame: frame,
) -> Flight:
    """Simulate the chip with a log's samples on its sensor's line.

    Args:
        plan: of the chip.
        generated: its core, front end and bus.
        firmware: its program.
        counts: (N, 6) samples, gyro and accelerometer x, y, z.
        faults: (N,) fault marks, sent as status flags; None for none.
        wire: what becomes of the datagrams.

    Raises:
        InputError: a count does not fit a frame, or Verilator fails.
    """
    design = plan.design
    link = design.front
    assert link is not None
    name = design.name
    verilog = {f"{name}.v": generated.verilog, **generated.further, **soc_texts(plan)}
    verilog |= {f"{cell}.v": text for cell, text in generated.cells.items()}
    chip = Chip(
        f"{name}_soc",
        {file: text for file, text in verilog.items() if file.endswith(".v")},
        {f"{name}_firmware.hex": firmware.hex},
        link.wire,
        link.clock_hz,
        plan.divisor,
    )
    begin = round(BEGIN_S * link.clock_hz)
    major = design.samples_per_major
    # the last result's telemetry comes some intervals later; placeholders make results behind it.
    # What waited for an alignment to end is worked off twice as fast as it came.
    clocks = begin + round((len(counts) + 3 * major) * link.clock_hz / link.sample_rate_hz)
    clocks += 2 * plan.busy_clocks
    line = _line(link, counts, faults or [0] * len(counts), wire, begin)
    sent = fly(chip, line, clocks)
    return Flight(sent, read_chip(design, sent.data), clocks)


def _line(
    link: Link, counts: Sequence[Row], faults: Sequence[int], wire: Wire, begin: int
) -> Iterator[tuple[int, ...]]:
    """Bytes and the clocks in which they begin; over SPI samples and those of data-ready."""
    a_sample = link.clock_hz / link.sample_rate_hz
    for number, (row, fault) in enumerate(zip(counts, faults, strict=True)):
        try:
            frame = frame_of(link.layout, row[:3], row[3:], number, bool(fault))
        except ValueError as error:
            raise InputError(f"sample {number + 1} of the log: {error}") from error
        sent, clock = wire(number, frame), begin + number * a_sample
        if isinstance(link.wire, Uart):
            a_byte = link.wire.bits_per_byte * link.clock_hz / link.wire.baud
            yield from ((round(clock + place * a_byte), byte) for place, byte in enumerate(sent))
        elif sent:
            yield (round(clock), *sent)
