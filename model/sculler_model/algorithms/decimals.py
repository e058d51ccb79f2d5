"""Sine, cosine and π to the precision of the current `decimal` context.

The fits work in decimals of many digits, not in doubles: the fit of a dozen taps over a low band is
far worse conditioned than doubles can bear, and the integers that come out, hence the generated
Verilog, must not depend on a machine's floating-point library.
"""

from __future__ import annotations

from decimal import Decimal, getcontext, localcontext
from fractions import Fraction
from functools import lru_cache

GUARD = 10


def exact(value: Fraction | int) -> Decimal:
    """A rational, rounded to the context."""
    value = Fraction(value)
    return Decimal(value.numerator) / Decimal(value.denominator)


@lru_cache(maxsize=4096)
def rational(value: float) -> Fraction:
    """The shortest decimal number that reads back as the float: 0.1 is one tenth."""
    return Fraction(repr(value))


def pi() -> Decimal:
    """π (Machin: 16 arctan 1/5 - 4 arctan 1/239)."""
    return +_pi(getcontext().prec)


def pi_to(digits: int) -> Fraction:
    """A rational that differs from π by less than 10^(1 - digits)."""
    return Fraction(_pi(digits))


@lru_cache(maxsize=8)
def _pi(digits: int) -> Decimal:
    with localcontext() as context:
        context.prec = digits + GUARD
        return 16 * _arctan_inverse(5) - 4 * _arctan_inverse(239)


def _arctan_inverse(x: int) -> Decimal:
    term, total, k = Decimal(1) / x, Decimal(0), 1
    tiny = Decimal(10) ** -(getcontext().prec + 2)
    while abs(term) > tiny:
        total += term / k
        term, k = -term / (x * x), k + 2
    return total


def sine_cosine(x: Decimal) -> tuple[Decimal, Decimal]:
    """sin x and cos x by their series, large x brought to half a turn first."""
    if abs(x) > 8:  # below, the series' terms stay small enough for the guard digits
        with localcontext() as context:
            context.prec += GUARD + max(x.adjusted(), 0)
            turn = 2 * pi()
            x = x - turn * (x / turn).to_integral_value()
    with localcontext() as context:
        context.prec += GUARD
        tiny = Decimal(10) ** -context.prec
        square = x * x
        sine = sine_term = x
        cosine = cosine_term = Decimal(1)
        k = 1
        while abs(cosine_term) > tiny or abs(sine_term) > tiny:
            cosine_term = -cosine_term * square / (k * (k + 1))
            sine_term = -sine_term * square / ((k + 1) * (k + 2))
            cosine, sine, k = cosine + cosine_term, sine + sine_term, k + 2
    return +sine, +cosine


def sinc(x: Decimal) -> Decimal:
    """sin x / x."""
    return sine_cosine(x)[0] / x if x else Decimal(1)


def sines(half_sine: Decimal, half_cosine: Decimal, count: int) -> list[Decimal]:
    """sin λ, sin 2λ, ..., sin count·λ, by sin (d+1)λ = 2 cos λ sin dλ - sin (d-1)λ.

    Args:
        half_sine, half_cosine: of λ/2.
        count: how many, 1 or more.
    """
    values = [Decimal(0), 2 * half_sine * half_cosine]
    twice = 2 - 4 * half_sine * half_sine  # 2 cos λ
    while len(values) <= count:
        values.append(twice * values[-1] - values[-2])
    return values[1 : count + 1]
