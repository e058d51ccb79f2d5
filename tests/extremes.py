"""The true extremes of the accumulators, found without interval arithmetic.

Every component of the six vectors is linear in each single count, so its extremes lie at corners of
the box of all inputs: every count at one of its two ends.  One component of a cross product of sums
is bilinear, p' K q, in the counts p and q of two sensor axes over the interval's samples and those
before that its taps reach.  For each corner p the best q follows count by count from its sign of
K'p, so it is enough to go through the corners of p; and as K falls into parts that share no count,
and counts with proportional rows of K act as one, these are few.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Design, Interval

Matrix = NDArray[np.object_]
Axis = tuple[str, int]
"""A sensor axis: "gyro" or "accel", and how many axes after the component's own."""

MOST_CORNERS = 1 << 16


@dataclass(frozen=True)
class Extreme:
    """The greatest value of a component over all inputs, and inputs that give it.

    Attributes:
        value: the greatest value.
        counts: for each sensor axis that matters, its counts of the interval and, in front, of the
            samples before it that the component reaches.
    """

    value: int
    counts: dict[Axis, list[int]]


def within_form(design: Design) -> Matrix:
    """K of sum over t of (A_p[t] q[t] - A_q[t] p[t]): the within products."""
    table, reach = design.table, reach_of(design)
    length = reach + design.samples_per_major
    form = np.zeros((length, length), object)
    for t in range(reach, length):
        for d, tap in enumerate(table.taps[(t - reach) % table.samples], start=1):
            if tap:
                form[t - d, t] += tap
                form[t, t - d] -= tap
    return form


def between_form(design: Design) -> Matrix:
    """K of sum over minor intervals i < j of (P_i Q_j - Q_i P_j), P and Q the weighted sums."""
    sums = minor_sums(design)
    form = np.zeros((len(sums[0]),) * 2, object)
    for j, later in enumerate(sums):
        for earlier in sums[:j]:
            form += np.outer(earlier, later) - np.outer(later, earlier)
    return form


def minor_sums(design: Design) -> list[NDArray[np.object_]]:
    """For each minor interval, the coefficient of every sample in its weighted sum."""
    table, reach = design.table, reach_of(design)
    sums = []
    for end in range(table.samples, design.samples_per_major + 1, table.samples):
        coefficients = np.zeros(reach + design.samples_per_major, object)
        for d, weight in enumerate(table.weights):
            coefficients[reach + end - 1 - d] += weight
        sums.append(coefficients)
    return sums


def reach_of(design: Design) -> int:
    """Samples before an interval that its result depends on."""
    return design.table.history


def linear(coefficients: NDArray[np.object_], box: Interval) -> tuple[int, list[int]]:
    """Greatest sum of coefficient * count, and the counts."""
    counts = [box.hi if c > 0 else box.lo for c in coefficients]
    return int(np.dot(coefficients, np.array(counts, object))), counts


def bilinear(form: Matrix, p_box: Interval, q_box: Interval) -> tuple[int, list[int], list[int]]:
    """Greatest p' K q over all counts in their boxes, and p and q.

    Raises:
        ValueError: too many corners to go through.
    """
    p, q = [p_box.hi] * len(form), [q_box.hi] * len(form)
    value = 0
    for rows, columns in _parts(form):
        part = form[np.ix_(rows, columns)]
        best, p_part, q_part = _corners(part, p_box, q_box)
        value += best
        for row, count in zip(rows, p_part, strict=True):
            p[row] = count
        for column, count in zip(columns, q_part, strict=True):
            q[column] = count
    return value, p, q


def _parts(form: Matrix) -> list[tuple[list[int], list[int]]]:
    """Rows and columns of the blocks that K falls into."""
    parts: list[tuple[set[int], set[int]]] = []
    for row in range(len(form)):
        columns = set(np.flatnonzero(form[row]).tolist())
        if not columns:
            continue
        touching = [part for part in parts if part[1] & columns]
        parts = [part for part in parts if part not in touching]
        rows = {row}.union(*(part[0] for part in touching))
        parts.append((rows, columns.union(*(part[1] for part in touching))))
    return [(sorted(rows), sorted(columns)) for rows, columns in parts]


def _corners(form: Matrix, p_box: Interval, q_box: Interval) -> tuple[int, list[int], list[int]]:
    """`bilinear` of one block."""
    groups = _proportional(form)
    if 1 << len(groups) > MOST_CORNERS:
        raise ValueError(f"2**{len(groups)} corners")
    rows = np.array([form[members[0][0]] for members in groups], object)
    # a group acts as one number, the sum of its counts times their factors; its two ends
    factors = [np.array([factor for _, factor in members], object) for members in groups]
    lows = [linear(-factor, p_box) for factor in factors]
    highs = [linear(factor, p_box) for factor in factors]
    ends = [(-low[0], high[0]) for low, high in zip(lows, highs, strict=True)]
    corners = np.array(list(product(*ends)), object)
    bound = np.abs(corners).max(axis=0) @ np.abs(rows).sum(axis=1) * -q_box.lo
    kind = np.int64 if bound < 1 << 62 else object
    gains = corners.astype(kind) @ rows.astype(kind)
    totals = np.where(gains > 0, gains * q_box.hi, gains * q_box.lo).sum(axis=1)
    best = int(totals.argmax())
    q = [q_box.hi if gain > 0 else q_box.lo for gain in gains[best]]
    p = [0] * len(form)
    for members, low, high, number in zip(groups, lows, highs, corners[best], strict=True):
        counts = high[1] if number == high[0] else low[1]
        for (row, _), count in zip(members, counts, strict=True):
            p[row] = count
    return int(totals[best]), p, q


def _proportional(form: Matrix) -> list[list[tuple[int, int]]]:
    """Rows grouped by direction: (row, factor), the row being factor times the group's first."""
    groups: list[list[tuple[int, int]]] = []
    for row, entries in enumerate(form):
        at = int(np.flatnonzero(entries)[0])
        for members in groups:
            first = form[members[0][0]]
            if (
                first[at]
                and entries[at] % first[at] == 0
                and (entries == first * (entries[at] // first[at])).all()
            ):
                members.append((row, entries[at] // first[at]))
                break
        else:
            groups.append([(row, 1)])
    return groups


def extreme(design: Design, vector: str, sign: int) -> Extreme:
    """The greatest value of sign * component, after enough samples since reset.

    Args:
        design: the design.
        vector: one of `sculler_model.design.VECTORS`; all its components are alike.
        sign: 1 or -1.

    Raises:
        ValueError: too many corners to go through.
    """
    words = design.words
    boxes = {"gyro": words.gyro, "accel": words.accel}
    if vector in ("alpha", "nu"):
        sensor = "gyro" if vector == "alpha" else "accel"
        value, counts = linear(sign * sum(minor_sums(design)), boxes[sensor])
        return Extreme(value, {(sensor, 0): counts})
    kind, _, place = vector.partition("_")
    form = sign * (within_form(design) if place == "within" else between_form(design))
    # coning_x is F(s_y, s_z); sculling_x is F(s_y, r_z) + F(r_y, s_z), F(p, q) = p' K q
    pairs = {"coning": [("gyro", "gyro")], "sculling": [("gyro", "accel"), ("accel", "gyro")]}
    total, chosen = 0, {}
    for left, right in pairs[kind]:
        value, p, q = bilinear(form, boxes[left], boxes[right])
        total += value
        chosen |= {(left, 1): p, (right, 2): q}
    return Extreme(total, chosen)
