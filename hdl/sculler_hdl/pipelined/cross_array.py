"""Sums of cross products, shared over several clocks."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import nullcontext

from amaranth import Cat, Module, Mux, Signal, Value
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.accumulator import Accumulator
from sculler_hdl.lib.adder_tree import emit_adder_tree
from sculler_hdl.lib.delay import APART, ControlDelay, SkewedSignal
from sculler_hdl.lib.multiplier import emit_multiplier
from sculler_hdl.plan.arrival import lowest, spans
from sculler_hdl.plan.cross_array import CrossArrayPlan
from sculler_model.design import AXES


class CrossArray(wiring.Component):
    """Totals of cross products: each grows by those that its form names, at each launch.

    coning += left0 x right0;  sculling += left0 x right1 + left1 x right0, for example.

    The units take the products in `plan.folding.steps` clocks, axis by axis inside side by side
    inside cross by cross:

        held operands, ─▶ units: blocks ─▶ adder tree ─▶ Accumulator,
        rotating          and rows                       sums rotating
        x ◀─ y ◀─ z ◀─ x

    The three components of each operand move round at every step, so that a unit finds what it
    needs in the same place: place 1 times place 2 to be added, place 2 times place 1 to be
    subtracted.

    Members:
        launch, last (clock -`lead`): the operands are to be taken; the totals are then complete.
        left0, ... right0, ...: vectors, as they arrive.
        coning, sculling, or what the totals are: their components, or the newest of them if axes
            take turns.

    A launch may follow `plan.folding.steps` clocks after the one before.

    Where a unit forms both the products that are added and those that are subtracted, it reads the
    same places for both, and the components move on to them in between (`plan.moves`).

    Latency: `plan.results`, from a launch to the total with its products.

    Args:
        plan: the plan.
        lead: clocks by which its flags come earlier, for they have far to go.
        primitive: whether to instantiate the target's multiplier blocks.
        inverted: how `last` is held (`ControlDelay`), to keep it apart from another array's.
        tell_unread: whether names tell of bits of products that no total has (`emit_multiplier`).
            Texts of second order have gone without.
        further: more members.
    """

    def __init__(
        self,
        plan: CrossArrayPlan,
        lead: int = 0,
        *,
        primitive: bool = True,
        inverted: bool = False,
        tell_unread: bool = False,
        further: Mapping[str, wiring.Member] | None = None,
    ) -> None:
        self.plan = plan
        self.lead = lead
        self.primitive = primitive
        self.inverted = inverted
        self.read = None
        if tell_unread:
            self.read = max(item.result.bits for item in plan.sums.values())
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
                **(further or {}),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        last = Steps(m, ControlDelay(m, "last", self.last, -self.lead, inverted=self.inverted))
        # what stands apart has flags of its own: the adders of each total, and in a long array the
        # operands of each pair.  What a reset leaves under way is loaded for nothing, for no sum
        # takes a step then.
        launches = {
            name: Steps(
                m, ControlDelay(m, f"launch_{name}", self.launch, -self.lead, inverted=i == 1)
            )
            for i, name in enumerate(plan.form.totals)
        }
        operands = _Operands(m, self)
        for lane in range(plan.lanes):
            products = self._products(m, operands, lane)
            built: dict[tuple[int, ...], SkewedSignal] = {}
            for name, launch in launches.items():
                pairs = tuple(plan.pairs_of(name))
                if pairs not in built:
                    terms = [value for pair in pairs for value in products[pair]]
                    tree_name = f"{name}_{AXES[lane]}"
                    built[pairs] = emit_adder_tree(m, tree_name, plan.sums[name], terms)
                self._total(m, name, lane, built[pairs], launch, last)
        return m

    def _products(self, m: Module, operands: _Operands, lane: int) -> list[list[Value]]:
        """For each pair the addends of its products: of both sides, or of the one in turn."""
        plan = self.plan
        one, two = (lane + 1) % 3, (lane + 2) % 3
        values: list[list[Value]] = []
        for pair, multiplier in enumerate(plan.multipliers):
            found: list[Value] = []
            for number, (a, b) in enumerate([(one, two), (two, one)][: plan.sides]):
                left = operands.seen("left", pair, a, lane)
                right = operands.seen("right", pair, b, lane)
                name = plan.unit_name(pair, lane, number)
                found += emit_multiplier(
                    m, name, multiplier, left, right, primitive=self.primitive, read=self.read
                )
            values.append(found)
        return values

    def _total(
        self,
        m: Module,
        name: str,
        lane: int,
        added: SkewedSignal,
        launch: Steps,
        last: Steps,
    ) -> None:
        """The accumulator of a total, which takes in what each step adds up."""
        plan = self.plan
        adder = Accumulator(plan.accumulators[name], inverted=launch.flag.inverted)
        m.submodules[f"{name}_{AXES[lane]}_total"] = adder
        steps, clock, near = plan.steps_of(name), adder.plan.clock, self._near(name, lane)
        final = steps[-plan.folding.axes :]
        m.d.comb += [
            adder.input.eq(self._signed(m, name, added, launch, near)),
            adder.step.eq(launch.during(steps, clock, near)),
            adder.last.eq(last.during(final, clock, near)),
            getattr(self, name)[lane].eq(adder.newest),
        ]
        if plan.folding.sides == 2:
            backward = plan.steps_where(side=1)
            m.d.comb += adder.carry.eq(launch.during(backward, clock, near))

    def _near(self, name: str, lane: int) -> str:
        """A name for a total's own flags, where others far from it do the same at the same time."""
        return f"{name}_{AXES[lane]}" if self.plan.lanes > 1 else ""

    def _signed(self, m: Module, name: str, word: SkewedSignal, launch: Steps, near: str) -> Value:
        """What a step adds, inverted where it is to be subtracted."""
        plan = self.plan
        bits = plan.accumulators[name].item.bits
        if plan.folding.sides == 1:
            return word.value[:bits]
        backward = plan.steps_where(side=1)
        pieces = []
        for lo, hi, clock in spans(lowest(word.arrival, bits)):
            piece = Signal(hi - lo, name=f"{name}_signed_{lo}", reset_less=True)
            turned = launch.during(backward, clock, near).replicate(hi - lo)
            m.d.sync += piece.eq(word.slice_at(lo, hi, clock) ^ turned)
            pieces.append(piece)
        return Cat(*pieces)


