"""Whole commands against an earlier commit: `motion` and `navigate`, an hour at 2 kHz.

Both sides are processes of their own, start-up and files and all.  The earlier commit gets CSV,
which is all that it has for vectors and states.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from sculler_model.errors import InputError
from studies.bench import before
from studies.bench.contest import Contest

DESIGN, SECONDS = "stim300", 3600.0
_LOAD = """
from sculler_model import machine_code
machine_code.alone()
import sculler.main, sculler.runs.navigation
from sculler_model.host import MajorIncrements
from sculler_model.navigation import Navigator, NavState
import numpy as np
start = NavState(0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.8, 0.2, 0.0)
Navigator(start, 0.01).run(MajorIncrements(*np.zeros((3, 9, 3))), compiled=True)
"""
"""What `navigate` cannot do without, whatever the log: it bounds the ratio that it may reach."""

_PLACE = ("--lat", "48", "--lon", "11", "--height", "500", "--heading", "60")


class Side(NamedTuple):
    """A tree, and the kind of files that its commands get; all are in one folder."""

    tree: Path
    folder: Path
    kind: str

    def file(self, name: str) -> str:
        """The path of a file of the side's kind."""
        return str(self.folder / f"{name}.{self.kind}")

    def motion(self, name: str, seconds: float, log: str, truth: str) -> None:
        """Write a motion's log and truth."""
        files = ["-o", self.file(log), "--truth", self.file(truth)]
        self._run("motion", name, "--design", DESIGN, *files, "--duration", f"{seconds:g}")

    def model(self) -> None:
        """Write the vectors of the log."""
        self._run("model", DESIGN, self.file("log"), "-o", self.file("vectors"))

    def navigate(self, *options: str) -> None:
        """Navigate with the vectors."""
        files = [self.file("vectors"), "-o", self.file("states")]
        self._run("navigate", DESIGN, *files, "--no-plots", *options)

    def load(self) -> None:
        """Start, and load what is compiled for `navigate`, for nothing."""
        before.run(self.tree, ["-c", _LOAD])

    def _run(self, *words: str) -> None:
        before.run(self.tree, ["-m", "sculler", *words])


def contests(folder: Path, seconds: float = SECONDS) -> list[Contest]:
    """`motion` of a flight and of a shaken turn; `navigate` with a truth, without, and its start.

    Args:
        folder: for the files.
        seconds: of the motions.
    """
    kind = "parquet" if find_spec("pyarrow") else "csv"
    ours, theirs, missing = Side(before.REPOSITORY, folder, kind), None, None
    try:
        theirs = Side(before.tree(folder), folder, "csv")
    except InputError as error:
        missing = str(error)
    for side in {ours, ours._replace(kind="csv")}:  # navigation begins with the same for both
        side.motion("flight", seconds, "log", "truth")
        side.model()
    held: list[tuple[str, int, str, float | None, Callable[[Side], None]]] = []
    for name, goal in (("flight", 6.0), ("demo", 6.0)):
        job = partial(Side.motion, name=name, seconds=seconds, log="written", truth="written-truth")
        held.append((f"motion {name}", round(2000 * seconds), "samples", goal, job))
    updates = round(100 * seconds)
    held.append(("navigate", updates, "updates", 8.0, lambda side: side.navigate(*_PLACE)))
    bare = Contest(
        "start and loading alone",
        f"navigate of {before.BEFORE}, csv",
        1,
        "starts",
        ours.load,
        partial(theirs.navigate, *_PLACE) if theirs else None,
        None,
        missing,
    )
    truth = ("navigate --truth", updates, "updates", None)
    held.append((*truth, lambda side: side.navigate("--truth", side.file("truth"))))
    return [bare] + [
        Contest(
            f"{name}, {kind}",
            f"{before.BEFORE}, csv",
            size,
            unit,
            partial(job, ours),
            partial(job, theirs) if theirs else None,
            goal,
            missing,
        )
        for name, size, unit, goal, job in held
    ]
