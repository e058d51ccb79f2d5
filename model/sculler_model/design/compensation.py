"""The design file's [compensation]: known errors of the sensor, taken out before the core.

The keys are those of [sensor.errors], in its units and with its signs; what is linear in the
samples becomes integers over one denominator (`CompensationPlan`).
"""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated, NamedTuple

from pydantic import Field, model_validator

from sculler_model.algorithms import fractional_delay, pi_to, rational
from sculler_model.design.compensation_plan import CompensationPlan, ProductTerm, Term
from sculler_model.design.interval import Interval
from sculler_model.design.matrices import Matrix, Row, dot, inverse, product, scaled
from sculler_model.design.sensor import Axes, Sensor
from sculler_model.design.sensor_errors import AxisErrors, SensorErrors, why_not_undone
from sculler_model.design.size_effect import REACH, SizeEffect, size_effect

MAX_SAMPLE_BITS = 62
"""Of a compensated sample: four digits of the compact core; the fast twin has it in 64 bits.

A 32-bit sensor has room for D = 2^28.
"""

MAX_DELAY = 8
"""Sample intervals between gyros and accelerometers."""

_BENT = ("asymmetry", "square")
_GRAVITY = Fraction("9.80665")  # m/s²
_DEGREE_AN_HOUR = pi_to(50) / 180 / 3600  # rad/s


class Compensation(SensorErrors):
    """What is taken out of the samples before the core, in exact integers.

    Attributes:
        gyro, accel: known bias, scale_factor, misalignment and, of gyros, g_sensitivity.
        delay_samples: how many sample intervals later than the gyros the accelerometers see.
        denominator: D, which all integers stand over; a count of the core is worth 1/D of one of
            the sensor.
        accel_denominator: that of accelerometers, if it is another.
        taps: samples that a delayed one is made of.
        arms_m: where each accelerometer sits, from the point that is navigated, body axes, m.
    """

    denominator: Annotated[
        int, Field(ge=2, le=1 << 42, description="a whole number from 2 to 2^42")
    ] = 1 << 16
    accel_denominator: Annotated[
        int | None, Field(ge=2, le=1 << 42, description="a whole number from 2 to 2^42")
    ] = None
    taps: Annotated[int, Field(ge=2, le=12, description="an even number from 2 to 12")] = 6

    @model_validator(mode="after")
    def _can_be_undone(self) -> Compensation:
        for name, axes in (("gyro", self.gyro), ("accel", self.accel)):
            for key in type(axes).model_fields:
                value = getattr(axes, key)
                if why := why_not_undone(key, value):
                    raise ValueError(f"{name}.{key}: {why}")
                if value is not None and key in _BENT:
                    raise ValueError(
                        f"{name}.{key}: is not linear in the samples, undo it in the log, by"
                        " convert --calibration"
                    )
        if self.taps % 2:
            raise ValueError(f"taps: {self.taps} is not allowed, give an even number from 2 to 12")
        if abs(self.delay_samples or 0.0) > MAX_DELAY:
            raise ValueError(
                f"delay_samples: {self.delay_samples:g} is not allowed, give a number from"
                f" {-MAX_DELAY} to {MAX_DELAY}"
            )
        return self

    def plan(self, sensor: Sensor) -> CompensationPlan:
        """As integers, each the nearest one.

        With L the matrices, b the biases, Γ the g-sensitivity and K = Lₐ⁻¹, all in counts,

            a = K (a_felt - bₐ)        g = L_g⁻¹ (g_felt - b_g - Γ a)

        and where the accelerometers are late by d samples, a is that of d samples later
        (`fractional_delay`), less what they feel for their places (`size_effect`).  The integers of
        a filter's taps sum to the nearest one of what they stand for, so that a steady count is not
        changed by their rounding.

        Args:
            sensor: gives what a count is worth.

        Raises:
            ValueError: a matrix has no inverse, or the samples would be too wide.
        """
        delay = rational(self.delay_samples or 0.0)
        weights = fractional_delay(delay, self.taps)
        behind = max(0, *weights, REACH if self.arms_m is not None else 0)
        units = (_per_count(sensor, sensor.gyro.lsb), _per_count(sensor, sensor.accel.lsb))
        gyro, accel = _inverse("gyro", self.gyro), _inverse("accel", self.accel)
        bias = (
            _vector(self.gyro.bias, _DEGREE_AN_HOUR / units[0]),
            _vector(self.accel.bias, _GRAVITY / 1000 / units[1]),
        )
        share = units[1] / units[0] / _GRAVITY
        felt = [share * g for g in _vector(self.gyro.g_sensitivity, _DEGREE_AN_HOUR)]
        crossed = product(gyro, scaled(accel, [-each for each in felt]))
        sums = [
            _Sum(
                {j: {behind: each} for j, each in enumerate((*own, *other))},
                -dot(own, bias[0]) - dot(other, bias[1]),
            )
            for own, other in zip(gyro, crossed, strict=True)
        ]
        for axis, row in enumerate(accel):
            spread = {
                3 + j: {behind - o: each * w for o, w in weights.items()}
                for j, each in enumerate(row)
            }
            sums.append(_Sum(spread, -dot(row, bias[1])))
            if self.arms_m is not None:
                arm = _vector(self.arms_m[axis], Fraction(1))
                T = 1 / rational(sensor.sample_rate_hz)
                more = size_effect(axis, arm, gyro, bias[0], units, T)
                sums[-1] = sums[-1].less(more, behind)
        over = [self.denominator] * 3 + [self.accel_denominator or self.denominator] * 3
        plan = CompensationPlan(
            over[0],
            over[-1],
            tuple(one.terms(D) for one, D in zip(sums, over, strict=True)),
            tuple(round(D * one.constant) for one, D in zip(sums, over, strict=True)),
            behind,
            tuple(one.product_terms(D, behind) for one, D in zip(sums, over, strict=True)),
        )
        self._require_narrow(plan, sensor)
        return plan

    def _require_narrow(self, plan: CompensationPlan, sensor: Sensor) -> None:
        counts = [Interval.signed(axes.bits) for axes in (sensor.gyro, sensor.accel)]
        own = "accel_denominator" if self.accel_denominator is not None else "denominator"
        for key, D, total in zip(
            ("denominator", own), plan.denominators, plan.ranges(*counts), strict=True
        ):
            if total.bits <= MAX_SAMPLE_BITS:
                continue
            fits = (D >> total.bits - MAX_SAMPLE_BITS).bit_length() - 1
            way = f"give 2^{fits} = {1 << fits} or less" if fits > 0 else "give smaller errors"
            raise ValueError(
                f"{key}: {D} makes samples of {total.bits} bits, more than the {MAX_SAMPLE_BITS}"
                f" that a core can take; {way}"
            )


