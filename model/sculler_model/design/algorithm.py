"""The design file's [algorithm], and the tap table that it asks for."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, ValidationInfo, field_validator

from sculler_model.algorithms import (
    BASES,
    FAMILIES,
    MAX_SAMPLES,
    TABLES,
    Match,
    Recipe,
    Response,
    Sum,
    TapTable,
    make,
    rational,
)
from sculler_model.design.band import BandTable
from sculler_model.design.filters import Filter, response
from sculler_model.design.result import FOURTH_ORDER_VECTORS, THIRD_ORDER_VECTORS, VECTORS
from sculler_model.design.sensor import Sensor
from sculler_model.design.word_lengths import MAX_BITS, word_lengths
from sculler_model.errors import InputError
from sculler_model.schema import Part


class UserTable(Part):
    """The user's own tap table, in the form `sculler coefficients --json` prints."""

    denominator: Annotated[int, Field(ge=1, description="a whole number >= 1")]
    taps: Annotated[
        list[int | list[int]],
        Field(min_length=1, description="n rows of whole numbers, or one flat row for phase n"),
    ]
    sum_denominator: Annotated[int, Field(ge=1, description="a whole number >= 1")] = 1
    weights: Annotated[
        list[int] | None, Field(description="up to n + 1 whole numbers, distance 0..n")
    ] = None


