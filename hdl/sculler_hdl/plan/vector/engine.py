"""What the vector engine is built of, and the clocks of what it does.

    program ─▶ addresses ─▶ operands ─▶ products ─▶ sums ─▶ stored
                            clock 0                         clock `whole`

Clocks are counted from the one in which a step's operands are at the multipliers, unless they are
said to be counted from `start`.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

from sculler_hdl.plan.accumulator import AccumulatorPlan
from sculler_hdl.plan.adder_tree import AdderTreePlan
from sculler_hdl.plan.arrival import at_once, by_limbs, evenly, first_limb_clock, last_clock
from sculler_hdl.plan.multiplier import MultiplierPlan
from sculler_hdl.plan.vector.page import Form, Page, Place
from sculler_hdl.plan.vector.program import Program, Row, Slots
from sculler_hdl.targets import Target
from sculler_model.design import Design, Interval

TURNS = (1, 3)
"""Clocks of a slot: the axes have a lane each, or take turns in one."""

RESULTS = {
    "third.angle": "coning_third",
    "third.velocity": "sculling_third",
    "fourth.angle": "coning_fourth",
    "fourth.velocity": "sculling_fourth",
}
"""The vectors of a result, by the running sums that they are."""


BEFORE_RESULTS = 12
"""Rows that the results are told of before they come: the hand-over looks ahead."""


class Field(NamedTuple):
    """Part of a word of the program: a number of so many bits."""

    name: str
    bits: int


class VectorEnginePlan:
    """The plan of a `VectorEngine`.

    Args:
        design: of third or fourth order.
        target: whose multiplier blocks, and how long a memory takes.
        turns: clocks of a slot, one of `TURNS`.

    Attributes:
        page, program: what it does in which slot.
        lanes: multiplications in a clock.
        multiplier, product: of a lane, and the sum of its blocks and rows.
        accumulator: of a lane; its input is the product, shifted, inverted where it is subtracted.
        whole: the clock at which a task's sum is there.
        left, right, sums: what stands at each address of the memories.
    """

    def __init__(self, design: Design, target: Target, turns: int) -> None:
        if turns not in TURNS:
            raise ValueError(f"a slot takes 1 or 3 clocks, not {turns}")
        self.design, self.target, self.turns = design, target, turns
        self.lanes = 3 // turns
        self.page = page = Page(design)
        self.latency = target.memory_latency
        left, right = page.left_range, page.right_range
        self.multiplier = MultiplierPlan(
            target, left, right, at_once(left.bits), at_once(right.bits)
        )
        total = Interval.signed(page.total_range.bits)
        limb = evenly(total.bits, target.limb_bits[0])
        made = left * right
        self.product = AdderTreePlan(
            self.multiplier.addends, made if made.bits < total.bits else total, limb
        )
        widest = self.product.result.bits + (page.digit_count - 1) * page.digit_bits
        item = Interval.signed(min(total.bits, widest))
        self.signed_clock = first_limb_clock(self.product.arrival, limb)
        self.accumulator = AccumulatorPlan(
            item,
            by_limbs(item.bits, limb, self.signed_clock + 1),
            total,
            limb,
            sums=turns,
            signs=True,
            initial=True,
        )
        self.whole = last_clock(self.accumulator.arrival)
        self.left = [*page.left_loads, *self._stored(Place.LEFT, page.left_loads)]
        self.right = [*page.right_loads, *self._stored(Place.RIGHT, page.right_loads)]
        self.sums = self._stored(Place.SUM, [])
        self.program = Program(page, self._slots())

    def _stored(self, place: Place, before: list[str]) -> list[str]:
        return [
            task.target
            for task in self.page.tasks
            if place in task.places and task.target not in before
        ]

    def _slots(self) -> Slots:
        """The clocks of the engine in slots."""
        way, turns = self._way, self.turns
        # a word that is written in clock c is read in clock c + 1 at the earliest, by any axis
        ready = -(-(way + turns) // turns)
        loaded = {
            name: max(0, -(-(self.load_clock(i) + turns - self.field_clock) // turns))
            for loads in (self.page.left_loads, self.page.right_loads)
            for i, name in enumerate(loads)
        }
        return Slots(way // turns, ready, loaded)

    @property
    def _way(self) -> int:
        """Clocks from when a word of the program is there to when what its step makes is."""
        return self.latency + 1 + self.whole

    @property
    def fetched(self) -> int:
        """The clock at which a word of the program is there."""
        return -self.latency - 1

    @property
    def store_delay(self) -> int:
        """Clocks from when a word of the program is there to when it stores something."""
        return self._way % self.turns

    @property
    def field_clock(self) -> int:
        """Clocks from `start` to when the program's first word is there."""
        return 1 + self.latency

    @property
    def operand_clock(self) -> int:
        """Clocks from `start` to when the first step's operands are at the multipliers."""
        return self.field_clock + self.latency + 1

    def load_clock(self, number: int) -> int:
        """Clocks from `start` to when a vector that is loaded is written to its memory."""
        return 1 + number

    def whole_clock(self, target: str, axis: int) -> int:
        """Clocks from `start` to when a component of a task's sum is there."""
        turn = axis if self.turns == 3 else 0
        slot = self.program.ends(target)
        return self.operand_clock + slot * self.turns + turn + self.whole

    @property
    def result_row(self) -> int:
        """A row some time before the first result is stored."""
        rows = self.program.rows
        first = next(
            i for i, row in enumerate(rows) if row.stored and row.stored.target in self.sums
        )
        return max(0, first - BEFORE_RESULTS)

    @property
    def result_clock(self) -> int:
        """Clocks from `start` to when that row's word is there: not after the result."""
        return self.field_clock + self.result_row * self.turns

    @property
    def period(self) -> int:
        """Clocks from one start to the next, at least."""
        # the last vector is stored before the next one is loaded
        last = max(self.whole_clock(task.target, 2) for task in self.page.tasks)
        return max(last, len(self.program.rows) * self.turns + 1)

    @property
    def loads(self) -> dict[str, list[str]]:
        """The vectors that are loaded, by the side they are loaded to."""
        sides = {"left": self.page.left_loads, "right": self.page.right_loads}
        return {side: names for side, names in sides.items() if names}

    def load_bits(self, side: str) -> int:
        """Of the words that are loaded to a side."""
        return max(self.page.ranges[name].bits for name in self.loads[side])

    @property
    def has_samples(self) -> bool:
        """Whether samples themselves are multiplied."""
        return any(
            step.left.startswith("sample") for task in self.page.tasks for step in task.steps
        )

    @property
    def block_count(self) -> int:
        """Multiplier blocks."""
        return self.multiplier.block_count * self.lanes

    @property
    def block_groups(self) -> list[list[str]]:
        """Names of the blocks' submodules, a group for each lane."""
        names = self.multiplier.block_names("unit")
        return [[f"lane{lane}.{name}" for name in names] for lane in range(self.lanes)]

    @property
    def sample_words(self) -> int:
        """Words of the memory of samples, for each axis: of two minor intervals and sensors."""
        return 4 * self.phases

    @property
    def phases(self) -> int:
        """Phases that the address of a sample has room for."""
        return 1 << (self.design.algorithm.samples - 1).bit_length()

    @cached_property
    def fields(self) -> list[Field]:
        """Of a word of the program, lowest first."""
        left = max(len(self.left), 2 * self.phases, 2)
        right = max(len(self.right), len(self.page.constants), 2)
        stored = max(len(self.left), len(self.right), 2)
        bits = {
            "left": (left - 1).bit_length(),
            "sample": int(self.has_samples),
            "old": 1,
            "right": (right - 1).bit_length(),
            "constant": 1,
            "form": 2,
            "subtract": 1,
            "digit": (self.page.digit_count - 1).bit_length(),
            "step": 1,
            "last": 1,
            "grows": 1,
            "sum": (max(len(self.sums), 2) - 1).bit_length(),
            "store_left": 1,
            "store_right": 1,
            "store_sum": 1,
            "store": (stored - 1).bit_length(),
            "store_sum_at": (max(len(self.sums), 2) - 1).bit_length(),
            "store_digit": self.page.digit_count.bit_length() * (self.page.digit_count > 1),
            "result": 1,
        }
        return [Field(name, count) for name, count in bits.items() if count]

    @cached_property
    def words(self) -> list[int]:
        """The program's words."""
        packed, result_row = [], self.result_row
        for number, row in enumerate(self.program.rows):
            values = self._step_fields(row) | self._store_fields(row)
            values["result"] = int(number == result_row)
            word = shift = 0
            for name, bits in self.fields:
                value = values.get(name, 0)
                if value >> bits:
                    raise ValueError(f"{name}: {value} does not fit {bits} bits")
                word |= value << shift
                shift += bits
            packed.append(word)
        return packed

    def _step_fields(self, row: Row) -> dict[str, int]:
        step, task = row.step, row.task
        if step is None or task is None:
            return {}
        sample, constant = step.left.startswith("sample"), isinstance(step.right, int)
        found = {
            "sample": int(sample),
            "old": int(step.old),
            "constant": int(constant),
            "form": step.form.value,
            "subtract": int(step.subtract),
            "digit": step.digit,
            "step": 1,
            "last": int(row.last),
            "grows": int(row.first and task.grows),
            "left": self._sample_address(step.left) if sample else self.left.index(step.left),
        }
        if isinstance(step.right, int):
            found["right"] = self.page.constants.index(step.right)
        else:
            assert step.form is not Form.STRAIGHT
            found["right"] = self.right.index(step.right)
        if found["grows"]:
            found["sum"] = self.sums.index(task.target)
        return found

    def _sample_address(self, name: str) -> int:
        """Phase, then sensor."""
        letter, half = name.split(".")
        distance = int(letter.removeprefix("sample"))
        phase = self.design.algorithm.samples - 1 - distance
        return phase + (self.phases if half == "velocity" else 0)

    def _store_fields(self, row: Row) -> dict[str, int]:
        task = row.stored
        if task is None:
            return {}
        found: dict[str, int] = {}
        for place, memory in ((Place.LEFT, self.left), (Place.RIGHT, self.right)):
            if place in task.places:
                found[f"store_{place.name.lower()}"] = 1
                found["store"] = memory.index(task.target)
        if Place.SUM in task.places:
            found |= {"store_sum": 1, "store_sum_at": self.sums.index(task.target)}
        if task.digit is not None:
            found["store_digit"] = task.digit + 1
        return found
