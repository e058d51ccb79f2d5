"""The design file's [algorithm.band] and [algorithm.filter], as a user with a data sheet has them.

Numbers are taken as the decimals they are written as, so that 0.1 is one tenth and coefficients
that can be exact are.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from sculler_model.algorithms import (
    Analogue,
    Band,
    Digital,
    Measured,
    Response,
    RotaryMode,
    Sinc,
    Stage,
    rational,
)
from sculler_model.errors import InputError
from sculler_model.inputs import read_small
from sculler_model.schema import Part

Positive = Annotated[float, Field(gt=0, description="a number > 0")]
Numbers = Annotated[list[float], Field(min_length=1, max_length=64)]
Rows = Annotated[list[list[float]], Field(min_length=2, max_length=10_000)]


class MountTable(Part):
    """An isolator between the vibration and the sensor: its rotary mode."""

    natural_hz: Positive
    damping: Annotated[float, Field(gt=0, description="a damping ratio > 0")]


class BandTable(Part):
    """Where the residual counts.

    Either low_hz and high_hz alone (every frequency alike), or with `psd` (weights joined by
    straight lines) or `profile` (a vibration profile's breakpoints, straight on log-log paper),
    whose ends then are the defaults.
    """

    psd: Annotated[Rows | None, Field(description="rows [frequency, weight], 2 or more")] = None
    profile: Annotated[
        Rows | None, Field(description="rows [frequency, PSD], 2 or more, all > 0")
    ] = None
    mount: Annotated[
        MountTable | None, Field(description="a table with natural_hz and damping")
    ] = None
    low_hz: Annotated[float | None, Field(ge=0, description="a number >= 0")] = None
    high_hz: Annotated[float | None, Field(gt=0, description="a number > 0")] = None

    @field_validator("psd", "profile")
    @classmethod
    def _rows_are_a_table(cls, rows: list[list[float]] | None) -> list[list[float]] | None:
        before = None
        for number, row in enumerate(rows or ()):
            if len(row) != 2:
                raise ValueError(f"row {number} has {len(row)} numbers, give [frequency, value]")
            frequency, value = row
            if frequency < 0 or (before is not None and frequency <= before):
                raise ValueError(
                    f"row {number}: frequencies must rise from 0 or above, but {frequency:g}"
                    + (f" follows {before:g}" if before is not None else " is negative")
                )
            if value < 0:
                raise ValueError(f"row {number}: {value:g} at {frequency:g} Hz is negative")
            before = frequency
        if rows and not any(value for _, value in rows):
            raise ValueError("every value is zero, give at least one that is not")
        return rows

    @field_validator("profile")
    @classmethod
    def _profile_fits_log_paper(cls, rows: list[list[float]] | None) -> list[list[float]] | None:
        for number, (frequency, value) in enumerate(rows or ()):
            if not frequency or not value:
                raise ValueError(
                    f"row {number}: [{frequency:g}, {value:g}] has no place on log-log paper, give"
                    " numbers > 0"
                )
        return rows

    @model_validator(mode="after")
    def _is_a_band(self) -> BandTable:
        if self.psd is not None and self.profile is not None:
            raise ValueError("psd and profile are both given, give one")
        rows = self.psd or self.profile
        if rows is None and self.high_hz is None:
            raise ValueError("high_hz: missing, give a number > 0, or psd or profile")
        low, high = self._ends()
        if low >= high:
            raise ValueError(f"low_hz = {low:g} is not below high_hz = {high:g}")
        if rows is not None and (low < rows[0][0] or high > rows[-1][0]):
            raise ValueError(
                f"{low:g} to {high:g} Hz reaches beyond the table's {rows[0][0]:g} to"
                f" {rows[-1][0]:g} Hz"
            )
        return self

    def _ends(self) -> tuple[float, float]:
        rows = self.psd or self.profile or [[0.0], [0.0]]
        low = self.low_hz if self.low_hz is not None else rows[0][0]
        high = self.high_hz if self.high_hz is not None else rows[-1][0]
        return low, high

    def exact(self) -> Band:
        """In rationals."""
        low, high = self._ends()
        return Band(
            rational(low),
            rational(high),
            tuple((rational(f), rational(w)) for f, w in self.psd or self.profile or ()),
            self.profile is not None,
            RotaryMode(rational(self.mount.natural_hz), rational(self.mount.damping))
            if self.mount
            else None,
        )


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


def response(filters: list[FilterTable], sample_rate: Fraction) -> Response:
    """The stages one after another.

    Raises:
        InputError: naming the key of the stage at fault.
    """
    stages = []
    for number, part in enumerate(filters):
        try:
            stages.append(part.stage(sample_rate))
        except InputError as error:
            name = f"algorithm.filter[{number}]" if len(filters) > 1 else "algorithm.filter"
            raise InputError(f"{name}: {error}") from error
    return Response(tuple(stages))


def with_measured_points(filters: Any, folder: Path) -> Any:
    """Put the points of each `file` in its place, so that the design stands by itself.

    Args:
        filters: what the design file has under `algorithm.filter`, not yet validated.
        folder: that relative paths start from.

    Raises:
        InputError: a file cannot be read.
    """
    if isinstance(filters, list):
        return [with_measured_points(part, folder) for part in filters]
    if not isinstance(filters, dict) or not isinstance(filters.get("file"), str):
        return filters
    if "points" in filters:
        raise InputError("algorithm.filter: file and points are both given, give one")
    inline = {key: value for key, value in filters.items() if key != "file"}
    inline["points"] = read_response(folder / filters["file"])
    return inline


def read_response(path: Path) -> list[list[float]]:
    """Rows of a response CSV with the header ``freq_hz,gain`` or ``freq_hz,gain,phase_deg``.

    Raises:
        InputError: it cannot be read, or a line is not as the header says.
    """
    name = f"algorithm.filter.file: {path}"
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
