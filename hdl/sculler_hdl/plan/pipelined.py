"""What the pipelined core of a design is built of.

Both arrays are folded: the within array takes its operands at phases with a tap row, the between
array at the ends of minor intervals, and until the next launch they have time for several steps
(`Folding`).  `plan_pipelined` chooses the steps, and the clocks per sample if multipliers are
scarce.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

from sculler_hdl.plan.cross_array import FOLDINGS
from sculler_hdl.plan.multiplier import RESIDUE_BITS
from sculler_hdl.plan.schedule import (
    AdderTiming,
    Configuration,
    Schedule,
    launch_gap,
    vector_engine,
)
from sculler_hdl.plan.vector.engine import TURNS
from sculler_hdl.targets import TARGETS
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.golden import Timing, clocks_per_major

LATENCY_GOAL = 24
"""Clocks from an interval's last sample to its result that folding is not to pass."""
POSITION_LATENCY_GOAL = 32
"""The same with high-resolution position, whose operands stand behind more additions."""


@dataclass(frozen=True)
class PipelinedPlan:
    """What the pipelined core of a design is built of.

    Attributes:
        schedule: its parts and the clocks at which they stand.
        timing: the clocks that it takes.
    """

    schedule: Schedule
    timing: Timing

    @property
    def configuration(self) -> Configuration:
        """How it is built."""
        return self.schedule.configuration

    @property
    def block_count(self) -> int:
        """Multiplier blocks."""
        return self.schedule.block_count

    @property
    def units(self) -> int:
        """Product units, of one or several blocks each."""
        made = self.configuration
        arrays = (made.within, made.between, made.position)
        lanes = self.schedule.engine.lanes if self.schedule.engine else 0
        return lanes + sum(folding.units for folding in arrays if folding is not None)

    @property
    def resources(self) -> dict[str, int]:
        """Figures for the manifest."""
        return {"multipliers": self.block_count, "product_units": self.units}


@lru_cache(maxsize=64)
def plan_pipelined(design: Design) -> PipelinedPlan:
    """Choose the folding, and the fewest clocks per sample that the multipliers allow.

    Of the foldings that keep the samples' pace, those within the latency goal are preferred, of
    them the ones that do little without multiplier blocks, of them the ones with fewest blocks.
    Then the operands of long arrays get registers of their own, sums of every clock an adder to be
    shown by, and additions as much time, as the latency goal and the pace of results allow.

    Raises:
        InputError: `hardware.multipliers` are too few for any folding; or an order above 2 is to be
            hardened, or has no terms.
    """
    if design.order > 2 and design.samples_per_major == 1:
        raise InputError(
            f"algorithm.order: {design.order} has no terms with samples = 1 and minors = 1, leave"
            ' it out, or give core = "compact"'
        )
    if design.order > 2 and design.hardware.hardening is not None:
        raise InputError(
            f'hardware.hardening: "{design.hardware.hardening}" is not built for core = "pipelined"'
            f' with algorithm.order = {design.order}: leave one out, or give core = "compact"'
        )
    budget, goal = design.hardware.multipliers, _latency_goal(design)
    target = TARGETS[design.hardware.target]
    lengths = target.limb_bits
    made: dict[Configuration, Schedule] = {}
    for spacing in _spacings(design):
        for configuration in _configurations(design, spacing):
            if configuration not in made:
                made[configuration] = Schedule(design, configuration)
        found = [one for one in made.values() if budget is None or one.block_count <= budget]
        if found:
            best = min(
                found,
                key=lambda one: (
                    max(one.timing(spacing).latency, goal),
                    one.configuration.residue,
                    one.block_count,
                    clocks_per_major(design, one.timing(spacing)),
                    one.timing(spacing).latency,
                ),
            )
            best = _rather(design, spacing, best, best.configuration._replace(spread=True))
            best = _rather(design, spacing, best, best.configuration._replace(apart=True))
            for carry_clocks in (2, 1):
                cuts = product(lengths, lengths)
                relaxed = [AdderTiming(lengths[0], *bits, carry_clocks) for bits in cuts]
                hurried, best = best, _slowest(design, spacing, best, relaxed)
                if best is not hurried:
                    break
            # A and B afterwards: their products mostly are there before the others
            adders = best.configuration.adders
            taps = [adders._replace(tap_bits=bits) for bits in lengths]
            best = _slowest(design, spacing, best, taps)
            if target.long_limb and max(best.longest) > target.long_limb:
                thirds = product(lengths, lengths, lengths)
                even = [AdderTiming(*bits, 1) for bits in thirds]
                best = _slowest(design, spacing, best, even, evenly=True)
            return PipelinedPlan(best, best.timing(spacing))
    least = min(one.block_count for one in made.values())
    raise InputError(
        f"hardware.multipliers: {budget} are not enough, the pipelined core of this design needs at"
        f' least {least}; give more, or core = "compact"'
    )


