"""The words and tables of hardware.md."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sculler.words import three_digits
from sculler_sim.place.placement import Placement
from studies import documents
from studies.hardware import counted_on
from studies.hardware.classes import spread
from studies.hardware.measure import SEEDS, Corner
from studies.hardware.points import Point, counted

HEADINGS = (
    "design",
    "device",
    "MHz",
    "LUTs",
    "flip-flops",
    "multipliers",
    "block RAMs",
    "clocks a sample",
    "clocks a minor interval",
    "latency",
    "samples/s",
)

PUBLISHED = (
    (
        "GPS/INS in software on a MicroBlaze"
        " ([Bhogadi 2015](https://doi.org/10.1186/s40064-015-1367-y))",
        "Virtex-6",
        "100 updates/s",
    ),
)
"""What is published of others: what it does, in what, how fast."""


def document(
    placed: Sequence[tuple[Point, Placement]],
    corners: Sequence[Corner],
    differed: Sequence[tuple[Point, Placement]] = (),
) -> str:
    """The text of the page.

    Args:
        placed: all points with what was found.
        corners: the design space.
        differed: the designs of `classes`; left out if there are none.
    """
    sections = (
        _introduction(placed),
        goals(placed),
        *(
            [spread(differed), counted_on.section(counted_on.rows(placed, differed))]
            if differed
            else []
        ),
        devices(placed),
        paths(placed),
        _space(corners),
        _beside(placed),
    )
    return documents.joined(sections)


def _introduction(placed: Sequence[tuple[Point, Placement]]) -> Iterator[str]:
    tools: dict[str, str] = {}
    for _, placement in placed:
        tools |= placement.tools
    yield "# The cores in real devices"
    yield ""
    yield documents.paragraph(
        "Written by `make hardware`; `sculler place DESIGN --device DEVICE` does it for any design."
        " What has the same Verilog, device and tools as before is not placed again: it is kept in"
        " `studies/hardware/kept.json`."
    )
    yield ""
    yield documents.paragraph(
        "**How.** Yosys and nextpnr as PyPI has them ("
        + ", ".join(f"{name} {version}" for name, version in sorted(tools.items()))
        + f"), the median of {len(SEEDS)} seeds with the slowest and fastest beside it; the timing"
        " model of the device is nextpnr's, not its maker's. Neither pins nor wide ports limit the"
        " figure: in an ECP5 the core is placed alone (`--out-of-context`); in an iCE40, where"
        " nextpnr has no such thing, it sits in a shift register, in which every input comes from"
        " a register and every output goes to one. The shift register's area is not counted: the"
        " area is the core's own, packed alone, with its result buffers. The multiplier blocks of a"
        " pipelined ECP5 core are put side by side, array by array, as the manifest's"
        " `resources.blocks` names them (attributes in the netlist); all else is nextpnr's choice."
    )
    yield ""
    yield documents.paragraph(
        "**Inside blocks.** nextpnr does not check what lies between a block's own registers. We"
        " do, from the netlist's parameters: a multiplier of an ECP5 -6 allows 292 MHz from input"
        " to output register and 390 MHz with its pipeline register in use, a block RAM 212 MHz"
        " (shortest clock pulses). The clock rates below are the smaller of both."
    )
    yield ""
    yield documents.paragraph(
        "**The netlist is checked.** `sculler place --check` simulates what was placed, with"
        " models of the device's cells, against the golden model; so do the tests, for both cores"
        " and both families. The check is needed: `synth_ice40 -dsp` of this Yosys ties products"
        " to constants when it moves registers with initial values into a multiplier, so it is"
        " not used; a design with `hardware.target` brings its multipliers itself."
    )


def goals(placed: Sequence[tuple[Point, Placement]]) -> Iterator[str]:
    """The figures asked for, and whether each is reached."""
    yield "## Figures to reach"
    yield from documents.table(
        "lllll",
        ("design", "device", "asked", "found", "reached"),
        (_goal_row(point, placement) for point, placement in placed if point.asked),
    )


def _goal_row(point: Point, placement: Placement) -> tuple[str, ...]:
    asked = "; ".join(condition.text for condition in point.asked)
    found = "; ".join(condition.reached(placement) for condition in point.asked)
    missed = [condition.text for condition in point.asked if not condition.met(placement)]
    verdict = f"**no**: {'; '.join(missed)}" if missed else "yes"
    return point.what, placement.device, asked, found, verdict


def table_row(point: Point, placement: Placement) -> list[str]:
    """A point in the words of `HEADINGS`."""
    area, seeds = placement.area, [seed.mhz for seed in placement.seeds]
    rate = latency = samples = "-"
    if placement.fmax_mhz is not None:
        rate = f"{placement.fmax_mhz:.1f} [{min(seeds):.1f} .. {max(seeds):.1f}]"
        latency = f", {placement.latency_ns:,.0f} ns"
        samples = three_digits(placement.samples_per_second or 0)
    return [
        point.what,
        placement.device,
        rate,
        _of(area.luts, placement, ("ICESTORM_LC",), " logic cells"),
        f"{area.flip_flops:,}",
        f"{area.multipliers:,}",
        f"{area.memories:,}",
        f"{placement.clocks_per_sample:.4g}",
        f"{placement.clocks_per_minor:,}",
        f"{placement.latency_clocks:,} clocks{latency if latency != '-' else ''}",
        samples,
    ]


def _of(luts: int, placement: Placement, kinds: Sequence[str], name: str) -> str:
    """LUTs, and the cells they come to where a cell holds register and LUT."""
    packed = [f"{placement.area.usage[k][0]:,}{name}" for k in kinds if k in placement.area.usage]
    return f"{luts:,}" + "".join(f" ({text})" for text in packed)


def devices(placed: Sequence[tuple[Point, Placement]]) -> Iterator[str]:
    """Every design in its device."""
    yield "## Designs and devices"
    yield documents.paragraph(
        "Four samples a minor interval without history, five minor intervals a result. LUTs have 4"
        " inputs in the Lattice devices (logic, carry chains and small memories together) and 6 in"
        " Xilinx's 7 series, where the area is an estimate by synthesis alone. Clocks are those of"
        " the long run, samples always offered and results taken at once."
    )
    yield ""
    rows = (table_row(point, placement) for point, placement in placed)
    yield from documents.table("ll" + "r" * (len(HEADINGS) - 2), HEADINGS, rows)
    yield ""
    yield f"![Speed against area]({documents.IMAGES}/hardware-speed-area.png)"


def paths(placed: Sequence[tuple[Point, Placement]]) -> Iterator[str]:
    """What limits the clock rate of each."""
    yield "## What limits each"
    for point, placement in placed:
        if placement.seeds:
            yield f"- {point.what}, {placement.device}: {placement.limited_by()}"
    yield ""
    yield documents.paragraph(
        "Names are the registers' in the generated Verilog; `harness` is the shift register. A"
        " carry step is one LUT's width of an addition."
    )


def _space(corners: Sequence[Corner]) -> Iterator[str]:
    yield "## Multipliers against clocks against LUTs"
    yield documents.paragraph(
        "The 24-bit design in an ECP5 with `hardware.multipliers` ever smaller, then the compact"
        " core; packed, not placed."
    )
    yield ""
    yield from documents.table(
        "lrrr",
        ("core", "multipliers", "clocks a sample", "LUTs"),
        (
            (corner.name, str(corner.multipliers), f"{corner.clocks:.4g}", f"{corner.luts:,}")
            for corner in corners
        ),
    )
    yield ""
    yield f"![The design space]({documents.IMAGES}/hardware-design-space.png)"


def _beside(placed: Sequence[tuple[Point, Placement]]) -> Iterator[str]:
    yield "## Beside a published figure"
    yield documents.paragraph(
        "It is of another task in another device: a whole navigation, where ours is the exact"
        " high-rate part of one, coning and sculling, with the low-rate part left to the host. So"
        " only the orders of magnitude say something."
    )
    yield ""
    yield from documents.table("lll", ("what", "in", "time"), (*PUBLISHED, *_our_rows(placed)))


def _our_rows(placed: Sequence[tuple[Point, Placement]]) -> Iterator[tuple[str, ...]]:
    """Our rows of the same."""
    for point, placement in placed:
        if placement.fmax_mhz is not None and point.asked:
            clocks = placement.clocks_per_minor
            yield (
                f"ours: coning and sculling of a minor interval, {point.what}",
                f"{clocks:,} clocks at {placement.fmax_mhz:.0f} MHz, {placement.device},"
                f" {counted(placement.area.multipliers, 'multipliers')}",
                f"{_duration(clocks / placement.fmax_mhz)} a minor interval",
            )
        elif not placement.seeds:
            yield (
                f"ours: {point.what}",
                f"{placement.area.multipliers} DSPs, {placement.device}",
                "area only",
            )


def _duration(microseconds: float) -> str:
    """15.7 ns, 1.82 µs."""
    if microseconds < 1:
        return f"{1000 * microseconds:.3g} ns"
    return f"{three_digits(microseconds)} µs"
