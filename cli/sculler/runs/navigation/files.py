"""Vectors from a file, states to a file, pictures beside it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from math import degrees
from pathlib import Path

from sculler.formats.history import HistoryWriter, Thinned
from sculler.formats.vectors import read_vectors
from sculler.plots import pictures as plots
from sculler.plots.truth import truth_picture_paths, truth_pictures
from sculler.runs.navigation.against_truth import AgainstTruth
from sculler.runs.navigation.outcome import Outcome
from sculler.runs.navigation.plan import Plan
from sculler.runs.navigation.rest import with_rest_bias
from sculler.runs.navigation.run import NavigationRun
from sculler.runs.navigation.seen import Seen
from sculler.words import Advance, silent
from sculler_model import inputs
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock
from sculler_model.navigation import NavHistory
from sculler_model.outputs import replacing


def navigate_file(
    plan: Plan,
    output: Path,
    *,
    truth: Path | None = None,
    telemetry: Path | None = None,
    pictures: bool = True,
    advance: Advance = silent,
) -> Outcome:
    """Navigate with the plan's vectors and write the states.

    Args:
        plan: what to run, and how; its `name` is the vectors file, `-` for stdin.
        output: CSV of the states, at the start and at the end of every major interval; it appears
            whole or not at all.
        truth: a file to hold the run against; what the plan leaves out of the initial state comes
            from it.
        telemetry: write the states as binary frames, too.
        pictures: draw them beside the output, where matplotlib is there; else the outcome says so.
        advance: told the number of results that went by.

    Raises:
        InputError: a file has a fault, or the run cannot be made (see `NavigationRun.take`).
    """
    no_pictures = _claim_pictures(output, truth is not None) if pictures else None

    def compared() -> AgainstTruth | None:
        if truth is None:
            return None
        interval = plan.design.major_interval
        return AgainstTruth(truth, interval, attitude_only=plan.attitude_only)

    if plan.rest is not None:
        if plan.name == "-" or (truth is not None and str(truth) == "-"):
            raise InputError("--rest reads vectors and truth more than once, give files")
        plan = with_rest_bias(plan, lambda: _vectors(plan), compared)
    reference = compared()
    shown = Thinned()
    with ExitStack() as stack:
        frames = None
        if telemetry is not None:
            frames = stack.enter_context(stack.enter_context(replacing(telemetry)).open("wb")).write
        temporary = stack.enter_context(replacing(output))
        writer = stack.enter_context(
            HistoryWriter(temporary, wander=True, attitude_only=plan.attitude_only)
        )

        def sink(part: NavHistory) -> None:
            writer.write(part)
            shown.add(part)

        run = NavigationRun(plan, sink, reference, frames)
        blocks = _vectors(plan)
        run.take(_advancing(blocks, advance))
    drawn = None
    if pictures and no_pictures is None:
        drawn = _draw(output, shown, run.seen, reference, plan.attitude_only)
    return Outcome.of(plan, output, run.seen, reference, drawn, no_pictures)


def _vectors(plan: Plan) -> Iterator[VectorBlock]:
    """The file, block by block, or one channel of it."""
    return read_vectors(plan.name, plan.design, missing=True, channel=plan.channel)


def _advancing(blocks: Iterable[VectorBlock], advance: Advance) -> Iterator[VectorBlock]:
    """The same blocks; tells how many results went by."""
    for block in blocks:
        yield block
        advance(len(block))


def _claim_pictures(output: Path, with_truth: bool) -> str | None:
    """Set the pictures' files aside; or why there will be none, in a line."""
    reason = plots.left_out()
    if reason is None:
        beside = truth_picture_paths(output) if with_truth else []
        for path in [*plots.navigation_picture_paths(output), *beside]:
            inputs.claim(path)
    return reason


def _draw(
    output: Path,
    shown: Thinned,
    seen: Seen,
    reference: AgainstTruth | None,
    attitude_only: bool,
) -> list[Path]:
    """The pictures' files."""
    found = seen.fine or seen.alignment
    euler = None if found is None else [degrees(sigma) for sigma in found.euler_sigma]
    draw = plots.attitude_pictures if attitude_only else plots.navigation_pictures
    drawn = draw(shown.history(), output, euler)
    if reference is not None and reference.instants > 1:
        sigma = None if found is None else found.sigma
        drawn += truth_pictures(*reference.shown(), reference.growth, output, sigma)
    return drawn
