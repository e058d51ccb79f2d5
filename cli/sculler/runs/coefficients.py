"""A tap table by its family or of a design, and what coning it leaves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sculler_model.algorithms import (
    FAMILIES,
    MAX_SAMPLES,
    SENSOR_KINDS,
    TABLES,
    Recipe,
    TapTable,
    make,
)
from sculler_model.analysis.closed_form import leading_term
from sculler_model.design import Design
from sculler_model.errors import InputError


@dataclass(frozen=True)
class Outcome:
    """A table.

    Attributes:
        title: where it is from.
        table: the table.
        notes: what was found while it was made, a line each.
    """

    title: str
    table: TapTable
    notes: tuple[str, ...]

    def as_json(self) -> dict[str, Any]:
        """What the design file's [algorithm.table] reads."""
        return self.table.as_json()


def of_design(design: Design) -> Outcome:
    """The table of a design."""
    notes: list[str] = []
    if design.algorithm.family != "table":
        notes = design.made.report()
    # the closed form of the residual knows no filter in the sensor
    left = (
        [] if design.sensor_response is not None else [_residual(design.table, design.sensor.kind)]
    )
    return Outcome(design.name, design.table, (*left, *notes))


def of_family(family: str, samples: int, history: int = 0) -> Outcome:
    """The table of a family that needs nothing but these numbers.

    Args:
        family: one of `TABLES`.
        samples: n, of a minor interval, 1 to `MAX_SAMPLES`.
        history: p, before that, 0 to `MAX_SAMPLES`.

    Raises:
        InputError: there is no such table.
    """
    if family in FAMILIES and family not in TABLES:
        raise InputError(
            f"--family: {family} needs a band or a filter, give them in a design file and --design"
        )
    if family not in TABLES:
        known = ", ".join(TABLES)
        raise InputError(f"--family: {family!r} is not known, give {known} or a --design")
    if not 1 <= samples <= MAX_SAMPLES:
        raise InputError(f"--samples: {samples} is not allowed, give 1 to {MAX_SAMPLES}")
    if not 0 <= history <= MAX_SAMPLES:
        raise InputError(f"--history: {history} is not allowed, give 0 to {MAX_SAMPLES}")
    if family != "filtered-rate" and samples + history < 2:
        raise InputError(
            f"--samples: 1 sample without history gives no cross product for {family}, give"
            " --samples 2 or --history 1"
        )
    kind = SENSOR_KINDS[family][0]
    made = make(Recipe(family, samples, history, kind=kind))
    title = f"{family}, samples n = {samples}, history p = {history}"
    return Outcome(title, made.table, (_residual(made.table, kind), *made.report()))


def _residual(table: TapTable, kind: str) -> str:
    """What coning the table leaves, in a sentence."""
    term = leading_term(table, "increment" if kind == "increment" else "rate")
    return (
        "Left by classical coning of half angle a at frequency Ω, computed minus true, in a minor\n"
        f"interval: {term.coefficient} a² (Ωh)^{term.power} rad and higher powers; h is the sample"
        " interval."
    )
