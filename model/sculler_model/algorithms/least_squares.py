"""`least-squares`: the residual's weighted mean square over a band made least (Savage-20 method 3).

A fit is as good as it can be in its band, and nowhere exact.  What it leaves of the first power of
the frequency, λ³, is what a manoeuvre feels: a rate that changes evenly.  So by default that power
is matched exactly (`slow_motion`), before rounding and after.

The fit is done in decimals of as many digits as its conditioning asks for, and rounded to integers
over a power of two by a lattice search, so that the generated hardware is the same on any machine.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction

from sculler_model.algorithms.balance import Balance
from sculler_model.algorithms.band import Band
from sculler_model.algorithms.decimals import exact, pi
from sculler_model.algorithms.lattice import Matrix, closest_integers, nearest
from sculler_model.algorithms.response import Response
from sculler_model.algorithms.tap_table import TapTable
from sculler_model.errors import InputError

MAX_TAPS = 16
"""Most taps that are fitted."""

DENOMINATOR_BITS = 24
"""Denominator of rounded taps where the user names none: 2^24."""

LEAST_RESPONSE = Decimal("0.01")
"""Where the filter passes less than this, the samples tell too little to correct with."""

ROUNDING_SHARE = Decimal("0.01")
"""Share of the fit's own mean square that one unit of every tap is made to cost at least."""

FURTHEST_MOVE = Decimal(2) ** -4
"""How far rounding may move a tap, so that noise and what lies outside the band stay as fitted."""

FURTHEST_UNITS = 8
"""How many units it may move one at least, where units are coarse."""

LARGEST_FACTOR = 1 << 8
"""By how much the denominator may grow so that the constraint is kept exactly."""

# Three-point Gauss-Legendre on panels of the band
_NODES = (Fraction(5, 18), Fraction(8, 18), Fraction(5, 18))


@dataclass(frozen=True)
class Fit:
    """A fitted row of phase n, before and after rounding.

    The residual is `balance` (B1): rad per minor interval for unit coning amplitudes.

    Attributes:
        reals: K_d, d = 1.., as fitted.
        integers: the same over `denominator`.
        denominator: 2^denominator_bits, times the factor that the constraint asks for.
        slow: Σ d K_d that was asked for, so that slow motion is exact; None for a free fit.
        rms_real, rms_rounded, rms_nearest: weighted root mean square residual over the band, as
            fitted, as rounded, and as nearest integers would leave it.
        worst_real, worst_rounded: largest |residual| in the band.
        worst_hz: the frequency of `worst_rounded`.
    """

    reals: tuple[Decimal, ...]
    integers: tuple[int, ...]
    denominator: int
    slow: Fraction | None
    rms_real: float
    rms_rounded: float
    rms_nearest: float
    worst_real: float
    worst_rounded: float
    worst_hz: float

    @property
    def loss(self) -> float:
        """What rounding costs: weighted rms residual after over before, minus 1."""
        return self.rms_rounded / self.rms_real - 1 if self.rms_real else 0.0

    @property
    def sums(self) -> list[Fraction]:
        """The rounded K_d."""
        return [Fraction(k, self.denominator) for k in self.integers]

    @property
    def missed(self) -> Fraction:
        """By how much the rounded Σ d K_d is off `slow`; 0 for a free fit."""
        if self.slow is None:
            return Fraction(0)
        return sum(d * k for d, k in enumerate(self.sums, start=1)) - self.slow

    def table(self, balance: Balance) -> TapTable:
        """The compressed table: these taps in row n."""
        rows: list[list[Fraction]] = [[] for _ in range(balance.samples - 1)]
        return TapTable.from_rationals([*rows, self.sums], balance.weights)


@dataclass(frozen=True)
class _Points:
    """The balance at the quadrature's points: rows of terms, right sides, weights, frequencies."""

    rows: Matrix
    right: list[Decimal]
    weights: list[Decimal]
    hertz: list[Fraction]

    def residuals(self, taps: Sequence[Decimal]) -> list[Decimal]:
        return [
            sum((k * x for k, x in zip(taps, row, strict=True)), -right)
            for row, right in zip(self.rows, self.right, strict=True)
        ]

    def mean_square(self, taps: Sequence[Decimal]) -> Decimal:
        squares = (r * r for r in self.residuals(taps))
        total = sum((w * s for w, s in zip(self.weights, squares, strict=True)), Decimal(0))
        return total / sum(self.weights)

    def worst(self, taps: Sequence[Decimal]) -> tuple[Decimal, Fraction]:
        return max((abs(r), f) for r, f in zip(self.residuals(taps), self.hertz, strict=True))


