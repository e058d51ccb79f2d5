"""What `coning` and `sculling` share: from the options to tables and a picture."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sculler import terminal
from sculler.commands.options import analysis as options

if TYPE_CHECKING:
    from rich.table import Table

    from sculler.runs.analysis import Kind


def run(kind: Kind, asked: Mapping[str, Any], output: Path | None, as_json: bool) -> None:
    """Study, draw and tell.

    Args:
        kind: the motion, and the words.
        asked: the options of `subject_options` and `frequency_options`.
        output: the picture, or None.
        as_json: how to tell.
    """
    from sculler.runs.analysis import frequency_study

    options.require_picture(output)
    plan = options.frequency_plan(kind, asked)
    with terminal.progress("integer path", plan.steps) as advance:
        data = frequency_study(plan, advance=advance)
    if output is not None:
        from sculler.plots.analysis import frequency_picture

        frequency_picture(output, kind.title, kind.unit, data)
        data["picture"] = str(output)
    terminal.report(data, as_json, *_tables(kind, data), *options.picture_told(output))


def _tables(kind: Kind, data: dict[str, Any]) -> list[Table]:
    return [_laws(kind, data), _points(kind, data)]


def _laws(kind: Kind, data: dict[str, Any]) -> Table:
    from rich.table import Table

    laws = Table(
        title="[bold]residual per minor interval, λ = Ω·T, and where it meets a requirement[/]",
        title_justify="left",
    )
    laws.add_column("design")
    for column in ("first term", "measured order", "measured constant"):
        laws.add_column(column, justify="right")
    for limit in data["requirements"]:
        laws.add_column(f"≤ {limit:g} {kind.unit} up to", justify="right")
    for name, found in data["designs"].items():
        law = found["law"]
        laws.add_row(
            name,
            _first_term(law),
            f"{law['measured_order']:.3f}",
            f"{law['measured_constant']:.6g}",
            *(_hertz(limit) for limit in found["meets_up_to_hz"]),
        )
    return laws


def _points(kind: Kind, data: dict[str, Any]) -> Table:
    from rich.table import Table

    points = Table(title=f"[bold]drift, computed minus true ({kind.unit})[/]", title_justify="left")
    points.add_column("design")
    last = ("iteration",) if "degree" in data else ()
    for column in (
        "frequency (Hz)",
        "uncorrected",
        "closed form",
        "integers",
        kind.complete,
        *last,
    ):
        points.add_column(column, justify="right")
    per_hertz = data["uncorrected"][-1], data["frequency_hz"][-1]
    for name, found in data["designs"].items():
        for i, point in enumerate(found["integer_path"]):
            points.add_row(
                name if i == 0 else "",
                f"{point['hertz']:.5g}",
                f"{_uncorrected(kind, per_hertz, point['hertz']):.3g}",
                f"{point['closed_form']:.4g}",
                f"{point['second_order']:.4g}",
                f"{point['complete']:.4g}",
                *(f"{point[key]:.4g}" for key in last),
                end_section=i == len(found["integer_path"]) - 1,
            )
        if found["does_not_fit_sensor_hz"]:
            first = min(found["does_not_fit_sensor_hz"])
            points.add_row("", f"from {first:.5g}", "", "does not fit the sensor's word")
    return points


def _uncorrected(kind: Kind, last: tuple[float, float], hertz: float) -> float:
    """Coning's rectification grows with the frequency, sculling's does not."""
    drift, highest = last
    return drift * hertz / highest if kind.verb == "coning" else drift


def _first_term(law: dict[str, Any]) -> str:
    if law["constant"] is None:
        return "of the filter"
    constant = law["constant"]
    if len(constant) > 16:
        numerator, _, denominator = constant.partition("/")
        constant = f"{int(numerator) / int(denominator or 1):.4g}"
    return f"{constant} λ^{law['order']}"


def _hertz(value: float | None) -> str:
    return "nowhere" if value is None else f"{value:.4g} Hz"
