"""The host navigator against the open package `python-ins`, on the same increments.

Both get the same rotation vectors and velocity increments of one smooth motion, exact to rounding,
in the same run and taking turns: how fast they are, and how far from the truth they end.
`python-ins` (import name pyins, BSD) follows the same papers in compiled code of its own.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
import warnings
from collections.abc import Callable, Mapping
from math import radians
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.host import MajorIncrements
from sculler_model.motion import Curve, Motion, Turn, X, Y, Z
from sculler_model.navigation import (
    GeographicNavigator,
    NavHistory,
    Navigator,
    NavState,
    exact_increments,
    navigation_errors,
)
from studies.bench import before
from studies.bench.contest import Contest, Run

Array = NDArray[np.float64]

FLIGHT = Motion(
    radians(48),
    radians(11),
    0.0,
    north=Curve((0.0, 80.0), ((2000.0, 0.02, 0.3),)),
    east=Curve((0.0, 150.0), ((1500.0, 0.03, 0.0),)),
    turns=(
        Turn(Z, Curve((1.0, 1e-3), ((0.5, 0.02, 0.0),))),
        Turn(Y, Curve((0.05,), ((0.1, 0.15, 0.3),))),
        Turn(X, Curve((0.0,), ((0.4, 0.1, 0.0),))),
    ),
    name="smooth flight at height 0",
)
"""At height 0, where both packages' gravity is the same formula."""


def compare(seconds: float = 1000.0, rate_hz: float = 100.0, runs: int = 5) -> dict[str, Any]:
    """Speed and error of both on one motion.

    Args:
        seconds: of the motion.
        rate_hz: increments a second.
        runs: measured runs of each, taking turns after one that is not measured.

    Returns:
        Plain data: per navigator the median seconds of a run, updates a second, and the largest
        horizontal position error (m) and velocity error (m/s); and the ratio of their speeds.

    Raises:
        InputError: python-ins or Numba is not installed.
    """
    package = _python_ins()
    count, interval = round(seconds * rate_hz), 1 / rate_hz
    increments = exact_increments(FLIGHT, count, interval)
    times = interval * np.arange(1.0, count + 1)
    true, start = FLIGHT.state(times), FLIGHT.state(np.zeros(1)).state(0)
    theirs = package.integration(start, times, interval, increments)
    contenders: dict[str, Callable[[], NavHistory]] = {
        "wander azimuth, compiled": lambda: Navigator(start, interval).run(
            increments, compiled=True
        ),
        "python-ins Integrator": theirs,
    }
    taken, found = _taking_turns(contenders, runs)
    taken |= _one_by_one(start, interval, increments)
    rows = {}
    for name, runs_taken in taken.items():
        median = statistics.median(runs_taken)
        rows[name] = {"us_per_update": 1e6 * median / count, "updates_per_s": count / median}
        if name in found:
            errors = navigation_errors(found[name], true)
            rows[name] |= {
                "horizontal_m": float(errors.horizontal.max()),
                "velocity_m_per_s": float(np.abs(errors.velocity).max()),
            }
    ours, other = contenders
    return {
        "motion": FLIGHT.name,
        "seconds": seconds,
        "rate_hz": rate_hz,
        "navigators": rows,
        "speed_ratio": rows[ours]["updates_per_s"] / rows[other]["updates_per_s"],
        "error_ratio": rows[other]["horizontal_m"] / rows[ours]["horizontal_m"],
    }


def _taking_turns(
    contenders: Mapping[str, Callable[[], NavHistory]], runs: int
) -> tuple[dict[str, list[float]], dict[str, NavHistory]]:
    """Seconds of each measured run, and what the last one found, by name."""
    taken: dict[str, list[float]] = {name: [] for name in contenders}
    found: dict[str, NavHistory] = {}
    for turn in range(runs + 1):
        for name, run in contenders.items():
            begin = time.perf_counter()
            found[name] = run()
            if turn:
                taken[name].append(time.perf_counter() - begin)
    return taken, found


def _one_by_one(
    start: NavState, interval: float, increments: MajorIncrements
) -> dict[str, list[float]]:
    """Seconds that all increments would take, one call an update, by name; measured on a few."""
    few = increments[: min(len(increments), 5000)]
    pairs = list(zip(few.phi.tolist(), few.dv_sf.tolist(), strict=True))
    taken = {}
    for name, one_by_one in (
        (
            "wander azimuth, one compiled update at a time",
            Navigator(start, interval, compiled=True),
        ),
        ("wander azimuth, one update at a time", Navigator(start, interval)),
        ("geographic, one update at a time", GeographicNavigator(start, interval)),
    ):
        begin = time.perf_counter()
        for phi, dv_sf in pairs:
            one_by_one.update(tuple(phi), tuple(dv_sf))
        taken[name] = [(time.perf_counter() - begin) * len(increments) / len(pairs)]
    return taken


