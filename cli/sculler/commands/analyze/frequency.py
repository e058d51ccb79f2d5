"""What `coning` and `sculling` share: drift against frequency, in tables and a picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sculler import terminal

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from rich.table import Table

    from sculler_model.analysis.frequency import Oscillation
    from sculler_model.design import Design

    Array = NDArray[np.float64]


@dataclass(frozen=True)
class Kind:
    """How a study speaks of its drift.

    Attributes:
        verb: "coning" or "sculling".
        title: of the picture.
        unit: of drifts.
        scale: units per rad/s or m/s².
        complete: what the host arrives at.
    """

    verb: str
    title: str
    unit: str
    scale: float
    complete: str


def study(
    kind: Kind,
    vibration: Oscillation,
    designs: Mapping[str, Design],
    own_sensor: Mapping[str, bool],
    band: tuple[float, float | None],
    points: int,
    integer_points: int,
    requirements: Sequence[float],
    output: Path | None,
    as_json: bool,
) -> None:
    """Compute, tell and draw.

    Args:
        kind: the words.
        vibration: the motion.
        designs: by name.
        own_sensor: whether a design's integer path runs on its own sensor, or on a fine one.
        band: lowest and highest frequency, Hz; None is the Nyquist limit of the fastest design.
        points, integer_points: how many frequencies by closed form and through the integer path.
        requirements: drifts in kind's unit.
        output: the picture, or None.
        as_json: how to tell.

    Raises:
        InputError: the band is empty for a design.
    """
    import numpy as np

    from sculler_model.analysis import frequency as analysis

    nyquist = {name: d.sensor.sample_rate_hz / 2 for name, d in designs.items()}
    low, high = band[0], band[1] or max(nyquist.values())
    _check_band(low, high, nyquist)
    hertz = np.geomspace(low, high, points)
    curves = {}
    data: dict[str, Any] = {
        "study": kind.verb,
        "vibration": asdict(vibration),
        "unit": kind.unit,
        "requirements": list(requirements),
        "frequency_hz": hertz.tolist(),
        "uncorrected": (kind.scale * analysis.uncorrected(vibration, hertz)).tolist(),
        "designs": {},
    }
    with terminal.progress("integer path", len(designs) * (integer_points + 2)) as advance:
        for name, design in designs.items():
            top = min(high, nyquist[name])
            inside = np.where(hertz <= top, hertz, np.nan)
            curves[name] = kind.scale * analysis.drift(design, vibration, inside)
            law = analysis.law(design, vibration)
            advance(2)
            measured, too_large = _integer_points(
                design, vibration, own_sensor[name], low, top, integer_points, advance
            )
            data["designs"][name] = {
                "nyquist_hz": nyquist[name],
                "sensor": "own" if own_sensor[name] else "fine",
                "drift": [None if np.isnan(x) else x for x in curves[name].tolist()],
                "law": {
                    "constant": None if law.constant is None else str(law.constant),
                    "order": law.order,
                    "measured_constant": law.measured_constant,
                    "measured_order": law.measured_order,
                    "measured_hz": [p / (2 * pi * design.sample_interval) for p in law.phases],
                },
                "meets_up_to_hz": [
                    _meets_up_to(hertz, curves[name], limit) for limit in requirements
                ],
                "integer_path": [
                    {
                        **asdict(point),
                        **{
                            key: kind.scale * getattr(point, key)
                            for key in ("closed_form", "second_order", "complete")
                        },
                    }
                    for point in measured
                ],
                "does_not_fit_sensor_hz": too_large,
            }
    if output is not None:
        from sculler.plots.analysis import frequency_picture

        frequency_picture(output, kind.title, kind.unit, data)
        data["picture"] = str(output)
    terminal.report(
        data,
        as_json,
        *_tables(kind, data),
        *([f"picture: {terminal.verbatim(output)}"] if output else []),
    )


def _check_band(low: float, high: float, nyquist: Mapping[str, float]) -> None:
    from sculler_model.errors import InputError

    fastest = max(nyquist.values())
    if high > fastest:
        raise InputError(
            f"--to: {high:g} Hz is above the Nyquist limit of {fastest:g} Hz, give less"
        )
    for name, limit in nyquist.items():
        if low >= min(high, limit):
            raise InputError(
                f"--from: {low:g} Hz leaves no band below {min(high, limit):g} Hz for {name},"
                " give less"
            )


def _integer_points(
    design: Design,
    vibration: Oscillation,
    own_sensor: bool,
    low: float,
    high: float,
    count: int,
    advance: terminal.Advance,
) -> tuple[list[Any], list[float]]:
    """Points through the integer path, and the frequencies that do not fit the sensor."""
    import numpy as np

    from sculler_model.analysis import frequency as analysis

    if not own_sensor:
        design = analysis.fine(design, vibration, high)
    measured, too_large = [], []
    for hertz in np.geomspace(low, 0.95 * high, count).tolist():
        if analysis.fits(design, vibration, hertz):
            measured.append(analysis.integer_point(design, vibration, hertz))
        else:
            too_large.append(hertz)
        advance(1)
    return measured, too_large


def _meets_up_to(hertz: Array, drift: Array, limit: float) -> float | None:
    """The highest frequency up to which the drift stays within a limit; None if it never does."""
    import numpy as np

    over = np.flatnonzero(~(np.abs(drift) <= limit))
    if len(over) == 0:
        return float(hertz[-1])
    return float(hertz[over[0] - 1]) if over[0] else None


def _tables(kind: Kind, data: dict[str, Any]) -> list[Table]:
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
    points = Table(title=f"[bold]drift, computed minus true ({kind.unit})[/]", title_justify="left")
    points.add_column("design")
    for column in ("frequency (Hz)", "uncorrected", "closed form", "integers", kind.complete):
        points.add_column(column, justify="right")
    per_hertz = data["uncorrected"][-1], data["frequency_hz"][-1]
    for name, found in data["designs"].items():
        law = found["law"]
        laws.add_row(
            name,
            _first_term(law),
            f"{law['measured_order']:.3f}",
            f"{law['measured_constant']:.6g}",
            *(_hertz(limit) for limit in found["meets_up_to_hz"]),
        )
        for i, point in enumerate(found["integer_path"]):
            points.add_row(
                name if i == 0 else "",
                f"{point['hertz']:.5g}",
                f"{_uncorrected(kind, per_hertz, point['hertz']):.3g}",
                f"{point['closed_form']:.4g}",
                f"{point['second_order']:.4g}",
                f"{point['complete']:.4g}",
                end_section=i == len(found["integer_path"]) - 1,
            )
        if found["does_not_fit_sensor_hz"]:
            first = min(found["does_not_fit_sensor_hz"])
            points.add_row("", f"from {first:.5g}", "", "does not fit the sensor's word", "", "")
    return [laws, points]


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
