"""What follows from a path and an attitude at an instant: arithmetic alone, on floats or arrays.

Sines and cosines come from outside.  So the same functions serve many instants at once, in numpy,
and one after the other in machine code (`compiled`), with the same bits.
"""

from __future__ import annotations

from typing import TypeAlias

from sculler_model.frames import (
    EARTH_RATE,
    ECCENTRICITY_SQUARED,
    Real,
    Vector,
    conjugate,
    cross,
    normal_gravity,
    product,
    radii,
    rotate,
)

Three: TypeAlias = tuple[Real, Real, Real]
"""Three components, or a value with its first and second time derivative."""

Four: TypeAlias = tuple[Real, Real, Real, Real]
"""A quaternion, or sine and cosine of two angles."""


def turned(
    attitude: tuple[Four[Real], Three[Real], Three[Real]],
    turn: tuple[Four[Real], Three[Real], Three[Real]],
) -> tuple[Four[Real], Three[Real], Three[Real]]:
    """An attitude with one more turn inside: quaternion, rate and the rate's derivative.

    Args:
        attitude: body to reference frame, rate (rad/s) and its derivative (rad/s²) in body axes.
        turn: the same of the turn, from the new body axes to those before.
    """
    (q, rate, change), (step, own, gain) = attitude, turn
    back = conjugate(step)
    old_x, old_y, old_z = rotate(back, rate)
    # in the new axes, which turn by `own`, what stood before turns the other way
    swing_x, swing_y, swing_z = cross((old_x, old_y, old_z), own)
    was_x, was_y, was_z = rotate(back, change)
    return (
        product(q, step),
        (old_x + own[0], old_y + own[1], old_z + own[2]),
        (was_x + swing_x + gain[0], was_y + swing_y + gain[1], was_z + swing_z + gain[2]),
    )


def seen(
    arm: tuple[Three[Real], Three[Real], Three[Real]],
    q: Four[Real],
    rate: Three[Real],
    change: Three[Real],
) -> tuple[Three[Real], Three[Real], Three[Real]]:
    """A vector of body axes seen from the level frame, with two derivatives, axis by axis.

    Args:
        arm: its components in body axes, each with two derivatives.
        q, rate, change: of the body against the level frame, as `turned` gives them.
    """
    (x, x1, x2), (y, y1, y2), (z, z1, z2) = arm
    a, b = cross(rate, (x, y, z)), cross(rate, (x1, y1, z1))
    first = (x1 + a[0], y1 + a[1], z1 + a[2])
    c, d = cross(change, (x, y, z)), cross(rate, a)
    second = (
        x2 + 2 * b[0] + c[0] + d[0],
        y2 + 2 * b[1] + c[1] + d[1],
        z2 + 2 * b[2] + c[2] + d[2],
    )
    value, first, second = rotate(q, (x, y, z)), rotate(q, first), rotate(q, second)
    return (
        (value[0], first[0], second[0]),
        (value[1], first[1], second[1]),
        (value[2], first[2], second[2]),
    )


def followed(
    lat: Three[Real], lon: Three[Real], h: Three[Real], sines: Four[Real], axis: Vector
) -> tuple[Three[Real], Three[Real], Three[Real], Three[Real]]:
    """The level frame (north, east, down) under way over the Earth: (M1-M2) and their derivative.

    Args:
        lat, lon, h: grid coordinates (rad, rad, m), each with two derivatives.
        sines: sine and cosine of the latitude, then of the longitude.
        axis: the Earth's, in the grid.

    Returns:
        In level axes: the Earth's axis k, the third part of which is less the sine of geodetic
        latitude; the frame's rate over the Earth ρ, rad/s; velocity over the Earth, m/s, and its
        derivative, component by component, m/s².
    """
    (_, lat1, lat2), (_, lon1, lon2), (h0, h1, h2) = lat, lon, h
    sin_lat, cos_lat, sin_lon, cos_lon = sines
    x, y, z = axis
    outward = x * cos_lon + y * sin_lon
    k_n = z * cos_lat - sin_lat * outward
    k_e = y * cos_lon - x * sin_lon
    s = z * sin_lat + cos_lat * outward

    # ρ; ṅ is (lat1, east1, 0)
    east1 = lon1 * cos_lat
    east2 = lon2 * cos_lat - lon1 * lat1 * sin_lat
    rate_d = -lon1 * sin_lat
    # k stands still on the Earth: k̇ = -ρ×k in level axes
    k_n1 = rate_d * k_e - lat1 * s
    k_e1 = -rate_d * k_n - east1 * s
    s1 = lat1 * k_n + east1 * k_e
    s2 = lat2 * k_n + east2 * k_e + lat1 * k_n1 + east1 * k_e1

    _, N = radii(s)
    D = 1 - ECCENTRICITY_SQUARED * s * s
    g = ECCENTRICITY_SQUARED * s * s1 / D
    p = ECCENTRICITY_SQUARED * N * s1 / D  # e² d(N s)/dt
    p1 = ECCENTRICITY_SQUARED * N * (s2 + 3 * g * s1) / D
    radius, radius1 = N + h0, N * g + h1
    return (
        (k_n, k_e, -s),
        (east1, -lat1, rate_d),
        (radius * lat1 - p * k_n, radius * east1 - p * k_e, -h1),
        (
            radius1 * lat1 + radius * lat2 - p1 * k_n - p * k_n1,
            radius1 * east1 + radius * east2 - p1 * k_e - p * k_e1,
            -h2,
        ),
    )


def felt(
    q: Four[Real],
    rate: Three[Real],
    lat: Three[Real],
    lon: Three[Real],
    h: Three[Real],
    sines: Four[Real],
    axis: Vector,
) -> tuple[Three[Real], Three[Real]]:
    """What perfect sensors feel: ω_ib (rad/s) and specific force (m/s²), in body axes.

    Args:
        q, rate: of the body against the level frame, as `turned` gives them.
        lat, lon, h, sines, axis: as `followed` takes them.
    """
    k, en, velocity, change = followed(lat, lon, h, sines, axis)
    to_body = conjugate(q)
    ie = (EARTH_RATE * k[0], EARTH_RATE * k[1], EARTH_RATE * k[2])
    frame = rotate(to_body, (ie[0] + en[0], ie[1] + en[1], ie[2] + en[2]))
    twice = (2 * ie[0] + en[0], 2 * ie[1] + en[1], 2 * ie[2] + en[2])
    coriolis = cross(twice, velocity)
    leaning, down = normal_gravity(-k[2], h[0])
    force = (
        change[0] + coriolis[0] - leaning * k[0],
        change[1] + coriolis[1] - leaning * k[1],
        change[2] + coriolis[2] - down,
    )
    turning = (frame[0] + rate[0], frame[1] + rate[1], frame[2] + rate[2])
    return turning, rotate(to_body, force)
