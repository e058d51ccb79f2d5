"""The balance of coning behind a filter: what the products give, what is needed, what is left.

Coning (or sculling) of frequency Ω, λ = Ω T, with both amplitudes 1, over one minor interval of n
samples that passed F (docs/explanation/families.md Eq. 8-11):

    residual(λ) = |F|² (σ Σ_d K_d sin dλ + β) - ½ nλ                                        (B1)

with K_d the table's sums over distance d, σ the power of one unfiltered sample and β what the sums
θ bring in between intervals: for increments

    σ = 4 sin²(λ/2),   β = ½ sin nλ.

A rate sample (rad/s, times T) has σ = λ².  Its sum is formed with weights, and `Sum` says which,
and what for:

    "zeng"          closed Newton-Cotes weights, taken as if they gave the integral of the filtered
                    rate (Zeng Eq. 15-17): β = ½ sin nλ
    "newton-cotes"  the same weights with the error that they really make: β = ¼ |W|² λ² cot(nλ/2),
                    W = Σ_d w_d e^(-idλ)
    "plain"         every sample counts once: β = ½ sin nλ / sinc²(λ/2)
"""

from __future__ import annotations

from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from typing import Literal

from sculler_model.algorithms.decimals import exact, sine_cosine, sines
from sculler_model.algorithms.response import Response
from sculler_model.algorithms.series import (
    Series,
    autocorrelation,
    cosine,
    cosine_sum,
    divide,
    multiply,
    sine,
)
from sculler_model.algorithms.tap_table import newton_cotes, solve_exactly

SensorKind = Literal["increment", "rate"]
Sum = Literal["zeng", "newton-cotes", "plain"]


@dataclass(frozen=True)
class Balance:
    """(B1) for a sensor: everything but the taps.

    Attributes:
        samples: n.
        kind: what the samples are.
        sum: how a rate sensor's sum is formed; increments are always "plain".
        response: F.
    """

    samples: int
    kind: SensorKind = "increment"
    sum: Sum = "plain"
    response: Response = field(default_factory=Response)

    @property
    def weights(self) -> list[Fraction]:
        """Weights of θ, distance 0, 1, ..."""
        if self.kind == "rate" and self.sum != "plain":
            return newton_cotes(self.samples)
        return [Fraction(1)] * self.samples

    def distances(self, history: int) -> int:
        """Taps that can be matched: n + p - 1, and one more where a rate's sum reaches t - n."""
        return self.samples + history - (self.kind == "increment")

    def taylor(self, count: int) -> list[Fraction]:
        """K_1..K_count that match the powers λ³, λ⁵, ... of (B1) one after another, exact.

        With (B1) divided by σ|F|², the sum Σ K_d sin dλ equals (½ nλ/|F|² - β)/σ in its first
        `count` powers.

        Raises:
            InputError: the response has no power series.
        """
        length = count + 1
        inverse = self.response.inverse_power_series(length)
        needed = [
            Fraction(self.samples, 2) * f - b
            for f, b in zip(inverse, self._between_series(length), strict=True)
        ]  # entry i of λ^(2i+1); the first is 0, and σ begins with λ²
        right = divide(needed[1:], self._sample_series(length)[:-1])
        matrix = [[sine(d, i + 1)[i] for d in range(1, count + 1)] for i in range(count)]
        return solve_exactly(matrix, right)

    def _sample_series(self, length: int) -> Series:
        """σ/λ²."""
        if self.kind == "rate":
            return [Fraction(1)] + [Fraction(0)] * (length - 1)
        return [-2 * entry for entry in cosine(1, length + 1)[1:]]

    def _between_series(self, length: int) -> Series:
        """β/λ."""
        half_sine = [entry / 2 for entry in sine(self.samples, length)]
        if self.kind == "increment" or self.sum == "zeng":
            return half_sine
        if self.sum == "plain":
            half = [2 * entry for entry in sine(Fraction(1, 2), length)]
            return divide(half_sine, multiply(half, half))
        n = Fraction(self.samples)
        power = cosine_sum(autocorrelation(self.weights), Fraction(1), length)
        cotangent = divide(cosine(n / 2, length), sine(n / 2, length))  # times λ
        return [entry / 4 for entry in multiply(power, cotangent)]

    def terms(self, phase: Decimal, count: int) -> tuple[list[Decimal], Decimal]:
        """|F|² σ sin dλ for d = 1..count, and ½ nλ - |F|² β: (B1) is their balance.

        Args:
            phase: λ > 0.
            count: how many distances.
        """
        power = self.response.power(phase)
        half_sine, half_cosine = sine_cosine(phase / 2)
        multiples = sines(half_sine, half_cosine, max(count, self.samples))
        sample = phase * phase if self.kind == "rate" else 4 * half_sine * half_sine
        total_sine = multiples[self.samples - 1]
        if self.kind == "increment" or self.sum == "zeng":
            between = total_sine / 2
        elif self.sum == "plain":
            between = total_sine / 2 * (phase / (2 * half_sine)) ** 2
        else:
            s, c = sine_cosine(self.samples * phase / 2)
            between = self._weight_power(phase) * phase * phase * c / s / 4
        scale = power * sample
        return (
            [scale * value for value in multiples[:count]],
            self.samples * phase / 2 - power * between,
        )

    def _weight_power(self, phase: Decimal) -> Decimal:
        """|W|²."""
        c = autocorrelation(self.weights)
        total = exact(c[0])
        for k, entry in enumerate(c[1:], start=1):
            total += 2 * exact(entry) * sine_cosine(k * phase)[1]
        return total
