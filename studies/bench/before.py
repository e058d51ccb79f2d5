"""Another commit of this repository as the other side of a contest: how fast it was before."""

from __future__ import annotations

import os
import subprocess
import sys
import tarfile
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

from sculler_model.errors import InputError

REPOSITORY = Path(__file__).parents[2]

BEFORE = "782870d"
"""The commit before *Fast everywhere*: what its figures are compared with."""


def tree(folder: Path, revision: str = BEFORE) -> Path:
    """The files of a commit, unpacked below `folder`.

    Raises:
        InputError: this is no clone with that commit.
    """
    target = folder / revision
    if target.is_dir():
        return target
    done = subprocess.run(
        ["git", "-C", str(REPOSITORY), "archive", revision, "model", "hdl", "sim", "cli"],
        capture_output=True,
    )
    if done.returncode:
        raise InputError(f"{REPOSITORY}: has no commit {revision}, clone the repository whole")
    with tarfile.open(fileobj=BytesIO(done.stdout)) as archive:
        archive.extractall(target)
    return target


def run(tree: Path, arguments: Sequence[str]) -> None:
    """Run the interpreter with a tree's packages first: `["-m", "sculler", "navigate", ...]`.

    Both sides of a contest run so, ours with `REPOSITORY`, that start-up counts for both.

    Raises:
        RuntimeError: it failed; with what it said.
    """
    done = subprocess.run(
        [sys.executable, *arguments],
        env=environment(tree),
        capture_output=True,
        text=True,
    )
    if done.returncode:
        raise RuntimeError(f"{tree}: {' '.join(arguments)}: {done.stderr}")


def environment(tree: Path) -> dict[str, str]:
    """The environment in which an interpreter finds a tree's packages first.

    It keeps the bytecode of what it imports, as an installation has it.
    """
    rooms = os.pathsep.join(str(tree / room) for room in ("model", "hdl", "sim", "cli"))
    surroundings = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    return {**surroundings, "PYTHONPATH": rooms}
