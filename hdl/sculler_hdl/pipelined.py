"""The pipelined core: up to one six-axis sample per clock, exact results once a major interval.

                                        alpha, nu
                                  ┌─▶ Accumulator ×6 ─┐
                  ┌▶ theta, v ────┴───────────────────┴─▶ CrossArray "between" ─┐
    sample ─▶ register                                                          ├─▶ HandOver
                  └▶ A, B (WeightedSum) ─ s, r delayed ─▶ CrossArray "within"  ─┘

theta and v are a WeightedSum each, or a RunningSum if all samples weigh the same.

The clock in which a sample is taken is clock 0 for all that follows from it.  Numbers travel as
skewed words (`parts.words`): the low bits of a sum are worked on first, the high bits in the
clocks after.  Each part says at which clock it takes and gives what; the flags of a sample travel
beside it (`FlagLine`) and are looked at at those clocks.

Both arrays are shared: the within array takes its operands at phases with a tap row, the between
array at the ends of minor intervals, and until the next launch they have time for several steps
(`Sharing`).  `plan` chooses the steps, and the clocks per sample if multipliers are scarce.

High-resolution position is a part beside all this (`parts.position`), with an array of its own that
works at every sample.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise, product
from typing import NamedTuple

from amaranth import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring

from sculler_hdl.parts.accumulate import Accumulation, Accumulator
from sculler_hdl.parts.cross import SHARINGS, CrossArray, Crossing, Operand, Sharing
from sculler_hdl.parts.handover import (
    LIMB,
    RAIL_DELAY,
    HandOver,
    Moves,
    StreamHandOver,
    complete_clock,
)
from sculler_hdl.parts.losses import Losses
from sculler_hdl.parts.multiply import FRINGES
from sculler_hdl.parts.position import Position, Positioning
from sculler_hdl.parts.running_sum import Running, RunningSum
from sculler_hdl.parts.sequencer import Sequencer
from sculler_hdl.parts.weighted_sum import Rows, WeightedSum, Weighting
from sculler_hdl.parts.words import (
    Arrival,
    FlagLine,
    Limbs,
    Word,
    at_once,
    evenly,
    last_clock,
    later,
)
from sculler_hdl.ports import port_members
from sculler_hdl.target import TARGETS
from sculler_model.algorithms import TapTable
from sculler_model.design import AXES, HIGH_RESOLUTION_VECTORS, Design, Interval
from sculler_model.errors import InputError
from sculler_model.golden import (
    PORT_MAJOR_BITS,
    Dropping,
    Timing,
    clocks_per_major,
    words_per_column,
)

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
LATENCY_GOAL = 24
"""Clocks from an interval's last sample to its result that sharing is not to pass."""
POSITION_LATENCY_GOAL = 32
"""The same with high-resolution position, whose operands stand behind more additions."""

_INVERTED = {"gyro": False, "accel": True, "between": False, "within": True}
"""How the flags of a sensor's parts, of an array are held, which keeps them apart (`FlagLine`)."""


class Pace(NamedTuple):
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


class Way(NamedTuple):
    """How a core is built: one of the ways that `plan` compares.

    Attributes:
        within, between, position: how the arrays are shared; None where there is no between array
            (M = 1), no high-resolution position.
        fringe: most low bits of an operand that are multiplied without a block.
        pace: how much time additions are given.
    """

    within: Sharing
    between: Sharing | None
    position: Sharing | None
    fringe: int
    pace: Pace


# the ways that `plan` compares have many of these in common
_crossing = lru_cache(maxsize=256)(Crossing)
_positioning = lru_cache(maxsize=64)(Positioning)


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


@dataclass(frozen=True)
class Plan:
    """What the pipelined core of a design is built of.

    Attributes:
        way: how it is built.
        tiles: multiplier blocks.
        units: product units, of one or several blocks each.
        timing: the clocks that it takes.
    """

    way: Way
    tiles: int
    units: int
    timing: Timing


