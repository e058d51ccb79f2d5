"""States at other instants than those that are there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sculler_model.frames import (
    Quaternions,
    conjugate,
    product,
    quaternions,
    radii,
    rotation_vectors,
    vectors,
)
from sculler_model.navigation.errors import known_quantities
from sculler_model.navigation.state import NavHistory

Array = NDArray[np.float64]

SAME_INSTANT = 1e-8
"""Two times (s) no further apart are the same instant, while a double has that many places."""


def slack(time: Array) -> Array:
    """How far (s) another time may be from this one and be the same instant.

    Of a clock that counts seconds since 1970 a double has 0.24 µs; four of those.
    """
    spacing: Array = np.maximum(SAME_INSTANT, 4 * np.spacing(np.abs(time)))
    return spacing


def interpolated(history: NavHistory, times: Array) -> tuple[NavHistory, int]:
    """States at other times, all inside the history's.

    A state that is there (to `SAME_INSTANT`) is taken as it is.  Between two states the position is
    the cubic with their positions and velocities, the velocity goes in a straight line, and the
    attitude turns evenly the short way.  Without velocities the position goes in a straight line.

    Args:
        history: (N,) states, times running forwards.
        times: (M,) s.

    Returns:
        (M,) the states, and how many had to be interpolated.
    """
    left = np.searchsorted(history.time, times + slack(times), side="right") - 1
    left = np.clip(left, 0, len(history) - 1)
    exact = history.rows(left)
    between = np.abs(exact.time - times) > slack(times)
    if not between.any():
        return exact, 0
    first = left[between]
    a, b = history.rows(first), history.rows(np.minimum(first + 1, len(history) - 1))
    step = (b.time - a.time)[:, None]
    u = ((times[between] - a.time) / step[:, 0])[:, None]

    turned = rotation_vectors(product(conjugate(quaternions(a.q)), quaternions(b.q))) * u
    angle = np.linalg.norm(turned, axis=1)
    sine = 0.5 * np.sinc(angle / (2 * np.pi))
    part: Quaternions = (np.cos(0.5 * angle), *vectors(turned * sine[:, None]))
    place, far = _place(a), _place(b)
    far[:, 1] = place[:, 1] + np.mod(far[:, 1] - place[:, 1] + np.pi, 2 * np.pi) - np.pi
    rates = [(far - place) / step] * 2
    if "velocity" in known_quantities(history):
        rates = [_place_rate(a), _place_rate(b)]
    cubic = (
        (1 + 2 * u) * (1 - u) ** 2 * place
        + u * u * (3 - 2 * u) * far
        + step * u * (1 - u) * ((1 - u) * rates[0] - u * rates[1])
    )
    # fields beside each other, so that both kinds go back to their rows
    table = np.column_stack((exact.q, exact.v, exact.lat, exact.lon, exact.h))
    table[between] = np.column_stack(
        (np.stack(product(quaternions(a.q), part), 1), (1 - u) * a.v + u * b.v, cubic)
    )
    states = NavHistory(times, table[:, :4], table[:, 4:7], *table[:, 7:].T)
    return states, int(between.sum())


def _place(history: NavHistory) -> Array:
    return np.column_stack((history.lat, history.lon, history.h))


def _place_rate(history: NavHistory) -> Array:
    meridian, prime_vertical = radii(np.sin(history.lat))
    east = (prime_vertical + history.h) * np.cos(history.lat)
    return np.column_stack(
        (history.v[:, 0] / (meridian + history.h), history.v[:, 1] / east, -history.v[:, 2])
    )
