"""Coning/sculling coefficients as exact rationals, and the tap table they are carried in.

With ``s[t]`` the integer sample of phase ``k`` (1..n) of a minor interval, every algorithm here
forms

    A = sum over d of tap[k][d] * s[t-d]          d = 1..reach
    theta = sum over d of weight[d] * s[t-d]      d = 0..n, at the minor interval's end

and adds ``A x s[t]`` to the coning correction (docs/explanation/theory.md).  The integers stand
over the common denominators ``denominator`` (taps) and ``sum_denominator`` (weights), so nothing is
rounded.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import factorial, lcm

from sculler_model.errors import InputError

MAX_SAMPLES = 16
"""Most samples in a minor interval (n)."""

MAX_REACH = 2 * MAX_SAMPLES
"""Furthest distance back that a tap may reach, in samples."""


@dataclass(frozen=True)
class TapTable:
    """An integer coning/sculling table in lowest terms.

    Attributes:
        denominator: common denominator ``Dc`` of the taps, >= 1.
        taps: n rows, phase k = 1..n; column j is the tap of distance d = j + 1.
        sum_denominator: common denominator ``Dw`` of the weights, >= 1.
        weights: n + 1 integers, ``weights[d]`` for distance d = 0..n.
    """

    denominator: int
    taps: tuple[tuple[int, ...], ...]
    sum_denominator: int
    weights: tuple[int, ...]

    @classmethod
    def from_rationals(
        cls, taps: Sequence[Sequence[Fraction]], weights: Sequence[Fraction]
    ) -> TapTable:
        """Bring rational taps (n rows) and weights (up to n + 1) to integers in lowest terms."""
        samples, reach = len(taps), max(map(len, taps))
        padded = [[*row, *[Fraction(0)] * (reach - len(row))] for row in taps]
        denominator = lcm(*(c.denominator for row in padded for c in row), 1)
        sum_denominator = lcm(*(w.denominator for w in weights), 1)
        full_weights = [*weights, *[Fraction(0)] * (samples + 1 - len(weights))]
        return cls(
            denominator,
            tuple(tuple(int(c * denominator) for c in row) for row in padded),
            sum_denominator,
            tuple(int(w * sum_denominator) for w in full_weights),
        )

    @classmethod
    def from_integers(
        cls,
        samples: int,
        denominator: int,
        taps: Sequence[int | Sequence[int]],
        sum_denominator: int = 1,
        weights: Sequence[int] | None = None,
    ) -> TapTable:
        """A user's own table, checked and brought to lowest terms.

        Args:
            samples: n, the samples of a minor interval.
            denominator: ``Dc``, positive.
            taps: n rows (dense), or one flat row, which is the row of phase n (compressed).
            sum_denominator: ``Dw``, positive.
            weights: up to n + 1 integers; left out, every sample of the interval counts once.

        Raises:
            InputError: with every fault of the table, joined by "; ".
        """
        faults = []
        if denominator < 1:
            faults.append(f"denominator: {denominator} is not allowed, give a whole number >= 1")
        if sum_denominator < 1:
            faults.append(
                f"sum_denominator: {sum_denominator} is not allowed, give a whole number >= 1"
            )
        flat = [entry for entry in taps if isinstance(entry, int)]
        rows = [list(entry) for entry in taps if not isinstance(entry, int)]
        if flat and rows:
            faults.append("taps: numbers and rows are mixed, give one flat row or n rows")
            rows = []
        elif flat:
            rows = [*([] for _ in range(samples - 1)), flat]
        if rows and len(rows) != samples:
            faults.append(
                f"taps: {len(rows)} rows for samples = {samples}, give one row per phase 1..n"
                " (empty rows count) or one flat row for phase n"
            )
        reach = max(map(len, rows), default=0)
        if reach > MAX_REACH:
            faults.append(f"taps: a row of {reach} reaches too far back, give at most {MAX_REACH}")
        if rows and not any(any(row) for row in rows):
            faults.append("taps: every tap is zero, give at least one that is not")
        if weights is None:
            weights = [sum_denominator] * samples
        if not 1 <= len(weights) <= samples + 1:
            faults.append(
                f"weights: {len(weights)} numbers for samples = {samples}, give 1 to"
                f" {samples + 1} (distance 0..n)"
            )
        elif not any(weights):
            faults.append("weights: every weight is zero, give at least one that is not")
        if faults:
            raise InputError("; ".join(faults))
        return cls.from_rationals(
            [[Fraction(c, denominator) for c in row] for row in rows],
            [Fraction(w, sum_denominator) for w in weights],
        )

    @property
    def samples(self) -> int:
        """Samples of a minor interval, n."""
        return len(self.taps)

    @property
    def reach(self) -> int:
        """Columns of the table: the furthest distance any row may name."""
        return len(self.taps[0])

    @property
    def history(self) -> int:
        """Samples before the newest that the hardware must remember (last non-zero distance)."""
        tap = max((d for row in self.taps for d, c in enumerate(row, start=1) if c), default=0)
        weight = max((d for d, w in enumerate(self.weights) if w), default=0)
        return max(tap, weight)

    def tap(self, phase: int, distance: int) -> int:
        """Integer tap of phase 1..n and distance 1..reach."""
        return self.taps[phase - 1][distance - 1]

    @property
    def active_phases(self) -> tuple[int, ...]:
        """Phases (1..n) with a non-zero row; a compressed table has only phase n."""
        return tuple(k for k, row in enumerate(self.taps, start=1) if any(row))

    def as_json(self) -> dict[str, object]:
        """The form `sculler coefficients --json` prints and the design file's table reads."""
        return {
            "denominator": self.denominator,
            "taps": [list(row) for row in self.taps],
            "sum_denominator": self.sum_denominator,
            "weights": list(self.weights),
        }