def fit(
    balance: Balance,
    history: int,
    band: Band,
    sample_rate: Fraction,
    denominator_bits: int = DENOMINATOR_BITS,
    constrained: bool = True,
) -> Fit:
    """Least-squares taps over a band, and the best rounding of them.

    Args:
        balance: the sensor.
        history: p.
        band: the band and its weight, at or below half the sample rate.
        sample_rate: Hz.
        denominator_bits: taps are integers over 2^denominator_bits, times a small factor where the
            constraint asks for it.
        constrained: whether the first power of the frequency is matched exactly.  One tap alone
            would then be fitted to nothing else, and is free.

    Raises:
        InputError: too many taps, no tap, a filter that passes nothing in the band, or a weight
            that is zero all over it.
    """
    count = _checked_count(balance, history)
    digits = 60 + 10 * count
    with localcontext() as context:
        context.prec = digits
        points = _points(balance, count, band, sample_rate)
        form, right = _normal_equations(points)
        slow = slow_motion(balance) if constrained and count > 1 else None
        if slow is None:
            reals = _solve(form, right)
        else:
            first = exact(slow)
            rest = [r - f * first for r, f in zip(right, form[0], strict=True)]
            reals = _with_first(first, _solve(_reduced(form), _reduced_right(rest)))
        return _rounded(points, form, reals, denominator_bits, slow)


def slow_motion(balance: Balance) -> Fraction | None:
    """Σ d K_d that makes slow motion exact, n³/12 where nothing is filtered (Yang Eq. 17).

    It is the first power of (B1), λ³; a rate that changes evenly, ω = g₀ + g₁ τ, feels just that.
    None behind a filter without a power series.
    """
    try:
        return balance.taylor(1)[0]
    except InputError:
        return None


def _with_first(total: Decimal, others: Sequence[Decimal]) -> list[Decimal]:
    """All K_d where Σ d K_d is known, from those beyond K_1."""
    return [total - sum(d * k for d, k in enumerate(others, start=2)), *others]


def _reduced(form: Matrix) -> Matrix:
    """A quadratic form of all K_d as one of those beyond K_1, where Σ d K_d is held."""
    size = range(1, len(form))
    return [
        [
            form[i][j]
            - (j + 1) * form[i][0]
            - (i + 1) * form[0][j]
            + (i + 1) * (j + 1) * form[0][0]
            for j in size
        ]
        for i in size
    ]


def _reduced_right(right: Sequence[Decimal]) -> list[Decimal]:
    """The right side that goes with `_reduced`."""
    return [right[i] - (i + 1) * right[0] for i in range(1, len(right))]


def round_taps(
    reals: Sequence[Fraction],
    balance: Balance,
    band: Band,
    sample_rate: Fraction,
    denominator_bits: int,
) -> Fit:
    """The best rounding of given taps: the least weighted mean square change of (B1) over a band.

    Raises:
        InputError: a filter that passes nothing in the band.
    """
    with localcontext() as context:
        context.prec = 60 + 10 * len(reals)
        points = _points(balance, len(reals), band, sample_rate)
        form, _ = _normal_equations(points)
        return _rounded(points, form, [exact(x) for x in reals], denominator_bits, None)


def _checked_count(balance: Balance, history: int) -> int:
    count = balance.distances(history)
    if count < 1:
        raise InputError(
            "algorithm.samples + algorithm.history: 1 sample gives no cross product, give"
            " samples + history >= 2"
        )
    if count > MAX_TAPS:
        extra = balance.samples + history - count
        raise InputError(
            f"algorithm.samples + algorithm.history: {balance.samples + history} is too large for"
            f" a least-squares fit, give a sum up to {MAX_TAPS + extra}"
        )
    return count


def _points(balance: Balance, count: int, band: Band, sample_rate: Fraction) -> _Points:
    """Quadrature points over the band, several to each ripple of the fastest term.

    The residual's square ripples at most as sin² of (count + 1 + n) λ.
    """
    highest = count + 1 + balance.samples
    width = band.high_hz - band.low_hz
    widest = min(sample_rate / (4 * highest), width / 16)
    points = _Points([], [], [], [])
    offset = Fraction(exact(Fraction(3, 5)).sqrt() / 2)
    places = [Fraction(1, 2) + away for away in (-offset, Fraction(0), offset)]
    turn = 2 * pi()
    for low, high in band.panels(widest):
        for share, place in zip(_NODES, places, strict=True):
            hertz = low + (high - low) * place
            weight = band.weight(hertz) * exact(share * (high - low))
            phase = turn * exact(hertz / sample_rate)
            row, right = balance.terms(phase, count)
            points.rows.append(row)
            points.right.append(right)
            points.weights.append(weight)
            points.hertz.append(hertz)
    if not any(points.weights):
        raise InputError("algorithm.band: the weight is zero everywhere, give some that is not")
    _check_response(balance.response, [band.low_hz, *points.hertz, band.high_hz], sample_rate)
    return points


