"""The wander-azimuth mechanisation: the arithmetic of one major interval (Savage-98 Table 1).

Frames:
    b   body: x forward, y right, z down.
    e   Earth: x through latitude 0 and longitude 0, z through the north pole.
    w   local level: z down along the ellipsoid's normal; x is turned from north by the wander
        angle α, towards east.  Over the Earth it turns with the travel alone and not about the
        vertical (ρ_z = 0), so nothing grows at the poles.

w stands for both of Savage's frames N (z up) and L (z down).  C_ew, his C_N^E, takes w components
to e components; it is carried as the quaternion `place`, which stays a rotation for ever, and
q (q_wb) is his C_B^L likewise.

Everything here is plain arithmetic on floats and tuples of floats, without any state of its own:
the real-time path runs it as it stands, and `compiled` compiles the very same functions.
"""

from __future__ import annotations

from math import asin, atan2, copysign, cos, pi, sin, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler_model.frames import (
    EARTH_RATE,
    ECCENTRICITY_SQUARED,
    Quaternion,
    Vector,
    about_z,
    cross,
    from_rotation_vector,
    normalised,
    plus,
    product,
    radii,
    rotate,
    to_dcm,
)
from sculler_model.navigation.gravity import Gravity, gravity_at

Array = NDArray[np.float64]

AT_POLE = 1e-12
"""Cosine of latitude below which north and longitude are by convention: 6 µm from a pole."""


class Earth(NamedTuple):
    """What the equations need of the Earth at one place, in the frame w.

    Attributes:
        rate: ω_ie, rad/s (Savage-98 Eq. 2).
        curvature: xx, xy, yy of the ellipsoid's curvature at the height, 1/m: the transport rate
            is (xy v_x + yy v_y, -xx v_x - xy v_y, 0) (Savage-98 Eq. 3, F_C and ρ_z = 0).
        gravity: plumb-bob gravity, m/s².
    """

    rate: Vector
    curvature: Vector
    gravity: Vector


class Settings(NamedTuple):
    """What does not change from interval to interval.

    Attributes:
        interval: T, length of a major interval, s.
        position_every: j, major intervals from one position update to the next.
        high_resolution: position by the doubly integrated increments, not by the trapezoid.
        damping: gains of the height loop k1 (1/s), k2 (1/s²), k3 (1/s³); 0 for no loop.
        gravity: the model to navigate by.
        free: w does not turn about the vertical against the stars (free azimuth); else it does not
            over the Earth (wander azimuth).
    """

    interval: float
    position_every: int
    high_resolution: bool
    damping: tuple[float, float, float]
    gravity: Gravity
    free: bool = False


class Level(NamedTuple):
    """All that is carried from one major interval to the next.

    At the end of the last major interval:
        q: q_wb, body to w.
        v, v_past: velocity over the Earth in w, m/s; and one interval before.
    At the last position update:
        place: q_ew, the rotation C_ew.
        h: height above the ellipsoid, m.
        earth, earth_past: there; and one position update before.
    Since the last position update:
        since: major intervals.
        travel: rotation vector of w over the Earth, rad (Savage-98 Eq. 73, ξ).
        climb: m.
    And:
        offset: integral of the height loop, m/s².
    """

    q: Quaternion
    v: Vector
    v_past: Vector
    place: Quaternion
    h: float
    earth: Earth
    earth_past: Earth
    since: int
    travel: Vector
    climb: float
    offset: float


NOT_YET: Vector = (0.0, 0.0, 0.0)


def numbers_of(now: Level) -> tuple[float, ...]:
    """A state as 39 numbers one after another, so that it fits an array."""
    here, past = now.earth, now.earth_past
    return (
        *now.q, *now.v, *now.v_past, *now.place, now.h,
        *here.rate, *here.curvature, *here.gravity,
        *past.rate, *past.curvature, *past.gravity,
        float(now.since), *now.travel, now.climb, now.offset,
    )  # fmt: skip


def level_of(n: Array | list[float]) -> Level:
    """The state of the 39 numbers of `numbers_of`."""
    return Level(
        (n[0], n[1], n[2], n[3]),
        (n[4], n[5], n[6]),
        (n[7], n[8], n[9]),
        (n[10], n[11], n[12], n[13]),
        n[14],
        Earth((n[15], n[16], n[17]), (n[18], n[19], n[20]), (n[21], n[22], n[23])),
        Earth((n[24], n[25], n[26]), (n[27], n[28], n[29]), (n[30], n[31], n[32])),
        int(n[33]),
        (n[34], n[35], n[36]),
        n[37],
        n[38],
    )


