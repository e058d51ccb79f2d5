"""The folder where compiled simulators are kept between runs.

It is $SCULLER_CACHE, else $XDG_CACHE_HOME/sculler, else ~/.cache/sculler, and may be deleted at any
time.  An entry's name hashes everything it is made of, so no entry is ever out of date.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sculler_model.errors import InputError
from sculler_model.outputs import make_folder, named, replacing, sweep


def folder() -> Path:
    """The cache folder, made if need be.

    Raises:
        InputError: it cannot be made.
    """
    chosen, base = os.environ.get("SCULLER_CACHE"), os.environ.get("XDG_CACHE_HOME")
    if chosen:
        return make_folder(chosen)
    return make_folder((Path(base) if base else Path.home() / ".cache") / "sculler")


@contextmanager
def workshop() -> Iterator[Path]:
    """A folder to make an entry in, on the same file system; removed when left.

    Raises:
        InputError: the cache folder cannot be written to, or is full.
    """
    here = folder().resolve()
    with named(here, _ANOTHER):
        try:
            made = tempfile.TemporaryDirectory(prefix="build-", dir=here)
        except OSError as error:
            raise InputError(
                f"{here}: cannot write to the cache folder ({error.strerror}), {_ANOTHER}"
            ) from error
        sweep(here, r"build-\w{8}")
        with made as name:
            yield Path(name)


_ANOTHER = "set SCULLER_CACHE to another"


def kept(path: Path) -> dict[str, Any] | None:
    """The JSON object of an entry; None where it is not there, or damaged."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) else None


def keep(path: Path, found: dict[str, Any]) -> None:
    """Write an entry that is a JSON object.

    Raises:
        InputError: the cache folder cannot be written to, or is full.
    """
    with replacing(path, _ANOTHER) as temporary:
        temporary.write_text(json.dumps(found), encoding="utf-8")


def entry(name: str, suffix: str, *made_of: str | bytes) -> Path:
    """Path of the entry made of these texts, there or not; absolute."""
    digest = hashlib.sha256()
    for part in made_of:
        data = part.encode() if isinstance(part, str) else part
        digest.update(len(data).to_bytes(8, "little") + data)
    return folder().resolve() / f"{name}-{digest.hexdigest()[:24]}{suffix}"
