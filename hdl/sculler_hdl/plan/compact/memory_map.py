"""Where a design's numbers stand in the memories of the compact core."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from sculler_hdl.plan.compact.digits import DIGIT, MemorySizes, digit_ranges
from sculler_hdl.plan.compact.instructions import Memory, MemoryWord, Number, SampleWord
from sculler_hdl.plan.compact.scrolling import (
    C_ALPHA,
    D_NU,
    FIRST_WEIGHT,
    LEFT_WEIGHTED,
    S_WEIGHT,
    WEIGHTS,
    factor_ranges,
)
from sculler_model.design import AXES, Design, Interval
from sculler_model.golden import WORD_BITS, words_per_column


class MemoryMap:
    """Places a design's numbers in memory.

    Args:
        design: the design.
        sizes: how large the memories are.

    Attributes:
        left, right: the memories of left and right operands.
        ranges: of the digit in each word.
        zero, one, unity: the words 0 and 1, and the number 1.
        A, B, theta, v: sums of samples, by axis.
        state: the accumulated components and the number of the major interval, by column.
        E, C, D, weight, factor: of high-resolution position (`scrolling`).
    """

    def __init__(self, design: Design, sizes: MemorySizes) -> None:
        self.design = design
        self.sizes = sizes
        self.words_per_column = words_per_column(design)
        self.left, self.right = Memory("left"), Memory("right")
        self.ranges: dict[MemoryWord | SampleWord, Interval] = {}
        # the results stand first, as they are streamed out
        for column in design.columns:
            for word in range(self.words_per_column):
                self.left.place(f"{column}.{word}")
        self.constants: dict[int, MemoryWord] = {}
        self.zero = self._constant(0)
        self.one = self.right.place("1", 1)
        self.unity = self.number("1", [self.one], [Interval(1, 1)])
        self._right_constants = {1: self.one}

        words = design.words
        self.A = self._vector("A", words.gyro_taps, self.left)
        self.B = self._vector("B", words.accel_taps, self.left)
        self.theta = self._vector("theta", words.theta, self.right)
        self.v = self._vector("v", words.v, self.right)
        self.state = {c: self._state(c) for c in design.columns if c != "status"}
        if design.high_resolution:
            self._place_position()

    def _place_position(self) -> None:
        words, samples = self.design.words, self.design.samples_per_major
        self.E = self._vector("E", words.gyro.scaled(FIRST_WEIGHT), self.left)
        self.weight = {
            weight: self.placed(
                weight.name,
                weight.range(samples),
                self.right if weight in LEFT_WEIGHTED else self.left,
            )
            for weight in WEIGHTS
        }
        self.factor = {
            value: self.number(
                str(value), [self.right.place(str(value), value)], [Interval(value, value)]
            )
            for value in (S_WEIGHT, -S_WEIGHT)
        }
        c, d = factor_ranges(words.gyro, words.accel, samples)
        self.C = self._factor("C", c, self.weight[C_ALPHA], self.state["alpha_x"])
        self.D = self._factor("D", d, self.weight[D_NU], self.state["nu_x"])

    def number(
        self, name: str, places: Iterable[MemoryWord | SampleWord], ranges: Sequence[Interval]
    ) -> Number:
        number = Number(name, tuple(places), tuple(ranges))
        self.ranges |= zip(number.places, number.ranges, strict=True)
        return number

    def _constant(self, value: int) -> MemoryWord:
        if value not in self.constants:
            self.constants[value] = self.left.place(str(value), value)
        return self.constants[value]

    def coefficient(self, value: int) -> Number:
        """A tap or weight as a constant."""
        digits = [value >> WORD_BITS * i for i in range(len(digit_ranges(Interval(value, value))))]
        digits[:-1] = [digit & DIGIT.hi for digit in digits[:-1]]
        places = [self._constant(digit) for digit in digits]
        return self.number(str(value), places, [Interval(digit, digit) for digit in digits])

    def right_factor(self, value: int) -> Number:
        """A constant on the right."""
        ranges = digit_ranges(Interval(value, value))
        digits = [value >> WORD_BITS * i for i in range(len(ranges))]
        digits[:-1] = [digit & DIGIT.hi for digit in digits[:-1]]
        places = [self._right_constant(digit) for digit in digits]
        return self.number(str(value), places, [Interval(digit, digit) for digit in digits])

    def _right_constant(self, value: int) -> MemoryWord:
        if value not in self._right_constants:
            self._right_constants[value] = self.right.place(str(value), value)
        return self._right_constants[value]

    @staticmethod
    def is_left(number: Number) -> bool:
        """Whether it is a left operand."""
        place = number.places[0]
        return isinstance(place, MemoryWord) and place.memory == "left"

    def placed(self, name: str, number: Interval, memory: Memory, least: int = 1) -> Number:
        """A new number, of `least` digits or more."""
        ranges = digit_ranges(number, least)
        places = [memory.place(f"{name}.{i}") for i in range(len(ranges))]
        return self.number(name, places, ranges)

    def _factor(
        self, name: str, components: Interval, weight: Number, number: Number
    ) -> list[Number]:
        """C or D, with the digits that weight * number, one of its terms, reaches."""
        digits = len(weight.places) + len(number.places) - 1
        return [self.placed(f"{name}_{axis}", components, self.left, digits) for axis in AXES]

    def _vector(self, name: str, components: Interval, memory: Memory) -> list[Number]:
        return [self.placed(f"{name}_{axis}", components, memory) for axis in AXES]

    def _state(self, column: str) -> Number:
        """An accumulated component, or the number of the major interval."""
        first = self.first_word(column)
        if column == "major":  # counts modulo 2^(16 K)
            ranges = [DIGIT] * self.words_per_column
        else:
            ranges = digit_ranges(getattr(self.design.words, column[:-2]))
        places = [MemoryWord("left", first + i) for i in range(len(ranges))]
        return self.number(column, places, ranges)

    def first_word(self, column: str) -> int:
        return self.design.columns.index(column) * self.words_per_column

    def accumulator(self, vector: str) -> list[Number]:
        return [self.state[f"{vector}_{axis}"] for axis in AXES]

    def sample(self, sensor: str, axis: int, distance: int) -> Number:
        """A count of the sample `distance` samples back; s is the gyro, r the accelerometer."""
        words = self.design.words
        counts, first = (words.gyro, 0) if sensor == "s" else (words.accel, len(AXES))
        start = (first + axis) * self.sizes.digits_per_count
        back = f"t-{distance}" if distance else "t"
        ranges = digit_ranges(counts)
        places = [SampleWord(distance, start + i) for i in range(len(ranges))]
        return self.number(f"{sensor}_{AXES[axis]}[{back}]", places, ranges)

    def samples(self, sensor: str, distance: int) -> list[Number]:
        return [self.sample(sensor, axis, distance) for axis in range(3)]