def level(
    q_nb: Quaternion,
    v_n: Vector,
    lat: float,
    lon: float,
    h: float,
    wander: float,
    model: Gravity,
) -> Level:
    """The carried state of geographic terms (see `NavState`), with a past that stood still."""
    to_level, place = about_z(-wander), place_at(lat, lon, wander)
    v = rotate(to_level, v_n)
    here = earth_at(place, h, model)
    q = normalised(product(to_level, q_nb))
    return Level(q, v, v, place, h, here, here, 0, NOT_YET, 0.0, 0.0)


def place_at(lat: float, lon: float, wander: float) -> Quaternion:
    """q_ew of latitude, longitude and wander angle (rad)."""
    theta = -0.5 * pi - lat  # C_en = R_z(lon) R_y(-90° - lat)
    to_earth: Quaternion = (cos(0.5 * theta), 0.0, sin(0.5 * theta), 0.0)
    return normalised(product(about_z(lon), product(to_earth, about_z(wander))))


def geographic(
    now: Level,
) -> tuple[Quaternion, Vector, float, float, float, float]:
    """What `NavState` tells, without the time: q_nb, v_n, lat, lon, h, wander.

    Within `AT_POLE` of a pole, where there is no north, the wander angle is 0 and the longitude
    goes with it.
    """
    place, h = position(now)
    (xx, _, xz), (yx, _, yz), (zx, zy, zz) = to_dcm(place)
    cos_lat = sqrt(xz * xz + yz * yz)  # the third column of C_ew is down
    lat = angle_of(cos_lat, -zz)
    if cos_lat <= AT_POLE:  # north is the frame's x axis
        lon = atan2(-yx, -xx) if lat > 0 else atan2(yx, xx)
        return now.q, now.v, lat, lon, h, 0.0
    per = 1 / cos_lat
    lon = angle_of(-per * xz, -per * yz)
    # the polar axis in w, the third row, is (cos lat cos α, -cos lat sin α, -sin lat)
    c, s = per * zx, -per * zy
    wander = angle_of(c, s)
    if c > 0:  # of α/2 the larger one of cosine and sine by the square root
        half_c = sqrt(0.5 + 0.5 * c)
        half_s = 0.5 * s / half_c
    else:
        half_s = copysign(sqrt(0.5 - 0.5 * c), s)
        half_c = 0.5 * s / half_s
    qw, qx, qy, qz = now.q
    q = (
        half_c * qw - half_s * qz,
        half_c * qx - half_s * qy,
        half_c * qy + half_s * qx,
        half_c * qz + half_s * qw,
    )
    x, y, z = now.v
    return q, (c * x - s * y, s * x + c * y, z), lat, lon, h, wander


def angle_of(cosine: float, sine: float) -> float:
    """`atan2(sine, cosine)` of a cosine and a sine of one angle, in a third of the time (rad)."""
    if abs(sine) >= abs(cosine):
        return copysign(0.5 * pi - asin(cosine), sine)
    small = asin(sine)
    return small if cosine > 0 else copysign(pi, sine) - small


def position(now: Level) -> tuple[Quaternion, float]:
    """q_ew and height (m) at the end of the last major interval (Savage-98 Eq. 64, 68, 70)."""
    if now.since == 0:
        return now.place, now.h
    place = normalised(product(now.place, from_rotation_vector(now.travel)))
    return place, now.h + now.climb


def earth_at(place: Quaternion, h: float, model: Gravity) -> Earth:
    """The Earth at q_ew and height h (m), in w.

    The polar axis in w is (cos lat cos α, -cos lat sin α, -sin lat), the third row of C_ew.  The
    principal curvatures differ by κ cos² lat, so turned into w by α they are 1/(R_N + h) + κ P Pᵀ:
    regular at the poles, where P has no horizontal part.  So is gravity's horizontal part, which
    goes with cos lat as well.
    """
    polar = to_dcm(place)[2]
    px, py, pz = polar
    meridian, prime_vertical = radii(pz)
    across = 1 / (prime_vertical + h)
    kappa = ECCENTRICITY_SQUARED / (1 - ECCENTRICITY_SQUARED) * across * meridian / (meridian + h)
    leaning, down = gravity_at(model, -pz, h)
    return Earth(
        (EARTH_RATE * px, EARTH_RATE * py, EARTH_RATE * pz),
        (across + kappa * px * px, kappa * px * py, across + kappa * py * py),
        (leaning * px, leaning * py, down),
    )


