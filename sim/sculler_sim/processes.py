"""The programs that we run: none of them, nor what they start, outlives the call that needs it."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
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
    seconds: float | None = None,
) -> list[Ended]:
    """Run programs side by side to their end, each in a process group of its own.

    If anything interrupts the wait, they and all that they started are killed first.

    Args:
        commands: programs with their arguments.
        folder: to run in.
        environment: to run in; None for ours.
        given: what they read; None for nothing.
        seconds: after which those that still run are killed; None for never.

    Returns:
        How each ended; stdout and stderr are one text.

    Raises:
        InputError: a program cannot be started.
    """
    started: list[subprocess.Popen[str]] = []
    try:
        for command in commands:
            with _signals_wait():
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
                        f"{command[0]}: cannot be run ({error.strerror}), install it again or"
                        " choose another"
                    ) from error
                started.append(process)
                _running.add(process)
        end = None if seconds is None else time.monotonic() + seconds
        said = [_said(process, given, end) for process in started]
        return [
            Ended(process.returncode, text) for process, text in zip(started, said, strict=True)
        ]
    finally:
        for process in started:
            _end(process)
            _running.discard(process)


def _said(process: subprocess.Popen[str], given: str | None, end: float | None) -> str:
    """What a program said by its end; at the time `end` it is killed."""
    try:
        left = None if end is None else max(0.0, end - time.monotonic())
        return process.communicate(given, left)[0]
    except subprocess.TimeoutExpired:
        _kill(process)
        return process.communicate()[0]


@contextmanager
def _signals_wait() -> Iterator[None]:
    """Within it a signal that raises waits: a program that was just started must not be lost."""
    if threading.current_thread() is not threading.main_thread():
        yield  # where signals do not come
        return
    came: list[tuple[int, FrameType | None]] = []
    before: dict[int, Callable[[int, FrameType | None], object]] = {}
    number: int
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        handler = signal.getsignal(number)
        if callable(handler):
            before[number] = handler
            signal.signal(number, lambda *of: came.append(of))
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for number, frame in came[:1]:
            before[number](number, frame)


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
