"""Output files that appear whole or not at all."""

from __future__ import annotations

import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sculler_model.errors import InputError


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Write a file under a temporary name beside it; it takes its own name when all went well.

    The temporary name keeps the suffix, by which some libraries choose their format.  If the body
    raises, the temporary file is removed and whatever stood under `path` stays as it was.  A path
    that is there and not a regular file (a pipe, /dev/stdout) is written directly.

    Raises:
        InputError: the folder is absent or cannot be written to, or `path` is a folder.
    """
    path = Path(path)
    if path.is_dir():
        raise InputError(f"{path}: is a folder, give the name of a file")
    if path.exists() and not path.is_file():
        yield path
        return
    target = path.resolve()  # through a symbolic link, which stays one
    temporary = target.with_name(f".{target.stem}.{secrets.token_hex(4)}{target.suffix}")
    try:
        temporary.touch(exist_ok=False)
    except OSError as error:
        raise InputError(
            f"{path}: cannot write to folder {path.parent} ({error.strerror}), make it or give"
            " another"
        ) from error
    try:
        yield temporary
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)


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
