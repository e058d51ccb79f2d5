"""What the cores reach in real devices: `python -m studies.hardware` (or `make hardware`).

Writes docs/explanation/hardware.md and its pictures.  Nothing in it is typed in but the figures
asked for, the published ones and the words.  What Yosys and nextpnr found is kept in the cache
folder, so that a second run is quick, and the same program gives the same document.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from sculler import documents, terminal
from sculler.main import run_command
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_sim.place.devices import find_device
from sculler_sim.place.placement import Placement, place

SEEDS = (1, 2, 3)


@dataclass(frozen=True)
class Condition:
    """A figure asked for.

    Attributes:
        text: in words.
        reached: what the placement has of it, in words.
        met: whether that is enough.
    """

    text: str
    reached: Callable[[Placement], str]
    met: Callable[[Placement], bool]


def at_least(mhz: float) -> Condition:
    """A clock rate, in the median."""
    return Condition(
        f"≥ {mhz:g} MHz", lambda p: f"{p.fmax_mhz or 0:.1f} MHz", lambda p: (p.fmax_mhz or 0) >= mhz
    )


def at_most(limit: int, thing: str, count: Callable[[Placement], int]) -> Condition:
    """So many of a thing and no more."""
    return Condition(
        f"≤ {_counted(limit, thing)}",
        lambda p: _counted(count(p), thing),
        lambda p: count(p) <= limit,
    )


def _counted(count: int, thing: str) -> str:
    """`1 multiplier`, `2,000 multipliers`."""
    return f"{count:,} {thing.removesuffix('s') if count == 1 else thing}"


def exactly(amount: float, thing: str, count: Callable[[Placement], float]) -> Condition:
    """So many of a thing."""
    return Condition(
        f"{amount:g} {thing}", lambda p: f"{count(p):g} {thing}", lambda p: count(p) == amount
    )


def keeps_up_with(rate: float) -> Condition:
    """Samples per second."""
    return Condition(
        f"{rate:,.0f} samples/s",
        lambda p: f"{terminal.three_digits(p.samples_per_second or 0)} samples/s",
        lambda p: (p.samples_per_second or 0) >= rate,
    )


def clocks_a_minor(limit: int) -> Condition:
    """Clocks for a minor interval."""
    return at_most(limit, "clocks a minor interval", lambda p: p.clocks_per_minor)


ONE_A_CLOCK = exactly(1, "clock a sample", lambda p: p.clocks_per_sample)
LATENCY = at_most(24, "clocks to the result", lambda p: p.latency_clocks)


def multipliers(limit: int) -> Condition:
    """Multiplier blocks."""
    return at_most(limit, "multipliers", lambda p: p.area.multipliers)


def cells(limit: int, kind: str, name: str) -> Condition:
    """Cells of the device."""
    return at_most(limit, name, lambda p: p.area.usage[kind][0])


@dataclass(frozen=True)
class Point:
    """A design in a device.

    Attributes:
        key: for `--only`.
        what: the design in words.
        design: the design.
        device: with its speed grade.
        asked: the figures asked for.
    """

    key: str
    what: str
    design: Design
    device: str
    speed: int | None = None
    asked: tuple[Condition, ...] = ()


def variant(bits: int, name: str, **hardware: Any) -> Design:
    """n = 4, p = 0, M = 5 with a sensor of 18, 24 (STIM300) or 32 bits (HG4930)."""
    preset = "hg4930" if bits == 32 else "stim300"
    data: dict[str, Any] = {"name": name, "preset": preset, "hardware": hardware}
    data["algorithm"] = {"samples": 4, "history": 0, "minors": 5}
    if bits == 18:
        data["sensor"] = {
            "gyro": {"bits": 18, "lsb": 5e-7},
            "accel": {"bits": 18, "lsb": 1.5e-5},
        }
    return Design.parse(data)


def points() -> list[Point]:
    """All of the table, in its order: first those of which something is asked."""
    fast = {"core": "pipelined", "target": "ecp5"}
    small: dict[str, Any] = {"core": "compact"}
    return [
        Point(
            "fast-18",
            "18-bit, pipelined",
            variant(18, "fast_18", **fast),
            "LFE5U-25F",
            6,
            (at_least(270), ONE_A_CLOCK, multipliers(28), LATENCY),
        ),
        Point(
            "fast-24",
            "24-bit, pipelined",
            variant(24, "fast_24", **fast),
            "LFE5U-85F",
            6,
            (at_least(250), ONE_A_CLOCK, LATENCY),
        ),
        Point(
            "fast-24-28",
            "24-bit, pipelined, 28 multipliers",
            variant(24, "fast_24_28", **fast, multipliers=28),
            "LFE5U-25F",
            6,
            (at_least(200), ONE_A_CLOCK, multipliers(28), LATENCY),
        ),
        Point(
            "fast-32",
            "32-bit, pipelined",
            variant(32, "fast_32", **fast),
            "LFE5U-85F",
            6,
            (at_least(220), LATENCY),
        ),
        Point(
            "compact-ecp5",
            "24-bit, compact",
            variant(24, "compact_ecp5", **small, target="ecp5"),
            "LFE5U-25F",
            6,
            (
                at_least(180),
                multipliers(1),
                at_most(700, "LUT4", lambda p: p.area.luts),
                clocks_a_minor(350),
            ),
        ),
        Point(
            "compact-up5k",
            "24-bit, compact",
            variant(24, "compact_ice40", **small, target="ice40"),
            "iCE40UP5K",
            None,
            (at_least(50), multipliers(2), cells(1500, "ICESTORM_LC", "logic cells")),
        ),
        Point(
            "compact-0-up5k",
            "24-bit, compact, no multiplier",
            variant(24, "compact_0_ice40", **small, target="ice40", multipliers=0),
            "iCE40UP5K",
            None,
            (multipliers(0), keeps_up_with(10_000)),
        ),
        Point(
            "compact-0-hx8k",
            "24-bit, compact, no multiplier",
            variant(24, "compact_0_ice40", **small, target="ice40", multipliers=0),
            "iCE40HX8K",
        ),
        Point(
            "compact-ecp5-8",
            "24-bit, compact",
            variant(24, "compact_ecp5", **small, target="ecp5"),
            "LFE5U-25F",
            8,
        ),
        Point(
            "fast-24-xc7",
            "24-bit, pipelined",
            variant(24, "fast_24_xilinx", core="pipelined", target="xilinx"),
            "xc7",
        ),
        Point(
            "compact-xc7",
            "24-bit, compact",
            variant(24, "compact_xilinx", **small, target="xilinx"),
            "xc7",
        ),
    ]


BUDGETS = (None, 28, 16, 12, 8, 6, 4)
"""Multipliers of the pipelined core in the picture of the design space."""


@dataclass(frozen=True)
class Corner:
    """A core in the design space, synthesised and packed but not placed.

    Attributes:
        name: for the picture.
        multipliers: multiplier blocks it takes.
        luts: look-up tables it takes.
        clocks: between samples in the long run.
    """

    name: str
    multipliers: int
    luts: int
    clocks: float


def design_space(advance: terminal.Advance = terminal.silent) -> list[Corner]:
    """The 24-bit core with ever fewer multipliers, in an ECP5."""
    designs = [
        (
            "as many as it takes" if budget is None else f"at most {budget}",
            {"core": "pipelined"} | ({} if budget is None else {"multipliers": budget}),
        )
        for budget in BUDGETS
    ]
    designs += [
        ("compact", {"core": "compact"}),
        ("compact, none", {"core": "compact", "multipliers": 0}),
    ]
    corners: list[Corner] = []
    for name, hardware in designs:
        device, speed = find_device("LFE5U-85F")
        try:
            design = variant(24, "corner", target="ecp5", **hardware)
            found = place(design, device, speed, seeds=())
        except InputError:
            if hardware["core"] == "compact" or "multipliers" not in hardware:
                raise
            continue  # too few for the pipelined core
        finally:
            advance(1)
        corner = Corner(name, found.area.multipliers, found.area.luts, found.clocks_per_sample)
        if all((corner.multipliers, corner.clocks) != (c.multipliers, c.clocks) for c in corners):
            corners.append(corner)
    return corners


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
    ("attitude alone (source not at hand)", "230 clocks at 50 MHz", "4.6 µs an update"),
    ("full navigation (source not at hand)", "980 clocks at 50 MHz", "19.6 µs an update"),
    (
        "fixed-point Madgwick filter (source not at hand)",
        "75 DSPs, Artix-7 -1",
        "fails 100 MHz",
    ),
    (
        "GPS/INS in software on a MicroBlaze"
        " ([Bhogadi 2015](../reference/bibliography.md#other-hardware))",
        "Virtex-6",
        "100 updates/s",
    ),
)
"""What is published of others: what it does, in what, how fast."""


def document(placed: Sequence[tuple[Point, Placement]], corners: Sequence[Corner]) -> str:
    """The text of docs/explanation/hardware.md.

    Args:
        placed: all points with what was found.
        corners: the design space.
    """
    lines: list[str] = []
    for section in (
        _introduction(placed),
        _goals(placed),
        _table(placed),
        _paths(placed),
        _space(corners),
        _beside(placed),
    ):
        lines += [*section, ""]
    return "\n".join(lines).rstrip() + "\n"


def _introduction(placed: Sequence[tuple[Point, Placement]]) -> Iterator[str]:
    tools: dict[str, str] = {}
    for _, placement in placed:
        tools |= placement.tools
    yield "# The cores in real devices"
    yield ""
    yield (
        "Written by `make hardware`; `sculler place DESIGN --device DEVICE` does it for any design."
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


def _goals(placed: Sequence[tuple[Point, Placement]]) -> Iterator[str]:
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
        samples = terminal.three_digits(placement.samples_per_second or 0)
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


def _table(placed: Sequence[tuple[Point, Placement]]) -> Iterator[str]:
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
    yield "![Speed against area](../images/hardware-speed-area.png)"


def _paths(placed: Sequence[tuple[Point, Placement]]) -> Iterator[str]:
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
    yield "![The design space](../images/hardware-design-space.png)"


def _beside(placed: Sequence[tuple[Point, Placement]]) -> Iterator[str]:
    yield "## Beside published figures"
    yield documents.paragraph(
        "They are of other algorithms in other devices: those of attitude and navigation hold the"
        " whole update, ours the exact high-rate part of both, coning and sculling, with the"
        " low-rate part left to the host. So only the orders of magnitude say something. Where the"
        " source is not at hand the figure could not be checked: do not cite it."
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
                f" {_counted(placement.area.multipliers, 'multipliers')}",
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
    return f"{terminal.three_digits(microseconds)} µs"


def draw(
    folder: Path, placed: Sequence[tuple[Point, Placement]], corners: Sequence[Corner]
) -> list[Path]:
    """The document's pictures, into a folder that is there."""
    from studies.plots_hardware import design_space_picture, speed_area_picture

    paths = [folder / "hardware-speed-area.png", folder / "hardware-design-space.png"]
    speed_area_picture(
        paths[0],
        [
            (f"{point.what}, {placement.device}", placement.area.luts, placement.samples_per_second)
            for point, placement in placed
            if placement.samples_per_second is not None
        ],
    )
    design_space_picture(paths[1], [(c.name, c.multipliers, c.luts, c.clocks) for c in corners])
    return paths


