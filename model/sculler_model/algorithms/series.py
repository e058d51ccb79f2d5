"""Truncated power series in λ² with exact rational coefficients.

An even function of λ is the list of its coefficients of λ⁰, λ², λ⁴, ...; an odd one is λ times
such a list.  All lists of one computation have the same length.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import factorial

Series = list[Fraction]


def sine(d: int | Fraction, length: int) -> Series:
    """sin(dλ)/λ."""
    return [
        Fraction((-1) ** i, factorial(2 * i + 1)) * Fraction(d) ** (2 * i + 1)
        for i in range(length)
    ]


def cosine(d: int | Fraction, length: int) -> Series:
    """cos(dλ)."""
    return [Fraction((-1) ** i, factorial(2 * i)) * Fraction(d) ** (2 * i) for i in range(length)]


def cosine_sum(coefficients: Sequence[Fraction], step: Fraction, length: int) -> Series:
    """c_0 + 2 Σ_k c_k cos(k step λ), the power |Σ b_k e^(-ikx)|² of an autocorrelation c."""
    total = [Fraction(0)] * length
    for k, c in enumerate(coefficients):
        for i, entry in enumerate(cosine(k * step, length)):
            total[i] += (2 if k else 1) * c * entry
    return total


def autocorrelation(b: Sequence[Fraction]) -> list[Fraction]:
    """c_k = Σ_j b_j b_(j+k), k = 0..len(b)-1."""
    return [
        sum((x * y for x, y in zip(b, b[k:], strict=False)), Fraction(0)) for k in range(len(b))
    ]


def multiply(a: Series, b: Series) -> Series:
    """a·b."""
    return [sum((a[j] * b[i - j] for j in range(i + 1)), Fraction(0)) for i in range(len(a))]


def divide(a: Series, b: Series) -> Series:
    """a/b.

    Raises:
        ZeroDivisionError: b vanishes at λ = 0.
    """
    quotient: Series = []
    for i in range(len(a)):
        known = sum((quotient[j] * b[i - j] for j in range(i)), Fraction(0))
        quotient.append((a[i] - known) / b[0])
    return quotient
