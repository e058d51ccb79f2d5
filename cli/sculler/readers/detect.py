"""The format of a log, by what is in it."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

from sculler.readers import registry as formats
from sculler.readers.columns import recognise
from sculler.readers.delimited import delimiter_given, delimiter_of, header_cells
from sculler.readers.format import Head
from sculler.readers.kfgins import looks_like_text
from sculler.readers.signatures import told
from sculler.readers.text import is_content, open_text
from sculler_model.errors import InputError

_HEAD_BYTES = 1 << 14
_LEAST = 0.4  # how sure is sure enough
_HEAD_LINES = 1000


def detect(path: Path, delimiter: str | None, skip_rows: int, columns_given: bool) -> str:
    """The format, as `convert --format` names it.

    The bytes that a format begins with say it; failing these the name's suffix; failing that whole
    datagrams with their checksums, or rows of 8-byte floats; failing that the first lines: a known
    header, rows of numbers as KF-GINS has them, else CSV.

    Args:
        path: the file, or folder of a ROS 2 bag.
        delimiter, skip_rows: of the text, see `format.Request`.
        columns_given: the user says which columns to read, so a text is CSV.

    Raises:
        InputError: the file cannot be read, is empty, or is known to be of no such format.
    """
    if path.is_dir():
        return "rosbag"
    try:
        with path.open("rb") as file:
            content = file.read(_HEAD_BYTES)
        head = Head(path, content, path.stat().st_size)
    except OSError as error:
        raise InputError(
            f"{path}: cannot read the log ({error.strerror}), check the path"
        ) from error
    every = list(formats.every())
    looks = {each.name: each.looks(head) for each in every}
    best = max(looks, key=looks.__getitem__)
    if looks[best] == 1:
        return best
    for each in every:
        if path.suffix.lower() in each.suffixes:
            return each.name
    if not content:
        raise InputError(f"{path}: the log is empty, give samples")
    known = told(content)
    if known is not None:
        raise InputError(f"{path}: {known}")
    if looks[best] > _LEAST and not columns_given:
        return best
    return "csv" if columns_given else _of_text(path, delimiter, skip_rows)


def _of_text(path: Path, delimiter: str | None, skip_rows: int) -> str:
    """The format of a text, by its first lines."""
    with open_text(path) as text:
        lines = list(islice(text, skip_rows, skip_rows + _HEAD_LINES))
    given = delimiter_given(delimiter)
    for line in lines:  # a known header may stand behind a #
        known = recognise(header_cells(line, delimiter_of(given, line)))
        if known is not None:
            return known.program
        if is_content(line):
            break
    rows = [line for line in lines if is_content(line)][:3]
    return "kfgins" if rows and not skip_rows and looks_like_text(rows) else "csv"
