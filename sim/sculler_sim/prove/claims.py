"""What is claimed of a core, and what comes of each claim."""

from __future__ import annotations

import time
from collections.abc import Collection, Iterator
from pathlib import Path

from sculler_hdl import PROPERTIES, module_ports
from sculler_model.design import Design
from sculler_sim.prove.arithmetic import LABEL as ARITHMETIC
from sculler_sim.prove.arithmetic import narrowed, settle_arithmetic
from sculler_sim.prove.counter import LABEL as EVERY_NUMBER
from sculler_sim.prove.counter import settle_counter
from sculler_sim.prove.engine import Outcome, Verdict, prove
from sculler_sim.prove.problem import labels_of, write_problems
from sculler_sim.prove.structure import Gates
from sculler_sim.prove.word_lengths import LABEL as WORD_LENGTHS
from sculler_sim.prove.word_lengths import settle_word_lengths

CLAIMS: dict[str, str] = {
    "no_path": "no output depends on an input within the clock: `sample_ready` on registers only,"
    " and nothing of the host reaches the sensor's side",
    "reset": "after one clock of reset, from any state, handshakes and counters are for ever as"
    " from power-up",
    **PROPERTIES,
    EVERY_NUMBER: "the same of major, from every value of its counter, carries of all limbs",
    ARITHMETIC: "with counts of 3 bits: the first two results are the page's integers, whatever the"
    " samples are",
    WORD_LENGTHS: "with counts of 3 bits: until then every accumulator of the pipelined core is in"
    " the interval that the design declares",
}
"""What each claim says, by its label."""

MAJOR = "major_as_due"
"""What follows from `EVERY_NUMBER`."""

FEW_RESULTS = (ARITHMETIC, WORD_LENGTHS)
"""Claims on the first results alone: left open, nothing is known."""

FEW_BITS = 3
"""Of a count where the arithmetic is compared."""

HANDSHAKE = ("sample_ready", "result_valid", "result_last", "samples_lost", "results_dropped")
"""Outputs that `reset` is about, of those that a core has."""


def claims_of(design: Design) -> list[str]:
    """The claims that can be made of a design's core, by their labels.

    The compact core has no counter of results of its own, its program counts; nor accumulators.
    High-resolution position is not among the arithmetic.
    """
    pipelined = design.hardware.core == "pipelined"
    labels = ["no_path", "reset", *labels_of(design)]
    labels += [EVERY_NUMBER] * pipelined
    if not design.high_resolution:
        labels += [ARITHMETIC, *[WORD_LENGTHS] * pipelined]
    return labels


def settle(
    design: Design, folder: Path, seconds: int, known: Collection[str] = (), *, cheap: bool = False
) -> Iterator[tuple[str, Outcome]]:
    """Every claim on a design's core that is not known yet, one after another.

    Args:
        design: the design.
        folder: to work in, a folder that is there.
        seconds: for each property.
        known: labels of claims to leave out.
        cheap: without those on the first results (`FEW_RESULTS`), which take minutes each.

    Yields:
        Label and outcome of each.

    Raises:
        InputError: Yosys is not installed.
        ToolError: Yosys failed.
    """
    wanted = [label for label in claims_of(design) if label not in known]
    if not {"no_path", "reset"}.isdisjoint(wanted):
        yield from structural(design, folder)
    labels = [label for label in labels_of(design) if label in wanted]
    if EVERY_NUMBER in wanted and (outcome := settle_counter(design, folder, seconds)):
        yield EVERY_NUMBER, outcome
        if outcome.verdict is Verdict.PROVED and MAJOR in labels:  # power-up is one of its values
            labels.remove(MAJOR)
            yield MAJOR, outcome
    if labels:
        write_problems(design, folder, labels)
    for label in labels:
        outcome = prove(folder, label, seconds)
        if outcome.verdict is Verdict.REFUTED and label in PROPERTIES:
            # by products that may be anything: a compact core counts its results by products
            write_problems(design, folder, [label], cut=False)
            outcome = prove(folder, label, seconds)
        yield label, outcome
    if not cheap and ARITHMETIC in wanted:
        yield ARITHMETIC, settle_arithmetic(narrowed(design, FEW_BITS), folder)
    if not cheap and WORD_LENGTHS in wanted:
        yield WORD_LENGTHS, settle_word_lengths(narrowed(design, FEW_BITS), folder)


def structural(design: Design, folder: Path) -> Iterator[tuple[str, Outcome]]:
    """Those that the gates show without a solver."""
    begun = time.monotonic()
    gates = Gates(design, folder)
    direct = any(gates.within_a_clock(output) for output in gates.outputs)
    yield "no_path", _outcome(not direct, begun)
    outputs = [port.name for port in module_ports(design) if port.name in HANDSHAKE]
    yield "reset", _outcome(gates.forgets_after(outputs) is not None, begun)


def _outcome(shown: bool, begun: float) -> Outcome:
    verdict = Verdict.PROVED if shown else Verdict.OPEN
    return Outcome(verdict, 0, time.monotonic() - begun)
