"""The design file's [compensation]: known errors of the sensor, taken out before the core.

The keys are those of [sensor.errors], in its units and with its signs; what is linear in the
samples becomes integers over one denominator (`CompensationPlan`).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Annotated, TypeAlias

from pydantic import Field, model_validator

from sculler_model.algorithms import fractional_delay, pi_to, rational
from sculler_model.design.compensation_plan import CompensationPlan, Term
from sculler_model.design.interval import Interval
from sculler_model.design.sensor import Axes, Sensor
from sculler_model.design.sensor_errors import AxisErrors, SensorErrors, cannot_be_undone

MAX_SAMPLE_BITS = 50
"""Of a compensated sample: three digits of the compact core; sums of its products fit `MAX_BITS`.

A 32-bit sensor has room for D = 2^16.
"""

MAX_DELAY = 8
"""Sample intervals between gyros and accelerometers."""

_BENT = ("asymmetry", "square")
_GRAVITY = Fraction("9.80665")  # m/s²
_DEGREE_AN_HOUR = pi_to(50) / 180 / 3600  # rad/s

Row: TypeAlias = tuple[Fraction, Fraction, Fraction]
Matrix: TypeAlias = tuple[Row, Row, Row]


class Compensation(SensorErrors):
    """What is taken out of the samples before the core, in exact integers.

    Attributes:
        gyro, accel: known bias, scale_factor, misalignment and, of gyros, g_sensitivity.
        delay_samples: how many sample intervals later than the gyros the accelerometers see.
        denominator: D, which all integers stand over; a count of the core is worth 1/D of one of
            the sensor.
        taps: samples that a delayed one is made of.
    """

    denominator: Annotated[
        int, Field(ge=2, le=1 << 42, description="a whole number from 2 to 2^42")
    ] = 1 << 16
    taps: Annotated[int, Field(ge=2, le=12, description="an even number from 2 to 12")] = 6

    @model_validator(mode="after")
    def _can_be_undone(self) -> Compensation:
        for name, axes in (("gyro", self.gyro), ("accel", self.accel)):
            for key in type(axes).model_fields:
                value = getattr(axes, key)
                if cannot_be_undone(key, value):
                    raise ValueError(
                        f"{name}.{key}: is random or a limit, so it cannot be undone, leave it out"
                        " or give numbers"
                    )
                if value is not None and key in _BENT:
                    raise ValueError(
                        f"{name}.{key}: is not linear in the samples, undo it in the log, by"
                        " convert --calibration"
                    )
        if self.arms_m is not None:
            raise ValueError(
                "arms_m: lever arms are not built before the core, undo them in the log, by convert"
                " --calibration"
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
        (`fractional_delay`).  The integers of a filter's taps sum to the nearest one of what they
        stand for, so that a steady count is not changed by their rounding.

        Args:
            sensor: gives what a count is worth.

        Raises:
            ValueError: a matrix has no inverse, or the samples would be too wide.
        """
        delay = rational(self.delay_samples or 0.0)
        weights = fractional_delay(delay, self.taps)
        behind = max(0, *weights)
        units = [_per_count(sensor, axes.lsb) for axes in (sensor.gyro, sensor.accel)]
        gyro, accel = _inverse("gyro", self.gyro), _inverse("accel", self.accel)
        bias = [
            tuple(each / unit for each in _vector(axes.bias, size))
            for axes, unit, size in (
                (self.gyro, units[0], _DEGREE_AN_HOUR),
                (self.accel, units[1], _GRAVITY / 1000),
            )
        ]
        share = units[1] / units[0] / _GRAVITY
        felt = [share * g for g in _vector(self.gyro.g_sensitivity, _DEGREE_AN_HOUR)]
        crossed = _product(gyro, _scaled(accel, [-each for each in felt]))
        outputs: list[tuple[Term, ...]] = []
        for own, other in zip(gyro, crossed, strict=True):
            terms = [(j, {behind: each}) for j, each in enumerate((*own, *other))]
            outputs.append(self._terms(terms))
        for row in accel:
            spread = [{behind - o: each * w for o, w in weights.items()} for each in row]
            outputs.append(self._terms([(3 + j, taps) for j, taps in enumerate(spread)]))
        constants = [
            -_dot(own, bias[0]) - _dot(other, bias[1])
            for own, other in zip(gyro, crossed, strict=True)
        ]
        constants += [-_dot(row, bias[1]) for row in accel]
        plan = CompensationPlan(
            self.denominator,
            tuple(outputs),
            tuple(round(self.denominator * each) for each in constants),
            behind,
        )
        self._require_narrow(plan, sensor)
        return plan

    def _terms(self, sums: Sequence[tuple[int, dict[int, Fraction]]]) -> tuple[Term, ...]:
        """The terms of one output, of each count's weights by lag."""
        found = []
        for source, weights in sums:
            whole = {lag: round(self.denominator * each) for lag, each in weights.items()}
            largest = max(whole, key=lambda lag: abs(weights[lag]))
            whole[largest] += round(self.denominator * sum(weights.values())) - sum(whole.values())
            found += [Term(source, lag, whole[lag]) for lag in sorted(whole) if whole[lag]]
        return tuple(found)

    def _require_narrow(self, plan: CompensationPlan, sensor: Sensor) -> None:
        counts = [Interval.signed(axes.bits) for axes in (sensor.gyro, sensor.accel)]
        bits = max(each.bits for each in plan.ranges(*counts))
        if bits <= MAX_SAMPLE_BITS:
            return
        fits = (self.denominator >> bits - MAX_SAMPLE_BITS).bit_length() - 1
        way = f"give 2^{fits} = {1 << fits} or less" if fits > 0 else "give smaller errors"
        raise ValueError(
            f"denominator: {self.denominator} makes samples of {bits} bits, more than the"
            f" {MAX_SAMPLE_BITS} that a core can take; {way}"
        )


