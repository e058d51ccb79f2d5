"""The words, tables and picture of chip.md."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from sculler.plots.pictures import BLUE, GREY, VERMILION, legend, new_figure
from sculler_model.frames import euler_angles
from studies import documents
from studies.soc.designs import DESIGN, SLOW_HZ
from studies.soc.fly import CORRUPTED, LOST, MOTION, SECONDS, Measured
from studies.soc.more import Further
from studies.soc.place import COLUMNS, Placed

PICTURE = "chip-flight.png"


def document(flight: Measured, more: Sequence[Further], placed: Sequence[Placed]) -> str:
    """The text of the page."""
    sections = (
        _introduction(flight),
        flight_table(flight),
        _times(flight),
        _damage(flight),
        further_table(more),
        parts_table(placed, flight.figures["busy_clocks"]),
    )
    return documents.joined(sections)


def _introduction(flight: Measured) -> Iterator[str]:
    chip = flight.chip
    yield "# The chip, measured"
    yield ""
    yield "<!-- written by `python -m studies.soc` -->"
    yield ""
    yield documents.paragraph(
        f"The [chip](../reference/soc.md) of the preset `stim300` ({DESIGN.algorithm.family}, n ="
        f" {DESIGN.algorithm.samples}, M = {DESIGN.algorithm.minors}: 100 results a second) at"
        f" {flight.figures['clock_hz'] / 1e6:g} MHz, {chip.plan.memory} KiB of memory; firmware"
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
    instructions = _instructions()
    yield documents.paragraph(
        f"The last row is what the rate depends on: {found['updates_per_second']:.0f} updates a"
        f" second at {clock / 1e6:g} MHz, for 100 that are needed. By the"
        f" [count of instructions](host-in-c-targets.md) of an update with state and frame,"
        f" {instructions:,}, that is {found['update_clocks'] / instructions:.2f} clocks an"
        " instruction or so; the first update takes twice as long, and results wait for it."
    )


def _instructions() -> int:
    """Of an update with state and frame on RV32IM, as host-in-c-targets.md tells."""
    text = (documents.PAGES / "host-in-c-targets.md").read_text(encoding="utf-8")
    found = re.search(r"^\| RV32IM .*?\*\*([\d,]+)\*\* \| ([\d,]+) \|", text, re.MULTILINE)
    assert found is not None
    return sum(int(number.replace(",", "")) for number in found.groups())


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


def further_table(more: Sequence[Further]) -> Iterator[str]:
    """Flights of other chips."""
    yield "## More flights"
    yield ""
    yield documents.paragraph(
        f"Other chips, at {SLOW_HZ / 1e6:g} MHz with sensors of 125 samples a second, so that they"
        " are quick to simulate. *Equal* are results that are the model's, integer for integer, of"
        " those that came, and how many there were to come. Each state is held against Python's"
        " navigator on the same results: the largest difference of attitude and velocity, and of"
        " position."
    )
    yield ""
    headings = ("flight", "code, bytes", "equal", "of", "states", "rad, m/s", "m", "coasted, s")
    rows = [
        (
            one.what,
            f"{one.code:,}",
            *(f"{one.equal} of {one.came}", f"{len(one.flown.model)}"),
            f"{len(one.flown.record.states)} of {len(one.flown.followed.rows)}",
            f"{max(one.away[:2]):.0e}" if max(one.away[:2]) else "0",
            f"{one.away[2]:.0e}" if one.away[2] else "0",
            f"{one.flown.followed.coasted:.3g}",
        )
        for one in more
    ]
    yield from documents.table("lr" + "r" * 6, headings, rows)
    yield ""
    yield documents.paragraph(
        "Where the processor is too slow an update takes longer than the interval: the core drops"
        " results, the next one's `major` tells how many, and the navigation coasts over them."
        " After a fine alignment results have waited too long: placeholders stand for samples, so"
        " what comes then is not the model's of the log, and is flagged."
    )
    for one in more:
        if one.aligned is not None:
            apart, clocks = one.aligned
            yield ""
            yield documents.paragraph(
                f"The {one.what}, is {apart:.1e} rad from the attitude that Python finds in the"
                f" same window, for the attitude is an eigenvector, which rounding moves"
                f" ([how far](host-in-c.md)). The end of the window takes {clocks:,} clocks,"
                f" {1e3 * clocks / 40e6:.0f} ms at 40 MHz, in which results wait."
            )


def told_busy_clocks(page: Path) -> int:
    """Clocks of an update, as the written page tells them."""
    text = page.read_text(encoding="utf-8")
    found = re.search(r"^\| taking it up to being free [^|]*\| ([\d,]+) \|", text, re.MULTILINE)
    assert found is not None
    return int(found[1].replace(",", ""))


def parts_table(placed: Sequence[Placed], busy: int) -> Iterator[str]:
    """What the chip takes of devices.

    Args:
        placed: the chip in each.
        busy: clocks of an update.
    """
    yield "## In real parts"
    yield ""
    yield documents.paragraph(
        "`NAME_soc` with its firmware, by Yosys and nextpnr, slowest speed grade, one seed, asked"
        " for 100 MHz. A design for another clock (`hardware.front.clock_hz`) is another chip, of"
        " the same size but for dividers. Updates a second are those of the flight above at the"
        " clock of the part."
    )
    yield ""
    headings = ("device", "MHz", *COLUMNS, "bitstream", "updates a second there")
    rows = [
        (
            one.device,
            f"{one.mhz:.1f}",
            *(f"{used:,} of {there:,}" for used, there in one.usage),
            one.bitstream,
            f"{1e6 * one.mhz / busy:.0f}",
        )
        for one in placed
    ]
    yield from documents.table("lr" + "r" * len(COLUMNS) + "rr", headings, rows)
    yield ""
    yield documents.paragraph(
        "The clock comes from a pin. Of a Nexus (LIFCL, package BG400, target `nexus`) nextpnr"
        " writes FASM, names of the switches that are set; what makes a bitstream of them,"
        " `prjoxide pack` of Project Oxide, is in no package for pip. Its usual router finds no"
        " way for the clock of the chip there; the older one, `--router router1`, does."
    )


def draw(folder: Path, flight: Measured) -> Path:
    """Truth, Python and chip: three lines that are one; and how far they are apart."""
    states, expected, truth = flight.flown.record.states, flight.flown.followed.states, flight.truth
    count = len(states)
    time = states["time"]
    chip = np.degrees(euler_angles(states["q"][:, [3, 0, 1, 2]]))
    python = np.degrees(expected.euler[:count])
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
