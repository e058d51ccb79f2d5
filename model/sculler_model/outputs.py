"""Output files that appear whole or not at all, and text files read within bounds."""

from __future__ import annotations

import errno
import io
import re
import secrets
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, TextIO

from sculler_model import inputs
from sculler_model.errors import InputError

MAX_LINE = 1 << 16
"""Bytes that a line of a text file may have, about: several hundred columns."""

LITTER_AGE = 24 * 3600
"""Seconds after which a temporary file or folder that nobody wrote to is a dead run's."""

_FULL = {errno.ENOSPC, errno.EDQUOT}


@contextmanager
def replacing(path: str | Path, cure: str = "give another place") -> Iterator[Path]:
    """Write a file under a temporary name beside it; it takes its own name when all went well.

    The temporary name keeps the suffix, by which some libraries choose their format.  If the body
    raises, the temporary file is removed and whatever stood under `path` stays as it was.  A path
    that is there and not a regular file (a pipe, /dev/stdout) is written directly.

    Args:
        path: the file.
        cure: what to do where there is no room, beside making some.

    Raises:
        InputError: the folder is absent or cannot be written to, `path` is a folder or an input of
            the run, or there is no room left.
    """
    path = Path(path)
    if path.is_dir():
        raise InputError(f"{path}: is a folder, give the name of a file")
    inputs.refuse(path)
    if path.exists() and not path.is_file():
        with named(path, cure):
            yield path
        return
    target = path.resolve()  # through a symbolic link, which stays one
    temporary = target.with_name(f".{target.stem}.{secrets.token_hex(4)}{target.suffix}")
    try:
        _new(path, temporary)
        sweep(
            target.parent, rf"\.{re.escape(target.stem)}\.[0-9a-f]{{8}}{re.escape(target.suffix)}"
        )
        with named(path, cure):
            yield temporary
            temporary.replace(target)
    finally:
        with suppress(OSError):  # it never came
            temporary.unlink(missing_ok=True)


def _new(path: Path, temporary: Path) -> None:
    try:
        temporary.touch(exist_ok=False)
    except OSError as error:
        raise InputError(
            f"{path}: cannot write to folder {path.parent} ({error.strerror}), make it or give"
            " another"
        ) from error


@contextmanager
def named(path: str | Path, cure: str = "give another place") -> Iterator[None]:
    """Within it an error that there is no room becomes one that names the file, and the cure.

    Raises:
        InputError: the disk or the quota is full, or the file grew beyond the size allowed.
    """
    try:
        yield
    except OSError as error:
        if error.errno in _FULL:
            raise InputError(
                f"{path}: the disk is full ({error.strerror}), free some space or {cure}"
            ) from error
        if error.errno == errno.EFBIG:
            raise InputError(
                f"{path}: larger than the limit on files allows (ulimit -f), raise it or {cure}"
            ) from error
        raise


@contextmanager
def gathering(folder: Path) -> Iterator[Path]:
    """A folder to write files into, which all move to `folder` when all went well.

    Raises:
        InputError: `folder` cannot be made or written to, there is no room left, or a file would
            replace an input of the run.
    """
    make_folder(folder)
    try:
        gathered = tempfile.TemporaryDirectory(prefix=".sculler-", dir=folder)
    except OSError as error:
        raise InputError(
            f"{folder}: cannot write to the folder ({error.strerror}), give another"
        ) from error
    sweep(folder, r"\.sculler-\w{8}")
    with named(folder), gathered as name:
        yield Path(name)
        files = sorted(Path(name).iterdir())
        for file in files:
            inputs.refuse(folder / file.name)
            if (folder / file.name).is_dir():
                raise InputError(f"{folder / file.name}: is a folder, take it away")
        for file in files:
            file.replace(folder / file.name)


def sweep(folder: Path, pattern: str) -> None:
    """Remove what dead runs left in a folder: names of this pattern, untouched for a day."""
    name, now = re.compile(pattern), time.time()
    try:
        found = [path for path in folder.iterdir() if name.fullmatch(path.name)]
    except OSError:
        return
    for path in found:
        try:
            if now - path.lstat().st_mtime < LITTER_AGE:
                continue
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink()
        except OSError:  # another run sweeps too, or it is not ours to remove
            continue


def make_folder(path: str | Path) -> Path:
    """The folder `path`, made with its parents if need be.

    Raises:
        InputError: it cannot be made, or a file bears its name.
    """
    path = Path(path)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{path}: cannot make the folder ({error.strerror}), give another"
        ) from error
    return path


def open_lines(path: str | Path, encoding: str = "utf-8", newline: str | None = None) -> TextIO:
    """Open a text file to read, as an input of the run; no line may be longer than `MAX_LINE`.

    Raises:
        OSError: it cannot be opened.
        InputError: now, it is an output of the run; where it is read, a line is too long.
    """
    return io.TextIOWrapper(open_blocks(path), encoding=encoding, newline=newline)


def open_blocks(path: str | Path) -> BinaryIO:
    """The same in bytes."""
    inputs.note(path)
    raw = Path(path).open("rb", buffering=0)  # noqa: SIM115
    return io.BufferedReader(_Limited(raw, str(path)), MAX_LINE)


def endless_line(name: str) -> InputError:
    """The error of a file with a line of more than `MAX_LINE`."""
    return InputError(
        f"{name}: a line of more than {MAX_LINE >> 10} KiB, which is no row of a table; give a text"
        " file with a row a line"
    )


class _Limited(io.RawIOBase):
    """A raw stream that refuses lines without end."""

    def __init__(self, raw: io.FileIO, name: str) -> None:
        self._raw, self._name = raw, name
        self._since = 0

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        count = self._raw.readinto(buffer) or 0
        block = bytes(memoryview(buffer)[:count])
        end = max(block.rfind(b"\n"), block.rfind(b"\r")) + 1
        self._since = count - end if end else self._since + count
        if self._since > MAX_LINE:
            raise endless_line(self._name)
        return count

    def close(self) -> None:
        self._raw.close()
        super().close()