@lru_cache(maxsize=64)
def plan(design: Design) -> Plan:
    """Choose the sharing, and the fewest clocks per sample that the multipliers allow.

    Of the sharings that keep the samples' pace, those within the latency goal are preferred, of
    them the ones that do little without multiplier blocks, of them the ones with fewest blocks.
    Then additions are given as much time as the latency goal and the pace of results allow.

    Raises:
        InputError: `hardware.multipliers` are too few for any sharing.
    """
    table, budget = design.table, design.hardware.multipliers
    goal = _latency_goal(design)
    lengths = TARGETS[design.hardware.target].limb_bits
    hurried = Pace(lengths[0], lengths[0], lengths[0], 1)
    ways: dict[Way, Stages] = {}
    for spacing in range(1, SHARINGS[-1].steps + 1):
        launches = launch_gap(table) * spacing, table.samples * spacing
        betweens = SHARINGS if design.algorithm.minors > 1 else [None]
        # launched at every sample, so it has the sample's clocks and no reason to take fewer
        position = [sharing for sharing in SHARINGS if sharing.steps <= spacing][-1:]
        positions = position if design.high_resolution else [None]
        for way in map(Way._make, product(SHARINGS, betweens, positions, FRINGES, [hurried])):
            within, between = way.within, way.between
            slow = within.steps > launches[0] or (between and between.steps > launches[1])
            if not slow and way not in ways:
                ways[way] = Stages(design, way)
        found = [made for made in ways.values() if budget is None or made.tiles <= budget]
        if found:
            best = min(
                found,
                key=lambda made: (
                    max(made.timing(spacing).latency, goal),
                    made.way.fringe,
                    made.tiles,
                    clocks_per_major(design, made.timing(spacing)),
                    made.timing(spacing).latency,
                ),
            )
            relaxed = [Pace(lengths[0], *bits, 2) for bits in product(lengths, lengths)]
            best = _slowest(design, spacing, best, relaxed)
            # A and B afterwards: their products mostly are there before the others
            taps = [best.way.pace._replace(tap_bits=bits) for bits in lengths]
            return _slowest(design, spacing, best, taps).plan(spacing)
    least = min(way.tiles for way in ways.values())
    raise InputError(
        f"hardware.multipliers: {budget} are not enough, the pipelined core of this design needs at"
        f' least {least}; give more, or core = "compact"'
    )


def _slowest(design: Design, spacing: int, stages: Stages, paces: Sequence[Pace]) -> Stages:
    """The same sharing at the pace that gives additions most time and results lose none by."""
    goal = max(_latency_goal(design), stages.timing(spacing).latency)
    return min(
        (stages, *(Stages(design, stages.way._replace(pace=pace)) for pace in paces)),
        key=lambda made: (
            max(made.timing(spacing).latency, goal),
            clocks_per_major(design, made.timing(spacing)),
            -made.way.pace.carry_clocks,
            made.longest,
            made.timing(spacing).latency,
        ),
    )


def _latency_goal(design: Design) -> int:
    return POSITION_LATENCY_GOAL if design.high_resolution else LATENCY_GOAL


def timing(design: Design) -> Timing:
    """The clocks that the pipelined core of a design takes.

    Raises:
        InputError: see `plan`.
    """
    return plan(design).timing


@lru_cache(maxsize=32)
def _weightings(
    design: Design, pace: Pace
) -> tuple[Weighting, Weighting, Weighting | Running, Weighting | Running]:
    """A, B, theta and v."""
    words, table, n = design.words, design.table, design.algorithm.samples

    def limb(most: int, total: Interval) -> Limbs:
        return evenly(total.bits, most, pace.carry_clocks)

    taps, weights = tap_rows(table), weight_rows(table)
    A, B = (
        Weighting(counts, taps, result, n, limb(pace.tap_bits, result))
        for counts, result in ((words.gyro, words.gyro_taps), (words.accel, words.accel_taps))
    )
    # theta and v are cut as alpha and nu are, so that these can be worked on at once
    theta, v = (
        Running(counts, result, limb(pace.minor_bits, total))
        if weights[n - 1] == [(d, 1) for d in range(n)]
        else Weighting(counts, weights, result, n, limb(pace.minor_bits, total))
        for counts, result, total in (
            (words.gyro, words.theta, words.alpha),
            (words.accel, words.v, words.nu),
        )
    )
    return A, B, theta, v