_UPDATES = 20_000
"""One at a time, in a run."""

_JOB = """
import sys
from sculler_model.motion import turn_motion
from sculler_model.navigation import Navigator, exact_increments
import numpy as np
turn = turn_motion()
found = exact_increments(turn, {updates}, 0.01)
pairs = [(tuple(a), tuple(b)) for a, b in zip(found.phi.tolist(), found.dv_sf.tolist())]
start = turn.state(np.zeros(1)).state(0)
for line in sys.stdin:
    navigator = Navigator(start, 0.01{options})
    for phi, dv_sf in pairs:
        navigator.update(phi, dv_sf)
    print("done", flush=True)
"""
"""Makes them whenever it is told."""


class _Updating:
    """Updates one at a time, of a tree's navigator."""

    def __init__(self, tree: Path, options: str = "") -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-c", _JOB.format(updates=_UPDATES, options=options)],
            env=before.environment(tree),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def __call__(self) -> None:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print("go", file=self._process.stdin, flush=True)
        if self._process.stdout.readline() != "done\n":
            raise RuntimeError("updates one at a time: the process failed")

    def __del__(self) -> None:
        self._process.communicate()  # its input's end is its own


def contests(folder: Path) -> list[Contest]:
    """Whole arrays against python-ins, single updates against an earlier commit."""
    increments = exact_increments(FLIGHT, _UPDATES * 5, 0.01)
    times, start = 0.01 * np.arange(1.0, len(increments) + 1), FLIGHT.state(np.zeros(1)).state(0)
    integration: Run | None = None
    absent = earlier_absent = None
    try:
        integration = _python_ins().integration(start, times, 0.01, increments)
    except InputError as error:
        absent = str(error)
    earlier: Run | None = None
    try:
        earlier = _Updating(before.tree(folder))
    except InputError as error:
        earlier_absent = str(error)

    def run() -> NavHistory:
        return Navigator(start, 0.01).run(increments, compiled=True)

    updating = _Updating(before.REPOSITORY, ", compiled=True")
    return [
        Contest(
            "Navigator.run",
            "python-ins Integrator",
            len(increments),
            "updates",
            run,
            integration,
            6.0,
            absent,
        ),
        Contest(
            "Navigator.update, compiled",
            before.BEFORE,
            _UPDATES,
            "updates",
            updating,
            earlier,
            3.2,  # 12.8 us of an update before, 4 us now
            earlier_absent,
        ),
    ]


class _PythonIns(NamedTuple):
    """What is used of `python-ins`, and the tables it takes."""

    pandas: Any
    integrator: Any
    columns: list[str]

    def integration(
        self, start: NavState, times: Array, interval: float, increments: MajorIncrements
    ) -> Callable[[], NavHistory]:
        """Its `Integrator` on the increments, made ready; what it returns is put into our terms."""
        pva = self.pandas.Series(
            [*np.degrees([start.lat, start.lon]), start.h, *start.v, *np.degrees(start.euler)],
            index=self.columns,
        )
        steps = np.full((len(times), 1), interval)
        table = self.pandas.DataFrame(
            np.hstack([steps, increments.phi, increments.dv_sf]),
            index=times,
            columns=["dt", "theta_x", "theta_y", "theta_z", "dv_x", "dv_y", "dv_z"],
        )

        def run() -> NavHistory:
            with warnings.catch_warnings():  # it uses what newer pandas gives up
                warnings.simplefilter("ignore", DeprecationWarning)
                found = self.integrator(pva).integrate(table).to_numpy()[1:]
            lat, lon = np.radians(found[:, :2]).T
            nothing = np.zeros((len(found), 4))
            return NavHistory(times, nothing, found[:, 3:6], lat, lon, found[:, 2])

        return run


def _python_ins() -> _PythonIns:
    try:
        import pandas
        from pyins.strapdown import Integrator
        from pyins.util import TRAJECTORY_COLS
    except ImportError as error:
        raise InputError(
            f"{error.name} is missing, install python-ins (pip install python-ins)"
        ) from error
    return _PythonIns(pandas, Integrator, TRAJECTORY_COLS)
