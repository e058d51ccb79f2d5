"""The programs that we run: none of them, nor what they start, outlives the call that needs it."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from sculler_model.errors import InputError


class Ended(NamedTuple):
    """How a program ended: its exit status (minus a signal's number), and what it said."""

    status: int
    said: str

    @property
    def how(self) -> str:
        """The status in words."""
        if self.status >= 0:
            return f"status {self.status}"
        try:
            return f"killed by {signal.Signals(-self.status).name}"
        except ValueError:
            return f"killed by signal {-self.status}"


_running: set[subprocess.Popen[str]] = set()


def run(
    *commands: Sequence[str],
    folder: Path | None = None,
    environment: Mapping[str, str] | None = None,
    given: str | None = None,
) -> list[Ended]:
    """Run programs side by side to their end, each in a process group of its own.

    If anything interrupts the wait, they and all that they started are killed first.

    Args:
        commands: programs with their arguments.
        folder: to run in.
        environment: to run in; None for ours.
        given: what they read; None for nothing.

    Returns:
        How each ended; stdout and stderr are one text.

    Raises:
        InputError: a program cannot be started.
    """
    started: list[subprocess.Popen[str]] = []
    try:
        for command in commands:
            try:
                process = subprocess.Popen(
                    command,
                    cwd=folder,
                    env=environment,
                    stdin=subprocess.DEVNULL if given is None else subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=subprocess.STDOUT,
                    encoding="utf-8",
                    errors="replace",
                    start_new_session=True,
                )
            except OSError as error:
                raise InputError(
                    f"{command[0]}: cannot be run ({error.strerror}), install it again or choose"
                    " another"
                ) from error
            started.append(process)
            _running.add(process)
        said = [process.communicate(given)[0] for process in started]
        return [
            Ended(process.returncode, text) for process, text in zip(started, said, strict=True)
        ]
    finally:
        for process in started:
            _end(process)
            _running.discard(process)


def end_all() -> None:
    """Kill all programs that other threads wait for."""
    for process in tuple(_running):
        _kill(process)


def _end(process: subprocess.Popen[str]) -> None:
    if process.poll() is None:
        _kill(process)
        process.wait()
    for pipe in (process.stdin, process.stdout):
        if pipe is not None:
            pipe.close()


def _kill(process: subprocess.Popen[str]) -> None:
    """Kill a program with its process group."""
    if process.poll() is None:
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except (ProcessLookupError, PermissionError):
            process.kill()
