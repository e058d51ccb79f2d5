"""What a sensor's filter does to the samples: F(Ω), as a function of the phase λ = Ω T.

Coning sees the power |F|² alone, since both gyro axes pass the same filter (Zeng Eq. 8).  Each
stage gives it in decimals, for fits, and as an exact power series in λ², for Taylor matching; the
complex value in floats is for analysis.  Every stage is normalised to F(0) = 1 (Zeng Eq. 1).
"""

from __future__ import annotations

import cmath
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from functools import reduce
from itertools import pairwise
from math import pi, radians, sin
from typing import Protocol

from sculler_model.algorithms.decimals import exact, sinc, sine_cosine
from sculler_model.algorithms.decimals import pi as decimal_pi
from sculler_model.algorithms.series import (
    Series,
    autocorrelation,
    cosine_sum,
    divide,
    multiply,
    sine,
)
from sculler_model.errors import InputError


class Stage(Protocol):
    """One filter."""

    def value(self, phase: float) -> complex:
        """F at phase λ (rad per sample interval)."""
        ...

    @property
    def delay(self) -> float:
        """Sample intervals by which slow motion comes out late."""
        ...

    def power(self, phase: Decimal) -> Decimal:
        """|F|² at phase λ."""
        ...

    def power_series(self, length: int) -> Series:
        """|F|² in powers of λ².

        Raises:
            InputError: there is no such series.
        """
        ...


@dataclass(frozen=True)
class Sinc:
    """A mean over `width` sample intervals, `order` times over: sinc(width λ/2)^order.

    The mean is taken as centred: it delays nothing.
    """

    width: Fraction = Fraction(1)
    order: int = 1

    def value(self, phase: float) -> complex:
        """F at λ."""
        x = float(self.width) * phase / 2
        return complex((sin(x) / x if x else 1.0) ** self.order)

    @property
    def delay(self) -> float:
        """None: the mean is centred."""
        return 0.0

    def power(self, phase: Decimal) -> Decimal:
        """|F|² at λ."""
        return sinc(exact(self.width) * phase / 2) ** (2 * self.order)

    def power_series(self, length: int) -> Series:
        """|F|² in λ²."""
        half = self.width / 2
        once = [entry / half for entry in sine(half, length)]
        return reduce(multiply, [once] * (2 * self.order))


@dataclass(frozen=True)
class Digital:
    """H(z) = Σ b_k z^-k / Σ a_k z^-k, clocked `1/step` times a sample interval.

    Raises:
        InputError: no numerator or denominator, a_0 = 0, no gain at zero frequency, or unstable.
    """

    numerator: tuple[Fraction, ...]
    denominator: tuple[Fraction, ...] = (Fraction(1),)
    step: Fraction = Fraction(1)

    def __post_init__(self) -> None:
        _check_polynomials(self.numerator, self.denominator)
        if not sum(self.denominator) or not sum(self.numerator):
            raise InputError(
                "the digital filter passes nothing, or everything, at zero frequency: its"
                " coefficients must not sum to 0"
            )
        if not _roots_inside(self.denominator):
            raise InputError("the digital filter is unstable: a pole on or outside the unit circle")

    def value(self, phase: float) -> complex:
        """F at λ."""
        back = cmath.exp(-1j * float(self.step) * phase)
        top, bottom = (
            sum(float(c) * back**k for k, c in enumerate(part)) / float(sum(part))
            for part in (self.numerator, self.denominator)
        )
        return top / bottom

    @property
    def delay(self) -> float:
        """Mean distance back of the numerator's taps, less that of the denominator's."""
        top, bottom = (
            sum((k * c for k, c in enumerate(part)), Fraction(0)) / sum(part)
            for part in (self.numerator, self.denominator)
        )
        return float((top - bottom) * self.step)

    def power(self, phase: Decimal) -> Decimal:
        """|F|² at λ."""
        _, cosine = sine_cosine(exact(self.step) * phase)

        def part(b: Sequence[Fraction]) -> Decimal:
            cosines = [Decimal(1), cosine]
            while len(cosines) < len(b):
                cosines.append(2 * cosine * cosines[-1] - cosines[-2])
            terms = zip(autocorrelation(b), cosines, strict=False)
            total = sum((exact(c) * x for c, x in terms), Decimal(0))
            return (2 * total - exact(sum((x * x for x in b), Fraction(0)))) / exact(sum(b)) ** 2

        return part(self.numerator) / part(self.denominator)

    def power_series(self, length: int) -> Series:
        """|F|² in λ²."""
        top, bottom = (
            [entry / sum(b) ** 2 for entry in cosine_sum(autocorrelation(b), self.step, length)]
            for b in (self.numerator, self.denominator)
        )
        return divide(top, bottom)