def _check_response(response: Response, hertz: Sequence[Fraction], sample_rate: Fraction) -> None:
    """See that the filter passes something everywhere in the band, between the points too.

    Raises:
        InputError: naming the frequency where it does not.
    """
    if not response.stages:
        return

    def power(frequency: Fraction) -> Decimal:
        return response.power(2 * pi() * exact(frequency / sample_rate))

    with localcontext() as context:
        context.prec = 30
        powers = [power(f) for f in hertz]
        for i, value in enumerate(powers):
            before, after = max(i - 1, 0), min(i + 1, len(powers) - 1)
            if value > min(powers[before], powers[after]):
                continue
            low, high = hertz[before], hertz[after]
            for _ in range(20):  # a dip: down to its bottom
                third = (high - low) / 3
                if power(low + third) < power(high - third):
                    high -= third
                else:
                    low += third
            bottom = (low + high) / 2
            if power(bottom) < LEAST_RESPONSE**2:
                raise InputError(
                    f"algorithm.band: the filter passes less than {LEAST_RESPONSE * 100:.0f} % at"
                    f" {float(bottom):.4g} Hz, so nothing is left to correct with; give a band"
                    " where it passes more"
                )


def _normal_equations(points: _Points) -> tuple[Matrix, list[Decimal]]:
    """Mean of row rowᵀ and of row·right: the quadratic form of the mean square residual."""
    total = sum(points.weights)
    count = len(points.rows[0])
    weighted = [[w * x for x in row] for w, row in zip(points.weights, points.rows, strict=True)]
    form = [[Decimal(0)] * count for _ in range(count)]
    for i in range(count):
        for j in range(i + 1):
            value = sum(
                (v[i] * row[j] for v, row in zip(weighted, points.rows, strict=True)), Decimal(0)
            )
            form[i][j] = form[j][i] = value / total
    right = [
        sum((v[i] * r for v, r in zip(weighted, points.right, strict=True)), Decimal(0)) / total
        for i in range(count)
    ]
    return form, right


def _solve(form: Matrix, right: list[Decimal]) -> list[Decimal]:
    """form x = right by Cholesky; the digits in hand are far more than its condition takes."""
    size = len(right)
    lower = [[Decimal(0)] * size for _ in range(size)]
    for i in range(size):
        for j in range(i + 1):
            rest = form[i][j] - sum((lower[i][k] * lower[j][k] for k in range(j)), Decimal(0))
            lower[i][j] = rest.sqrt() if i == j else rest / lower[j][j]
    x: list[Decimal] = []
    for i in range(size):
        x.append((right[i] - sum((lower[i][k] * x[k] for k in range(i)), Decimal(0))) / lower[i][i])
    for i in reversed(range(size)):
        x[i] = (x[i] - sum((lower[k][i] * x[k] for k in range(i + 1, size)), Decimal(0))) / lower[
            i
        ][i]
    return x


def _rounded(
    points: _Points, form: Matrix, reals: list[Decimal], bits: int, slow: Fraction | None
) -> Fit:
    """Reals to integers over a denominator: the closest in the form, kept from wandering off in it.

    Where the form is nearly flat, far-off integers would fit as well as near ones; a cost on every
    tap, at first a share of the fit's own residual, is raised until they stay near.
    """
    denominator = _denominator(bits, slow)
    unit = 1 / Decimal(denominator)
    mean_square = points.mean_square(reals)
    guard = ROUNDING_SHARE * mean_square / (len(reals) * unit * unit)
    guard = max(guard, form[0][0].scaleb(-40))
    target = [x / unit for x in reals]
    furthest = max(FURTHEST_MOVE / unit, Decimal(FURTHEST_UNITS))
    while True:
        guarded = [
            [value + (guard if i == j else 0) for j, value in enumerate(row)]
            for i, row in enumerate(form)
        ]
        integers = _closest(guarded, target, None if slow is None else round(slow * denominator))
        if max(abs(k - x) for k, x in zip(integers, target, strict=True)) <= furthest:
            break
        guard *= 16
    rounded = [k * unit for k in integers]
    plain = [nearest(x) * unit for x in target]
    worst, worst_hz = points.worst(rounded)
    return Fit(
        tuple(reals),
        tuple(integers),
        denominator,
        slow,
        rms_real=float(mean_square.sqrt()),
        rms_rounded=float(points.mean_square(rounded).sqrt()),
        rms_nearest=float(points.mean_square(plain).sqrt()),
        worst_real=float(points.worst(reals)[0]),
        worst_rounded=float(worst),
        worst_hz=float(worst_hz),
    )


def _denominator(bits: int, slow: Fraction | None) -> int:
    """2^bits, times what makes Σ d K_d a whole number of units where that is a small factor."""
    if slow is None:
        return 1 << bits
    factor = (slow * (1 << bits)).denominator
    return factor << bits if factor <= LARGEST_FACTOR else 1 << bits


def _closest(form: Matrix, target: list[Decimal], total: int | None) -> list[int]:
    """The integers k nearest to a target in a form; with Σ d k_d = total where that is given."""
    if total is None:
        return closest_integers(form, target)
    others = closest_integers(_reduced(form), target[1:])
    return [total - sum(d * k for d, k in enumerate(others, start=2)), *others]
