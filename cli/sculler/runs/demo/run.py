"""Motion, log, Verilog, golden model, simulation, comparison, navigation, pictures."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.formats.comparison import Difference, compare
from sculler.formats.history import HistoryWriter
from sculler.formats.log import LogWriter
from sculler.formats.vectors import read_vectors
from sculler.plots.pictures import left_out
from sculler.runs.counts import model_log, simulate_log
from sculler.runs.demo.outcome import CORRECTED, QUANTITIES, UNCORRECTED, Outcome
from sculler.runs.demo.pictures import draw
from sculler.runs.engines import SimulationEngine, choose_engine
from sculler.runs.hardware import write_hardware
from sculler.units import ARCSEC
from sculler.words import silent
from sculler_model.design import Design
from sculler_model.fast import VectorBlock
from sculler_model.host import major_increments, uncorrected
from sculler_model.motion import Motion, demo_motion
from sculler_model.navigation import NavErrors, NavHistory, navigate, navigation_errors
from sculler_model.outputs import make_folder, replacing
from sculler_model.samples import Quantiser
from sculler_sim.engines.verilator_build import build
from sculler_sim.stimulus import Stimulus

Array = NDArray[np.float64]
Done = Callable[[str, float], None]
"""Told that a step is done, and the seconds it took."""


def run_demo(
    folder: Path,
    seconds: float = 60.0,
    *,
    pictures: bool = True,
    done: Done = lambda step, took: None,
) -> Outcome:
    """Show the main job on a motion whose truth is known.

    A vehicle turns while it cones and sculls.  Its integer log goes through the simulated hardware
    and through the golden model, and the two are compared.  Then the host navigates, and so does an
    integrator that knows no corrections; both are held against the truth.

    Args:
        folder: where to write; it is made if need be.
        seconds: length of the motion.
        pictures: draw them, where matplotlib is there; else the outcome's warnings say so.
        done: told each step as it ends.

    Raises:
        InputError: $CXX cannot be used, or the folder cannot be written to.
        SimulationError: the core hangs.
    """
    warnings = []
    if pictures and (no_pictures := left_out()) is not None:
        warnings.append(no_pictures)
        pictures = False
    engine, no_verilator = choose_engine()  # asked before anything is written
    if no_verilator is not None:
        warnings.append(f"simulated by Amaranth: {no_verilator}")
    make_folder(folder)

    steps = _Steps(done)
    design, motion = Design.preset("stim300"), demo_motion()
    samples = round(seconds * design.sensor.sample_rate_hz)
    difference = _counts(folder, design, motion, samples, engine, steps)
    with steps("navigation"):
        flown = _Flown.of(folder, design, motion)
        flown.write(folder)
    drawn: list[Path] = []
    if pictures:
        with steps("pictures"):
            drawn = draw(folder, design, flown.truth, flown.estimates, flown.errors)
    outcome = Outcome(
        design,
        folder,
        seconds,
        samples,
        flown.majors,
        engine,
        difference,
        flown.identical,
        flown.errors_at_end,
        warnings,
        steps.seconds,
        drawn,
    )
    outcome.write()
    return outcome


class _Steps:
    """Times the steps and tells each as it ends."""

    def __init__(self, done: Done) -> None:
        self._done = done
        self.seconds: dict[str, float] = {}

    @contextmanager
    def __call__(self, name: str) -> Iterator[None]:
        began = time.perf_counter()
        yield
        self.seconds[name] = time.perf_counter() - began
        self._done(name, self.seconds[name])


def _counts(
    folder: Path,
    design: Design,
    motion: Motion,
    samples: int,
    engine: SimulationEngine,
    steps: _Steps,
) -> Difference | None:
    """The exact path: the log, and its vectors by model and hardware; where the two differ."""
    log, model, rtl = (folder / name for name in ("imu.csv", "model.csv", "rtl.csv"))
    if engine == "verilator":
        with steps("simulator, compiled or from the cache"):
            build(design)
    with steps("motion and its IMU log"):
        _write_log(log, design, motion, samples)
    with steps("Verilog, manifest and test bench"):
        write_hardware(design, folder / design.name)
    with steps("golden model"):
        model_log(design, log, model, "fast", silent)
    with steps(f"RTL in {engine.capitalize()}"):
        simulate_log(design, log, rtl, engine, Stimulus.always(), None, silent)
    with steps("comparison"):
        return compare(rtl, model)


def _write_log(path: Path, design: Design, motion: Motion, samples: int) -> None:
    quantise = Quantiser(design)
    chunks = motion.chunks(design.sensor.kind, samples, design.sample_interval)
    with replacing(path) as temporary, LogWriter(temporary) as writer:
        for chunk in chunks:
            writer.write(quantise(chunk))


@dataclass(frozen=True)
class _Flown:
    """What came of navigating with the vectors.

    Attributes:
        majors: results of the hardware.
        truth: the motion at the instants of the estimates.
        estimates: by `CORRECTED` and `UNCORRECTED`, of the hardware's vectors.
        errors: of each, sizes of the attitude (arcsec), velocity (m/s) and position (m) errors.
        identical: whether the model's vectors give the same states.
    """

    majors: int
    truth: NavHistory
    estimates: dict[str, NavHistory]
    errors: dict[str, tuple[Array, Array, Array]]
    identical: bool

    @classmethod
    def of(cls, folder: Path, design: Design, motion: Motion) -> _Flown:
        """Navigate with `rtl.csv` and `model.csv` of the folder."""
        simulated, modelled = (
            VectorBlock.concatenate(list(read_vectors(folder / name, design)))
            for name in ("rtl.csv", "model.csv")
        )
        T, start = design.major_interval, motion.state(np.zeros(1)).state(0)
        estimates = {
            CORRECTED: navigate(start, T, major_increments(design, simulated)),
            UNCORRECTED: navigate(start, T, uncorrected(design, simulated)),
        }
        twin = navigate(start, T, major_increments(design, modelled))
        truth = motion.state(twin.time)
        errors = {
            name: _sizes(navigation_errors(estimate, truth)) for name, estimate in estimates.items()
        }
        identical = _same(estimates[CORRECTED], twin)
        return cls(len(simulated), truth, estimates, errors, identical)

    @property
    def errors_at_end(self) -> dict[str, dict[str, float]]:
        """The last of the errors, by `QUANTITIES`."""
        return {
            name: dict(zip(QUANTITIES, (float(series[-1]) for series in three), strict=True))
            for name, three in self.errors.items()
        }

    def write(self, folder: Path) -> None:
        """The states as `nav_*.csv`."""
        for name, history in {"truth": self.truth, **self.estimates}.items():
            path = folder / f"nav_{name}.csv"
            with replacing(path) as temporary, HistoryWriter(temporary) as writer:
                writer.write(history)


def _sizes(errors: NavErrors) -> tuple[Array, Array, Array]:
    """Sizes of the attitude (arcsec), velocity (m/s) and position (m) errors, (N,) each."""
    attitude, velocity, position = (
        np.linalg.norm(table, axis=1)
        for table in (errors.attitude, errors.velocity, errors.position)
    )
    return ARCSEC * attitude, velocity, position


def _same(a: NavHistory, b: NavHistory) -> bool:
    return all(np.array_equal(getattr(a, name), getattr(b, name)) for name in ("q", "v", "lat"))
