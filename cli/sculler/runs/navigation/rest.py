"""Biases of the gyros, from a window of a run in which the unit rests."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

from sculler.runs.navigation.against_truth import AgainstTruth
from sculler.runs.navigation.plan import Plan
from sculler.runs.navigation.run import NavigationRun
from sculler_model.fast import VectorBlock
from sculler_model.navigation import NavHistory, RestBias, RestWindow

PASSES = 5
"""Over the vectors, at most: the attitude in the window turns the Earth's rate, and each pass knows
the bias better; it ends where that moves by less than a tenth of its sigma."""


def with_rest_bias(
    plan: Plan,
    blocks: Callable[[], Iterable[VectorBlock]],
    reference: Callable[[], AgainstTruth | None] = lambda: None,
) -> Plan:
    """The plan with the bias that its rest window shows, to be taken out; the same without one.

    Args:
        plan: the run's.
        blocks: the vectors, from the beginning each time.
        reference: the truth, which tells where the run begins, likewise.

    Raises:
        InputError: as `NavigationRun.take`, or there is too little of the window in the run.
    """
    if plan.rest is None:
        return plan
    begin, end = plan.rest
    stop = end if plan.stop is None else min(plan.stop, end)
    found: RestBias | None = None
    for _ in range(PASSES):
        before = (0.0, 0.0, 0.0) if found is None else found.bias
        window = RestWindow(begin, end, plan.design.major_interval, before)
        first = replace(plan, rest=None, bias=found, stop=stop)
        NavigationRun(first, _nowhere, reference(), watch=window.see).take(blocks())
        found = window.found()
        moved = (
            abs(a - b) < 0.1 * s for a, b, s in zip(found.bias, before, found.sigma, strict=True)
        )
        if not found.earth or all(moved):
            break
    return replace(plan, bias=found)


def _nowhere(part: NavHistory) -> None:
    """States that nobody wants."""
