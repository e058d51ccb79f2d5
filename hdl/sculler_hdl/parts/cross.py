"""Sums of cross products, shared over several clocks."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, reduce
from itertools import pairwise

from amaranth import Cat, Module, Mux, Signal, Value
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.parts.accumulate import Accumulation, Accumulator
from sculler_hdl.parts.multiply import Product
from sculler_hdl.parts.words import (
    Arrival,
    FlagLine,
    Limbs,
    Sum,
    Word,
    last_clock,
    later,
    lowest,
    spans,
)
from sculler_hdl.target import Target
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

_During = Callable[[tuple[int, ...], int, FlagLine], Value]


@dataclass(frozen=True)
class Sharing:
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
        """Clocks of a launch."""
        return self.crosses * self.sides * self.axes

    @property
    def units(self) -> int:
        """Product units."""
        return 18 // self.steps


SHARINGS = [
    Sharing(),
    Sharing(sides=2),
    Sharing(axes=3),
    Sharing(sides=2, axes=3),
    Sharing(crosses=3, axes=3),
    Sharing(crosses=3, sides=2, axes=3),
]
"""The choices, most units first."""


@dataclass(frozen=True)
class Operand:
    """One of the vectors: the range of a component, and when its bits are there."""

    range: Interval
    arrival: Arrival


class Crossing:
    """The plan of a `CrossArray`.

    Args:
        lefts, rights: the operands.
        totals: ranges of the totals' components, in the order of `form.totals`.
        sharing: how the units are shared.
        target: whose multiplier blocks.
        limb: how sums are cut.
        fringe: most low bits of an operand that may go to rows of AND gates.
        form: what it calculates.

    Attributes:
        tiles: multiplier blocks in all.
        results: for each total and axis, the component on the port and when its bits are there,
            complete, after the last launch.
    """

    def __init__(
        self,
        lefts: Sequence[Operand],
        rights: Sequence[Operand],
        totals: Sequence[Interval],
        sharing: Sharing,
        target: Target,
        limb: Limbs,
        fringe: int,
        form: Form = CONING_AND_SCULLING,
    ) -> None:
        self.operands = {f"left{i}": item for i, item in enumerate(lefts)}
        self.operands |= {f"right{i}": item for i, item in enumerate(rights)}
        self.form = form
        self.totals = dict(zip(form.totals, totals, strict=True))
        self.sharing = sharing
        self.target = target
        self.limb = limb
        self.lanes = 3 // sharing.axes
        self.sides = 2 // sharing.sides

        # the pairs of operands that the units see, at the first step
        taken = self.operands
        self.pairs = [(f"left{a}", f"right{b}") for a, b in form.crosses]
        if sharing.crosses == 3:
            taken = {
                "left": _joint(*lefts),
                "right": _joint(*rights),
            }
            self.pairs = [("left", "right")]
        self.held = int(sharing.steps > 1)
        self.seen = {
            name: Operand(item.range, later(item.arrival, self.held))
            for name, item in taken.items()
        }
        self.products = [
            Product(
                target,
                self.seen[a].range,
                self.seen[b].range,
                self.seen[a].arrival,
                self.seen[b].arrival,
                fringe,
            )
            for a, b in self.pairs
        ]
        self.tiles = sum(product.tiles for product in self.products) * self.sides * self.lanes

        # what a step adds up for each total, and the adders behind
        self.sums: dict[str, Sum] = {}
        self.adders: dict[str, Accumulation] = {}
        self.results: dict[str, list[tuple[int, Arrival]]] = {}
        widest = Interval.signed(max(total.bits for total in totals))
        for name, total in self.totals.items():
            addends, item = [], ZERO_RANGE
            for product in self.products_of(name):
                one = product.left * product.right
                item += one - one if self.sides == 2 else one
                for negative in (False, True)[: self.sides]:
                    addends += [replace(part, negative=negative) for part in product.addends]
            if item.bits > widest.bits:
                item = widest  # modulo what the totals hold
            self.sums[name] = Sum(addends, item, limb)
            arrival = later(self.sums[name].arrival, sharing.sides - 1)
            if item.bits > total.bits:  # as it may be of the other total
                item, arrival = Interval.signed(total.bits), lowest(arrival, total.bits)
            adder = self.adders[name] = Accumulation(
                item, arrival, total, limb, sums=sharing.axes, signs=sharing.sides == 2
            )
            final = self.steps_of(name)[-1]
            self.results[name] = [
                (axis % self.lanes, later(adder.arrival, final - (2 - axis) * (sharing.axes == 3)))
                for axis in range(3)
            ]

    def unit_name(self, pair: int, lane: int, number: int) -> str:
        """The name of a unit's parts; `number` is its side, or 0 if sides take turns."""
        return f"unit{pair}_{AXES[lane]}{number}"

    @property
    def blocks(self) -> list[list[str]]:
        """The array's multiplier blocks, those next to each other whose products are added first.

        In one group, or one for each total in a long array whose axes take turns.  Names of
        submodules.
        """
        groups: list[list[str]] = []
        for lane in range(self.lanes):
            for total, added in self.sums.items():
                terms: list[str | None] = []
                for pair in self.pairs_of(total):
                    product = self.products[pair]
                    for number in range(self.sides):
                        terms += product.block_names(self.unit_name(pair, lane, number))
                        terms += [None] * product.rows
                added_up = [block for i in added.order if (block := terms[i]) is not None]
                seen = {block for group in groups for block in group}  # totals may take turns
                if not seen.issuperset(added_up):
                    groups.append([block for block in added_up if block not in seen])
        if self.tiles > LONG and self.lanes == 1:
            return groups
        return [[block for group in groups for block in group]]

    def pairs_of(self, total: str) -> Sequence[int]:
        """The pairs of operands whose products a step forms for a total."""
        return (0,) if self.sharing.crosses == 3 else self.form.totals[total]

    def products_of(self, total: str) -> list[Product]:
        """The products that a step forms for a total, each once or on both sides."""
        return [self.products[pair] for pair in self.pairs_of(total)]

    def steps_of(self, total: str) -> list[int]:
        """The steps that add to a total."""
        each = self.sharing.sides * self.sharing.axes
        if self.sharing.crosses == 1:
            return list(range(each))
        return [cross * each + step for cross in self.form.totals[total] for step in range(each)]

    def steps_where(self, cross: int | None = None, side: int | None = None) -> list[int]:
        """The steps of one of the crosses or one of the sides that take turns."""
        axes, sides = self.sharing.axes, self.sharing.sides
        return [
            step
            for step in range(self.sharing.steps)
            if cross in (None, step // (axes * sides)) and side in (None, step // axes % sides)
        ]


class CrossArray(wiring.Component):
    """Totals of cross products: each grows by those that its form names, at each launch.

    coning += left0 x right0;  sculling += left0 x right1 + left1 x right0, for example.

    The units take the products in `plan.sharing.steps` clocks, axis by axis inside side by side
    inside cross by cross:

        held operands, rotating ─▶ units: blocks and rows ─▶ Sum ─▶ Accumulator, sums rotating
        x ◀─ y ◀─ z ◀─ x

    The three components of each operand move round at every step, so that a unit finds what it
    needs in the same place: place 1 times place 2 to be added, place 2 times place 1 to be
    subtracted.

    Members:
        launch, last (clock -`lead`): the operands are to be taken; the totals are then complete.
        left0, ... right0, ...: vectors, as they arrive.
        coning, sculling, or what the totals are: their components, or the newest of them if axes
            take turns.

    A launch may follow `plan.sharing.steps` clocks after the one before.

    Args:
        plan: the plan.
        lead: clocks by which its flags come earlier, for they have far to go.
        primitive: whether to instantiate the target's multiplier blocks.
        inverted: how `last` is held (`FlagLine`), to keep it apart from another array's.
    """

    def __init__(
        self, plan: Crossing, lead: int = 0, *, primitive: bool = True, inverted: bool = False
    ) -> None:
        self.plan = plan
        self.lead = lead
        self.primitive = primitive
        self.inverted = inverted
        super().__init__(
            {
                "launch": In(1),
                "last": In(1),
                **{
                    name: In(data.ArrayLayout(item.range.bits, 3))
                    for name, item in plan.operands.items()
                },
                **{
                    name: Out(data.ArrayLayout(total.bits, plan.lanes))
                    for name, total in plan.totals.items()
                },
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        last = FlagLine(m, "last", self.last, -self.lead, inverted=self.inverted)

        @cache
        def during(steps: tuple[int, ...], clock: int, flag: FlagLine) -> Value:
            """High in the clocks of these steps, for a thing done at `clock` in step 0."""
            high = Signal(name=f"{flag.name}_{steps[0]}to{steps[-1]}_{clock}")
            m.d.sync += high.eq(Cat(flag.at(clock - 1 + step) for step in steps).any())
            return high

        # what stands apart has flags of its own: the adders of each total, and in a long array the
        # operands of each pair.  What a reset leaves under way is loaded for nothing, for no sum
        # takes a step then.
        launches = {
            name: FlagLine(m, f"launch_{name}", self.launch, -self.lead, inverted=i == 1)
            for i, name in enumerate(plan.form.totals)
        }
        loads = [
            FlagLine(m, f"load{i}", self.launch, -self.lead, inverted=i == 2, cleared=i == 0)
            for i in range(len(plan.pairs))
        ]
        places: dict[tuple[int, str], list[Word]] = {}
        copied = plan.tiles > NEAR and plan.sharing.crosses == 1
        for group, names in enumerate(plan.pairs if copied else [plan.operands]):
            for name in names:
                copy = sum(name == other for _, other in places)
                places[group, name] = self._places(m, name, loads[group], copy)

        def at_place(
            side: str, group: int, name: str, number: int, lo: int, hi: int, clock: int
        ) -> Value:
            """Bits of the component in a place, of the operand in turn if they take turns."""
            if plan.sharing.crosses == 1:
                return places[group, name][number].window(lo, hi, clock)
            numbers = [cross[side == "right"] for cross in plan.form.crosses]
            chosen, *others = (
                places[group, f"{side}{i}"][number].window(lo, hi, clock)
                for i in range(max(numbers) + 1)
            )
            for i, other in enumerate(others, start=1):
                turn = plan.steps_where(cross=numbers.index(i))
                chosen = Mux(during(tuple(turn), clock, loads[group]), other, chosen)
            return chosen

        def seen(side: str, pair: int, forward: int, backward: int, axis: int) -> Word:
            """A unit's operand: from the place of the forward product, or of the one in turn."""
            name, group = plan.pairs[pair][side == "right"], pair if copied else 0
            arrival = plan.seen[name].arrival
            word_name = f"{side}{pair}_{forward}_{axis}"
            bits: list[Value] = []
            for lo, hi, clock in spans(arrival):
                chosen = at_place(side, group, name, forward, lo, hi, clock)
                if plan.sharing.sides == 2:
                    swap = during(tuple(plan.steps_where(side=1)), clock, loads[group])
                    other = at_place(side, group, name, backward, lo, hi, clock)
                    chosen = Mux(swap, other, chosen)
                piece = Signal(hi - lo, name=f"{word_name}_{lo}")
                m.d.comb += piece.eq(chosen)
                bits.append(piece)
            return Word(m, word_name, Cat(*bits), arrival)

        for lane in range(plan.lanes):
            one, two = (lane + 1) % 3, (lane + 2) % 3
            values: list[list[Value]] = []  # for each pair: both sides, or the one in turn
            for pair, product in enumerate(plan.products):
                found = []
                for number, (a, b) in enumerate([(one, two), (two, one)][: plan.sides]):
                    left = seen("left", pair, a, b, lane)
                    right = seen("right", pair, b, a, lane)
                    found += product.build(
                        m,
                        plan.unit_name(pair, lane, number),
                        left,
                        right,
                        primitive=self.primitive,
                    )
                values.append(found)
            built: dict[tuple[int, ...], Word] = {}
            for name, launch in launches.items():
                mine = tuple(plan.pairs_of(name))
                if mine not in built:
                    terms = [value for pair in mine for value in values[pair]]
                    built[mine] = plan.sums[name].build(m, f"{name}_{AXES[lane]}", terms)
                adder = Accumulator(plan.adders[name], inverted=launch.inverted)
                m.submodules[f"{name}_{AXES[lane]}_total"] = adder
                steps = plan.steps_of(name)
                final = steps[-plan.sharing.axes :]
                m.d.comb += [
                    adder.input.eq(self._signed(m, name, built[mine], during, launch)),
                    adder.step.eq(during(tuple(steps), adder.plan.clock, launch)),
                    adder.last.eq(during(tuple(final), adder.plan.clock, last)),
                    getattr(self, name)[lane].eq(adder.newest),
                ]
                if plan.sharing.sides == 2:
                    backward = tuple(plan.steps_where(side=1))
                    m.d.comb += adder.carry.eq(during(backward, adder.plan.clock, launch))
        return m

    def _places(self, m: Module, name: str, launch: FlagLine, copy: int) -> list[Word]:
        """The three components of an operand where the units find them.

        A second copy has other initial values, or synthesis would make it one with the first.
        """
        plan = self.plan
        words = [
            Word(m, f"{name}_{axis}", getattr(self, name)[i], plan.operands[name].arrival)
            for i, axis in enumerate(AXES)
        ]
        if not plan.held:
            return words
        side = name if plan.sharing.crosses == 1 else name[:-1]
        arrival = plan.seen[side].arrival
        held: list[list[Value]] = [[], [], []]
        for lo, hi, clock in spans(arrival):
            load = launch.at(clock - 1)
            init = copy * ((1 << (hi - lo)) - 1)
            registers = [
                Signal(hi - lo, name=f"held{copy}_{name}_{axis}_{lo}", init=init, reset_less=True)
                for axis in AXES
            ]
            for i, register in enumerate(registers):
                held[i].append(register)
                taken = words[i].window(lo, hi, clock - 1)
                with m.If(load):
                    m.d.sync += register.eq(taken)
                if plan.sharing.axes == 3:
                    with m.Else():
                        m.d.sync += register.eq(registers[(i + 1) % 3])
        return [
            Word(m, f"held{copy}_{name}_{axis}", Cat(*held[i]), arrival)
            for i, axis in enumerate(AXES)
        ]

    def _signed(self, m: Module, name: str, word: Word, during: _During, launch: FlagLine) -> Value:
        """What a step adds, inverted where it is to be subtracted."""
        plan = self.plan
        bits = plan.adders[name].item.bits
        if plan.sharing.sides == 1:
            return word.value[:bits]
        backward = tuple(plan.steps_where(side=1))
        pieces = []
        for lo, hi, clock in spans(lowest(word.arrival, bits)):
            piece = Signal(hi - lo, name=f"{name}_signed_{lo}", reset_less=True)
            turned = during(backward, clock, launch).replicate(hi - lo)
            m.d.sync += piece.eq(word.window(lo, hi, clock) ^ turned)
            pieces.append(piece)
        return Cat(*pieces)


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
