"""The files that a run reads: small ones are read within bounds, and no output may replace any.

Whoever opens an input notes it (`note`), whoever writes asks first (`refuse`, `claim`).  Files are
told apart by what they are, not by how they are called: through a symbolic link, a hard link or
another spelling of the path an input stays an input.
"""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sculler_model.errors import InputError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

MAX_SMALL = 4 << 20
"""Bytes of a design, a response or a spectrum, which are tables that people write or measure."""

_Key = tuple[int | str, ...]


@dataclass
class _Run:
    inputs: dict[_Key, str] = field(default_factory=dict)
    folders: dict[_Key, str] = field(default_factory=dict)
    outputs: dict[_Key, str] = field(default_factory=dict)


_run: ContextVar[_Run | None] = ContextVar("_run", default=None)


@contextmanager
def remembered() -> Iterator[None]:
    """Within it inputs and outputs are remembered and held against each other; outside, nothing."""
    token = _run.set(_Run())
    try:
        yield
    finally:
        _run.reset(token)


def note(path: str | Path | int) -> None:
    """Remember a file, an open file's number or a folder as an input.

    Raises:
        InputError: it has been claimed for an output.
    """
    run, key = _run.get(), _key(path)
    if run is None or key is None:
        return
    if key in run.outputs:
        raise _both(run.outputs[key], path)
    kept = run.inputs if len(key) == 2 else run.folders
    kept.setdefault(key, _told(path))


def refuse(path: str | Path) -> None:
    """See that an output would replace no input.

    Raises:
        InputError: it would, under whatever name; or it is there already in a folder that is an
            input.
    """
    run, key = _run.get(), _key(path)
    if run is None or key is None:
        return
    if key in run.inputs:
        raise _both(path, run.inputs[key])
    if run.folders and Path(path).exists():
        for folder in Path(path).resolve().parents:
            if _key(folder) in run.folders:
                raise InputError(
                    f"{path}: lies in {folder}, which this command reads, and is there already;"
                    " give the output another name"
                )


def claim(path: str | Path) -> None:
    """Set a file aside for an output, before any work is done.

    Raises:
        InputError: it is an input, or another output has it.
    """
    refuse(path)
    run, key = _run.get(), _key(path)
    if run is None or key is None:
        return
    if key in run.outputs:
        raise InputError(
            f"{path}: two outputs of this command would be this file, give them different names"
        )
    run.outputs[key] = str(path)


def _both(output: str | Path, read: str | Path | int) -> InputError:
    same = "" if str(output) == _told(read) else f" (as {_told(read)})"
    return InputError(
        f"{output}: this command reads this file{same} and would replace it, give the output"
        " another name"
    )


def _told(path: str | Path | int) -> str:
    return "standard input" if isinstance(path, int) else str(path)


def _key(path: str | Path | int) -> _Key | None:
    """What a file is, whatever it is called; None for what is neither file nor folder.

    (device, number) of a file, (device, number, "") of a folder, and of a file that is not there
    its folder's with its name.
    """
    try:
        found = os.fstat(path) if isinstance(path, int) else Path(path).stat()
        if stat.S_ISDIR(found.st_mode):
            return found.st_dev, found.st_ino, ""
        return (found.st_dev, found.st_ino) if stat.S_ISREG(found.st_mode) else None
    except (OSError, ValueError):
        pass
    try:
        absent = Path(str(path)).resolve()
        folder = absent.parent.stat()
    except (OSError, ValueError, RuntimeError):
        return None
    return folder.st_dev, folder.st_ino, absent.name


def read_small(path: str | Path, what: str, form: str, name: str | None = None) -> str:
    """The text of a small file, noted as an input; a byte order mark is passed over.

    Args:
        path: the file.
        what: it is, for the message: "design file".
        form: to give instead of what is no text: "a design in TOML".
        name: of the file in messages; None for its path.

    Raises:
        InputError: it cannot be read, is larger than `MAX_SMALL`, or is no text in UTF-8.
    """
    name = str(path) if name is None else name
    try:
        note(path)
        with Path(path).open("rb") as file:
            content = file.read(MAX_SMALL + 1)
    except OSError as error:
        raise InputError(
            f"{name}: cannot read the {what} ({error.strerror}), check the path"
        ) from error
    except InputError:
        raise
    except ValueError as error:  # a path that cannot be one
        raise InputError(f"{name!r}: cannot read the {what} ({error}), check the path") from error
    if len(content) > MAX_SMALL:
        raise InputError(
            f"{name}: longer than {MAX_SMALL >> 20} MiB, which no {what} is, give {form}"
        )
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{name}: not a text file in UTF-8, give {form}") from error


def read_toml(path: str | Path, what: str, form: str) -> dict[str, Any]:
    """A small file of TOML as a mapping.

    Args:
        path, what, form: as of `read_small`.

    Raises:
        InputError: it cannot be read, or is not TOML that Python can hold.
    """
    text = read_small(path, what, form)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not valid TOML: {error}") from error
    except ValueError as error:  # Python's limit on the digits of a whole number
        raise InputError(f"{path}: a number of too many digits, give fewer") from error
    except RecursionError as error:
        raise InputError(f"{path}: brackets too deep in each other, give {form}") from error


def require_file(path: str | Path, what: str) -> None:
    """See that a file can be read more than once, and ends.

    Raises:
        InputError: it is a pipe or a device.  What is absent is told where it is opened.
    """
    try:
        mode = Path(path).stat().st_mode
    except (OSError, ValueError):
        return
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
        kind = "a pipe" if stat.S_ISFIFO(mode) else "a device"
        raise InputError(f"{path}: is {kind}, and the {what} is read twice: give a file")
