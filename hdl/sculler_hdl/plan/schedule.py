"""The parts of a pipelined core that calculate, and the clocks at which they stand.

The clock in which a sample is taken is clock 0 for all that follows from it.  A `Configuration`
says how a core is built; its `Schedule` lines up the plans of the parts, each behind what it takes
its inputs from, by adding clocks.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

from sculler_hdl.plan.accumulator import AccumulatorPlan
from sculler_hdl.plan.arrival import Arrival, Limbs, at_once, evenly, last_clock, later
from sculler_hdl.plan.cross_array import CrossArrayPlan, Folding, Operand
from sculler_hdl.plan.position import PositionPlan
from sculler_hdl.plan.running_sum import RunningSumPlan
from sculler_hdl.plan.transfer import RAIL_DELAY, HandOverPlan
from sculler_hdl.plan.vector.engine import RESULTS, VectorEnginePlan
from sculler_hdl.plan.weighted_sum import Rows, WeightedSumPlan
from sculler_hdl.targets import TARGETS
from sculler_model.algorithms import TapTable
from sculler_model.design import Design, Interval
from sculler_model.golden import Dropping, Timing, words_per_column

TAP_CLOCK = 1
"""At which A and B take a sample."""
MINOR_CLOCK = 2
"""At which theta and v do, from registers of their own."""
POSITION_CLOCK = 2
"""At which high-resolution position does."""
MAJOR_CLOCK = 3
"""At which the hand-over is told that a result comes."""
STATUS_CLOCK = MAJOR_CLOCK + 1
"""At which its status is there."""
RAIL_CLOCK = STATUS_CLOCK + RAIL_DELAY
"""At which its status bit 2 is."""


class AdderTiming(NamedTuple):
    """How much time additions are given.

    Attributes:
        tap_bits: longest limb of A and B.
        minor_bits: longest limb of theta and v, alpha and nu.
        sum_bits: longest limb of the sums of products.
        carry_clocks: that a carry has from one limb of a sum to the next.
    """

    tap_bits: int
    minor_bits: int
    sum_bits: int
    carry_clocks: int

    def cut(self, most: int, *ranges: Interval) -> Limbs:
        """How additions in these ranges are cut into limbs of at most so many bits."""
        return evenly(max(item.bits for item in ranges), most, self.carry_clocks)


class Configuration(NamedTuple):
    """How a core is built: one of the ways that `plan_pipelined` compares.

    Attributes:
        within, between, position: how the arrays are folded; None where there is no between array
            (M = 1), no high-resolution position.
        residue: most low bits of an operand that are multiplied without a block.
        adders: how much time additions are given.
        turns: clocks of a slot of the vector engine; None with second order.
        spread: whether the operands of a long array that is not folded stand in registers of each
            axis: a clock more, and wires half as long.
        apart: whether sums that may take a step at every clock are added up once more to be shown:
            a clock more, and what goes round is short (`AccumulatorPlan`).
    """

    within: Folding
    between: Folding | None
    position: Folding | None
    residue: int
    adders: AdderTiming
    turns: int | None = None
    spread: bool = False
    apart: bool = False


# the configurations that are compared have many of these in common
_cross_array = lru_cache(maxsize=256)(CrossArrayPlan)
_position = lru_cache(maxsize=64)(PositionPlan)
vector_engine = lru_cache(maxsize=32)(VectorEnginePlan)
"""The plan of the vector engine of a design."""


def tap_rows(table: TapTable) -> Rows:
    """The table's non-zero rows, and the last one in any case, for the sums A and B."""
    phases = sorted({*table.active_phases, table.samples})
    return {k - 1: [(d, c) for d, c in enumerate(table.taps[k - 1], start=1) if c] for k in phases}


def weight_rows(table: TapTable) -> Rows:
    """The weights as the row of phase n, for the sums theta and v."""
    return {table.samples - 1: [(d, w) for d, w in enumerate(table.weights) if w]}


def launch_gap(table: TapTable) -> int:
    """Fewest samples from one launch of the within array to the next."""
    phases = sorted(tap_rows(table))
    return min(b - a for a, b in pairwise([*phases, phases[0] + table.samples]))


@lru_cache(maxsize=32)
def _taps(design: Design, adders: AdderTiming) -> dict[str, WeightedSumPlan]:
    """A and B, by sensor."""
    words, rows, n = design.words, tap_rows(design.table), design.algorithm.samples
    return {
        sensor: WeightedSumPlan(counts, rows, result, n, adders.cut(adders.tap_bits, result))
        for sensor, counts, result in (
            ("gyro", words.gyro, words.gyro_taps),
            ("accel", words.accel, words.accel_taps),
        )
    }


@lru_cache(maxsize=32)
def _minors(design: Design, adders: AdderTiming) -> dict[str, WeightedSumPlan | RunningSumPlan]:
    """theta and v, cut as alpha and nu are, so that these can be worked on at once."""
    words, rows, n = design.words, weight_rows(design.table), design.algorithm.samples
    return {
        name: (
            RunningSumPlan(counts, result, adders.cut(adders.minor_bits, total))
            if rows[n - 1] == [(d, 1) for d in range(n)]
            else WeightedSumPlan(counts, rows, result, n, adders.cut(adders.minor_bits, total))
        )
        for name, counts, result, total in (
            ("theta", words.gyro, words.theta, words.alpha),
            ("v", words.accel, words.v, words.nu),
        )
    }