class Algorithm(Part):
    """The high-rate algorithm.  Field order matters: later ones are checked against earlier.

    Attributes:
        samples: n, of a minor interval.
        history: p, samples before the minor interval that the coefficients may use.
        minors: M, minor intervals in a major one.
        family: where the tap table comes from, one of `FAMILIES` or "table".
        table: the user's own, with family = "table".
        base: what family = "uncompressed" starts from.
        match: how "tuned" is matched.
        filter: `sensor.filter`, as design files of before had it.
        sum: how a rate sensor's sum is formed.
        band: where a fit counts.
        denominator_bits: rounded taps stand over 2 to this.
        fit: "constrained", which is the default: slow motion stays exact; "free": the band alone
            counts.
        order: 2 (the default), 3 or 4: up to which products of increments the rotation vector and
            the velocity are formed (`higher_order`); above 2 adds `coning_third` and
            `sculling_third`, 4 `coning_fourth` and `sculling_fourth` too.
        position: "high-resolution" adds the vectors s_alpha, s_nu and scrolling (`scrolling`),
            from which the host has the displacement over each major interval; "trapezoidal", which
            is the default, has none of them.
    """

    samples: Annotated[
        int, Field(ge=1, le=MAX_SAMPLES, description=f"a whole number from 1 to {MAX_SAMPLES}")
    ]
    history: Annotated[
        int, Field(ge=0, le=MAX_SAMPLES, description=f"a whole number from 0 to {MAX_SAMPLES}")
    ] = 0
    minors: Annotated[int, Field(ge=1, le=4096, description="a whole number from 1 to 4096")]
    family: Annotated[
        Literal[
            "frequency-taylor",
            "filtered-rate",
            "time-taylor",
            "uncompressed",
            "least-squares",
            "tuned",
            "table",
        ],
        Field(description=", ".join(f'"{family}"' for family in FAMILIES) + ' or "table"'),
    ]
    table: Annotated[
        UserTable | None,
        Field(description="a table with denominator and taps", validate_default=True),
    ] = None
    base: Annotated[
        Literal["frequency-taylor", "least-squares", "tuned"] | None,
        Field(description=" or ".join(f'"{base}"' for base in BASES)),
    ] = None
    match: Annotated[Match | None, Field(description='"taylor" or "least-squares"')] = None
    filter: Filter = None
    sum: Annotated[Sum | None, Field(description='"zeng", "newton-cotes" or "plain"')] = None
    band: Annotated[
        BandTable | None,
        Field(description="a table with low_hz and high_hz, psd or profile", validate_default=True),
    ] = None
    denominator_bits: Annotated[
        int | None, Field(ge=1, le=48, description="a whole number from 1 to 48")
    ] = None
    fit: Annotated[
        Literal["constrained", "free"] | None,
        Field(description='"constrained" or "free"'),
    ] = None
    position: Annotated[
        Literal["trapezoidal", "high-resolution"] | None,
        Field(description='"trapezoidal" or "high-resolution"'),
    ] = None

    order: Annotated[Literal[2, 3, 4] | None, Field(description="2, 3 or 4")] = None

    @field_validator("family")
    @classmethod
    def _family_can_be_made(cls, family: str, info: ValidationInfo) -> str:
        samples, history = info.data.get("samples"), info.data.get("history")
        # an uncompressed table may start from another base, which is not known yet
        computed = TABLES.get(family) if family != "uncompressed" else None
        if computed is not None and samples is not None and history is not None:
            computed(samples, history)
        return family

    @field_validator("table")
    @classmethod
    def _table_is_consistent(
        cls, table: UserTable | None, info: ValidationInfo
    ) -> UserTable | None:
        family, samples = info.data.get("family"), info.data.get("samples")
        if family == "table" and table is None:
            raise ValueError(
                'missing, family = "table" needs [algorithm.table] with denominator and taps'
            )
        if family in FAMILIES and table is not None:
            raise ValueError(
                f'not used by family = "{family}", leave it out or give family = "table"'
            )
        if table is not None and samples is not None:
            user_table(table, samples)
        return table

    @field_validator("position")
    @classmethod
    def _the_usual_is_left_unsaid(cls, value: str | None) -> str | None:
        return None if value == "trapezoidal" else value

    @field_validator("order")
    @classmethod
    def _second_order_is_left_unsaid(cls, value: int | None) -> int | None:
        return None if value == 2 else value

    @field_validator("base", "match", "filter", "sum", "band", "denominator_bits", "fit")
    @classmethod
    def _option_fits_family(cls, value: Any, info: ValidationInfo) -> Any:
        """Options come with the families that use them; a band in use must be there."""
        key = info.field_name or ""
        known = ("family", "base", "match")
        earlier = known[: known.index(key)] if key in known else known
        if any(name not in info.data for name in earlier):
            return value  # what it depends on is at fault itself
        family, match = info.data["family"], info.data.get("match")
        source = info.data.get("base") or "frequency-taylor" if family == "uncompressed" else family
        fitted = source == "least-squares" or (source == "tuned" and match == "least-squares")
        used = {
            "base": family == "uncompressed",
            "match": source == "tuned",
            "filter": source == "tuned",
            "sum": source == "tuned",
            "band": fitted,
            "denominator_bits": fitted or source == "tuned",
            "fit": fitted,
        }
        if value is not None and not used[key]:
            how = f'family = "{family}"'
            if family == "uncompressed" and key != "base":
                how = f'base = "{source}"'
            if key in ("band", "fit") and source == "tuned":
                how = 'match = "taylor"'
            raise ValueError(f"not used by {how}, leave it out")
        if value is None and used[key] and key == "band":
            allowed = cls.model_fields[key].description
            raise ValueError(f'missing, "{source}" needs it: give {allowed}')
        return value


def sensor_response(sensor: Sensor, algorithm: Algorithm) -> Response | None:
    """What the samples passed in the sensor; None where nothing is stated.

    Raises:
        InputError: it stands in two places, or is no filter that a sensor can have.
    """
    if sensor.filter is not None and algorithm.filter is not None:
        raise InputError("algorithm.filter: sensor.filter is given too, leave this one out")
    rate = rational(sensor.sample_rate_hz)
    if sensor.filter is not None:
        return response(sensor.filter, rate, "sensor.filter")
    if algorithm.filter is not None:
        return response(algorithm.filter, rate, "algorithm.filter")
    return None