class Stages:
    """The plans of the parts that calculate, and the clocks at which they stand.

    Args:
        design: the design.
        way: how to build it.

    Attributes:
        tiles: multiplier blocks.
        longest: bits of the longest limbs together: of A and B, of theta to nu, of the products'
            sums.
        arrivals: for each vector of the result, when the bits of its components are there.
    """

    def __init__(self, design: Design, way: Way) -> None:
        words, n = design.words, design.algorithm.samples
        target = TARGETS[design.hardware.target]

        def limbs(most: int, *ranges: Interval) -> Limbs:
            return evenly(max(item.bits for item in ranges), most, way.pace.carry_clocks)

        self.design = design
        self.way = way
        sum_bits = way.pace.sum_bits
        self.gyro_taps, self.accel_taps, self.theta, self.v = _weightings(design, way.pace)
        minor_arrivals = [later(part.arrival, MINOR_CLOCK) for part in (self.theta, self.v)]

        # alpha and nu before the last minor interval's, which is all the between products see
        self.integrals = {}
        before: dict[str, Interval] = {}
        for name, item, arrival, total in (
            ("alpha", words.theta, minor_arrivals[0], words.alpha),
            ("nu", words.v, minor_arrivals[1], words.nu),
        ):
            before[name] = item.repeated(design.algorithm.minors - 1)
            self.integrals[name] = Accumulation(
                item, arrival, total, limbs(way.pace.minor_bits, total), before[name], gap=n
            )

        # the arrays, launched when the first limbs of their operands are there
        def operands(*items: tuple[Interval, Arrival]) -> tuple[int, list[Operand]]:
            launch = min(last_clock(arrival[:1]) for _, arrival in items)
            return launch, [Operand(range_, later(arrival, -launch)) for range_, arrival in items]

        taps_arrivals = [
            later(part.arrival, TAP_CLOCK) for part in (self.gyro_taps, self.accel_taps)
        ]
        self.sample_clock = min(last_clock(arrival[:1]) for arrival in taps_arrivals)
        self.within_launch, (A, B, s, r) = operands(
            (words.gyro_taps, taps_arrivals[0]),
            (words.accel_taps, taps_arrivals[1]),
            (words.gyro, at_once(words.gyro.bits, self.sample_clock)),
            (words.accel, at_once(words.accel.bits, self.sample_clock)),
        )
        self.arrays = {
            "within": _crossing(
                (A, B),
                (s, r),
                (words.coning_within, words.sculling_within),
                way.within,
                target,
                limbs(sum_bits, words.coning_within, words.sculling_within),
                way.fringe,
            )
        }
        self.launches = {"within": self.within_launch}
        if way.between is not None:
            self.launches["between"], (alpha, nu, theta, v) = operands(
                (before["alpha"], self.integrals["alpha"].before_arrival),
                (before["nu"], self.integrals["nu"].before_arrival),
                (words.theta, minor_arrivals[0]),
                (words.v, minor_arrivals[1]),
            )
            self.arrays["between"] = _crossing(
                (alpha, nu),
                (theta, v),
                (words.coning_between, words.sculling_between),
                way.between,
                target,
                limbs(sum_bits, words.coning_between, words.sculling_between),
                way.fringe,
            )

        self.arrivals: dict[str, list[Arrival]] = {
            name: [part.arrival] * 3 for name, part in self.integrals.items()
        }
        for place, array in self.arrays.items():
            for name, components in array.results.items():
                self.arrivals[f"{name}_{place}"] = [
                    later(arrival, self.launches[place]) for _, arrival in components
                ]
        self.position: Positioning | None = None
        if way.position is not None and words.scrolling is not None:
            N, limb = design.samples_per_major, limbs(sum_bits, words.scrolling)
            self.position = _positioning(words, N, way.position, target, limb, way.fringe)
            for name, three in self.position.arrivals.items():
                self.arrivals[name] = [later(arrival, POSITION_CLOCK) for arrival in three]
        self.tiles = sum(array.tiles for array in self.arrays.values())
        sums = [array.limb for array in self.arrays.values()]
        if self.position is not None:
            self.tiles += self.position.tiles
            sums.append(self.position.crossing.limb)
        minors = (self.theta, self.v, *self.integrals.values())
        self.longest = (
            max(self.gyro_taps.limb.bits, self.accel_taps.limb.bits)
            + max(part.limb.bits for part in minors)
            + max(limb.bits for limb in sums)
        )

    @property
    def blocks(self) -> list[list[str]]:
        """The arrays' multiplier blocks in groups (`Crossing.blocks`), the longest group first.

        Names of submodules of the core.
        """
        arrays = dict(self.arrays)
        if self.position is not None:
            arrays["position.scrolling"] = self.position.crossing
        groups = [
            [f"{place}.{name}" for name in group]
            for place, array in arrays.items()
            for group in array.blocks
        ]
        return sorted(groups, key=len, reverse=True)

    def timing(self, spacing: int) -> Timing:
        """The clocks that it takes, if samples come in `spacing` clocks at the fastest."""
        timing = Timing(latency=complete_clock(self.arrivals) + 1, spacing=spacing)
        hardware, span = self.design.hardware, self.design.samples_per_major
        if self.design.drops_results:
            stream = hardware.handover == "stream"
            majors = words_per_column(self.design) if stream else PORT_MAJOR_BITS // LIMB
            moves = Moves(self.arrivals, MAJOR_CLOCK, majors)
            return Timing(
                moves.latency,
                max(spacing, -(-max(moves.least_gap, 2) // span)),
                handover_spacing=1 if stream else moves.refill,
                # the host's taking is seen a clock later, and acted on a clock after that
                dropping=Dropping(moves.claim - 1, moves.refill),
            )
        gap = span * spacing
        may = TARGETS[hardware.target].two_results and hardware.handover == "parallel"
        if may and gap <= timing.latency:  # room for a second result wins clocks
            moves = Moves(self.arrivals, MAJOR_CLOCK)
            if moves.possible and moves.least_gap <= gap:
                return Timing(moves.latency, spacing, handover_spacing=moves.refill, results=2)
        return timing

    def plan(self, spacing: int) -> Plan:
        """The plan with these parts."""
        arrays = (self.way.within, self.way.between, self.way.position)
        return Plan(
            way=self.way,
            tiles=self.tiles,
            units=sum(sharing.units for sharing in arrays if sharing is not None),
            timing=self.timing(spacing),
        )


class PipelinedCore(wiring.Component):
    """Coning and sculling accumulators of one design, exact in every bit.

    Ports (clock `clk`, synchronous `rst`; the handshake contract is `sculler_model.golden`):
        sample_valid, sample_ready; sample_gyro_x..z, sample_accel_x..z (signed counts),
        sample_fault.
        result_valid, result_ready; result_major (unsigned), result_status (4 bits), and
        result_NAME for each of `sculler_model.design.COMPONENTS`, signed, worst-case wide; or
        result_data, result_last, the stream of words.
        samples_lost, and results_dropped where the design drops results.

    Throughput: one sample every `timing.spacing` clocks.  Within a major interval nothing stalls;
    the last sample of an interval waits while there is no room for its result (`timing.results`).

    Args:
        design: the design.
        primitive: whether to instantiate the target's own multiplier blocks.

    Attributes:
        plan: what it is built of.
        timing: clocks it takes.
        resources: the plan's figures, for the manifest.
        listing: None, there is no schedule to read.

    Raises:
        InputError: see `plan`.
    """

    def __init__(self, design: Design, *, primitive: bool = True) -> None:
        self.design = design
        self.primitive = primitive
        self.plan = plan(design)
        self.timing = self.plan.timing
        self.stages = Stages(design, self.plan.way)
        self.sequencer = Sequencer(design, self.timing.spacing, self.timing.results)
        self.handover: HandOver | StreamHandOver
        words, arrivals, drops = design.words, self.stages.arrivals, design.drops_results
        if design.hardware.handover == "stream":
            columns = words_per_column(design)
            self.handover = StreamHandOver(words, columns, arrivals, MAJOR_CLOCK, drops)
        else:
            self.handover = HandOver(words, arrivals, MAJOR_CLOCK, self.timing.results, drops)
        self.resources = {
            "multipliers": self.plan.tiles,
            "product_units": self.plan.units,
            "blocks": self.stages.blocks,
        }
        self.listing = None
        super().__init__(port_members(design))

    def elaborate(self, platform: object) -> Module:
        m = Module()
        words, stages = self.design.words, self.stages
        m.submodules.sequencer = sequencer = self.sequencer
        m.submodules.handover = handover = self.handover
        m.submodules.losses = losses = Losses()
        m.d.comb += [
            sequencer.sample_valid.eq(self.sample_valid),
            sequencer.sample_fault.eq(self.sample_fault),
            sequencer.result_taken.eq(handover.taken),
            sequencer.sample_lost.eq(losses.lost),
            losses.sample_valid.eq(self.sample_valid),
            losses.sample_ready.eq(sequencer.sample_ready),
            self.sample_ready.eq(sequencer.sample_ready),
            self.samples_lost.eq(losses.count),
        ]
        # the parts of each sensor, which stand together, and the arrays have flags of their own
        flags = {
            sensor: {
                name: FlagLine(
                    m, f"{sensor}_{name}", getattr(sequencer, name), inverted=_INVERTED[sensor]
                )
                for name in ("taken", "minor_end", "major_end")
            }
            for sensor in ("gyro", "accel")
        }
        ended = flags["gyro"]["major_end"]

        tap_samples: dict[str, list[Word]] = {}  # for A and B
        samples: dict[str, list[Word]] = {}  # for all else, a clock later
        for sensor in ("gyro", "accel"):
            bits = getattr(words, sensor).bits
            tap_samples[sensor], samples[sensor] = [], []
            for axis in AXES:
                name = f"{sensor}_{axis}"
                register = Signal(bits, name=f"{name}_sample", reset_less=True)
                m.d.sync += register.eq(getattr(self, f"sample_{name}"))
                tap_samples[sensor].append(
                    Word(m, f"{name}_sample", register, at_once(bits, TAP_CLOCK))
                )
                # synthesis makes one of registers that are equal, and one could not stand near all
                # that reads it: the initial value keeps this one apart
                ones = (1 << bits) - 1
                apart = Signal(bits, name=name, reset_less=True, init=ones)
                m.d.sync += apart.eq(register)
                samples[sensor].append(Word(m, name, apart, at_once(bits, MINOR_CLOCK)))

        def delayed(sensor: str, clock: int) -> list[Value]:
            held = (tap_samples if clock == TAP_CLOCK else samples)[sensor]
            return [word.window(0, len(word.value), clock) for word in held]

        phase = Word(m, "phase", sequencer.phase, at_once(len(sequencer.phase), TAP_CLOCK))

        def weighted(name: str, weighting: Weighting, sensor: str, clock: int) -> list[Value]:
            m.submodules[name] = part = WeightedSum(weighting, inverted=_INVERTED[sensor])
            m.d.comb += part.step.eq(flags[sensor]["taken"].at(clock))
            if weighting.is_gated:
                m.d.comb += part.phase.eq(phase.window(0, len(phase.value), clock))
            for i, sample in enumerate(delayed(sensor, clock)):
                m.d.comb += part.samples[i].eq(sample)
            return [Value.cast(part.output[i]) for i in range(3)]

        def of_minor(name: str, plan: Weighting | Running, sensor: str) -> list[Value]:
            if isinstance(plan, Weighting):
                return weighted(name, plan, sensor, MINOR_CLOCK)
            outputs: list[Value] = []
            for axis, sample in zip(AXES, delayed(sensor, MINOR_CLOCK), strict=True):
                m.submodules[f"{name}_{axis}"] = part = RunningSum(plan, inverted=_INVERTED[sensor])
                m.d.comb += [
                    part.step.eq(flags[sensor]["taken"].at(MINOR_CLOCK)),
                    part.last.eq(flags[sensor]["minor_end"].at(MINOR_CLOCK)),
                    part.sample.eq(sample),
                ]
                outputs.append(part.output)
            return outputs

        A = weighted("gyro_taps", stages.gyro_taps, "gyro", TAP_CLOCK)
        B = weighted("accel_taps", stages.accel_taps, "accel", TAP_CLOCK)
        theta = of_minor("theta", stages.theta, "gyro")
        v = of_minor("v", stages.v, "accel")
        before: dict[str, list[Value]] = {}
        for name, items, sensor in (("alpha", theta, "gyro"), ("nu", v, "accel")):
            before[name] = []
            for i, axis in enumerate(AXES):
                m.submodules[f"{name}_{axis}"] = part = Accumulator(
                    stages.integrals[name], inverted=_INVERTED[sensor]
                )
                m.d.comb += [
                    part.step.eq(flags[sensor]["minor_end"].at(part.plan.clock)),
                    part.last.eq(flags[sensor]["major_end"].at(part.plan.clock)),
                    part.input.eq(items[i]),
                    handover.input[name][i].eq(part.newest),
                ]
                before[name].append(part.before)

        operands = {
            "within": (
                A,
                B,
                delayed("gyro", stages.sample_clock),
                delayed("accel", stages.sample_clock),
            ),
            "between": (before["alpha"], before["nu"], theta, v),
        }
        starts = {"within": sequencer.launch, "between": sequencer.minor_end}
        for place, crossing in stages.arrays.items():
            m.submodules[place] = array = CrossArray(
                crossing,
                stages.launches[place],
                primitive=self.primitive,
                inverted=_INVERTED[place],
            )
            m.d.comb += [array.launch.eq(starts[place]), array.last.eq(sequencer.major_end)]
            for name, vectors in zip(crossing.operands, operands[place], strict=True):
                for i in range(3):
                    m.d.comb += getattr(array, name)[i].eq(vectors[i])
            for total, components in crossing.results.items():
                for i, (lane, _) in enumerate(components):
                    m.d.comb += handover.input[f"{total}_{place}"][i].eq(
                        getattr(array, total)[lane]
                    )

        if stages.position is not None:
            m.submodules.position = position = Position(stages.position, primitive=self.primitive)
            first = FlagLine(m, "first", sequencer.first, 1)
            m.d.comb += [
                position.step.eq(flags["gyro"]["taken"].at(POSITION_CLOCK)),
                position.first.eq(first.at(POSITION_CLOCK)),
                position.last.eq(ended.at(POSITION_CLOCK)),
            ]
            for sensor in samples:
                for i, sample in enumerate(delayed(sensor, POSITION_CLOCK)):
                    m.d.comb += getattr(position, sensor)[i].eq(sample)
            for i, lane in enumerate(stages.position.lanes):
                for name, component in zip(HIGH_RESOLUTION_VECTORS, (i, i, lane), strict=True):
                    m.d.comb += handover.input[name][i].eq(getattr(position, name)[component])

        # status, and the result to the host
        status = Signal(3)
        news = Cat(sequencer.short, sequencer.fault, sequencer.lost)
        with m.If(flags["gyro"]["taken"].at(1)):
            m.d.sync += status.eq(Mux(sequencer.first, 0, status) | news)
        held = Word(m, "status", status, at_once(3, 2))  # for the next sample starts another
        short, fault, lost = held.window(0, 3, STATUS_CLOCK)
        rail = self._rail(m, tap_samples, flags["gyro"]["taken"], ended)
        m.d.comb += [
            handover.major_end.eq(ended.at(handover.clock)),
            handover.status.eq(Cat(short, fault, 0, lost)),
            handover.rail.eq(rail),
            handover.ready.eq(self.result_ready),
            self.result_valid.eq(handover.valid),
        ]
        if self.design.drops_results and handover.moves is not None:
            m.d.comb += [
                handover.claim.eq(ended.at(handover.moves.claim)),
                self.results_dropped.eq(handover.dropped),
            ]
        if isinstance(handover, StreamHandOver):
            m.d.comb += [self.result_data.eq(handover.data), self.result_last.eq(handover.last)]
            return m
        m.d.comb += [
            self.result_major.eq(handover.shown_major),
            self.result_status.eq(handover.shown_status),
        ]
        for name in self.design.vectors:
            for i, axis in enumerate(AXES):
                m.d.comb += getattr(self, f"result_{name}_{axis}").eq(handover.output[name][i])
        return m

    def _rail(
        self, m: Module, samples: dict[str, list[Word]], taken: FlagLine, ended: FlagLine
    ) -> Value:
        """At `RAIL_CLOCK`: a count of the interval so far, this sample included, is at a rail.

        There every bit of it differs from its sign.  This is found in small steps, for the counts
        stand far apart.
        """
        sensors = []
        for sensor, words in samples.items():
            whole: list[Value] = []  # at TAP_CLOCK + 2, some for each count
            for word in words:
                *bits, sign = word.window(0, len(word.value), TAP_CLOCK)
                few = [
                    _held(m, f"{word.name}_rail{i}", Cat(bit != sign for bit in bits[i : i + 3]))
                    for i in range(0, len(bits), 3)
                ]
                parts = [
                    _held(m, f"{word.name}_rails{i}", Cat(few[i : i + 4]))
                    for i in range(0, len(few), 4)
                ]
                whole.append(Cat(parts).all())
            sensors.append(Signal(name=f"{sensor}_at_rail"))
            m.d.sync += sensors[-1].eq(Cat(whole).any())
        newest, rail = Signal(name="newest_at_rail"), Signal(name="rail")
        m.d.sync += [
            newest.eq(Cat(sensors).any() & taken.at(RAIL_CLOCK - 2)),
            rail.eq(newest | (rail & ~ended.at(RAIL_CLOCK))),
        ]
        return rail


def _held(m: Module, name: str, bits: Value) -> Value:
    """Whether all bits are 1, a clock later."""
    held = Signal(name=name, reset_less=True)
    m.d.sync += held.eq(bits.all())
    return held
