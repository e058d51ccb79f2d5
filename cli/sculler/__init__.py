"""Coning and sculling in exact integers: generator, golden model, simulation and navigator.

    design = sculler.Design.load("stim300_4x5.toml")
    core = sculler.generate(design)                 # .verilog, .manifest, .write(folder)
    log = sculler.read_log("imu.csv")               # counts (N, 6), .to_pandas()
    vectors = sculler.FastModel(design).feed(log)   # exact integers, a row each major interval
    rtl = sculler.simulate(design, log)             # the same from the Verilog
    assert sculler.compare(vectors, rtl) is None
    run = sculler.navigate(design, vectors, lat=48, lon=11, height=500, align=300)
    run.history.to_pandas()

Inputs are numpy arrays of any integer type (nothing is ever wrapped or rounded), pandas or polars
frames, or paths; outputs have `to_numpy()` and `to_pandas()`.  Every error that is raised on
purpose is a `sculler.Error`.  What stands in `__all__` is stable; it is loaded when it is first
used, so that the command line starts fast.

The verbs of the command line are `sculler.commands`; `sculler.main.main` is their entry point.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sculler.formats.comparison import Difference as Difference
    from sculler.library.hardware import Core as Core
    from sculler.library.hardware import generate as generate
    from sculler.library.hardware import simulate as simulate
    from sculler.library.live import LiveNavigator as LiveNavigator
    from sculler.library.logs import Log as Log
    from sculler.library.logs import read_log as read_log
    from sculler.library.logs import write_log as write_log
    from sculler.library.models import FastModel as FastModel
    from sculler.library.motions import motion as motion
    from sculler.library.motions import motion_through as motion_through
    from sculler.library.motions import record as record
    from sculler.library.navigating import Navigated as Navigated
    from sculler.library.navigating import increments as increments
    from sculler.library.navigating import navigate as navigate
    from sculler.library.studies import advise as advise
    from sculler.library.studies import coning_drift as coning_drift
    from sculler.library.studies import sculling_drift as sculling_drift
    from sculler.library.vectors import compare as compare
    from sculler.library.vectors import read_vectors as read_vectors
    from sculler.library.vectors import write_vectors as write_vectors
    from sculler_model.analysis.advice import Candidate as Candidate
    from sculler_model.analysis.advice import Environment as Environment
    from sculler_model.analysis.advice import Requirement as Requirement
    from sculler_model.analysis.iteration import iterated as iterated
    from sculler_model.design import Design as Design
    from sculler_model.errors import Error as Error
    from sculler_model.errors import InputError as InputError
    from sculler_model.errors import ToolError as ToolError
    from sculler_model.fast import VectorBlock as VectorBlock
    from sculler_model.golden import GoldenModel as GoldenModel
    from sculler_model.host import MajorIncrements as MajorIncrements
    from sculler_model.motion import Motion as Motion
    from sculler_model.navigation import HeightReference as HeightReference
    from sculler_model.navigation import NavHistory as NavHistory
    from sculler_model.navigation import Navigator as Navigator
    from sculler_model.navigation import NavState as NavState
    from sculler_model.navigation import SensorNoise as SensorNoise
    from sculler_sim.run import SimulationError as SimulationError

    __version__: str

_PLACES = {
    "Candidate": "sculler_model.analysis.advice",
    "Core": "sculler.library.hardware",
    "Design": "sculler_model.design",
    "Difference": "sculler.formats.comparison",
    "Environment": "sculler_model.analysis.advice",
    "Error": "sculler_model.errors",
    "FastModel": "sculler.library.models",
    "GoldenModel": "sculler_model.golden",
    "HeightReference": "sculler_model.navigation",
    "InputError": "sculler_model.errors",
    "LiveNavigator": "sculler.library.live",
    "Log": "sculler.library.logs",
    "MajorIncrements": "sculler_model.host",
    "Motion": "sculler_model.motion",
    "NavHistory": "sculler_model.navigation",
    "NavState": "sculler_model.navigation",
    "Navigated": "sculler.library.navigating",
    "Navigator": "sculler_model.navigation",
    "Requirement": "sculler_model.analysis.advice",
    "SensorNoise": "sculler_model.navigation",
    "SimulationError": "sculler_sim.run",
    "ToolError": "sculler_model.errors",
    "VectorBlock": "sculler_model.fast",
    "advise": "sculler.library.studies",
    "compare": "sculler.library.vectors",
    "coning_drift": "sculler.library.studies",
    "generate": "sculler.library.hardware",
    "increments": "sculler.library.navigating",
    "iterated": "sculler_model.analysis.iteration",
    "motion": "sculler.library.motions",
    "motion_through": "sculler.library.motions",
    "navigate": "sculler.library.navigating",
    "read_log": "sculler.library.logs",
    "read_vectors": "sculler.library.vectors",
    "record": "sculler.library.motions",
    "sculling_drift": "sculler.library.studies",
    "simulate": "sculler.library.hardware",
    "write_log": "sculler.library.logs",
    "write_vectors": "sculler.library.vectors",
}

__all__ = [
    "Candidate",
    "Core",
    "Design",
    "Difference",
    "Environment",
    "Error",
    "FastModel",
    "GoldenModel",
    "HeightReference",
    "InputError",
    "LiveNavigator",
    "Log",
    "MajorIncrements",
    "Motion",
    "NavHistory",
    "NavState",
    "Navigated",
    "Navigator",
    "Requirement",
    "SensorNoise",
    "SimulationError",
    "ToolError",
    "VectorBlock",
    "__version__",
    "advise",
    "compare",
    "coning_drift",
    "generate",
    "increments",
    "iterated",
    "motion",
    "motion_through",
    "navigate",
    "read_log",
    "read_vectors",
    "record",
    "sculling_drift",
    "simulate",
    "write_log",
    "write_vectors",
]


def __getattr__(name: str) -> object:
    value: object
    if name == "__version__":
        from importlib.metadata import version

        value = version("sculler")
    elif name in _PLACES:
        value = getattr(import_module(_PLACES[name]), name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
