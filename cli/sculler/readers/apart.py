"""Arrays of files whose libraries may crash: MAT and HDF5, loaded in a process of their own.

A damaged MAT file can make SciPy write where it may not, ask for more memory than there is, or go
on for ever.  A child process loads it, within bounds of memory and time, and sends the arrays that
are asked for; what becomes of the child, here it is one line that says so.
"""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from threading import Timer
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError

_LEAST_MEMORY = 384 << 20
_MEMORY_BY_SIZE = 64  # compressed files unfold, and are copied
_LEAST_SECONDS = 10
_BYTES_A_SECOND = 1 << 20
_PATIENCE = 6  # times the seconds of processor: other programs run too
_MOST_LINE = 64 << 20


@dataclass(frozen=True)
class Shape:
    """What is known of an array before it is read.

    Attributes:
        shape: its axes.
        kind: numpy's type code.
        text: what it says, if it is a text.
    """

    shape: tuple[int, ...]
    kind: str
    text: str | None = None

    @property
    def is_real(self) -> bool:
        """Whether it holds real numbers."""
        return np.dtype(self.kind).kind in "iuf"


class Arrays:
    """The arrays of an open file.

    Attributes:
        path: the file.
        listing: all of them by name; those in structures as `structure.field`.
    """

    def __init__(self, path: Path, process: subprocess.Popen[bytes], seconds: float) -> None:
        self.path, self._process = path, process
        self._late = False
        self._limit = Timer(seconds, self._stop)
        self._limit.daemon = True
        self._limit.start()
        self.listing: dict[str, Shape] = {}

    def fill(self) -> None:
        """Wait for the listing.

        Raises:
            InputError: the file cannot be read.
        """
        self.listing = {
            name: Shape(tuple(shown["shape"]), shown["kind"], shown.get("text"))
            for name, shown in self._answer()["arrays"].items()
        }

    def __getitem__(self, name: str) -> NDArray[Any]:
        """An array.

        Raises:
            InputError: it cannot be read.
        """
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            self._process.stdin.write(json.dumps(name).encode() + b"\n")
            self._process.stdin.flush()
        except OSError:
            raise self._died() from None
        answer = self._answer()
        content = self._process.stdout.read(answer["bytes"])
        if len(content) < answer["bytes"]:
            raise self._died()
        kind = np.dtype(answer["kind"])
        given: NDArray[Any] = np.frombuffer(content, kind).reshape(answer["shape"])
        return given

    def _answer(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        line = self._process.stdout.readline(_MOST_LINE)
        try:
            answer: dict[str, Any] = json.loads(line)
        except ValueError:
            raise self._died() from None
        if "error" in answer:
            raise _refusal(self.path, answer["error"], answer["text"])
        return answer

    def _stop(self) -> None:
        self._late = True
        self._process.kill()

    def close(self) -> None:
        """End the child."""
        self._limit.cancel()
        self._process.kill()
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe is not None
            with suppress(OSError):  # what was not yet written has no reader
                pipe.close()
        self._process.wait()

    def _died(self) -> InputError:
        """What to say of a child that answers no more."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(1)
        status = self._process.poll()
        late = self._late or status == -getattr(signal, "SIGXCPU", 0)
        how = "it crashed the library that reads it"
        if late:
            how = "it took longer to read than its size explains"
        elif status is None or status >= 0:
            how = "the library that reads it gives no answer"
        return InputError(f"{self.path}: not a whole MAT or HDF5 file, {how}; write it again")


def _refusal(path: Path, kind: str, text: str) -> InputError:
    if kind == "version":
        return InputError(f"{path}: of a MAT version that is not read, {_RESAVE}")
    if kind == "import":
        return InputError(f"{path}: cannot be read without a library ({text}), {_INSTALL}")
    if kind == "unreadable":
        return InputError(f"{path}: cannot read the log ({text}), check the path")
    if kind == "memory":
        most = _memory(path) >> 20
        return InputError(
            f"{path}: needs more than {most:,} MiB of memory to read, which its size does not"
            " explain: damaged, or compressed; write it again (MATLAB's save -v6)"
        )
    return InputError(f"{path}: not a whole MAT or HDF5 file ({text}), write it again")


_INSTALL = "run: pip install 'sculler[formats]'"
_RESAVE = "save it again with MATLAB's save -v7"


def _memory(path: Path) -> int:
    return _LEAST_MEMORY + _MEMORY_BY_SIZE * path.stat().st_size


@contextmanager
def open_arrays(path: Path, only: Sequence[str] = ()) -> Iterator[Arrays]:
    """The arrays of a MAT file (up to version 7 through SciPy, 7.3 through h5py) or HDF5 file.

    Args:
        path: the file.
        only: variables that are enough, where they are there; none for all.

    Raises:
        InputError: the library is absent, or the file cannot be read; here, or when an array is
            asked for.
    """
    try:
        with path.open("rb") as file:
            head = file.read(520)
    except OSError as error:
        raise InputError(
            f"{path}: cannot read the log ({error.strerror}), check the path"
        ) from error
    _require_library(path, head)
    seconds = _LEAST_SECONDS + path.stat().st_size // _BYTES_A_SECOND
    words = [json.dumps(sys.path), str(path.absolute()), json.dumps(list(only))]
    process = subprocess.Popen(
        [
            *(sys.executable, "-I", str(Path(__file__).with_name("apart_child.py"))),
            *(*words, str(_memory(path)), str(seconds)),
        ],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )
    arrays = Arrays(path, process, _PATIENCE * seconds)
    try:
        arrays.fill()
        yield arrays
    finally:
        arrays.close()


def _require_library(path: Path, head: bytes) -> None:
    hdf5 = head.startswith(b"MATLAB 7.3") or b"\x89HDF\r\n\x1a\n" in (head[:8], head[512:])
    library = "h5py" if hdf5 else "scipy"
    if sys.modules.get(library, ...) is not None and find_spec(library) is not None:
        return
    if not hdf5:
        raise InputError(f"{path}: reading MAT files needs scipy, {_INSTALL}")
    resave = f" (or {_RESAVE})" if head.startswith(b"MATLAB") else ""
    what = "a MAT file of version 7.3" if resave else "an HDF5 file"
    raise InputError(f"{path}: {what}, reading it needs h5py, {_INSTALL}{resave}")


def told(listing: Mapping[str, Shape]) -> str:
    """What a file holds, for messages."""
    shown = [
        f"{name} ({'×'.join(map(str, each.shape)) or 'one'})"
        for name, each in listing.items()
        if each.text is None
    ]
    text = ", ".join(shown)
    return (text if len(text) <= 400 else text[:400].rsplit(",", 1)[0] + ", ...") or "no arrays"
