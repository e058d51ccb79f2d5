"""The words, tables and picture of chip.md."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from sculler.plots.pictures import BLUE, GREY, VERMILION, legend, new_figure
from sculler_model.frames import euler_angles
from studies import documents
from studies.soc.fly import CORRUPTED, DESIGN, LOST, MOTION, SECONDS, Measured
from studies.soc.place import CELLS, Placed

PICTURE = "chip-flight.png"


def document(flight: Measured, placed: Sequence[Placed]) -> str:
    """The text of the page."""
    lines: list[str] = []
    for section in (
        _introduction(flight),
        flight_table(flight),
        _times(flight),
        _damage(flight),
        _parts(flight, placed),
    ):
        lines += [*section, ""]
    return "\n".join(lines).rstrip() + "\n"


def _introduction(flight: Measured) -> Iterator[str]:
    chip = flight.chip
    yield "# The chip, measured"
    yield ""
    yield "<!-- written by `python -m studies.soc` -->"
    yield ""
    yield documents.paragraph(
        f"The [chip](../reference/soc.md) of the preset `stim300` ({DESIGN.algorithm.family}, n ="
        f" {DESIGN.algorithm.samples}, M = {DESIGN.algorithm.minors}: 100 results a second) at"
        f" {flight.figures['clock_hz'] / 1e6:g} MHz, {chip.plan.memory_kib} KiB of memory; firmware"
        f" of {chip.firmware.code:,} bytes of code and {chip.firmware.variables:,} of variables, by"
        f" {chip.firmware.compiler}."
    )


def flight_table(flight: Measured) -> Iterator[str]:
    """The whole flight."""
    found = flight.figures
    away = found["largest_difference"]
    yield "## A flight"
    yield ""
    yield documents.paragraph(
        f"The truth motion `{MOTION}`, {SECONDS:g} s: counts, datagrams on the sensor's line at"
        " 921,600 baud, the whole chip in Verilator, telemetry at 921,600 baud, decoded and held"
        " against `sculler model` and Python's navigator."
    )
    yield ""
    rows = [
        (
            "results that are the model's, integer for integer",
            f"{found['identical_results']} of {found['results_of_the_model']}",
        ),
        ("states told", f"{found['states']}"),
        (
            "largest difference from Python's states",
            f"{away['attitude']:.2g} rad, {away['velocity']:.2g} m/s, {away['position']:.1e} m",
        ),
        ("clocks simulated", f"{found['clocks']:,}"),
        ("processor time of the simulation, for a second of flight", f"{flight.cpu_seconds:.0f} s"),
    ]
    yield from documents.table("lr", ("what", "found"), rows)
    yield ""
    yield documents.paragraph(
        "Where a position differs it is by units in the last place of latitude or longitude, which"
        " come out of `asin` and `atan2` of two mathematical libraries (picolibc's on the chip);"
        " the navigator carries nothing on from them."
    )
    yield ""
    yield f"![Truth, Python and the chip]({documents.IMAGES}/{PICTURE})"


def _times(flight: Measured) -> Iterator[str]:
    found = flight.figures
    clock = found["clock_hz"]
    yield "## Times"
    yield ""
    yield documents.paragraph(
        "Medians of the flight, as the telemetry's own stamps tell them; [what each is](time.md)."
    )
    yield ""
    rows = [
        ("first bit of the interval's last datagram to the result", found["core_clocks"]),
        ("result to the firmware's taking it up", found["wait_clocks"]),
        ("taking it up to the state", found["update_clocks"]),
        ("first bit to the state's last byte on the line", found["telemetry_clocks"]),
        ("taking it up to being free for the next, telemetry queued", found["busy_clocks"]),
    ]
    yield from documents.table(
        "lrr",
        ("from, to", "clocks", "µs"),
        [(what, f"{clocks:,}", f"{1e6 * clocks / clock:,.1f}") for what, clocks in rows],
    )
    yield ""
    instructions = 100_728 + 27_459
    yield documents.paragraph(
        f"The last row is what the rate depends on: {found['updates_per_second']:.0f} updates a"
        f" second at {clock / 1e6:g} MHz, for 100 that are needed. By the"
        f" [count of instructions](host-in-c-targets.md) of an update with state and frame,"
        f" {instructions:,}, that is {found['update_clocks'] / instructions:.2f} clocks an"
        " instruction or so; the first update takes twice as long, and results wait for it."
    )


def _damage(flight: Measured) -> Iterator[str]:
    hurt = flight.damaged
    yield "## Damage on the wire"
    yield ""
    yield documents.paragraph(
        f"{len(LOST)} datagrams are missing, {len(CORRUPTED)} have a wrong bit, of"
        f" {hurt.counters['taken'] + len(LOST) + len(CORRUPTED)}. The expected integers are those"
        " of the model of the front end and of the core on the same bytes."
    )
    yield ""
    rows = [
        ("results that are the model's", f"{hurt.equal} of {hurt.results}"),
        ("results flagged (status bit 1)", f"{hurt.flagged}"),
        ("states told", f"{hurt.states}"),
        *((f"`{name}`", f"{count}") for name, count in hurt.counters.items()),
        ("last position, from that of the whole flight", f"{hurt.away:.1e} m"),
    ]
    yield from documents.table("lr", ("what", "found"), rows)


def _parts(flight: Measured, placed: Sequence[Placed]) -> Iterator[str]:
    busy = flight.figures["busy_clocks"]
    yield "## In real parts"
    yield ""
    yield documents.paragraph(
        "`NAME_soc` with its firmware, by Yosys and nextpnr to a bitstream, slowest speed grade,"
        " one seed, asked for 100 MHz. The clock comes from a pin. A design for another clock"
        " (`hardware.front.clock_hz`) is another chip, of the same size but for dividers."
    )
    yield ""
    headings = ("device", "MHz", *CELLS.values(), "bitstream, bytes", "updates a second there")
    rows = [
        (
            one.device,
            f"{one.mhz:.1f}",
            *(f"{used:,} of {there:,}" for used, there in one.usage.values()),
            f"{one.bitstream:,}",
            f"{1e6 * one.mhz / busy:.0f}",
        )
        for one in placed
    ]
    yield from documents.table("lr" + "r" * len(CELLS) + "rr", headings, rows)


def draw(folder: Path, flight: Measured) -> Path:
    """Truth, Python and chip: three lines that are one; and how far they are apart."""
    states, expected, truth = flight.flown.record.states, flight.flown.expected, flight.truth
    count = len(states)
    time = states["time"]
    chip = np.degrees(euler_angles(states["q"][:, [3, 0, 1, 2]]))
    python = np.degrees(expected.euler[1 : count + 1])
    true = np.degrees(truth.euler)
    path = folder / PICTURE
    with new_figure(path, 10, 7) as figure:
        rows = figure.subplots(3, 1, sharex=True, height_ratios=[2, 2, 1.4])
        for axes, angle, name in ((rows[0], 0, "roll, °"), (rows[1], 2, "heading, °")):
            axes.plot(time, true[:, angle], color=GREY, lw=6, alpha=0.4, label="truth")
            axes.plot(time, python[:, angle], color=BLUE, lw=2.5, label="Python")
            axes.plot(time, chip[:, angle], color=VERMILION, lw=1, ls="--", label="chip")
            axes.set_ylabel(name)
        legend(rows[0])
        off = 3600 * np.abs(chip - true).max(axis=1)
        rows[2].plot(time, off, color=GREY, label="chip from truth")
        apart = 3600 * np.abs(chip - python).max(axis=1)
        rows[2].plot(time, apart, color=VERMILION, label="chip from Python")
        rows[2].set_ylabel("largest angle, ″")
        rows[2].set_xlabel("time, s")
        legend(rows[2])
    return path
