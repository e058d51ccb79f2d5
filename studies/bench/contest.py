"""A contest: ours against something else that does the same work, in one run, taking turns.

A subject of the benchmark (`kernels`, `files`, ...) lists its contests; `hold` runs them.  The
ratio of a contest is the median time of the other side over the median time of ours: 2 means that
ours is twice as fast.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from sculler import terminal
from sculler_model.errors import InputError

Run = Callable[[], object]


class Contest(NamedTuple):
    """Two ways to do the same work.

    `missing` says in one line why the other side cannot run here (a compiler, a package); then
    `theirs` is not called.  `goal` is the ratio to reach, None where there is none.
    """

    name: str
    against: str
    size: int
    unit: str  # of size: samples, rows, updates, trials
    ours: Run
    theirs: Run | None
    goal: float | None = None
    missing: str | None = None


def hold(contests: Sequence[Contest], runs: int) -> list[dict[str, Any]]:
    """Run each contest `runs` times, both sides taking turns, after one turn not measured.

    Returns:
        A row each: its name, the other side, the goal, the median, least and most seconds of both
        sides, units a second of ours, and the ratio; of a missing side None.
    """
    rows = []
    with terminal.progress("measuring", (runs + 1) * len(contests)) as advance:
        for contest in contests:
            ours: list[float] = []
            theirs: list[float] = []
            for turn in range(runs + 1):
                for run, seconds in ((contest.ours, ours), (contest.theirs, theirs)):
                    taken = _seconds(run)
                    if turn and taken is not None:
                        seconds.append(taken)
                advance(1)
            rows.append(_row(contest, ours, theirs))
    return rows


def _seconds(run: Run | None) -> float | None:
    if run is None:
        return None
    begin = time.perf_counter()
    run()
    return time.perf_counter() - begin


def _row(contest: Contest, ours: list[float], theirs: list[float]) -> dict[str, Any]:
    median = statistics.median(ours)
    return {
        "name": contest.name,
        "against": contest.against,
        "goal": contest.goal,
        "size": contest.size,
        "unit": contest.unit,
        "per_second": contest.size / median,
        "ours_s": [min(ours), median, max(ours)],
        "theirs_s": [min(theirs), statistics.median(theirs), max(theirs)] if theirs else None,
        "ratio": statistics.median(theirs) / median if theirs else None,
        "missing": contest.missing,
    }


def compiled(source: str, program: str, *options: str) -> str | None:
    """Compile a C source for the other side; returns what is missing, None where all went well.

    Args:
        source: path of the C source.
        program: path of the program or, where it ends in `.so`, of the shared library to write.
        options: of the compiler, besides.
    """
    import subprocess

    shared = ["-shared", "-fPIC"] if program.endswith(".so") else []
    flags = ["-O3", "-march=native", "-Wall", "-Wextra"]
    try:
        done = subprocess.run(
            ["gcc", *flags, *shared, *options, "-o", program, source],
            capture_output=True,
            text=True,
        )
    except FileNotFoundError:
        return "gcc is missing"
    if done.returncode:
        raise InputError(f"{source}: gcc could not compile it:\n{done.stderr}")
    return None
