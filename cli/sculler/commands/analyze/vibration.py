"""`sculler analyze vibration`: rectified coning and sculling of a shaken sensor assembly."""

from __future__ import annotations

from math import degrees, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.analyze import subjects
from sculler.commands.options.vibration import SPECTRUM_HELP, mount, mount_options

if TYPE_CHECKING:
    from rich.table import Table

    from sculler_model.analysis.vibration import Errors, Mount, MountResponse, Spectrum
    from sculler_model.design import Design

PER_HOUR = degrees(1) * 3600


@click.command(
    short_help="Rectified coning and sculling under random vibration.",
    epilog=terminal.examples(
        "sculler analyze vibration stim300 --spectrum savage-98 -o build/vibration.png",
        "sculler analyze vibration --family frequency-taylor --samples 2 --samples 4 \\\n"
        "    --spectrum flat:20-2000:0.04 --imbalance 2 --offset 0.5 --check 120",
    ),
)
@subjects.subject_options
@click.option(
    "--spectrum", default="savage-98", show_default=True, metavar="NAME|FILE", help=SPECTRUM_HELP
)
@mount_options
@click.option(
    "--check",
    "check_seconds",
    type=terminal.number_type(0, 3600, above=True),
    metavar="SECONDS",
    help="Also run so long a random vibration through counts, core and host, in 8 parts.",
)
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True, help="Of --check.")
@subjects.picture_option
@terminal.json_option
def command(
    spectrum: str,
    check_seconds: float | None,
    seed: int,
    output: Path | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Show what a vibration rectifies to in a sensor assembly on isolators, and what is left of it.

    A linear mode along the vibration and two rotary modes, coupled by imbalance and offset of the
    centre of mass (Savage-98 section VI), their signs chosen to be worst.  `model` has the phases
    of that model; `worst phase` bounds any phases.
    """
    from sculler.formats.spectra import spectrum_of
    from sculler_model.analysis.vibration import respond, sensor_filter, step_for

    subjects.require_picture(output)
    names = mount.__annotations__
    shaken = mount(**{name: options.pop(name) for name in names if name in options})
    designs = {name: found.design for name, found in subjects.subjects(**options).items()}
    psd = spectrum_of(spectrum)
    data: dict[str, Any] = {}
    first = None
    for name, design in designs.items():
        response = respond(
            psd, shaken, step_for(design.table.samples, design.sensor.sample_rate_hz)
        )
        first = first or response
        T, kind = design.sample_interval, design.sensor.kind
        passed = sensor_filter(design)
        data[name] = {
            "sample_rate_hz": design.sensor.sample_rate_hz,
            "model": _errors(response.rectified.errors(design.table, T, kind, passed)),
            "worst_phase": _errors(response.worst_phase.errors(design.table, T, kind, passed)),
        }
        if check_seconds is not None:
            data[name]["check"] = _check(design, psd, shaken, check_seconds, seed)
    assert first is not None  # subjects() gives one at least
    summary = {"study": "vibration", "spectrum": psd.name, **_motion(first), "designs": data}
    if output is not None:
        from sculler.plots.vibration import vibration_picture

        vibration_picture(output, psd, first, designs)
        summary["picture"] = str(output)
    terminal.report(
        summary,
        as_json,
        terminal.facts(_facts(summary), title=f"{psd.name} through the mount"),
        _table(data),
        *([_check_table(data)] if check_seconds is not None else []),
        *([f"picture: {terminal.verbatim(output)}"] if output else []),
    )


def _errors(errors: Errors) -> dict[str, float]:
    from sculler_model.analysis.vibration import G

    along = errors.sculling / G * 1e6
    return {
        "coning_deg_per_h": errors.coning * PER_HOUR,
        "sculling_y_ug": float(along[1]),
        "sculling_z_ug": float(along[2]),
    }


def _motion(response: MountResponse) -> dict[str, Any]:
    """What the sensor assembly feels, and what it rectifies to."""
    from sculler_model.analysis.vibration import G

    y, z = response.angle_rms
    motion: dict[str, Any] = {
        "input_g_rms": response.input_rms / G,
        "response_g_rms": response.force_rms / G,
        "rotation_y_rad_rms": y,
        "rotation_z_rad_rms": z,
        "rotation_rad_rms": sqrt(y * y + z * z),
    }
    for name, found in (("model", response.rectified), ("worst_phase", response.worst_phase)):
        force = found.sculling_force / G * 1e6
        motion[name] = {
            "coning_deg_per_h": found.coning_rate * PER_HOUR,
            "sculling_y_ug": float(force[1]),
            "sculling_z_ug": float(force[2]),
        }
    return motion


PARTS = 8


def _check(
    design: Design, psd: Spectrum, shaken: Mount, seconds: float, seed: int
) -> dict[str, Any]:
    """Random vibrations through the integer path: mean errors and how sure they are."""
    import numpy as np

    from sculler_model.analysis.vibration import G, trial

    coning, sculling = [], []
    with terminal.progress("integer path", PARTS) as advance:
        for part in range(PARTS):
            found = trial(design, psd, shaken, seconds / PARTS, seed + part)
            coning.append((found.coning - found.true_coning) * PER_HOUR)
            sculling.append((found.sculling - found.true_sculling) / G * 1e6)
            advance(1)
    columns = np.column_stack((coning, np.array(sculling)[:, 1:]))
    names = ("coning_deg_per_h", "sculling_y_ug", "sculling_z_ug")
    means, sigmas = columns.mean(axis=0), columns.std(axis=0, ddof=1) / sqrt(PARTS)
    return {
        "seconds": seconds,
        "seed": seed,
        "error": dict(zip(names, means.tolist(), strict=True)),
        "sigma": dict(zip(names, sigmas.tolist(), strict=True)),
    }


def _facts(data: dict[str, Any]) -> dict[str, str]:
    def rectified(name: str) -> str:
        found = data[name]
        return (
            f"coning {found['coning_deg_per_h']:.4g} °/h, sculling {found['sculling_y_ug']:.4g}"
            f" and {found['sculling_z_ug']:.4g} µg along y and z"
        )

    return {
        "input": f"{data['input_g_rms']:.3g} g rms",
        "sensor assembly": f"{data['response_g_rms']:.3g} g rms,"
        f" {data['rotation_y_rad_rms']:.3g} and {data['rotation_z_rad_rms']:.3g} rad rms about y"
        " and z",
        "rectified, model": rectified("model"),
        "rectified, worst phase": rectified("worst_phase"),
    }


_COLUMNS = (
    ("coning_deg_per_h", "coning (°/h)"),
    ("sculling_y_ug", "sculling y (µg)"),
    ("sculling_z_ug", "sculling z (µg)"),
)


def _table(data: dict[str, Any]) -> Table:
    from rich.table import Table

    table = Table(
        title="[bold]what the algorithm leaves of it, computed minus true; worst phase: at most[/]",
        title_justify="left",
    )
    table.add_column("design")
    table.add_column("phases")
    for _, title in _COLUMNS:
        table.add_column(title, justify="right")
    for name, found in data.items():
        for key, words in (("model", "model"), ("worst_phase", "worst phase")):
            table.add_row(
                name if key == "model" else "",
                words,
                *(f"{found[key][column]:.3g}" for column, _ in _COLUMNS),
                end_section=key == "worst_phase",
            )
    return table


def _check_table(data: dict[str, Any]) -> Table:
    from rich.table import Table

    seconds = next(iter(data.values()))["check"]["seconds"]
    table = Table(
        title=f"[bold]the same through counts, core and host: {seconds:g} s at random[/]",
        title_justify="left",
    )
    table.add_column("design")
    for _, title in _COLUMNS:
        table.add_column(title, justify="right")
    for name, found in data.items():
        error, sigma = found["check"]["error"], found["check"]["sigma"]
        table.add_row(name, *(f"{error[c]:.3g} ± {sigma[c]:.1g}" for c, _ in _COLUMNS))
    return table
