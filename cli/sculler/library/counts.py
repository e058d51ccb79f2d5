"""Whole numbers of any form as exact counts: nothing wraps, nothing is rounded."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler.formats.log import COUNTS
from sculler_model.design import Design, Interval
from sculler_model.errors import InputError

CountsLike: TypeAlias = ArrayLike | Any
"""(N, 6) integers as an array, nested lists, or a pandas or polars frame with the log's columns."""


def is_frame(value: object) -> bool:
    """Whether something is a pandas or polars frame, told without importing either."""
    root = type(value).__module__.partition(".")[0]
    return root in ("pandas", "polars") and hasattr(value, "columns")


def column(frame: Any, name: str) -> NDArray[Any]:
    """A frame's column as an array.

    Raises:
        InputError: it is missing, or a value in it is.
    """
    if name not in frame.columns:
        raise InputError(f"frame: column {name} is missing, add it")
    series = frame[name]
    missing = series.isna().any() if hasattr(series, "isna") else series.null_count()
    if missing:
        raise InputError(f"frame: a value of column {name} is missing, fill or drop the row")
    return np.asarray(series.to_numpy())


def whole(name: str, values: ArrayLike) -> NDArray[np.int64]:
    """Whole numbers as int64, exactly.

    Args:
        name: of the values, for messages.
        values: integers of any type, booleans not; Python integers; or floats that are whole and
            below 2^53.

    Raises:
        InputError: one is no whole number or does not fit 64 bits; its place is told.
    """
    try:
        array = np.asarray(values)
    except (ValueError, OverflowError) as error:  # rows of unlike lengths
        raise InputError(f"{name}: not an array ({error}), give rows of one length") from error
    kind = array.dtype.kind
    if kind == "i" or (kind == "u" and array.dtype.itemsize < 8):
        return array.astype(np.int64)
    if kind == "f":
        good = np.isfinite(array) & (np.abs(array) < 2.0**53) & (array == np.round(array))
        return _checked(name, array, good)
    if kind == "u":
        return _checked(name, array, array <= np.uint64(2**63 - 1))
    if kind == "O":
        flat = np.array([_fits(value) for value in array.ravel().tolist()], np.bool_)
        return _checked(name, array, flat.reshape(array.shape))
    if array.size == 0:
        return array.astype(np.int64)
    raise InputError(f"{name}: {array.dtype} is no type of whole numbers, give integers")


def _fits(value: object) -> bool:
    """Whether an object is a whole number of 64 bits."""
    if isinstance(value, float | np.floating):
        return abs(float(value)) < 2.0**53 and float(value).is_integer()
    return (
        isinstance(value, int | np.integer)
        and not isinstance(value, bool)
        and -(2**63) <= int(value) < 2**63
    )


def _checked(name: str, array: NDArray[Any], good: NDArray[np.bool_]) -> NDArray[np.int64]:
    if not good.all():
        place = tuple(int(i) for i in np.argwhere(~good)[0])
        shown = str(array[place])
        shown = shown if len(shown) <= 40 else shown[:37] + "..."
        where = place[0] if len(place) == 1 else place
        raise InputError(
            f"{name}: {shown} at {where} is not a whole number of 64 bits, give integers"
        )
    return array.astype(np.int64)


def as_counts(values: CountsLike, design: Design | None = None) -> NDArray[np.int64]:
    """Counts (N, 6), exactly: gyro x, y, z, accelerometer x, y, z.

    Args:
        values: an array, nested lists, a frame with the columns `gyro_x` to `accel_z`, or one
            sample of six numbers.
        design: whose sensor's widths they must fit; None for 64 bits.

    Raises:
        InputError: the shape is another, or a value is no whole number or does not fit.
    """
    if is_frame(values):
        counts = np.column_stack([whole(name, column(values, name)) for name in COUNTS])
    else:
        counts = whole("counts", values)
    if counts.shape == (6,):
        counts = counts.reshape(1, 6)
    if counts.size == 0 and counts.ndim < 2:
        counts = counts.reshape(0, 6)
    if counts.ndim != 2 or counts.shape[1] != 6:
        raise InputError(f"counts: shape {counts.shape}, give (N, 6)")
    if design is not None:
        _check_widths(counts, design)
    return counts


def _check_widths(counts: NDArray[np.int64], design: Design) -> None:
    allowed: list[Interval] = [design.words.gyro] * 3 + [design.words.accel] * 3
    lo = np.array([each.lo for each in allowed])
    hi = np.array([each.hi for each in allowed])
    wrong = (counts < lo) | (counts > hi)
    if wrong.any():
        row, place = (int(i) for i in np.argwhere(wrong)[0])
        each = allowed[place]
        raise InputError(
            f"sample {row}: {COUNTS[place]} = {int(counts[row, place])} does not fit the sensor's"
            f" {each.bits} bits, give {each.lo} to {each.hi}"
        )


def as_marks(name: str, values: ArrayLike, samples: int) -> NDArray[np.uint8]:
    """Flags (N,) of 0 and 1, from integers or booleans.

    Raises:
        InputError: not one for each sample, or another value.
    """
    array = np.atleast_1d(np.asarray(values))
    marks = array.astype(np.int64) if array.dtype.kind == "b" else whole(name, array)
    if marks.shape != (samples,) or ((marks != 0) & (marks != 1)).any():
        raise InputError(f"{name}: shape {marks.shape}, give {samples} of 0 or 1, one a sample")
    return marks.astype(np.uint8)


def as_times(values: ArrayLike, samples: int) -> NDArray[np.float64]:
    """Stamps (N,), s.

    Raises:
        InputError: not one finite number for each sample.
    """
    try:
        times = np.atleast_1d(np.asarray(values, np.float64))
    except (TypeError, ValueError) as error:
        raise InputError("times: not numbers, give seconds") from error
    if times.shape != (samples,) or not np.isfinite(times).all():
        raise InputError(f"times: shape {times.shape}, give {samples} finite seconds, one a sample")
    return times
