"""The design file's [sensor.filter]: what the samples have passed in the sensor.

Numbers are taken as the decimals they are written as, so that 0.1 is one tenth and coefficients
that can be exact are.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from sculler_model.algorithms import Analogue, Digital, Measured, Response, Sinc, Stage, rational
from sculler_model.errors import InputError
from sculler_model.inputs import read_small
from sculler_model.schema import Part

Numbers = Annotated[list[float], Field(min_length=1, max_length=64)]
Rows = Annotated[list[list[float]], Field(min_length=2, max_length=10_000)]

_FILTER_KEYS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "sinc": ((), ("width_samples", "order")),
    "digital": (("numerator",), ("denominator", "rate_hz")),
    "analogue": (("numerator", "denominator"), ()),
    "measured": (("points",), ()),
}
"""Of each kind, the keys it needs and the keys it may have."""


class FilterTable(Part):
    """One stage of the filter that the samples have passed."""

    kind: Annotated[
        Literal["sinc", "digital", "analogue", "measured"],
        Field(description='"sinc", "digital", "analogue" or "measured"'),
    ]
    width_samples: Annotated[
        float | None, Field(gt=0, description="a number > 0 (sample intervals)")
    ] = None
    order: Annotated[int | None, Field(ge=1, le=16, description="a whole number from 1 to 16")] = (
        None
    )
    numerator: Annotated[Numbers | None, Field(description="1 to 64 numbers")] = None
    denominator: Annotated[Numbers | None, Field(description="1 to 64 numbers")] = None
    rate_hz: Annotated[float | None, Field(gt=0, description="a number > 0")] = None
    points: Annotated[
        Rows | None,
        Field(description="rows [frequency, gain] or [frequency, gain, phase], or file"),
    ] = None

    @model_validator(mode="after")
    def _keys_fit_kind(self) -> FilterTable:
        needed, optional = _FILTER_KEYS[self.kind]
        fields = FilterTable.model_fields
        given = {key for key in self.model_fields_set if getattr(self, key) is not None}
        faults = [
            f'{key}: missing, kind = "{self.kind}" needs {fields[key].description}'
            for key in needed
            if key not in given
        ]
        faults += [
            f'{key}: not used by kind = "{self.kind}", leave it out'
            for key in sorted(given - {"kind", *needed, *optional})
        ]
        if self.points and not faults:
            widths = {len(row) for row in self.points}
            if widths != {2} and widths != {3}:
                faults.append("points: give 2 numbers in every row, or 3 in every row")
        if faults:
            raise ValueError("; ".join(faults))
        return self

    def stage(self, sample_rate: Fraction) -> Stage:
        """As a function of phase.

        Raises:
            InputError: it is no filter that a sensor can have.
        """
        numerator = tuple(map(rational, self.numerator or ()))
        denominator = tuple(map(rational, self.denominator or (1.0,)))
        if self.kind == "sinc":
            return Sinc(rational(self.width_samples or 1.0), self.order or 1)
        if self.kind == "digital":
            step = sample_rate / rational(self.rate_hz) if self.rate_hz else Fraction(1)
            return Digital(numerator, denominator, step)
        if self.kind == "analogue":
            return Analogue(numerator, denominator, sample_rate)
        frequencies, gains, *phases = (
            tuple(map(rational, column)) for column in zip(*(self.points or ()), strict=True)
        )
        degrees = phases[0] if phases else (Fraction(0),) * len(gains)
        return Measured(frequencies, gains, degrees, sample_rate)


def _as_list(value: Any) -> Any:
    """One stage is a list of one."""
    return [value] if isinstance(value, dict) else value


Filter = Annotated[
    list[FilterTable] | None,
    BeforeValidator(_as_list),
    Field(description="a table with kind, or several", max_length=16),
]
"""Stage after stage; None where nothing is stated."""


def response(filters: list[FilterTable], sample_rate: Fraction, key: str) -> Response:
    """The stages one after another.

    Args:
        filters: the stages.
        sample_rate: Hz.
        key: of the design file, that they stand under.

    Raises:
        InputError: naming the key of the stage at fault.
    """
    stages = []
    for number, part in enumerate(filters):
        try:
            stages.append(part.stage(sample_rate))
        except InputError as error:
            name = f"{key}[{number}]" if len(filters) > 1 else key
            raise InputError(f"{name}: {error}") from error
    return Response(tuple(stages))


def at_another_rate(
    filters: list[dict[str, Any]], rate: float, summed: int
) -> list[dict[str, Any]]:
    """The same filter for samples that are sums of this many: what counts in samples is changed.

    Args:
        filters: stages, as `FilterTable` has them.
        rate: of the samples that are summed, Hz.
        summed: how many make one.
    """
    changed = []
    for stage in filters:
        if stage["kind"] == "sinc":
            stage = stage | {"width_samples": (stage.get("width_samples") or 1.0) / summed}
        elif stage["kind"] == "digital":
            stage = stage | {"rate_hz": stage.get("rate_hz") or rate}
        changed.append(stage)
    return changed


def with_measured_points(filters: Any, folder: Path, key: str) -> Any:
    """Put the points of each `file` in its place, so that the design stands by itself.

    Args:
        filters: what the design file has under `key`, not yet validated.
        folder: that relative paths start from.
        key: names it in messages.

    Raises:
        InputError: a file cannot be read.
    """
    if isinstance(filters, list):
        return [with_measured_points(part, folder, key) for part in filters]
    if not isinstance(filters, dict) or not isinstance(filters.get("file"), str):
        return filters
    if "points" in filters:
        raise InputError(f"{key}: file and points are both given, give one")
    inline = {key: value for key, value in filters.items() if key != "file"}
    inline["points"] = read_response(folder / filters["file"], key)
    return inline


def read_response(path: Path, key: str = "sensor.filter") -> list[list[float]]:
    """Rows of a response CSV with the header ``freq_hz,gain`` or ``freq_hz,gain,phase_deg``.

    Args:
        path: the file.
        key: names it in messages.

    Raises:
        InputError: it cannot be read, or a line is not as the header says.
    """
    name = f"{key}.file: {path}"
    lines = read_small(path, "response", "a CSV", name).splitlines()
    header = [word.strip() for word in lines[0].split(",")] if lines else []
    if header not in (["freq_hz", "gain"], ["freq_hz", "gain", "phase_deg"]):
        raise InputError(f"{name}: the first line must be freq_hz,gain or freq_hz,gain,phase_deg")
    rows = []
    for number, line in enumerate(lines[1:], start=2):
        if not line.strip():
            continue
        try:
            row = [float(word) for word in line.split(",")]
        except ValueError as error:
            raise InputError(f"{name}: line {number}: {line[:40]!r} is not numbers") from error
        if len(row) != len(header):
            raise InputError(
                f"{name}: line {number} has {len(row)} numbers, the header names {len(header)}"
            )
        rows.append(row)
    return rows
