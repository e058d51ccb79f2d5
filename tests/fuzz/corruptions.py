"""Ways to spoil a file: bytes, text, or the arrays in a container."""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from typing import Any

import numpy as np

NUMBERS = (
    "", "0", "-0", "-1", "1", "2", "3", "7", "65", "0.5", "1e-9", "1e9", "1e22", "1e300", "1e308",
    "1e999", "-1e999", "1e-320", "nan", "-nan", "inf", "NaN", "None", "null", "true", "0x10",
    "1_000", "1,5", "+1", " 1", "1 ", "--1", "1e", "2147483647", "-2147483648", "2147483648",
    "9223372036854775807", "9223372036854775808", "-9223372036854775809", "18446744073709551616",
    "9" * 30, "7" * 300, "9" * 5000, "-" + "9" * 5000, "0." + "3" * 5000, "1e" + "9" * 50,
    "١٢٣", "½",
)  # fmt: skip
"""What may stand where a number should."""

PIECES = (
    "\0", "\0" * 100, "\ufeff", "°", "é", "日本", "\U0001f600", "\u2028", "\x85", "\x1a", "\x1c",
    "\r", "\n", "\r\n", "\n\n\n", "\t", " ", ",", ",,", ";", '"', "'", '"""', "#", "\\", "[",
    "]" * 50, "[" * 5000, "{" * 3000, "=", "%s%n", "{0}", "[red]", "[/red]", "../../etc",
    "A" * 100_000, "1," * 50_000, "\x1b[31m",
)  # fmt: skip
"""What may be put in."""

FLOATS = (np.nan, np.inf, -np.inf, 1e308, -1e308, 5e-324, 1e18, 0.0, -0.0, -1.0)
"""The same in binary."""

Corruption = Callable[[random.Random, bytes], bytes]


def spoilt(rng: random.Random, content: bytes, text: bool) -> bytes:
    """The content after one to three corruptions.

    Args:
        rng: decides.
        content: of a valid file.
        text: it is one.
    """
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        kinds: tuple[Corruption, ...] = _BYTES
        if text and rng.random() < 0.8:
            kinds = _TEXT
        content = rng.choice(kinds)(rng, content)
    return content


def _at(rng: random.Random, content: bytes) -> int:
    """A place, the beginning more often than the rest, for headers are there."""
    end = rng.choice((16, 256, len(content), len(content)))
    return rng.randrange(min(end, len(content)) + 1)


def _flip(rng: random.Random, content: bytes) -> bytes:
    spoilt = bytearray(content or b"\0")
    for _ in range(rng.choice((1, 1, 2, 8, 64))):
        spoilt[min(_at(rng, spoilt), len(spoilt) - 1)] ^= 1 << rng.randrange(8)
    return bytes(spoilt)


def _cut(rng: random.Random, content: bytes) -> bytes:
    return content[: _at(rng, content)]


def _leave_out(rng: random.Random, content: bytes) -> bytes:
    at = _at(rng, content)
    return content[:at] + content[at + rng.choice((1, 2, 7, 100)) :]


def _repeat(rng: random.Random, content: bytes) -> bytes:
    at = _at(rng, content)
    piece = content[at : at + rng.choice((1, 8, 100, 3000))]
    return content[:at] + piece * rng.choice((1, 2, 20)) + content[at:]


def _garbage(rng: random.Random, content: bytes) -> bytes:
    at = _at(rng, content)
    return content[:at] + rng.randbytes(rng.choice((1, 4, 100))) + content[at:]


def _overwrite(rng: random.Random, content: bytes) -> bytes:
    at = _at(rng, content)
    word = rng.choice(
        (b"\xff" * 4, b"\0" * 4, b"\0" * 64, b"\xff" * 8, b"\x7f" + b"\xff" * 3,
         b"\xff" * 3 + b"\x7f", np.float64(rng.choice(FLOATS)).tobytes())
    )  # fmt: skip
    return content[:at] + word + content[at + len(word) :]


def _twice(rng: random.Random, content: bytes) -> bytes:
    return content * rng.choice((2, 3))


def _nothing(rng: random.Random, content: bytes) -> bytes:
    return rng.choice((b"", b"\n", b"\0" * 4096, b"\n" * 1000))


_BYTES = (_flip, _flip, _flip, _cut, _leave_out, _repeat, _garbage, _overwrite, _twice, _nothing)