def user_table(table: UserTable, samples: int) -> TapTable:
    """The user's own table, checked.

    Raises:
        InputError: it is not of a core's form, see `TapTable.from_integers`.
    """
    return TapTable.from_integers(
        samples, table.denominator, table.taps, table.sum_denominator, table.weights
    )


def tap_table_of(sensor: Sensor, algorithm: Algorithm) -> TapTable:
    """The tap table, the user's own or computed."""
    if algorithm.table is not None:
        return user_table(algorithm.table, algorithm.samples)
    return make(recipe_of(sensor, algorithm)).table


def require_narrow(table: TapTable, sensor: Sensor, algorithm: Algorithm) -> None:
    """See that a core of this table can be built.

    Raises:
        InputError: its denominators or results are wider than `MAX_BITS`.
    """
    order = algorithm.order or 2
    words = word_lengths(sensor.gyro.bits, sensor.accel.bits, algorithm.minors, table, False, order)
    higher = (*THIRD_ORDER_VECTORS, *FOURTH_ORDER_VECTORS)[: 2 * (order - 2)]
    widths = {vector: getattr(words, vector).bits for vector in (*VECTORS, *higher)}
    widths["denominator"] = table.denominator.bit_length()
    widths["sum_denominator"] = table.sum_denominator.bit_length()
    widest = max(widths, key=lambda name: widths[name])
    if widths[widest] > MAX_BITS:
        raise InputError(
            f"algorithm.table: {widest} would have {widths[widest]:,} bits, more than the"
            f" {MAX_BITS} that a core can have; give smaller taps and weights (no published table"
            " needs more than 395)"
        )


def require_summed(table: TapTable, sensor: Sensor, algorithm: Algorithm) -> None:
    """See that terms of third and fourth order can be formed.

    Raises:
        InputError: the samples are no increments that count once each, or high-resolution
            position is asked for too.
    """
    key = f"algorithm.order: {algorithm.order}"
    if sensor.kind != "increment":
        raise InputError(
            f'{key} is not possible with sensor.kind = "{sensor.kind}", give sensor.kind ='
            ' "increment" or leave it out'
        )
    if algorithm.position is not None:
        raise InputError(
            f'{key} is not possible with algorithm.position = "{algorithm.position}", leave one'
            " of them out"
        )
    if table.sum_denominator != 1 or table.weights != (1,) * table.samples + (0,):
        raise InputError(
            f"{key} needs every sample of a minor interval to count once, leave out"
            " algorithm.table.weights or order"
        )


def recipe_of(sensor: Sensor, algorithm: Algorithm) -> Recipe:
    """What a computed family is designed from.

    Raises:
        InputError: a filter that no sensor can have.
    """
    sample_rate = rational(sensor.sample_rate_hz)
    match = algorithm.match or "taylor"
    # a fit is to the drift as it is; Zeng's equations take his sum for exact
    usual: Sum = "zeng" if sensor.kind == "rate" and match == "taylor" else "plain"
    if algorithm.sum is not None and sensor.kind == "increment":
        raise InputError(
            'algorithm.sum: not used by sensor.kind = "increment", whose samples just add up'
        )
    passed = sensor_response(sensor, algorithm)
    tuned = "tuned" in (algorithm.family, algorithm.base)
    if tuned and passed is None:
        raise InputError('sensor.filter: missing, "tuned" needs it: give a table with kind')
    return Recipe(
        family=algorithm.family,
        samples=algorithm.samples,
        history=algorithm.history,
        kind=sensor.kind,
        sample_rate=sample_rate,
        base=algorithm.base or "frequency-taylor",
        match=match,
        sum=algorithm.sum or usual,
        response=passed if tuned and passed is not None else Response(()),
        band=algorithm.band.exact() if algorithm.band is not None else None,
        denominator_bits=algorithm.denominator_bits,
        constrained=algorithm.fit != "free",
    )