def compensated_sensor(sensor: Sensor, plan: CompensationPlan) -> Sensor:
    """The sensor whose counts the compensated samples are: wider, and worth 1/D as much."""
    given = (sensor.gyro, sensor.accel)
    ranges = plan.ranges(*(Interval.signed(axes.bits) for axes in given))
    gyro, accel = (
        Axes.model_construct(bits=range_.bits, lsb=axes.lsb / plan.denominator)
        for axes, range_ in zip(given, ranges, strict=True)
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
    """The inverse of the matrix, by its cofactors.

    Raises:
        ValueError: it has none.
    """
    m = _linear(errors)

    def cofactor(i: int, j: int) -> Fraction:
        a, b = (i + 1) % 3, (i + 2) % 3
        c, d = (j + 1) % 3, (j + 2) % 3
        return m[a][c] * m[b][d] - m[a][d] * m[b][c]

    determinant = sum((m[0][j] * cofactor(0, j) for j in range(3)), Fraction(0))
    if not determinant:
        raise ValueError(f"{name}: scale_factor and misalignment make a matrix without an inverse")
    x, y, z = (
        (cofactor(0, i) / determinant, cofactor(1, i) / determinant, cofactor(2, i) / determinant)
        for i in range(3)
    )
    return x, y, z


def _scaled(matrix: Matrix, rows: Sequence[Fraction]) -> Matrix:
    """Each row by a factor of its own."""
    x, y, z = (
        (factor * row[0], factor * row[1], factor * row[2])
        for factor, row in zip(rows, matrix, strict=True)
    )
    return x, y, z


def _product(left: Matrix, right: Matrix) -> Matrix:
    columns = [tuple(row[j] for row in right) for j in range(3)]
    x, y, z = ((_dot(r, columns[0]), _dot(r, columns[1]), _dot(r, columns[2])) for r in left)
    return x, y, z


def _dot(left: Sequence[Fraction], right: Sequence[Fraction]) -> Fraction:
    return sum((a * b for a, b in zip(left, right, strict=True)), Fraction(0))