def measure(chosen: Sequence[Point], advance: terminal.Advance) -> list[tuple[Point, Placement]]:
    """Place the points, one after the other, each with its seeds side by side."""
    placed = []
    for point in chosen:
        device, speed = find_device(point.device, point.speed)
        placed.append((point, place(point.design, device, speed, SEEDS, done=advance)))
    return placed


@click.command(
    epilog=terminal.examples(
        "python -m studies.hardware -o docs",
        "python -m studies.hardware --only fast-24 --only compact-ecp5",
    )
)
@documents.folder_option("hardware.md")
@click.option(
    "--only",
    "keys",
    multiple=True,
    metavar="KEY",
    help="A part of the table, shown and not written; several times for several: "
    + ", ".join(point.key for point in points())
    + ".",
)
def command(folder: Path, keys: tuple[str, ...]) -> None:
    """Place and route the cores in the devices; write the page and its pictures."""
    chosen = [point for point in points() if not keys or point.key in keys]
    known = [point.key for point in points()]
    for key in keys:
        if key not in known:
            raise InputError(f"--only {key}: not in the table, give one of {', '.join(known)}")
    if keys:
        with terminal.progress("placing", len(chosen) * (1 + len(SEEDS))) as advance:
            placed = measure(chosen, advance)
        text = "\n".join([*_goals(placed), "", *_table(placed), "", *_paths(placed)])
        terminal.report({}, False, text)
        return

    def compute(images: Path) -> tuple[str, list[Path]]:
        total = len(chosen) * (1 + len(SEEDS)) + len(BUDGETS) + 2
        with terminal.progress("placing", total) as advance:
            placed = measure(chosen, advance)
            corners = design_space(advance)
        return document(placed, corners), draw(images, placed, corners)

    documents.write_document(folder / "hardware.md", compute)


if __name__ == "__main__":
    sys.exit(run_command(command, sys.argv[1:], "python -m studies.hardware"))