class _Sum(NamedTuple):
    """An output in counts of the sensor, exact.

    Attributes:
        linear: of each count, 0 to 5, its weights by lag.
        constant: besides.
        products: weights of products of two gyros' counts.
    """

    linear: dict[int, dict[int, Fraction]]
    constant: Fraction
    products: dict[tuple[int, int], Fraction] = {}  # noqa: RUF012 - never changed

    def less(self, more: SizeEffect, behind: int) -> _Sum:
        """Without what is felt for a place; the weights are of samples about that lag."""
        linear = {
            source: {behind - o: -w for o, w in weights.items()}
            for source, weights in more.linear.items()
        }
        products = {pair: -each for pair, each in more.products.items()}
        return _Sum(linear | self.linear, self.constant - more.constant, products)

    def terms(self, D: int) -> tuple[Term, ...]:
        """The linear part in integers over D."""
        found = []
        for source, weights in self.linear.items():
            whole = {lag: round(D * each) for lag, each in weights.items()}
            largest = max(whole, key=lambda lag: abs(weights[lag]))
            whole[largest] += round(D * sum(weights.values())) - sum(whole.values())
            found += [Term(source, lag, whole[lag]) for lag in sorted(whole) if whole[lag]]
        return tuple(found)

    def product_terms(self, D: int, lag: int) -> tuple[ProductTerm, ...]:
        """The products in integers over D."""
        whole = ((pair, round(D * each)) for pair, each in self.products.items())
        return tuple(ProductTerm(*pair, lag, factor) for pair, factor in whole if factor)


def compensated_sensor(sensor: Sensor, plan: CompensationPlan) -> Sensor:
    """The sensor whose counts the compensated samples are: wider, and worth 1/D as much."""
    given = (sensor.gyro, sensor.accel)
    ranges = plan.ranges(*(Interval.signed(axes.bits) for axes in given))
    gyro, accel = (
        Axes.model_construct(bits=range_.bits, lsb=axes.lsb / D)
        for axes, range_, D in zip(given, ranges, plan.denominators, strict=True)
    )
    return Sensor.model_construct(
        kind=sensor.kind,
        sample_rate_hz=sensor.sample_rate_hz,
        gyro=gyro,
        accel=accel,
        filter=sensor.filter,
        errors=None,
    )


def _per_count(sensor: Sensor, lsb: float) -> Fraction:
    """Rate or specific force of one count, rad/s or m/s²."""
    rate = rational(sensor.sample_rate_hz) if sensor.kind == "increment" else Fraction(1)
    return rational(lsb) * rate


def _vector(value: object, unit: Fraction) -> Row:
    """Three numbers of [sensor.errors], exact."""
    x, y, z = (unit * rational(each) for each in value) if isinstance(value, list) else (0, 0, 0)
    return Fraction(x), Fraction(y), Fraction(z)


def _linear(errors: AxisErrors) -> list[list[Fraction]]:
    """What the axes make of the perfect vector: scale factors and misalignments."""
    scale = _vector(errors.scale_factor, Fraction(1, 10**6))
    off = iter(errors.misalignment if isinstance(errors.misalignment, list) else [0.0] * 6)
    return [
        [1 + scale[i] if i == j else rational(next(off)) / 1000 for j in range(3)] for i in range(3)
    ]


def _inverse(name: str, errors: AxisErrors) -> Matrix:
    """The inverse of the axes' matrix.

    Raises:
        ValueError: it has none.
    """
    try:
        return inverse(_linear(errors))
    except ZeroDivisionError as error:
        raise ValueError(
            f"{name}: scale_factor and misalignment make a matrix without an inverse"
        ) from error