def _number(rng: random.Random, content: bytes) -> bytes:
    found = list(re.finditer(rb"-?\d+(\.\d+)?(e-?\d+)?", content))
    if not found:
        return content
    one = rng.choice(found if rng.random() < 0.5 else found[:30])
    return content[: one.start()] + rng.choice(NUMBERS).encode() + content[one.end() :]


def _piece(rng: random.Random, content: bytes) -> bytes:
    at = _at(rng, content)
    return content[:at] + rng.choice(PIECES).encode() + content[at:]


def _word(rng: random.Random, content: bytes) -> bytes:
    """A word replaced by another of the file."""
    found = list(re.finditer(rb"[A-Za-z_][A-Za-z_0-9-]*", content))
    if not found:
        return content
    one, other = rng.choice(found), rng.choice(found)
    return content[: one.start()] + other[0] + content[one.end() :]


def _lines(rng: random.Random, content: bytes) -> bytes:
    """Lines twice, left out, swapped, or the header again."""
    lines = content.splitlines(keepends=True)
    if len(lines) < 2:
        return content
    i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
    kind = rng.randrange(5)
    if kind == 0:
        lines.insert(j, lines[i])
    elif kind == 1:
        del lines[i]
    elif kind == 2:
        lines[i], lines[j] = lines[j], lines[i]
    elif kind == 3:
        lines.insert(j, lines[0])
    else:
        del lines[min(i, j) : max(i, j)]
    return b"".join(lines)


def _columns(rng: random.Random, content: bytes) -> bytes:
    """Columns swapped, doubled or left out, in all lines or in one."""
    lines = content.split(b"\n")
    separator = rng.choice([b",", b",", b" "])
    width = len(lines[0].split(separator))
    i, j, kind = rng.randrange(width), rng.randrange(width), rng.randrange(3)
    only = rng.choice((None, rng.randrange(len(lines))))
    for number, line in enumerate(lines):
        cells = line.split(separator)
        if only not in (None, number) or len(cells) <= max(i, j):
            continue
        if kind == 0:
            cells[i], cells[j] = cells[j], cells[i]
        elif kind == 1:
            cells[i] = cells[j]
        else:
            del cells[i]
        lines[number] = separator.join(cells)
    return b"\n".join(lines)


def _ends(rng: random.Random, content: bytes) -> bytes:
    """Another line end, another separator, another encoding."""
    kind = rng.randrange(5)
    if kind < 2:
        return content.replace(b"\n", (b"\r", b"\r\n")[kind])
    if kind == 2:
        return content.replace(b",", rng.choice((b";", b"\t", b" ", b"", b",,")))
    if kind == 3:
        return content.decode("utf-8", "replace").encode("utf-16")
    return content.rstrip(b"\n")


_TEXT = (_number, _number, _number, _number, _piece, _piece, _word, _lines, _columns, _ends)


def spoilt_arrays(rng: random.Random, arrays: dict[str, Any]) -> dict[str, Any]:
    """Named arrays of which one or two are not what they should be."""
    arrays = dict(arrays)
    for _ in range(rng.choice((1, 1, 2))):
        if not arrays:
            break
        name = rng.choice(sorted(arrays))
        array = np.array(arrays[name])
        kind = rng.randrange(9)
        if kind == 0:
            del arrays[name]
        elif kind == 1:
            arrays[name] = array.astype(
                rng.choice(("f4", "i8", "u1", "c16", "U3", "?", "i2", "S2"))
            )
        elif kind == 2:
            arrays[name] = array[: rng.randrange(3)]
        elif kind == 3:
            arrays[name] = array.reshape(-1)
        elif kind == 4:
            arrays[name] = array[..., None]
        elif kind == 5 and array.dtype.kind == "f" and array.size:
            flat = array.copy().ravel()
            flat[rng.randrange(flat.size)] = rng.choice(FLOATS)
            arrays[name] = flat.reshape(array.shape)
        elif kind == 6:
            arrays[name] = array[::-1].copy()
        elif kind == 7:
            other = rng.choice(("time", "x" * 300, "gyro", "é", "accel_unit", "time_s"))
            arrays[other] = arrays.pop(name)
        else:
            arrays[name] = (
                array * rng.choice((0, -1, 1e300, 1e-300)) if array.dtype.kind in "fi" else 7
            )
    return arrays
