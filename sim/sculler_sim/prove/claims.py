"""What is claimed of a core, and what comes of each claim."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from sculler_hdl import PROPERTIES, module_ports
from sculler_model.design import Design
from sculler_sim.prove.arithmetic import LABEL as ARITHMETIC
from sculler_sim.prove.arithmetic import narrowed, settle_arithmetic
from sculler_sim.prove.counter import LABEL as EVERY_NUMBER
from sculler_sim.prove.counter import write_counter_problem
from sculler_sim.prove.engine import Outcome, Verdict, prove
from sculler_sim.prove.problem import write_problems
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

FEW_RESULTS = (ARITHMETIC, WORD_LENGTHS)
"""Claims on the first results alone: left open, nothing is known."""

FEW_BITS = 3
"""Of a count where the arithmetic is compared."""

HANDSHAKE = ("sample_ready", "result_valid", "result_last", "samples_lost", "results_dropped")
"""Outputs that `reset` is about, of those that a core has."""


def settle(
    design: Design, folder: Path, seconds: int, done: Callable[[], None] = lambda: None
) -> dict[str, Outcome]:
    """Every claim on a design's core, two at a time.

    Args:
        design: the design.
        folder: to work in, a folder that is there.
        seconds: for each property.
        done: called after each claim.

    Raises:
        InputError: Yosys is not installed.
        ToolError: Yosys failed.
    """
    found: dict[str, Outcome] = {}
    for label, outcome in structural(design, folder):
        found[label] = outcome
        done()
    if not design.high_resolution:
        few = narrowed(design, FEW_BITS)
        found[ARITHMETIC] = settle_arithmetic(few, folder)
        done()
        if design.hardware.core == "pipelined":
            found[WORD_LENGTHS] = settle_word_lengths(few, folder)
            done()
    labels = write_problems(design, folder)
    if write_counter_problem(design, folder):
        labels.append(EVERY_NUMBER)
    with ThreadPoolExecutor(2) as pool:
        outcomes = pool.map(lambda label: prove(folder, label, seconds), labels)
        for label, outcome in zip(labels, outcomes, strict=True):
            found[label] = outcome
            done()
    return found


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