@dataclass(frozen=True)
class Analogue:
    """H(s) = Σ b_k s^(m-k) / Σ a_k s^(l-k), highest power first, s in 1/s.

    Attributes:
        numerator, denominator: coefficients.
        sample_rate: 1/T, Hz.

    Raises:
        InputError: no numerator or denominator, no gain at zero frequency, or unstable.
    """

    numerator: tuple[Fraction, ...]
    denominator: tuple[Fraction, ...]
    sample_rate: Fraction
    _powers: tuple[Series, Series] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        _check_polynomials(self.numerator, self.denominator)
        if not self.numerator[-1] or not self.denominator[-1]:
            raise InputError(
                "the analogue filter passes nothing, or everything, at zero frequency: its last"
                " coefficients must not be 0"
            )
        scaled = self._scaled(self.denominator)
        # s = (1 - 1/z)/(1 + 1/z) takes the left half plane to the inside of the unit circle
        order = len(scaled) - 1
        mapped = [Fraction(0)] * (order + 1)
        for k, c in enumerate(scaled):
            for i, entry in enumerate(_binomials(k, order - k)):
                mapped[i] += c * entry
        if not mapped[0] or not _roots_inside(tuple(mapped)):
            raise InputError("the analogue filter is unstable: a pole with a real part >= 0")
        powers = self._power(self.numerator), self._power(self.denominator)
        object.__setattr__(self, "_powers", powers)

    def _scaled(self, polynomial: Sequence[Fraction]) -> list[Fraction]:
        """Coefficients of (s T)^k, k = 0.., over the constant one."""
        rising = list(reversed(polynomial))
        return [c * self.sample_rate**k / rising[0] for k, c in enumerate(rising)]

    def _power(self, polynomial: Sequence[Fraction]) -> Series:
        """|N(iλ)|² in powers of λ²."""
        c = self._scaled(polynomial)
        power = [Fraction(0)] * len(c)
        for j, left in enumerate(c):
            for k, right in enumerate(c):
                if (j + k) % 2 == 0:
                    power[(j + k) // 2] += (-1) ** (abs(j - k) // 2) * left * right
        return power

    def value(self, phase: float) -> complex:
        """F at λ."""
        top, bottom = (
            sum(float(c) * (1j * phase) ** k for k, c in enumerate(self._scaled(part)))
            for part in (self.numerator, self.denominator)
        )
        return complex(top / bottom)

    @property
    def delay(self) -> float:
        """The denominator's share of s, less the numerator's."""
        top, bottom = (
            self._scaled(part)[1] if len(part) > 1 else Fraction(0)
            for part in (self.numerator, self.denominator)
        )
        return float(bottom - top)

    def power(self, phase: Decimal) -> Decimal:
        """|F|² at λ."""
        square = phase * phase
        top, bottom = (
            reduce(lambda total, c: total * square + exact(c), reversed(part), Decimal(0))
            for part in self._powers
        )
        return top / bottom

    def power_series(self, length: int) -> Series:
        """|F|² in λ²."""
        top, bottom = ((part + [Fraction(0)] * length)[:length] for part in self._powers)
        return divide(top, bottom)


@dataclass(frozen=True)
class Measured:
    """A measured response, joined by straight lines over frequency.

    Below the first point it is as at the first; above the last one it is not known.

    Attributes:
        frequencies: Hz, rising.
        gains: |F|, relative to zero frequency.
        degrees: phase of F, deg, zero if it was not measured.
        sample_rate: 1/T, Hz.
    """

    frequencies: tuple[Fraction, ...]
    gains: tuple[Fraction, ...]
    degrees: tuple[Fraction, ...]
    sample_rate: Fraction

    def __post_init__(self) -> None:
        if len(self.frequencies) < 2:
            raise InputError("a measured response needs two points or more")
        for before, after in pairwise(self.frequencies):
            if not 0 <= before < after:
                raise InputError(
                    f"the measured response's frequencies must rise from 0 or above, but"
                    f" {float(after):g} Hz follows {float(before):g} Hz"
                )
        for frequency, gain in zip(self.frequencies, self.gains, strict=True):
            if gain < 0:
                raise InputError(
                    f"the measured response's gain at {float(frequency):g} Hz is"
                    f" {float(gain):g}, give 0 or more"
                )

    def value(self, phase: float) -> complex:
        """F at λ; NaN above the last frequency."""
        hertz = phase * float(self.sample_rate) / (2 * pi)
        if hertz > self.frequencies[-1]:
            return complex("nan")
        at = [float(f) for f in self.frequencies]
        upper = min(max(bisect_right(at, hertz), 1), len(at) - 1)
        share = min(max((hertz - at[upper - 1]) / (at[upper] - at[upper - 1]), 0.0), 1.0)
        gain, angle = (
            float(values[upper - 1]) * (1 - share) + float(values[upper]) * share
            for values in (self.gains, self.degrees)
        )
        return cmath.rect(gain, radians(angle))

    @property
    def delay(self) -> float:
        """By the phase at the first frequency above 0."""
        first = int(self.frequencies[0] == 0)
        turns = -self.degrees[first] / 360
        return float(turns * self.sample_rate / self.frequencies[first])

    def power(self, phase: Decimal) -> Decimal:
        """|F|² at λ."""
        hertz = Fraction(phase * exact(self.sample_rate) / (2 * decimal_pi()))
        last = self.frequencies[-1]
        if hertz > last:
            raise InputError(
                f"algorithm.band: the measured response ends at {float(last):g} Hz, inside the"
                " band; give a lower band or more points"
            )
        upper = min(max(bisect_right(self.frequencies, hertz), 1), len(self.frequencies) - 1)
        low, high = self.frequencies[upper - 1], self.frequencies[upper]
        share = max((hertz - low) / (high - low), Fraction(0))
        return exact(self.gains[upper - 1] * (1 - share) + self.gains[upper] * share) ** 2

    def power_series(self, length: int) -> Series:
        """There is none.

        Raises:
            InputError: always.
        """
        raise InputError(
            "sensor.filter: a measured response has no power series, so only"
            ' match = "least-squares" with a band can use it, and uncompressed cannot'
        )


@dataclass(frozen=True)
class Response:
    """Stages one after another; no stage at all is F = 1."""

    stages: tuple[Stage, ...] = ()

    def value(self, phase: float) -> complex:
        """F at phase λ."""
        return reduce(lambda total, stage: total * stage.value(phase), self.stages, 1 + 0j)

    @property
    def delay(self) -> float:
        """Sample intervals by which slow motion comes out late: -d arg F/dλ at zero frequency."""
        return sum(stage.delay for stage in self.stages)

    def power(self, phase: Decimal) -> Decimal:
        """|F|² at phase λ, in the current decimal context."""
        return reduce(lambda total, stage: total * stage.power(phase), self.stages, Decimal(1))

    def power_series(self, length: int) -> Series:
        """|F|² in powers of λ², exact.

        Raises:
            InputError: a measured stage has none.
        """
        one = [Fraction(1)] + [Fraction(0)] * (length - 1)
        return reduce(multiply, [stage.power_series(length) for stage in self.stages], one)

    def inverse_power_series(self, length: int) -> Series:
        """1/|F|² in powers of λ², exact."""
        one = [Fraction(1)] + [Fraction(0)] * (length - 1)
        return divide(one, self.power_series(length))


def _check_polynomials(numerator: Sequence[Fraction], denominator: Sequence[Fraction]) -> None:
    if not numerator or not denominator:
        raise InputError("the filter needs a numerator and a denominator of one number or more")
    if not denominator[0]:
        raise InputError("the denominator begins with 0, leave that out")


def _roots_inside(a: tuple[Fraction, ...]) -> bool:
    """Whether Σ a_k z^-k has all its roots inside the unit circle (Schur-Cohn)."""
    c = list(a)
    while len(c) > 1:
        reflection = c[-1] / c[0]
        if abs(reflection) >= 1:
            return False
        c = [x - reflection * y for x, y in zip(c, reversed(c), strict=True)][:-1]
    return True


def _binomials(minus: int, plus: int) -> list[Fraction]:
    """Coefficients of (1 - x)^minus (1 + x)^plus."""
    c = [Fraction(1)]
    for sign in [-1] * minus + [1] * plus:
        c = [
            low + sign * high
            for low, high in zip([*c, Fraction(0)], [Fraction(0), *c], strict=True)
        ]
    return c
