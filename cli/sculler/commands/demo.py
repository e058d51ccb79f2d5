"""`sculler demo`: the main job from end to end, with nothing but this program."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from rich.table import Table

    from sculler.runs.counts import SimulationEngine
    from sculler_model.design import Design
    from sculler_model.motion import Motion
    from sculler_model.navigation import NavErrors, NavHistory

    Array = NDArray[np.float64]

_FAILED = 1
CORRECTED, UNCORRECTED = "corrected", "uncorrected"
"""The host with the core's coning and sculling, and an integrator of the plain sums."""


@click.command(epilog=terminal.examples("sculler demo -o build/demo --seconds 60"))
@click.option(
    "-o",
    "--output",
    "folder",
    type=click.Path(path_type=Path),
    default=Path("build/demo"),
    show_default=True,
    metavar="FOLDER",
    help="Where to write.",
)
@click.option(
    "--seconds",
    type=terminal.number_type(1, 3600),
    default=60.0,
    show_default=True,
    help="Length of the motion.",
)
@click.option("--plots/--no-plots", default=True, show_default=True, help="Draw the pictures.")
@terminal.json_option
def command(folder: Path, seconds: float, plots: bool, as_json: bool) -> int:
    """Show the main job on a motion whose truth is known.

    A vehicle turns while it cones and sculls.  Its integer IMU log goes through the generated
    Verilog (in Verilator) and through the golden model; the two must agree bit for bit.  Then the
    host navigates, and so does an integrator that knows no corrections; both are held against
    the truth.
    """
    import numpy as np

    from sculler.commands.generate import write_hardware
    from sculler.formats.comparison import compare
    from sculler.formats.history import HistoryWriter
    from sculler.formats.vectors import read_vectors
    from sculler.plots.pictures import left_out as pictures_left_out
    from sculler.runs.counts import model_log, simulate_log
    from sculler_model.design import Design
    from sculler_model.fast import VectorBlock
    from sculler_model.host import major_increments, uncorrected
    from sculler_model.motion import demo_motion
    from sculler_model.navigation import navigate, navigation_errors
    from sculler_model.outputs import make_folder, replacing
    from sculler_sim.engines.verilator_build import build
    from sculler_sim.stimulus import Stimulus

    left_out = []
    if plots and (no_pictures := pictures_left_out()) is not None:
        left_out, plots = [no_pictures], False
    steps = _Steps(quiet=as_json)
    design, motion = Design.preset("stim300"), demo_motion()
    T = design.major_interval
    samples = round(seconds * design.sensor.sample_rate_hz)
    log, model, rtl = (folder / name for name in ("imu.csv", "model.csv", "rtl.csv"))
    engine: SimulationEngine = "verilator"
    no_verilator = terminal.why_no_verilator()  # asked before anything is written
    if no_verilator is not None:
        engine = "amaranth"
        left_out.append(f"simulated by Amaranth: {no_verilator}")
    make_folder(folder)

    if engine == "verilator":
        with steps("simulator, compiled or from the cache"):
            build(design)
    with steps("motion and its IMU log"):
        _write_log(log, design, motion, samples)
    with steps("Verilog, manifest and test bench"):
        write_hardware(design, folder / design.name)
    with steps("golden model"):
        model_log(design, log, model, "fast", terminal.silent)
    with steps(f"RTL in {engine.capitalize()}"):
        simulate_log(design, log, rtl, engine, Stimulus.always(), None, terminal.silent)
    with steps("comparison"):
        difference = compare(rtl, model)
    with steps("navigation"):
        simulated, modelled = (
            VectorBlock.concatenate(list(read_vectors(path, design))) for path in (rtl, model)
        )
        start = motion.state(np.zeros(1)).state(0)
        estimates = {
            CORRECTED: navigate(start, T, major_increments(design, simulated)),
            UNCORRECTED: navigate(start, T, uncorrected(design, simulated)),
        }
        twin = navigate(start, T, major_increments(design, modelled))
        truth = motion.state(twin.time)
        errors = {
            name: _sizes(navigation_errors(estimate, truth)) for name, estimate in estimates.items()
        }
        for name, history in {"truth": truth, **estimates}.items():
            path = folder / f"nav_{name}.csv"
            with replacing(path) as temporary, HistoryWriter(temporary) as writer:
                writer.write(history)
    pictures: list[Path] = []
    if plots:
        with steps("pictures"):
            pictures = _pictures(folder, design, truth, estimates, errors)

    data = {
        "design": design.name,
        "seconds": seconds,
        "samples": samples,
        "majors": len(simulated),
        "identical": difference is None,
        "navigation_identical": _same(estimates[CORRECTED], twin),
        "errors_at_end": {
            name: dict(zip(QUANTITIES, (float(series[-1]) for series in three), strict=True))
            for name, three in errors.items()
        },
        "engine": engine,
        "warnings": left_out,
        "steps_s": steps.seconds,
        "pictures": [str(picture) for picture in pictures],
        "folder": str(folder),
    }
    _write_notes(folder, data, design)
    warnings = [f"warning: {terminal.verbatim(warning)}" for warning in left_out]
    terminal.report(
        data, as_json, "", _verdict(data), "", _table(data), "", *warnings, _where(data)
    )
    return 0 if data["identical"] and data["navigation_identical"] else _FAILED