def travelled(curvature: Vector, moved: Vector) -> Vector:
    """F_C (u × moved): rotation (rad) over the Earth of a displacement (m), both in w.

    Of a velocity (m/s) it is the rate of that rotation, rad/s.
    """
    xx, xy, yy = curvature
    return (xy * moved[0] + yy * moved[1], -xx * moved[0] - xy * moved[1], 0.0)


def with_past(now: Level, after: Level, settings: Settings) -> Level:
    """The first state with the past that straight lines through it and the next one give.

    The extrapolations of `step` need a past; the first interval is therefore done twice.
    """
    place, h = position(after)
    there = earth_at(place, h, settings.gravity)
    return Level(
        now.q,
        now.v,
        plus(now.v, plus(now.v, after.v, -1.0), 1.0),
        now.place,
        now.h,
        now.earth,
        between(now.earth, there, -float(settings.position_every)),
        now.since,
        now.travel,
        now.climb,
        now.offset,
    )


def between(a: Earth, b: Earth, part: float) -> Earth:
    """A part of the way (1: all of it) from a to b, on the straight line."""
    return Earth(
        plus(a.rate, plus(b.rate, a.rate, -1.0), part),
        plus(a.curvature, plus(b.curvature, a.curvature, -1.0), part),
        plus(a.gravity, plus(b.gravity, a.gravity, -1.0), part),
    )


def about_vertical(turn: Vector, there: Earth, settings: Settings, time: float) -> Vector:
    """The turn of w over the Earth with its part about the vertical: ρ_z = -ω_ie,z where free."""
    return (turn[0], turn[1], -time * there.rate[2]) if settings.free else turn


def turned_and_pulled(there: Earth, v: Vector, settings: Settings) -> tuple[Vector, Vector]:
    """ζ (rad) and gravity with Coriolis (m/s) over an interval at velocity v (Eq. 7, 17)."""
    T = settings.interval
    w_en = about_vertical(travelled(there.curvature, v), there, settings, 1.0)
    x, y, z = plus(there.rate, w_en, 1.0)
    pull_x, pull_y, pull_z = plus(there.gravity, cross(plus(w_en, there.rate, 2.0), v), -1.0)
    return (T * x, T * y, T * z), (T * pull_x, T * pull_y, T * pull_z)


def carried(
    now: Level, settings: Settings, mid: Earth, damped: Vector, dv_sf: Vector, dr_sf: Vector
) -> tuple[Vector, Vector]:
    """Velocity (m/s) at the end of the interval, and the displacement over it (m), both in w.

    The frame w turns by ζ while the specific force acts.  A force constant in w, as at rest or in
    steady flight, then gives (I - ½ζ× + (ζ×)²/12) C_wb ΔV_SF: exact to ζ⁴/720, where Savage-98
    Eq. 13-14 with the whole of ζ (for intervals within one position update) leaves ½ζ.  Likewise
    its double integral gets -(ζ/6× - (ζ×)²/24) C_wb ΔV_SF T, the 1/3 of Eq. 79 for half of ζ.

    With `high_resolution` more is known, so that vibration in step with the updates, whose velocity
    at the interval ends stands off its mean, does no harm: Coriolis and transport rate are those of
    the mean velocity, displacement over T, and -½ζ× ΔV_SF becomes -ζ× (ΔV_SF - ΔR_SF/T), which
    holds for any course of the force.  The term in ζ² then is 1/6 for a force constant in w.

    Args:
        now, settings, dv_sf, dr_sf: as for `step`.
        mid: the Earth at the middle of the interval.
        damped: what the height loop adds to the velocity, m/s.
    """
    T = settings.interval
    v_mid = plus(now.v, plus(now.v, now.v_past, -1.0), 0.5)
    zeta, dv_g_cor = turned_and_pulled(mid, v_mid, settings)
    dv = rotate(now.q, dv_sf)
    once = cross(zeta, dv)
    twice = cross(zeta, once)

    # velocity (Savage-98 Eq. 4-7, 11, 13) and displacement over the interval (Eq. 75 or 83)
    moved = NOT_YET
    if settings.high_resolution:
        dr = rotate(now.q, dr_sf)
        half = plus(plus(now.v, dv_g_cor, 0.5), damped, 0.5)
        moved = plus(dr, plus(plus(half, once, -1 / 6), twice, 1 / 24), T)
        zeta, dv_g_cor = turned_and_pulled(
            mid, (moved[0] / T, moved[1] / T, moved[2] / T), settings
        )
        dv_sf_w = plus(plus(dv, cross(zeta, plus(dv, dr, -1 / T)), -1.0), twice, 1 / 6)
    else:
        dv_sf_w = plus(plus(dv, once, -0.5), twice, 1 / 12)
    v = plus(plus(plus(now.v, dv_sf_w, 1.0), dv_g_cor, 1.0), damped, 1.0)
    if not settings.high_resolution:
        moved = plus((0.5 * T * v[0], 0.5 * T * v[1], 0.5 * T * v[2]), now.v, 0.5 * T)
    return v, moved


