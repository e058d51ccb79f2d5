"""How a sum of cross products is spread over product units and clocks.

A cross product has six products, so three of them have 18.  `Folding` says how many units do these
in how many clocks; `CrossArrayPlan` what that asks of operands, products, sums and accumulators.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import pairwise

from sculler_hdl.plan.accumulator import AccumulatorPlan
from sculler_hdl.plan.adder_tree import AdderTreePlan
from sculler_hdl.plan.arrival import Arrival, Limbs, last_clock, later, lowest, spans
from sculler_hdl.plan.multiplier import MultiplierPlan
from sculler_hdl.targets import Target
from sculler_model.design import AXES, ZERO_RANGE, Interval


@dataclass(frozen=True, eq=False)
class Form:
    """What an array calculates.

    Attributes:
        crosses: (left, right) of three cross products: the numbers of their operands.
        totals: which of them go into which total.
    """

    crosses: tuple[tuple[int, int], ...]
    totals: Mapping[str, tuple[int, ...]]


CONING_AND_SCULLING = Form(((0, 0), (0, 1), (1, 0)), {"coning": (0,), "sculling": (1, 2)})
"""A x s;  A x r + B x s: or alpha x theta and so on."""

SCROLLING = Form(((0, 0), (1, 1), (2, 2)), {"scrolling": (0, 1, 2)})
"""Three cross products of different operands for one total."""

NEAR = 16
"""Blocks of an array that operands held once still reach: it stretches over some 30 columns."""

LONG = 24
"""Blocks of an array that still can stand in one row: six fours, some 54 columns."""


@dataclass(frozen=True)
class Folding:
    """How the 18 products of a launch are spread over clocks: 18 / `steps` units do them.

    Attributes:
        crosses: 3: the three cross products one after another, else 1.
        sides: 2: first the products that are added, then those that are subtracted, else 1.
        axes: 3: x, y, z one after another, else 1.
    """

    crosses: int = 1
    sides: int = 1
    axes: int = 1

    @property
    def steps(self) -> int:
        """The folding factor: clocks of a launch."""
        return self.crosses * self.sides * self.axes

    @property
    def units(self) -> int:
        """Product units."""
        return 18 // self.steps


FOLDINGS = [
    Folding(),
    Folding(sides=2),
    Folding(axes=3),
    Folding(sides=2, axes=3),
    Folding(crosses=3, axes=3),
    Folding(crosses=3, sides=2, axes=3),
]
"""The choices, most units first."""


@dataclass(frozen=True)
class Operand:
    """One of the vectors: the range of a component, and when its bits are there."""

    range: Interval
    arrival: Arrival


class CrossArrayPlan:
    """The plan of a `CrossArray`.

    Args:
        lefts, rights: the operands.
        totals: ranges of the totals' components, in the order of `form.totals`.
        folding: how the units are shared.
        target: whose multiplier blocks.
        limb: how sums are cut.
        residue: most low bits of an operand that may go to rows of AND gates.
        form: what it calculates.
        spread: whether each axis may have its operands in registers of its own; only a long array
            that is not folded has.
        apart: whether sums that may take a step at every clock are shown `apart`
            (`AccumulatorPlan`).

    Attributes:
        operands: by the names of the ports: left0, left1, ..., right0, ...
        lanes, sides: axes, and sides of a cross product, that have units of their own.
        pairs: names of the operands (of `seen`) that each kind of unit multiplies.
        held: clocks that holding the operands takes: 1, or 0 where units neither take turns nor
            stand far apart.
        seen: the operands as the units see them, at the first step.
        multipliers: of each pair.
        block_count: multiplier blocks in all.
        spread: whether each axis has its operands in registers of its own.
        sums: what a step adds up for each total.
        accumulators: of each total.
        results: for each total and axis, the component on the port and when its bits are there,
            complete, after the last launch.
    """

    def __init__(
        self,
        lefts: Sequence[Operand],
        rights: Sequence[Operand],
        totals: Sequence[Interval],
        folding: Folding,
        target: Target,
        limb: Limbs,
        residue: int,
        form: Form = CONING_AND_SCULLING,
        *,
        spread: bool = False,
        apart: bool = False,
    ) -> None:
        self.operands = {f"left{i}": item for i, item in enumerate(lefts)}
        self.operands |= {f"right{i}": item for i, item in enumerate(rights)}
        self.form = form
        self.totals = dict(zip(form.totals, totals, strict=True))
        self.folding = folding
        self.target = target
        self.limb = limb
        self.residue = residue
        self.apart = apart
        self.lanes = 3 // folding.axes
        self.sides = 2 // folding.sides

        taken = self.operands
        self.pairs = [(f"left{a}", f"right{b}") for a, b in form.crosses]
        if folding.crosses == 3:
            taken = {"left": _joint(*lefts), "right": _joint(*rights)}
            self.pairs = [("left", "right")]
        self.multipliers = self._multipliers(taken)
        self.block_count = (
            sum(one.block_count for one in self.multipliers) * self.sides * self.lanes
        )
        self.spread = spread and self.block_count > NEAR and folding.steps == 1
        self.held = int(folding.steps > 1 or self.spread)
        self.seen = {
            name: Operand(item.range, later(item.arrival, self.held))
            for name, item in taken.items()
        }
        self.multipliers = self._multipliers(self.seen)

        self.sums: dict[str, AdderTreePlan] = {}
        self.accumulators: dict[str, AccumulatorPlan] = {}
        self.results: dict[str, list[tuple[int, Arrival]]] = {}
        widest = Interval.signed(max(total.bits for total in totals))
        for name, total in self.totals.items():
            self._plan_total(name, total, widest)

    def _multipliers(self, operands: Mapping[str, Operand]) -> list[MultiplierPlan]:
        """The products of the pairs of these operands."""
        return [
            MultiplierPlan(
                self.target,
                operands[a].range,
                operands[b].range,
                operands[a].arrival,
                operands[b].arrival,
                self.residue,
            )
            for a, b in self.pairs
        ]

    def _plan_total(self, name: str, total: Interval, widest: Interval) -> None:
        """What a step adds up for a total, and the accumulator behind."""
        addends, item = [], ZERO_RANGE
        for pair in self.pairs_of(name):
            multiplier = self.multipliers[pair]
            one = multiplier.left * multiplier.right
            item += one - one if self.sides == 2 else one
            for negative in (False, True)[: self.sides]:
                addends += [replace(part, negative=negative) for part in multiplier.addends]
        if item.bits > widest.bits:
            item = widest  # modulo what the totals hold
        self.sums[name] = AdderTreePlan(addends, item, self.limb)
        arrival = later(self.sums[name].arrival, self.folding.sides - 1)
        if item.bits > total.bits:  # as it may be of the other total
            item, arrival = Interval.signed(total.bits), lowest(arrival, total.bits)
        axes = self.folding.axes
        adder = self.accumulators[name] = AccumulatorPlan(
            item,
            arrival,
            total,
            self.limb,
            sums=axes,
            signs=self.folding.sides == 2,
            cleared=True,
            apart=self.apart,
        )
        final = self.steps_of(name)[-1]
        self.results[name] = [
            (axis % self.lanes, later(adder.arrival, final - (2 - axis) * (axes == 3)))
            for axis in range(3)
        ]

    @property
    def copied(self) -> bool:
        """Whether the operands are held once for each pair: the array is long."""
        return self.block_count > NEAR and self.folding.crosses == 1 and self.folding.steps > 1

    def unit_name(self, pair: int, lane: int, number: int) -> str:
        """The name of a unit's parts; `number` is its side, or 0 if sides take turns."""
        return f"unit{pair}_{AXES[lane]}{number}"

    @property
    def block_groups(self) -> list[list[str]]:
        """The array's multiplier blocks, those next to each other whose products are added first.

        In one group; in a long array one for each axis, or for each axis and total where an axis
        has many, or its blocks are those of all axes.  Names of submodules.
        """
        lanes = [self._groups_of(lane) for lane in range(self.lanes)]
        joined = [[block for group in groups for block in group] for groups in lanes]
        if self.block_count <= LONG:
            return [[block for lane in joined for block in lane]]
        if self.lanes > 1 and max(map(len, joined)) <= LONG:
            return joined
        return [group for groups in lanes for group in groups]

    def _groups_of(self, lane: int) -> list[list[str]]:
        """A lane's blocks, by totals."""
        groups: list[list[str]] = []
        for total, added in self.sums.items():
            terms: list[str | None] = []
            for pair in self.pairs_of(total):
                multiplier = self.multipliers[pair]
                for number in range(self.sides):
                    terms += multiplier.block_names(self.unit_name(pair, lane, number))
                    terms += [None] * multiplier.rows
            added_up = [block for i in added.order if (block := terms[i]) is not None]
            seen = {block for group in groups for block in group}  # totals may take turns
            if not seen.issuperset(added_up):
                groups.append([block for block in added_up if block not in seen])
        return groups

    def pairs_of(self, total: str) -> Sequence[int]:
        """The pairs of operands whose products a step forms for a total."""
        return (0,) if self.folding.crosses == 3 else self.form.totals[total]

    def steps_of(self, total: str) -> list[int]:
        """The steps that add to a total."""
        each = self.folding.sides * self.folding.axes
        if self.folding.crosses == 1:
            return list(range(each))
        return [cross * each + step for cross in self.form.totals[total] for step in range(each)]

    def moves(self, operand: str) -> dict[int, list[int]]:
        """How an operand's components move: by so many places before these steps; the usual first.

        A unit finds the next axis one place on.  For a product that is to be subtracted it finds
        the left component one place on, the right one a place back.
        """
        axes, sides = self.folding.axes, self.folding.sides
        side = 1 if operand.startswith("left") else -1
        places = [step % axes + side * (step // axes % sides) for step in range(self.folding.steps)]
        found: dict[int, list[int]] = {}
        for step, (before, now) in enumerate(pairwise(places), start=1):
            found.setdefault((now - before) % 3, []).append(step)
        return found

    def steps_where(self, cross: int | None = None, side: int | None = None) -> list[int]:
        """The steps of one of the crosses or one of the sides that take turns."""
        axes, sides = self.folding.axes, self.folding.sides
        return [
            step
            for step in range(self.folding.steps)
            if cross in (None, step // (axes * sides)) and side in (None, step // axes % sides)
        ]


def _joint(*items: Operand) -> Operand:
    """An operand that is now the one and now the other: its bits come with the latest."""
    joint = reduce(Interval.__or__, (item.range for item in items))
    ends = {end for item in items for _, end, _ in spans(item.arrival)}
    cuts = sorted({0, joint.bits, *(end for end in ends if end < joint.bits)})
    arrival = tuple(
        (hi - lo, max(_clock_of(item, lo, hi) for item in items)) for lo, hi in pairwise(cuts)
    )
    return Operand(joint, arrival)


def _clock_of(operand: Operand, lo: int, hi: int) -> int:
    """The clock at which bits lo..hi-1 are there, of which the upper may be the sign."""
    top = operand.range.bits
    return last_clock(operand.arrival, min(lo, top - 1), min(hi, top))