class Schedule:
    """The plans of the parts that calculate, and the clocks at which they stand.

    Args:
        design: the design.
        configuration: how to build it.

    Attributes:
        taps: A and B, by sensor; they take samples at `tap_clock`.
        minors: theta and v; they take samples at `minor_clock`.
        integrals: alpha and nu.
        arrays: within, and between if there is one.
        launches: the clock at which each array takes its operands.
        sample_clock: at which the within array sees the sample itself.
        position: high-resolution position, if there is any; from `POSITION_CLOCK` on.
        engine: of third and fourth order, if there is any; it starts at `engine_clock`.
        tap_clock, minor_clock: at which A and B, theta and v take a sample.
        block_count: multiplier blocks.
        longest: bits of the longest limb of A and B, of theta to nu, of the products' sums.
        arrivals: for each vector of the result, when the bits of its components are there.
    """

    tap_clock = TAP_CLOCK
    minor_clock = MINOR_CLOCK
    taps: dict[str, WeightedSumPlan]
    minors: dict[str, WeightedSumPlan | RunningSumPlan]

    def __init__(self, design: Design, configuration: Configuration) -> None:
        self.design = design
        self.configuration = configuration
        self._plan_sums()
        self.integrals = self._integrals()
        self.arrays: dict[str, CrossArrayPlan] = {}
        self.launches: dict[str, int] = {}
        tap_arrivals = [later(part.arrival, self.tap_clock) for part in self.taps.values()]
        self.sample_clock = min(last_clock(arrival[:1]) for arrival in tap_arrivals)
        self._plan_within(tap_arrivals)
        if configuration.between is not None:
            self._plan_between(configuration.between)
        self.position = self._position()
        self.engine: VectorEnginePlan | None = None
        self.engine_clock = 0
        if configuration.turns is not None:
            target = TARGETS[design.hardware.target]
            self.engine = vector_engine(design, target, configuration.turns)
            come = [one for three in self.loads(self.engine).values() for one in three]
            self.engine_clock = max(MINOR_CLOCK + 3, *map(last_clock, come))
        self.arrivals = self._arrivals()

        arrays = [*self.arrays.values(), *([self.position.array] if self.position else [])]
        self.block_count = sum(array.block_count for array in arrays)
        if self.engine is not None:
            self.block_count += self.engine.block_count
        minors = (*self.minors.values(), *self.integrals.values())
        self.longest = tuple(
            max(part.limb.bits for part in parts) for parts in (self.taps.values(), minors, arrays)
        )

    def _plan_sums(self) -> None:
        """A and B, theta and v."""
        self.taps = _taps(self.design, self.configuration.adders)
        self.minors = _minors(self.design, self.configuration.adders)

    def _integrals(self) -> dict[str, AccumulatorPlan]:
        """Alpha and nu; `before` the last minor interval's is all the between products see."""
        design, adders = self.design, self.configuration.adders
        words, minors = design.words, design.algorithm.minors
        return {
            name: AccumulatorPlan(
                item,
                later(self.minors[minor].arrival, self.minor_clock),
                total,
                adders.cut(adders.minor_bits, total),
                item.repeated(minors - 1),
                gap=self._minor_gap,
                cleared=True,
                apart=self.configuration.apart,
            )
            for name, minor, item, total in (
                ("alpha", "theta", words.theta, words.alpha),
                ("nu", "v", words.v, words.nu),
            )
        }

    @property
    def _minor_gap(self) -> int:
        """Samples from one that ends a minor interval to the next, at least."""
        return self.design.algorithm.samples

    def _plan_within(self, taps: Sequence[Arrival]) -> None:
        """A x s and A x r + B x s."""
        words, clock = self.design.words, self.sample_clock
        A, B = zip((words.gyro_taps, words.accel_taps), taps, strict=True)
        s, r = ((counts, at_once(counts.bits, clock)) for counts in (words.gyro, words.accel))
        totals = words.coning_within, words.sculling_within
        self._plan_array("within", (A, B), (s, r), totals, self.configuration.within)

    def _plan_between(self, folding: Folding) -> None:
        """Alpha x theta and alpha x v + nu x theta."""
        words = self.design.words
        alpha, nu = ((part.before, part.before_arrival) for part in self.integrals.values())
        theta, v = (
            (part.result, later(part.arrival, self.minor_clock)) for part in self.minors.values()
        )
        totals = words.coning_between, words.sculling_between
        self._plan_array("between", (alpha, nu), (theta, v), totals, folding)

    def _plan_array(
        self,
        place: str,
        lefts: Sequence[tuple[Interval, Arrival]],
        rights: Sequence[tuple[Interval, Arrival]],
        totals: tuple[Interval, Interval],
        folding: Folding,
    ) -> None:
        """An array, launched when the first limbs of its operands are there."""
        launch = min(last_clock(arrival[:1]) for _, arrival in (*lefts, *rights))

        def operands(items: Sequence[tuple[Interval, Arrival]]) -> tuple[Operand, ...]:
            return tuple(Operand(range_, later(arrival, -launch)) for range_, arrival in items)

        adders = self.configuration.adders
        self.launches[place] = launch
        self.arrays[place] = _cross_array(
            operands(lefts),
            operands(rights),
            totals,
            folding,
            TARGETS[self.design.hardware.target],
            adders.cut(adders.sum_bits, *totals),
            self.configuration.residue,
            spread=self.configuration.spread,
            apart=self.configuration.apart,
        )

    def _position(self) -> PositionPlan | None:
        words, configuration = self.design.words, self.configuration
        if configuration.position is None or words.scrolling is None:
            return None
        return _position(
            words,
            self.design.samples_per_major,
            configuration.position,
            TARGETS[self.design.hardware.target],
            configuration.adders.cut(configuration.adders.sum_bits, words.scrolling),
            configuration.residue,
            spread=configuration.spread,
            apart=configuration.apart,
        )

    def _arrivals(self) -> dict[str, list[Arrival]]:
        arrivals = self._sums()
        if self.position is not None:
            for name, three in self.position.arrivals.items():
                arrivals[name] = [later(arrival, POSITION_CLOCK) for arrival in three]
        if self.engine is not None:
            for target in self.engine.sums:
                arrivals[RESULTS[target]] = [
                    at_once(
                        self.engine.page.ranges[target].bits,
                        self.engine_clock + self.engine.whole_clock(target, axis),
                    )
                    for axis in range(3)
                ]
        return arrivals

    def _sums(self) -> dict[str, list[Arrival]]:
        """When the sums of second order are there."""
        arrivals: dict[str, list[Arrival]] = {
            name: [part.arrival] * 3 for name, part in self.integrals.items()
        }
        for place, array in self.arrays.items():
            for name, components in array.results.items():
                arrivals[f"{name}_{place}"] = [
                    later(arrival, self.launches[place]) for _, arrival in components
                ]
        return arrivals

    def loads(self, engine: VectorEnginePlan) -> dict[str, list[Arrival]]:
        """When the words that the engine is given are there, by its names."""
        sums, found = self._sums(), {}
        for half, minor, integral, kind in (
            ("angle", "theta", "alpha", "coning"),
            ("velocity", "v", "nu", "sculling"),
        ):
            found[f"theta.{half}"] = [later(self.minors[minor].arrival, MINOR_CLOCK)] * 3
            found[f"alpha.{half}"] = [self.integrals[integral].before_arrival] * 3
            for place in self.arrays:
                found[f"{place}.{half}"] = sums[f"{kind}_{place}"]
        return {name: found[name] for name in (*engine.page.left_loads, *engine.page.right_loads)}

    @property
    def block_groups(self) -> list[list[str]]:
        """The arrays' multiplier blocks, by names of submodules of the core; longest group first.

        The groups are those of `CrossArrayPlan.block_groups`.
        """
        arrays = {f"cross_{place}": array for place, array in self.arrays.items()}
        if self.position is not None:
            arrays["position.scrolling"] = self.position.array
        groups = [
            [f"{place}.{name}" for name in group]
            for place, array in arrays.items()
            for group in array.block_groups
        ]
        if self.engine is not None:
            groups += [[f"engine.{name}" for name in group] for group in self.engine.block_groups]
        return sorted(groups, key=len, reverse=True)

    def handover(self, results: int = 1) -> HandOverPlan:
        """The part that hands results over, with room for so many."""
        stream = self.design.hardware.handover == "stream"
        return HandOverPlan(
            self.design.words,
            self.arrivals,
            MAJOR_CLOCK,
            results,
            drop=self.design.drops_results,
            column_words=words_per_column(self.design) if stream else None,
            late=self.engine_clock + self.engine.result_clock if self.engine else None,
        )

    def timing(self, spacing: int) -> Timing:
        """The clocks that it takes, if samples come in `spacing` clocks at the fastest."""
        hardware, span = self.design.hardware, self.design.samples_per_major
        stream = hardware.handover == "stream"
        handover = self.handover()
        if handover.moves is not None:  # the design drops results
            moves = handover.moves
            return Timing(
                handover.latency,
                max(spacing, -(-max(moves.least_gap, 2) // span)),
                handover_spacing=1 if stream else moves.refill,
                # the host's taking is seen a clock later, and acted on a clock after that
                dropping=Dropping(moves.claim - 1, moves.refill),
            )
        gap = span * spacing
        may = TARGETS[hardware.target].two_results and not stream
        if may and gap <= handover.latency:  # room for a second result wins clocks
            apart = self.handover(results=2).moves
            if apart is not None and apart.possible and apart.least_gap <= gap:
                return Timing(apart.latency, spacing, handover_spacing=apart.refill, results=2)
        return Timing(handover.latency, spacing)