class Steps:
    """In which steps of a launch something is done, told by a flag that goes along with it."""

    def __init__(self, m: Module, flag: ControlDelay) -> None:
        self.m = m
        self.flag = flag
        self._made: dict[tuple[tuple[int, ...], int, str], Value] = {}

    def during(self, steps: list[int], clock: int, near: str = "") -> Value:
        """High in the clocks of these steps, for a thing done at `clock` in step 0.

        Each part that is named as `near` has registers of its own: one beside it, and where there
        is time one on the way.
        """
        key = tuple(steps), clock, near
        if key not in self._made:
            name = f"{self.flag.name}_{steps[0]}to{steps[-1]}_{clock}"
            spare = clock - 1 + steps[0] - self.flag.clock
            own = min(2, spare) if near else 0
            if own:
                value = self.during(steps, clock - own)
            else:
                value = Cat(self.flag.at_clock(clock - 1 + step) for step in steps).any()
            if near:
                name = f"{name}_{near}"
            if own == 2:
                value = self._held(f"{name}_on_the_way", value, apart=True)
            self._made[key] = self._held(name, value, apart=bool(near))
        return self._made[key]

    def _held(self, name: str, value: Value, *, apart: bool) -> Value:
        register = Signal(name=name, attrs=APART if apart else {})
        self.m.d.sync += register.eq(value)
        return register


