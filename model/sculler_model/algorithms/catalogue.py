"""All families behind one door: a `Recipe` says what is wanted, `make` designs it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import lru_cache
from typing import Literal

from sculler_model.algorithms.balance import Balance, SensorKind, Sum
from sculler_model.algorithms.band import Band
from sculler_model.algorithms.least_squares import DENOMINATOR_BITS, Fit, fit
from sculler_model.algorithms.pairs import distance_sums
from sculler_model.algorithms.response import Response, Sinc
from sculler_model.algorithms.tap_table import CLOSED_FORMS, TapTable
from sculler_model.algorithms.time_taylor import time_taylor
from sculler_model.algorithms.tuned import matched, matched_and_rounded
from sculler_model.algorithms.uncompressed import Uncompressed, uncompress, uncompressed
from sculler_model.errors import InputError

Match = Literal["taylor", "least-squares"]

TABLES: dict[str, Callable[[int, int], TapTable]] = {
    **CLOSED_FORMS,
    "time-taylor": time_taylor,
    "uncompressed": uncompressed,
}
"""Families that (samples, history) describe in full."""

FAMILIES = (*TABLES, "least-squares", "tuned")
"""Every family that is computed."""

SENSOR_KINDS: dict[str, tuple[SensorKind, ...]] = {
    **dict.fromkeys(FAMILIES, ("increment",)),
    "filtered-rate": ("rate",),
    "tuned": ("increment", "rate"),
}
"""What a family takes its samples to be."""

BASES = ("frequency-taylor", "least-squares", "tuned")
"""Compressed families that `uncompressed` can start from."""


_NONE, _ZENG = Response(), Response((Sinc(),))


@dataclass(frozen=True)
class Recipe:
    """Everything a family is designed from.

    Attributes:
        family: one of `FAMILIES`.
        samples, history: n and p.
        kind: the sensor's samples.
        sample_rate: Hz.
        base: what `uncompressed` starts from, one of `BASES`.
        match: how `tuned` is matched.
        sum: how a rate sensor's sum is formed (`tuned`).
        response: the sensor's filter (`tuned`).
        band: band and weight (`least-squares`, and `tuned` so matched).
        denominator_bits: rounded taps stand over 2^this; None: exact, or 24 where they are fitted.
        constrained: whether a fit keeps slow motion exact.
    """

    family: str
    samples: int
    history: int = 0
    kind: SensorKind = "increment"
    sample_rate: Fraction = Fraction(1)
    base: str = "frequency-taylor"
    match: Match = "taylor"
    sum: Sum = "plain"
    response: Response = field(default_factory=Response)
    band: Band | None = None
    denominator_bits: int | None = None
    constrained: bool = True


@dataclass(frozen=True)
class Made:
    """A designed table, and how it was come by.

    Attributes:
        table: the tap table.
        balance: the sensor it is for.
        fit: of a table with rounded taps.
        uncompressed: of an uncompressed one.
    """

    table: TapTable
    balance: Balance
    fit: Fit | None = None
    uncompressed: Uncompressed | None = None

    def report(self) -> list[str]:
        """What rounding cost and which manoeuvre terms are left, a sentence each."""
        lines = []
        if self.fit is not None:
            f = self.fit
            if f.slow is not None:
                total = str(f.slow) if f.slow.denominator < 10**6 else f"{float(f.slow):.12g}"
                lines.append(
                    f"Slow motion is held: the sum of d K_d is {total}"
                    + ("." if not f.missed else f", but for {float(f.missed):.2g} by rounding.")
                )
            lines.append(
                f"Rounded to 1/{f.denominator}: weighted rms residual {f.rms_real:.4g}"
                f" before, {f.rms_rounded:.4g} after ({f.rms_nearest:.4g} by nearest integers);"
                f" largest {f.worst_real:.4g} before, {f.worst_rounded:.4g} after, at"
                f" {f.worst_hz:.4g} Hz (rad per minor interval, unit amplitudes)."
            )
        if self.uncompressed is not None:
            u = self.uncompressed
            left = ", ".join(f"{_term(*term)}: {error}" for term, error in u.left.items())
            also = [_term(*term) for term in u.vanishing if sum(term) == u.order]
            lines.append(
                "Manoeuvres ω = Σ g_a τ^a: "
                + (
                    f"every term g_a × g_b with a + b < {u.order} vanishes"
                    if u.order > 1
                    else "no order vanishes whole"
                )
                + (f", and {', '.join(also)}" if also else "")
                + f"; left per minor interval (τ in samples): {left}."
            )
        if self.balance.sum == "zeng":
            lines.append(
                "The sum's Newton-Cotes weights are taken to give the integral, as Zeng takes them;"
                ' tuned with sum = "plain" needs no weights and leaves far less drift.'
            )
        return lines


def _term(a: int, b: int) -> str:
    return f"g{a}×g{b}"


@lru_cache(maxsize=1024)
def make(recipe: Recipe) -> Made:
    """Design the table of a recipe.

    Raises:
        InputError: one line, naming the key of the design file that is at fault.
    """
    _check(recipe)
    n, p = recipe.samples, recipe.history
    compressed = recipe.base if recipe.family == "uncompressed" else recipe.family
    if compressed in TABLES and recipe.sample_rate != 1:  # the same table at every rate
        return make(replace(recipe, sample_rate=Fraction(1)))
    made = _compressed(recipe, compressed)
    if recipe.family != "uncompressed":
        return made
    inverse = None
    if compressed == "tuned":
        inverse = recipe.response.inverse_power_series(n + p + 3)
    spread = uncompress(distance_sums(made.table), n, p, inverse)
    return Made(spread.table, made.balance, made.fit, spread)


def _compressed(recipe: Recipe, family: str) -> Made:
    """The table before it is uncompressed."""
    n, p = recipe.samples, recipe.history
    if family in TABLES:
        rate = family == "filtered-rate"
        balance = Balance(
            n,
            "rate" if rate else "increment",
            "zeng" if rate else "plain",
            _ZENG if rate else _NONE,
        )
        return Made(TABLES[family](n, p), balance)
    bits = recipe.denominator_bits
    if family == "least-squares":
        balance = Balance(n)
    else:
        balance = Balance(n, recipe.kind, recipe.sum, recipe.response)
        if recipe.match == "taylor" and bits is None:
            return Made(matched(balance, p), balance)
    if family == "tuned" and recipe.match == "taylor":
        result = matched_and_rounded(balance, p, recipe.sample_rate, bits or DENOMINATOR_BITS)
    else:
        assert recipe.band is not None  # by _check
        result = fit(
            balance,
            p,
            recipe.band,
            recipe.sample_rate,
            bits or DENOMINATOR_BITS,
            recipe.constrained,
        )
    return Made(result.table(balance), balance, result)


def _check(recipe: Recipe) -> None:
    """Faults that one key alone does not show.

    Raises:
        InputError: the first.
    """
    kinds = SENSOR_KINDS[recipe.family]
    if recipe.kind not in kinds:
        raise InputError(
            f'family = "{recipe.family}" is for sensor.kind = "{kinds[0]}", but it is'
            f' "{recipe.kind}"; change one of them'
        )
    base = recipe.base if recipe.family == "uncompressed" else recipe.family
    fitted = base == "least-squares" or (base == "tuned" and recipe.match == "least-squares")
    if fitted and recipe.band is None:
        raise InputError("algorithm.band: missing, a least-squares fit needs a band of frequencies")
    if recipe.band is not None and recipe.band.high_hz > recipe.sample_rate / 2:
        raise InputError(
            f"algorithm.band: reaches to {float(recipe.band.high_hz):g} Hz, above the Nyquist limit"
            f" of {float(recipe.sample_rate / 2):g} Hz; give high_hz up to that"
        )