QUANTITIES = ("attitude_arcsec", "velocity_m_s", "position_m")


class _Steps:
    """Times the steps and tells each as it ends."""

    def __init__(self, quiet: bool) -> None:
        self._quiet = quiet
        self.seconds: dict[str, float] = {}

    @contextmanager
    def __call__(self, name: str) -> Iterator[None]:
        began = time.perf_counter()
        yield
        self.seconds[name] = time.perf_counter() - began
        if not self._quiet:
            terminal.stdout_console().print(
                f"[green]done[/] {name} [dim]{self.seconds[name]:.1f} s[/]"
            )


def _write_log(path: Path, design: Design, motion: Motion, samples: int) -> None:
    from sculler.formats.log import LogWriter
    from sculler_model.outputs import replacing
    from sculler_model.samples import Quantiser

    quantise = Quantiser(design)
    chunks = motion.chunks(design.sensor.kind, samples, design.sample_interval)
    with replacing(path) as temporary, LogWriter(temporary) as writer:
        for chunk in chunks:
            writer.write(quantise(chunk))


def _sizes(errors: NavErrors) -> tuple[Array, Array, Array]:
    """Sizes of the attitude (arcsec), velocity (m/s) and position (m) errors, (N,) each."""
    import numpy as np

    from sculler.units import ARCSEC

    attitude, velocity, position = (
        np.linalg.norm(table, axis=1)
        for table in (errors.attitude, errors.velocity, errors.position)
    )
    return ARCSEC * attitude, velocity, position


def _same(a: NavHistory, b: NavHistory) -> bool:
    import numpy as np

    return all(np.array_equal(getattr(a, name), getattr(b, name)) for name in ("q", "v", "lat"))


def _pictures(
    folder: Path,
    design: Design,
    truth: NavHistory,
    estimates: dict[str, NavHistory],
    errors: dict[str, tuple[Array, Array, Array]],
) -> list[Path]:
    """Errors over time, tracks, and what the algorithm leaves of coning at other frequencies."""
    import numpy as np

    from sculler.plots import pictures as plots
    from sculler_model.algorithms import frequency_taylor
    from sculler_model.analysis.closed_form import drift_rate, uncorrected_rate

    paths = [folder / name for name in ("errors.png", "track.png", "coning.png")]
    plots.error_picture(paths[0], truth.time, errors)
    plots.track_picture(paths[1], truth, estimates)

    n, T = design.algorithm.samples, design.sample_interval
    frequency = np.geomspace(1, 0.5 / T, 600)
    half_angle = np.radians(0.1)
    hour = np.degrees(1) * 3600
    omega = 2 * np.pi * frequency
    curves = {"uncorrected": hour * uncorrected_rate(half_angle, half_angle, omega)}
    for samples in (n, 3, 2):
        table = frequency_taylor(samples, 0)
        curves[f"n = {samples} samples a minor interval"] = hour * drift_rate(
            table, half_angle, half_angle, omega, T
        )
    plots.coning_picture(paths[2], frequency, curves, 50.0, "0.1°", 1 / T)
    return paths


