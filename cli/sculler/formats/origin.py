"""Where a file comes from: a record beside every log and every vectors file that a verb writes.

`imu.csv.origin.json` tells the program's version, the verb, its settings and what it found, the
SHA-256 of the file and of all that it was made from, with their records where they have one.  So
the last file of a chain knows the whole chain, and a record that tells of another file shows it.
"""

from __future__ import annotations

import json
import platform
from collections.abc import Iterator, Mapping, Sequence
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

from sculler_model.outputs import replacing

_BLOCK = 1 << 16
_LARGEST_RECORD = 1 << 24


class Step(NamedTuple):
    """One file of a chain.

    Attributes:
        name: of the file, with what it is: "vectors model.csv".
        sha256: of its bytes, or why it is not known.
        record: as `write_origin` made it, without its inputs; None where there is none.
        note: why there is none.
    """

    name: str
    sha256: str
    record: dict[str, Any] | None
    note: str


def environment() -> str:
    """The programs that a result depends on."""
    import numpy

    python = platform.python_version()
    return f"sculler {version('sculler')}, Python {python}, numpy {numpy.__version__}"


def record_path(path: str | Path) -> Path:
    """Where the record of a file stands."""
    path = Path(path)
    return path.with_name(f"{path.name}.origin.json")


def write_origin(
    output: Path,
    inputs: Mapping[str, str | Path],
    result: Mapping[str, Any],
    *,
    verb: str | None,
    settings: Mapping[str, Any],
) -> None:
    """Write the record of a file that has been written; none for a pipe.

    Args:
        output: the file.
        inputs: the files it was made from, by what they are.
        result: what the verb tells with --json.
        verb: that wrote it.
        settings: what the verb was told.

    Raises:
        InputError: the record cannot be written.
    """
    digest = None if output.is_relative_to("/dev") else file_hash(output)
    if digest is None:
        return
    record = {
        "program": environment(),
        "verb": verb,
        "settings": {name: _plain(value) for name, value in settings.items()},
        "file": {"name": output.name, "sha256": digest},
        "inputs": [_input(kind, path) for kind, path in inputs.items()],
        "result": result,
    }
    with replacing(record_path(output)) as temporary:
        temporary.write_text(
            json.dumps(record, indent=1, ensure_ascii=False, default=str) + "\n", encoding="utf-8"
        )


def file_hash(path: str | Path) -> str | None:
    """SHA-256 of a file, read in blocks; None for what is no regular file, or cannot be read."""
    path = Path(path)
    if not path.is_file():
        return None
    digest = sha256()
    try:
        with path.open("rb") as file:
            while block := file.read(_BLOCK):
                digest.update(block)
    except OSError:
        return None
    return digest.hexdigest()


def chain(kind: str, path: str | Path) -> list[Step]:
    """A file and all that it was made from, the file first, by the records beside them."""
    return list(_steps(_input(kind, path)))


def _steps(entry: Mapping[str, Any]) -> Iterator[Step]:
    """Of an input as records hold them; what does not look like one is passed over."""
    record = entry.get("origin")
    name = f"{entry.get('kind', 'file')} {entry.get('name', '')}"
    preset = "a preset" if entry.get("kind") == "design" else "not known: no file that stays"
    known = entry.get("sha256") or preset
    if not isinstance(record, dict):
        yield Step(name, str(known), None, str(entry.get("note", "no record")))
        return
    inputs = record.get("inputs")
    yield Step(
        name, str(known), {key: value for key, value in record.items() if key != "inputs"}, ""
    )
    for before in inputs if isinstance(inputs, list) else []:
        if isinstance(before, dict):
            yield from _steps(before)


def _input(kind: str, path: str | Path) -> dict[str, Any]:
    """A file as a record tells of it, with its own record if that is there and true."""
    digest = file_hash(path)
    entry: dict[str, Any] = {"kind": kind, "name": Path(path).name, "sha256": digest}
    if digest is None:
        return entry
    record, note = _read(record_path(path), digest)
    return entry | ({"note": note} if record is None else {"origin": record})


def _read(path: Path, digest: str) -> tuple[dict[str, Any] | None, str]:
    """The record at a path if it tells of a file with this hash; else why there is none."""
    try:
        if not path.is_file():
            return None, "no record beside it"
        if path.stat().st_size > _LARGEST_RECORD:
            raise ValueError
        record = json.loads(path.read_text(encoding="utf-8"))
        told = record["file"]["sha256"]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None, f"{path.name} cannot be read"
    if told != digest:
        return None, f"{path.name} tells of another file: this one was changed or replaced since"
    return record, ""


def _plain(value: Any) -> Any:
    """A setting as JSON holds it."""
    return value if isinstance(value, int | float | str | list | tuple) else str(value)


def told(steps: Sequence[Step]) -> list[str]:
    """Warnings about records that tell of other files."""
    return [f"{step.name}: {step.note}" for step in steps if "another file" in step.note]
