"""What the pipelined core with many channels is built of.

What outlives a sample stands in block memory, a word for each channel.  Each sum has a memory of
its own, which is read `memory_latency` clocks before the sum is looked at and written in the clock
after.  So all that a sample of a channel changes is there for the next one if that comes `apart`
clocks later.  Clock 0 is that in which a sample's flags are there (`Front`): the clock after its
launch.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

from sculler_hdl.plan.accumulator import AccumulatorPlan
from sculler_hdl.plan.arrival import Arrival, at_once
from sculler_hdl.plan.cross_array import Folding
from sculler_hdl.plan.direct_sum import DirectSumPlan
from sculler_hdl.plan.multiplier import RESIDUE_BITS
from sculler_hdl.plan.schedule import (
    AdderTiming,
    Configuration,
    Schedule,
    tap_rows,
    weight_rows,
)
from sculler_hdl.plan.transfer import HandOverPlan
from sculler_hdl.targets import TARGETS, Target
from sculler_model.design import Design, Interval
from sculler_model.errors import InputError
from sculler_model.golden import WORD_BITS, PipelinedChannelTiming, words_per_column

LIMB_BITS = 18
"""Longest addition in one clock: each limb of a sum has a memory, and blocks are so wide."""

STATUS_CLOCK = 5
"""At which the status of a channel's interval is there: its rails are found a clock before."""

NUMBER_BITS = 64
"""Of a result's number, at most; no core lives long enough to count further."""

FOLDINGS = (Folding(), Folding(axes=3))
"""How products are shared: not at all, or by the three axes, a clock each."""

WAITING = 4
"""Samples that may wait to be launched."""


class ChannelSchedule(Schedule):
    """As the `Schedule` of one sensor, but that the samples before the newest come from memory.

    Attributes:
        number: the count of a channel's results.
    """

    def __init__(self, design: Design, configuration: Configuration) -> None:
        self.target = TARGETS[design.hardware.target]
        self.tap_clock = self.minor_clock = history_clock(self.target)
        super().__init__(design, configuration)
        one, adders = Interval(0, 1), configuration.adders
        numbers = Interval.signed(min(NUMBER_BITS, WORD_BITS * words_per_column(design)))
        limb = adders.cut(adders.minor_bits, numbers)
        self.number = AccumulatorPlan(one, at_once(one.bits, STATUS_CLOCK), numbers, limb)

    def _plan_sums(self) -> None:
        design, adders = self.design, self.configuration.adders
        words, n = design.words, design.algorithm.samples
        rows = tap_rows(design.table)
        self.taps = {
            sensor: DirectSumPlan(counts, rows, result, n, adders.cut(adders.tap_bits, result))
            for sensor, counts, result in (
                ("gyro", words.gyro, words.gyro_taps),
                ("accel", words.accel, words.accel_taps),
            )
        }
        rows = weight_rows(design.table)
        self.minors = {
            name: DirectSumPlan(counts, rows, result, n, adders.cut(adders.minor_bits, total))
            for name, counts, result, total in (
                ("theta", words.gyro, words.theta, words.alpha),
                ("v", words.accel, words.v, words.nu),
            )
        }

    @property
    def _minor_gap(self) -> int:
        return 1  # samples of other channels come in between

    @property
    def oldest(self) -> int:
        """The distance of the oldest sample that is used."""
        sums = (*self.taps.values(), *self.minors.values())
        return max(part.oldest for part in sums if isinstance(part, DirectSumPlan))

    @property
    def number_arrival(self) -> Arrival:
        """When the bits of a result's number are there."""
        return self.number.before_arrival

    def handover(self, results: int = 1) -> HandOverPlan:
        """The part that hands results over, as a stream."""
        return HandOverPlan(
            self.design.words,
            self.arrivals,
            STATUS_CLOCK - 1,
            results,
            column_words=words_per_column(self.design),
            number=self.number_arrival,
        )


@dataclass(frozen=True)
class PipelinedChannelPlan:
    """What the pipelined core with many channels is built of.

    Attributes:
        design: the design.
        schedule: the parts that calculate and the clocks at which they stand.
        timing: the clocks that it takes.
    """

    design: Design
    schedule: ChannelSchedule
    timing: PipelinedChannelTiming

    @property
    def target(self) -> Target:
        """The family of devices."""
        return self.schedule.target

    @property
    def in_blocks(self) -> bool:
        """Whether the target's own memory blocks are instantiated: few words need none."""
        return self.design.channels > 16

    @property
    def resources(self) -> dict[str, int]:
        """Figures for the manifest."""
        made, words = self.schedule.configuration, self.design.words
        arrays = (made.within, made.between)
        totals = [
            total for array in self.schedule.arrays.values() for total in array.totals.values()
        ]
        sums = sum(total.bits for total in totals)
        counts = words.gyro.bits + words.accel.bits
        integrals = words.alpha.bits + words.nu.bits
        return {
            "multipliers": self.schedule.block_count,
            "product_units": sum(folding.units for folding in arrays if folding is not None),
            "bits_per_channel": 3 * (self.schedule.oldest * counts + integrals + sums),
        }


def history_clock(target: Target) -> int:
    """The clock at which a channel's last samples are there: read, and then put to 0 if need be."""
    return target.memory_latency + 1


@lru_cache(maxsize=64)
def plan_pipelined_channels(design: Design) -> PipelinedChannelPlan:
    """Choose the fewest clocks per sample that the multipliers allow, and the fewest of those.

    Raises:
        InputError: `hardware.multipliers` are too few.
    """
    budget, most = design.hardware.multipliers, []
    for folding in FOLDINGS:
        made = [ChannelSchedule(design, one) for one in _configurations(design, folding)]
        found = [one for one in made if budget is None or one.block_count <= budget]
        if found:
            best = min(found, key=lambda one: (one.configuration.residue, one.block_count))
            return PipelinedChannelPlan(design, best, _timing(best, folding.steps))
        most += [one.block_count for one in made]
    raise InputError(
        f"hardware.multipliers: {budget} are not enough, the pipelined core of this design with"
        f' channels needs at least {min(most)}; give more, or core = "compact"'
    )


def _configurations(design: Design, folding: Folding) -> Iterator[Configuration]:
    longest = min(LIMB_BITS, TARGETS[design.hardware.target].limb_bits[0])
    adders = AdderTiming(longest, longest, longest, 1)
    between = folding if design.algorithm.minors > 1 else None
    for residue in RESIDUE_BITS:
        yield Configuration(folding, between, None, residue, adders, spread=True)


def _timing(schedule: ChannelSchedule, spacing: int) -> PipelinedChannelTiming:
    latency = schedule.target.memory_latency
    lookup = 1 + latency
    return PipelinedChannelTiming(
        latency=lookup + 1 + schedule.handover().latency,
        spacing=spacing,
        startup=schedule.design.channels + 1,
        lookup=lookup,
        apart=max(latency + 2, spacing),
        waiting=WAITING,
    )