class _Operands:
    """The operands where the units find them: held once, or in a long array for each pair or axis.

    Copies are marked, or synthesis would make them one.
    """

    def __init__(self, m: Module, array: CrossArray) -> None:
        self.m = m
        self.array = array
        self.plan = plan = array.plan
        # where sides take turns, what a reset left under way would move the next launch's operands
        all_cleared = plan.folding.sides == 2
        self.loads = [
            Steps(
                m,
                ControlDelay(
                    m,
                    f"load{i}",
                    array.launch,
                    -array.lead,
                    inverted=i == 2,
                    cleared=i == 0 or all_cleared,
                    apart=all_cleared,
                ),
            )
            for i in range(len(plan.pairs))
        ]
        self.places: dict[tuple[int, str], list[SkewedSignal]] = {}
        self.beside: dict[tuple[str, int, int], SkewedSignal] = {}
        if plan.spread:
            return
        for group, names in enumerate(plan.pairs if plan.copied else [tuple(plan.operands)]):
            for name in names:
                copy = sum(name == other for _, other in self.places)
                self.places[group, name] = self._places(name, self.loads[group], copy)

    def seen(self, side: str, pair: int, number: int, axis: int) -> SkewedSignal:
        """A unit's operand, from its place."""
        plan, m = self.plan, self.m
        name, group = plan.pairs[pair][side == "right"], pair if plan.copied else 0
        if plan.spread:
            return self._beside(name, number, axis)
        arrival = plan.seen[name].arrival
        word_name = f"{side}{pair}_{number}_{axis}"
        bits: list[Value] = []
        for lo, hi, clock in spans(arrival):
            piece = Signal(hi - lo, name=f"{word_name}_{lo}")
            m.d.comb += piece.eq(self._at_place(side, group, name, number, (lo, hi), clock))
            bits.append(piece)
        return SkewedSignal(m, word_name, Cat(*bits), arrival)

    def _beside(self, name: str, number: int, axis: int) -> SkewedSignal:
        """A component of an operand, in registers that stand with the units of one axis."""
        key = name, number, axis
        if key not in self.beside:
            word, arrival = self._word(name, number), self.plan.seen[name].arrival
            word_name, held = f"{word.name}_for_{AXES[axis]}", []
            for lo, hi, clock in spans(arrival):
                register = Signal(hi - lo, name=f"{word_name}_{lo}", reset_less=True, attrs=APART)
                self.m.d.sync += register.eq(word.slice_at(lo, hi, clock - 1))
                held.append(register)
            self.beside[key] = SkewedSignal(self.m, word_name, Cat(*held), arrival)
        return self.beside[key]

    def _word(self, name: str, number: int) -> SkewedSignal:
        """A component of an operand as it comes."""
        value = getattr(self.array, name)[number]
        return SkewedSignal(
            self.m, f"{name}_{AXES[number]}", value, self.plan.operands[name].arrival
        )

    def _at_place(
        self, side: str, group: int, name: str, number: int, bits: tuple[int, int], clock: int
    ) -> Value:
        """Bits of the component in a place, of the operand in turn if they take turns."""
        plan = self.plan
        if plan.folding.crosses == 1:
            return self.places[group, name][number].slice_at(*bits, clock)
        numbers = [cross[side == "right"] for cross in plan.form.crosses]
        chosen, *others = (
            self.places[group, f"{side}{i}"][number].slice_at(*bits, clock)
            for i in range(max(numbers) + 1)
        )
        for i, other in enumerate(others, start=1):
            turn = plan.steps_where(cross=numbers.index(i))
            chosen = Mux(self.loads[group].during(turn, clock), other, chosen)
        return chosen

    def _places(self, name: str, launch: Steps, copy: int) -> list[SkewedSignal]:
        """The three components of an operand, in registers that move round from step to step."""
        plan, m = self.plan, self.m
        words = [self._word(name, i) for i in range(3)]
        if not plan.held:
            return words
        side = name if plan.folding.crosses == 1 else name[:-1]
        arrival = plan.seen[side].arrival
        held: list[list[Value]] = [[], [], []]
        for lo, hi, clock in spans(arrival):
            registers = [
                Signal(
                    hi - lo,
                    name=f"held{copy}_{name}_{axis}_{lo}",
                    reset_less=True,
                    attrs=APART if plan.copied else {},
                )
                for axis in AXES
            ]
            for i, register in enumerate(registers):
                held[i].append(register)
            taken = [word.slice_at(lo, hi, clock - 1) for word in words]
            self._move(registers, taken, launch, plan.moves(name), clock - 1)
        return [
            SkewedSignal(m, f"held{copy}_{name}_{axis}", Cat(*held[i]), arrival)
            for i, axis in enumerate(AXES)
        ]

    def _move(
        self,
        registers: list[Signal],
        taken: list[Value],
        launch: Steps,
        moves: dict[int, list[int]],
        clock: int,
    ) -> None:
        """Registers take new components at a clock, and in the steps after move as is said."""
        m, load = self.m, launch.flag.at_clock(clock)
        usual, *others = moves
        when = {far: launch.during(moves[far], clock) for far in others}
        waits = when.pop(0, None)  # an enable from a register, no gate in the enable's way
        for i, register in enumerate(registers):
            moved: Value = registers[(i + usual) % 3]
            for far, now in when.items():
                moved = Mux(now, registers[(i + far) % 3], moved)
            with nullcontext() if waits is None else m.If(~waits):
                with m.If(load):
                    m.d.sync += register.eq(taken[i])
                with m.Else():
                    m.d.sync += register.eq(moved)
