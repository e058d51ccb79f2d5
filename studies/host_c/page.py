"""The words and tables of host-in-c-targets.md."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from studies import documents
from studies.host_c.measure import DESIGN, MANY, STAGES, Measured
from studies.host_c.precision import Left, section
from studies.host_c.targets import TARGETS, Target

GOAL_INSTRUCTIONS, GOAL_BYTES = 6000, 24 * 1024
"""What a processor with hardware for doubles is meant to need."""


def document(found: Sequence[Measured], precisions: Sequence[Left] = ()) -> str:
    """The text of the page."""
    lines: list[str] = []
    for part in (
        *(_introduction(found), instructions(found), memory(found)),
        *(section(precisions), _left_out(found)),
    ):
        lines += [*part, ""]
    return "\n".join(lines).rstrip() + "\n"


def _introduction(found: Sequence[Measured]) -> Iterator[str]:
    yield "# The host in C on small processors"
    yield ""
    yield "<!-- written by `python -m studies.host_c` -->"
    yield ""
    yield documents.paragraph(
        f"What the [host in C](host-in-c.md) takes of an update: design `{DESIGN.name}`,"
        f" {DESIGN.words.coning_between.bits}-bit components, position at every interval, compiled"
        " with `-O2` where there is hardware for doubles, else with `-Os`. QEMU in user mode runs"
        " a bare program and tells every instruction; the figures are differences of programs that"
        f" differ by {MANY - 2} updates, so what begins and ends is not in them. The first update,"
        " which works its past out too, takes the navigator's part twice."
    )
    yield ""
    for one in found:
        yield f"- {one.target.name}: {one.compiler}, `{' '.join(_flags(one.target))}`"


def _flags(target: Target) -> list[str]:
    shown = [flag for flag in target.flags if flag.startswith(("-mcpu", "-march", "-mfpu"))]
    return [*target.optimised, *shown]


def instructions(found: Sequence[Measured]) -> Iterator[str]:
    """What an update takes."""
    yield "## Instructions an update"
    headings = ("processor", *STAGES[:2], "update", STAGES[2], "µs an update")
    rows = [
        (
            f"{one.target.name}",
            *(f"{count:,.0f}" for count in one.instructions[:2]),
            f"**{one.update:,.0f}**",
            f"{one.instructions[2]:,.0f}",
            f"{one.update / one.target.clock_mhz:,.1f} at {one.target.clock_mhz:g} MHz",
        )
        for one in found
    ]
    yield from documents.table("lrrrrr", headings, rows)
    yield ""
    yield documents.paragraph(
        "*Decoding* is from the stream's words to φ and ΔV_SF; *state and frame* tells attitude,"
        " velocity and position and writes a frame of telemetry, which need not be done every time."
        " The times are those of one instruction a clock, a rough figure: caches, flash and"
        " dual issue move it both ways."
    )
    yield ""
    fast = [one for one in found if one.target.double]
    met = [one for one in fast if one.update <= GOAL_INSTRUCTIONS and one.whole <= GOAL_BYTES]
    yield documents.paragraph(
        f"The goal, {GOAL_INSTRUCTIONS:,} instructions an update and {GOAL_BYTES // 1024} KiB of"
        f" code with hardware for doubles, is met on {len(met)} of {len(fast)} processors; where"
        ' the table says "without", code is counted without the libraries.'
        " Without such hardware every operation on doubles is a call into the compiler's library,"
        " some"
        " ten to thirty times as many instructions, and up to three times the code."
    )


def memory(found: Sequence[Measured]) -> Iterator[str]:
    """Code, data and stack."""
    yield "## Memory, bytes"
    headings = (
        *("processor", "navigator", "telemetry", "alignment"),
        *("flight program with libraries", "`sculler_nav`", "`sculler_align`"),
        *("stack touched", "at most: flight", "alignment"),
    )
    rows = [
        (
            one.target.name,
            *(f"{size:,}" for size in one.code),
            f"**{one.whole:,}**" + " (without)" * one.target.hosted,
            *(f"{size:,}" for size in one.data),
            f"{one.stack:,}",
            *(f"{size:,}" for size in one.bound),
        )
        for one in found
    ]
    yield from documents.table("lrrrrrrrrr", headings, rows)
    yield ""
    yield documents.paragraph(
        "Code is instructions and constants: of the navigator with increments and decoding, of"
        " telemetry and alignment each by itself, and of the whole flight program (navigator and"
        " telemetry) with what it takes of the mathematical library and the compiler's, unused"
        " functions left out; without the libraries where they are an operating system's. Data is"
        " one navigator, and one window of alignment, which is free again after it. The stack"
        " touched is that of an update with state and frame, measured by a pattern, libraries and"
        " all. *At most* is the deepest path of the compiler's call graph (`-fcallgraph-info=su`),"
        " whatever the data: of any function that a flight calls, and of the alignment; without the"
        " frames of the mathematical and the compiler's libraries. Nothing recurses, no frame's"
        " size depends on data, nothing is called by a pointer."
    )


def _left_out(found: Sequence[Measured]) -> Iterator[str]:
    there = {one.target.key for one in found}
    missing = [target for target in TARGETS if target.key not in there]
    if missing:
        yield documents.paragraph(
            "Not measured here, for a tool was missing: "
            + ", ".join(f"{target.name} ({target.missing})" for target in missing)
            + "."
        )