def above(h: float, down: float, held: tuple[float, float]) -> float:
    """By how much (m) a height is above the one to hold to, both when that was measured.

    Args:
        h, down: height (m) and velocity down (m/s) at the start of the interval.
        held: as for `step`.
    """
    reference, age = held
    return h - reference + down * age if age >= 0.0 else 0.0


def step(
    now: Level,
    settings: Settings,
    phi: Vector,
    dv_sf: Vector,
    dr_sf: Vector,
    held: tuple[float, float],
) -> Level:
    """Carry the state over one major interval: velocity, position, then attitude.

    Args:
        now: at the start of the interval.
        settings: interval and modes.
        phi: rotation vector of the body over the interval, against inertial space, rad.
        dv_sf: ΔV_SF, integral of the specific force (m/s) in the body frame at the START of the
            interval, held fixed in inertial space (Savage-98 Eq. 37).
        dr_sf: ΔR_SF, the running integral of that over the interval (m), same frame (Savage-98
            Eq. 84); not looked at without `high_resolution`.
        held: the height (m) that the loop holds to and its age (s) at the start of the interval;
            below 0 for none, the loop then rests.

    Returns:
        The state at the end of the interval.
    """
    turn, moved_on = displaced(now, settings, dv_sf, dr_sf, held)
    # attitude: q_wb(new) = q(-ζ) q_wb(old) q(φ), with the ζ of the displacement (Savage-20 Eq. 1)
    back = from_rotation_vector((-turn[0], -turn[1], -turn[2]))
    q = normalised(product(back, product(now.q, from_rotation_vector(phi))))
    return settled(moved_on, settings, q)


def displaced(
    now: Level, settings: Settings, dv_sf: Vector, dr_sf: Vector, held: tuple[float, float]
) -> tuple[Vector, Level]:
    """Velocity and position of `step`, and by how much w turns against the stars, ζ (rad).

    The state returned has the attitude of the interval's start still, and its place is not worked
    out yet: both are up to `settled`.
    """
    T, j = settings.interval, settings.position_every
    # the middle of the interval, by extrapolation (Savage-98 Eq. 8, 9, 19)
    mid = between(now.earth, now.earth_past, -(now.since + 0.5) / j)
    k1, k2, k3 = settings.damping
    too_high = above(now.h + now.climb, now.v[2], held)
    offset = now.offset + T * k3 * too_high
    damped = (0.0, 0.0, T * (k2 * too_high + offset))

    v, moved = carried(now, settings, mid, damped, dv_sf, dr_sf)

    # position: what the displacement turns w by (Eq. 71-73)
    xi = about_vertical(travelled(mid.curvature, moved), mid, settings, T)
    travel = plus(now.travel, xi, 1.0)
    climb = now.climb - moved[2] - T * k1 * too_high
    after = Level(
        now.q, v, now.v, now.place, now.h, now.earth, now.earth_past,
        now.since + 1, travel, climb, offset,
    )  # fmt: skip
    return plus(xi, mid.rate, T), after


def settled(after: Level, settings: Settings, q: Quaternion) -> Level:
    """The state with its new attitude, and with its place where it is time for that."""
    if after.since < settings.position_every:
        return Level(
            q, after.v, after.v_past, after.place, after.h, after.earth, after.earth_past,
            after.since, after.travel, after.climb, after.offset,
        )  # fmt: skip
    place, h = position(after)
    here = earth_at(place, h, settings.gravity)
    return Level(
        q, after.v, after.v_past, place, h, here, after.earth, 0, NOT_YET, 0.0, after.offset
    )
