"""Studies of accuracy against an earlier commit: Monte Carlo, sweeps over frequencies, advice.

Each side is a process of its own with its tree's packages loaded, so start-up does not count.  A
Monte Carlo runs in that process again and again; any other study in a fork of it, so that nothing
is known from the turn before, as where a command is called once.
"""

from __future__ import annotations

import subprocess
import sys
from functools import partial
from pathlib import Path

from sculler_model.errors import InputError
from studies.bench import before
from studies.bench.contest import Contest

LEVELS, TRIALS = 2, 600
"""LSBs of a Monte Carlo beside the design's own, the finest first, and trials at each."""

DESIGNS = ("stim300", "hg4930")
"""Of a Monte Carlo: five minor intervals in a major one, and, the unfavourable case, one."""

GOAL_TRIALS, GOAL_STUDIES = 20.0, 3.0

_SIDE = f"""
import os, sys
from sculler.runs.advice import Plan, find_designs
from sculler.runs.analysis import *
from sculler_model.analysis.vibration import PROFILES, Mount
from sculler_model.design import Design

def monte_carlo(name):
    design = Design.preset(name)
    hertz = design.sensor.sample_rate_hz / 40
    quantisation_study(QuantisationPlan(
        {{name: Subject(design, False)}}, frequency=hertz, levels={LEVELS}, trials={TRIALS}))

STIM, SHAKEN = Design.preset("stim300"), (PROFILES["savage-98"], Mount.worst(0.05, 0.014))
ONE = {{"stim300": Subject(STIM, False)}}
STUDIES = {{
    "coning": lambda: frequency_study(FrequencyPlan(coning(0.1), ONE)),
    "sculling": lambda: frequency_study(FrequencyPlan(sculling(0.1, 10.0), ONE)),
    "manoeuvre": lambda: manoeuvre_study(ManoeuvrePlan(ONE)),
    "third-order": lambda: third_order_study(ThirdOrderPlan(STIM, "stim300")),
    "vibration": lambda: vibration_study(VibrationPlan({{"stim300": STIM}}, *SHAKEN, 120.0)),
    "advise, coning": lambda: find_designs(Plan(STIM, SHAKEN[1], coning=(0.1, 50.0), drift=1e-4)),
    "advise, vibration": lambda: find_designs(
        Plan(STIM, SHAKEN[1], SHAKEN[0], drift=1.7e-4, force=1.0)),
}}
for line in sys.stdin:
    job = line.strip()
    if job not in STUDIES:
        monte_carlo(job)
    elif os.fork() == 0:
        STUDIES[job]()
        os._exit(0)
    elif os.wait()[1]:
        sys.exit(job + " failed")
    print("done", flush=True)
"""

STUDIES = (
    "coning",
    "sculling",
    "manoeuvre",
    "third-order",
    "vibration",
    "advise, coning",
    "advise, vibration",
)


class Side:
    """A process that runs studies with a tree's packages, one after another as it is told.

    It starts with the first one.
    """

    def __init__(self, tree: Path) -> None:
        self._tree = tree
        self._process: subprocess.Popen[str] | None = None

    def run(self, job: str) -> None:
        """Run one and wait for its end: the name of a preset for a Monte Carlo, or of `STUDIES`.

        Raises:
            RuntimeError: it failed.
        """
        if self._process is None:
            self._process = subprocess.Popen(
                [sys.executable, "-c", _SIDE],
                env=before.environment(self._tree),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(job + "\n")
        self._process.stdin.flush()
        if self._process.stdout.readline() != "done\n":
            raise RuntimeError(f"{job}: the study failed")

    def __del__(self) -> None:
        if self._process is not None:
            self._process.communicate()  # its input's end is its own


def contests(folder: Path) -> list[Contest]:
    """Monte Carlo of every preset, and every other study of one of them."""
    ours = Side(before.REPOSITORY)
    theirs, missing = None, None
    try:
        theirs = Side(before.tree(folder))
    except InputError as error:
        missing = str(error)

    def contest(name: str, job: str, size: int, unit: str, goal: float) -> Contest:
        other = partial(theirs.run, job) if theirs else None
        return Contest(
            name, before.BEFORE, size, unit, partial(ours.run, job), other, goal, missing
        )

    trials = (LEVELS + 1) * TRIALS
    return [
        *(
            contest(f"analyze quantisation {name}", name, trials, "trials", GOAL_TRIALS)
            for name in DESIGNS
        ),
        *(
            contest(name if "advise" in name else f"analyze {name}", name, 1, "studies", goal)
            for name, goal in ((name, GOAL_STUDIES) for name in STUDIES)
        ),
    ]