def _verdict(data: dict[str, Any]) -> str:
    if data["identical"]:
        return (
            f"[green]identical[/]: {data['majors']:,} results of the RTL and of the golden model,"
            f" {data['samples']:,} samples, every integer"
        )
    return "[red]DIFFERENT[/]: the RTL and the golden model, see sculler compare"


_SIMULATED = {
    "verilator": "what the Verilog gave in Verilator",
    "amaranth": "what the core gave in Amaranth's simulator",
}
_LABELS = ("attitude", "velocity", "position")
_UNITS = ("arcsec", "m/s", "m")


def _table(data: dict[str, Any]) -> Table:
    from rich.table import Table

    table = Table(title=f"error after {data['seconds']:g} s", title_justify="left")
    table.add_column("")
    for name in (CORRECTED, UNCORRECTED, "times smaller"):
        table.add_column(name, justify="right")
    good, bad = (data["errors_at_end"][name] for name in (CORRECTED, UNCORRECTED))
    for label, unit, key in zip(_LABELS, _UNITS, QUANTITIES, strict=True):
        table.add_row(
            label,
            f"{terminal.three_digits(good[key])} {unit}",
            f"{terminal.three_digits(bad[key])} {unit}",
            f"{bad[key] / good[key]:,.0f}" if good[key] else "",
        )
    return table


def _where(data: dict[str, Any]) -> str:
    made = "files and pictures" if data["pictures"] else "files"
    return f"{made}: {terminal.verbatim(data['folder'])} (README.md says what is what)"


def _write_notes(folder: Path, data: dict[str, Any], design: Design) -> None:
    """summary.json, and a README of the folder."""
    from sculler_model.outputs import replacing

    good, bad = (data["errors_at_end"][name] for name in (CORRECTED, UNCORRECTED))
    lines = [
        "# sculler demo",
        "",
        f"{data['seconds']:g} s of a vehicle at 30 m/s in a 6 °/s turn, coning (0.1° at 50 Hz) and"
        " sculling (0.1° of roll",
        "with 10 m/s² at 35 Hz), as a STIM300 would sense it.  Everything here was made by"
        " `sculler demo`.",
        "",
        "| file | what it is |",
        "|---|---|",
        f"| `imu.csv` | the integer IMU log, {data['samples']:,} samples |",
        f"| `{design.name}/` | the generated Verilog, its manifest and its own test bench |",
        f"| `rtl.csv` | {_SIMULATED[data['engine']]} |",
        "| `model.csv` | what the golden model gave: "
        + ("the same integers |" if data["identical"] else "NOT the same |"),
        "| `nav_truth.csv`, `nav_corrected.csv`, `nav_uncorrected.csv` | attitude, velocity and"
        " position after every major interval |",
        "| `errors.png` | attitude, velocity and position errors against the truth |",
        "| `track.png` | the ground track |",
        "| `coning.png` | what the algorithm leaves of such coning, by frequency (closed form) |",
        "| `summary.json` | the figures |",
        "",
        f"| error after {data['seconds']:g} s | corrected | uncorrected |",
        "|---|---:|---:|",
        *(
            f"| {label} ({unit}) | {terminal.three_digits(good[key])} |"
            f" {terminal.three_digits(bad[key])} |"
            for label, unit, key in zip(_LABELS, _UNITS, QUANTITIES, strict=True)
        ),
    ]
    if not data["pictures"]:
        lines = [line for line in lines if ".png" not in line]
    for name, text in (
        ("summary.json", json.dumps(data, indent=2)),
        ("README.md", "\n".join(lines)),
    ):
        with replacing(folder / name) as temporary:
            temporary.write_text(text + "\n", encoding="utf-8")