def _engines(design: Design) -> dict[int, int]:
    """The fewest clocks per sample that each kind of vector engine takes, by its turns."""
    if design.order == 2:
        return {}
    target, samples = TARGETS[design.hardware.target], design.algorithm.samples
    return {turns: -(-vector_engine(design, target, turns).period // samples) for turns in TURNS}


def _spacings(design: Design) -> Sequence[int]:
    """The clocks per sample to be looked at, fewest first."""
    last = FOLDINGS[-1].steps
    engines = _engines(design).values()
    if not engines:
        return range(1, last + 1)
    return sorted({*engines, max(*engines, last)})


def _configurations(design: Design, spacing: int) -> Iterator[Configuration]:
    """Those that keep the pace of samples so many clocks apart, with additions in one clock."""
    longest = TARGETS[design.hardware.target].limb_bits[0]
    hurried = AdderTiming(longest, longest, longest, 1)
    within_gap, between_gap = (
        samples * spacing for samples in (launch_gap(design.table), design.table.samples)
    )
    withins = [folding for folding in FOLDINGS if folding.steps <= within_gap]
    betweens = [folding for folding in FOLDINGS if folding.steps <= between_gap]
    # launched at every sample, so it has the sample's clocks and no reason to take fewer
    position = [folding for folding in FOLDINGS if folding.steps <= spacing][-1:]
    engines: list[int | None] = [
        turns for turns, least in _engines(design).items() if least <= spacing
    ]
    choices = product(
        withins,
        betweens if design.algorithm.minors > 1 else [None],
        position if design.high_resolution else [None],
        RESIDUE_BITS,
        [hurried],
        engines or [None],
    )
    return (Configuration(*choice) for choice in choices)


def _rather(design: Design, spacing: int, schedule: Schedule, wanted: Configuration) -> Schedule:
    """What is wanted, unless results lose time by it."""
    other = Schedule(design, wanted)
    before, after = schedule.timing(spacing), other.timing(spacing)
    late = after.latency > max(_latency_goal(design), before.latency)
    slow = clocks_per_major(design, after) > clocks_per_major(design, before)
    return schedule if late or slow else other


def _slowest(
    design: Design,
    spacing: int,
    schedule: Schedule,
    timings: Sequence[AdderTiming],
    *,
    evenly: bool = False,
) -> Schedule:
    """The same folding with the adders that are given most time and that results lose none by.

    First of all carries are, then all additions together; or if `evenly` the longest of them.
    """
    goal = max(_latency_goal(design), schedule.timing(spacing).latency)
    others = (
        Schedule(design, schedule.configuration._replace(adders=adders)) for adders in timings
    )
    return min(
        (schedule, *others),
        key=lambda one: (
            max(one.timing(spacing).latency, goal),
            clocks_per_major(design, one.timing(spacing)),
            max(one.longest) if evenly else -one.configuration.adders.carry_clocks,
            sum(one.longest),
            one.timing(spacing).latency,
        ),
    )


def _latency_goal(design: Design) -> int:
    if design.order > 2:  # the vector engine takes most of it
        slowest = vector_engine(design, TARGETS[design.hardware.target], max(TURNS))
        return LATENCY_GOAL + slowest.period
    return POSITION_LATENCY_GOAL if design.high_resolution else LATENCY_GOAL
