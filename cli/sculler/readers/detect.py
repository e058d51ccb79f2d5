"""The format of a log, by what is in it."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

from sculler.readers.columns import recognise
from sculler.readers.delimited import delimiter_of, header_cells
from sculler.readers.kfgins import looks_like_binary, looks_like_text
from sculler.readers.text import open_text
from sculler_model.errors import InputError

_HEAD_BYTES = 4096
_MAGIC = (
    (b"MATLAB ", "mat"),
    (b"PK\x03\x04", "npz"),
    (b"PAR1", "parquet"),
    (b"% PSINS", "psins"),
)
_SUFFIXES = {".mat": "mat", ".npz": "npz", ".parquet": "parquet", ".imu": "psins"}


def detect(path: Path, delimiter: str | None, skip_rows: int, columns_given: bool) -> str:
    """The format, as `convert --format` names it.

    The bytes that a format begins with say it; failing these the name's suffix; failing that the
    first lines: a known header, rows of numbers as KF-GINS has them, else CSV.

    Args:
        path: the file.
        delimiter, skip_rows: of the text, see `delimited.Layout`.
        columns_given: the user says which columns to read, so a text is CSV.

    Raises:
        InputError: the file cannot be read, or is empty.
    """
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD_BYTES)
        size = path.stat().st_size
    except OSError as error:
        raise InputError(
            f"{path}: cannot read the log ({error.strerror}), check the path"
        ) from error
    for magic, name in _MAGIC:
        if head.startswith(magic):
            return name
    if path.suffix.lower() in _SUFFIXES:
        return _SUFFIXES[path.suffix.lower()]
    if not head:
        raise InputError(f"{path}: the log is empty, give samples")
    if columns_given:
        return "csv"
    if looks_like_binary(head, size):
        return "kfgins-binary"
    with open_text(path) as text:
        lines = list(islice(text, skip_rows, skip_rows + 3))
    if not lines:
        return "csv"
    known = recognise(header_cells(lines[0], delimiter_of(delimiter, lines[0])))
    if known is not None:
        return known.program
    return "kfgins" if not skip_rows and looks_like_text(lines) else "csv"