def solve_exactly(matrix: list[list[Fraction]], right: list[Fraction]) -> list[Fraction]:
    """Solve a square rational system by Gauss-Jordan elimination, without rounding.

    In whole numbers (Bareiss 1968): what a step leaves is a multiple of the pivot before.

    Raises:
        ZeroDivisionError: the matrix is singular.
    """
    size = len(right)
    rows = [_whole([*row, value]) for row, value in zip(matrix, right, strict=True)]
    last = 1
    for col in range(size):
        pivot = next((r for r in range(col, size) if rows[r][col]), None)
        if pivot is None:
            raise ZeroDivisionError("singular system")
        rows[col], rows[pivot] = rows[pivot], rows[col]
        chosen = rows[col]
        scale = chosen[col]
        for r in range(size):
            if r != col:
                factor = rows[r][col]
                pairs = zip(rows[r], chosen, strict=True)
                rows[r] = [(scale * a - factor * b) // last for a, b in pairs]
        last = scale
    return [Fraction(row[size], row[at]) for at, row in enumerate(rows)]


def _whole(numbers: list[Fraction]) -> list[int]:
    """An equation multiplied by the least number that makes its coefficients whole."""
    scale = lcm(*(number.denominator for number in numbers))
    return [number.numerator * (scale // number.denominator) for number in numbers]


def _second_difference(j: int, power: int) -> int:
    ends: int = (j + 1) ** power + (j - 1) ** power
    return ends - 2 * int(j**power)


def _compressed(samples: int, row: list[Fraction]) -> list[list[Fraction]]:
    return [[] for _ in range(samples - 1)] + [row]


def frequency_taylor(samples: int, history: int) -> TapTable:
    """Taylor-matched coning coefficients for angle increments (Yang Eq. 11-12; Ignagni; Park).

    The coning response of the n + p increments equals the true coning integral in every power of
    frequency up to the (2(n+p)-1)-th, n + p - 1 powers in all.

    Raises:
        InputError: n + p < 2 leaves no product to form.
    """
    taps = samples + history - 1
    if taps < 1:
        raise InputError(
            "algorithm.samples + algorithm.history: 1 sample gives no cross product for"
            " frequency-taylor, give samples + history >= 2"
        )
    matrix = [
        [
            Fraction(_second_difference(j, 2 * i + 1), factorial(2 * i + 1))
            for j in range(1, taps + 1)
        ]
        for i in range(1, taps + 1)
    ]
    right = [Fraction(samples ** (2 * i + 1), 2 * factorial(2 * i + 1)) for i in range(1, taps + 1)]
    return TapTable.from_rationals(
        _compressed(samples, solve_exactly(matrix, right)), [Fraction(1)] * samples
    )


def newton_cotes(samples: int) -> list[Fraction]:
    """Closed Newton-Cotes weights over n sub-intervals, in units of one sub-interval (Zeng Eq. 15).

    They sum to n; Zeng's s_i sum to 1 and are multiplied by the interval h = n T.
    """
    points = range(samples + 1)
    matrix = [[Fraction(i**power) for i in points] for power in points]
    right = [Fraction(samples ** (power + 1), power + 1) for power in points]
    return solve_exactly(matrix, right)


def filtered_rate(samples: int, history: int = 0) -> TapTable:
    """Coning coefficients for rate samples that passed sinc(Omega T/2) (Zeng Eq. 10-26).

    Zeng's M is n; distances run 1..n, and `history` more distances extend his equations in the
    same way.  The weights integrate the interpolating polynomial through the n + 1 rate samples,
    the oldest of which is shared with the previous interval.
    """
    taps = samples + history
    matrix = [
        [Fraction(_second_difference(p, 2 * k + 1)) for p in range(1, taps + 1)]
        for k in range(1, taps + 1)
    ]
    right = [
        Fraction(_second_difference(samples, 2 * k + 3), 2 * (2 * k + 2) * (2 * k + 3))
        for k in range(1, taps + 1)
    ]
    return TapTable.from_rationals(
        _compressed(samples, solve_exactly(matrix, right)), newton_cotes(samples)
    )


CLOSED_FORMS: dict[str, Callable[[int, int], TapTable]] = {
    "frequency-taylor": frequency_taylor,
    "filtered-rate": filtered_rate,
}
"""Families computed from (samples, history)."""
