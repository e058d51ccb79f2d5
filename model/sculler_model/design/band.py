"""The design file's [algorithm.band], as a user with a data sheet has it.

Numbers are taken as the decimals they are written as.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, field_validator, model_validator

from sculler_model.algorithms import Band, RotaryMode, rational
from sculler_model.design.filters import Rows
from sculler_model.schema import Part

Positive = Annotated[float, Field(gt=0, description="a number > 0")]


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
