"""A flight of one hour, planned leg by leg and flown as smooth splines."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import atan2, cos, radians, sin
from typing import NamedTuple

import numpy as np

from sculler_model.frames import radii
from sculler_model.motion.curves import Spline
from sculler_model.motion.earthbound import Motion
from sculler_model.motion.turns import euler_turns

STEP = 5.0
"""Seconds between the control points."""

BANK_GRAVITY = 9.81
"""m/s², for the bank of a coordinated turn, which is nobody's truth."""


class Leg(NamedTuple):
    """A part of a flight plan: speed, heading and height go evenly to their ends.

    Attributes:
        seconds: how long; a multiple of `STEP`.
        speed: over the Earth at the end, m/s.
        turn: heading changes by, degrees, right turns positive.
        climb: height changes by, m.
    """

    seconds: float
    speed: float
    turn: float = 0.0
    climb: float = 0.0


PLAN = (
    Leg(60, 0),  # at rest before take-off
    Leg(40, 75),  # along the runway
    Leg(120, 110, climb=1200),
    Leg(60, 120, turn=90, climb=300),
    Leg(360, 200, climb=5500),
    Leg(60, 200, turn=-70),
    Leg(600, 210),
    Leg(240, 210, turn=360),  # a full circle to the right
    Leg(60, 210, turn=-45, climb=200),
    Leg(300, 230, climb=2000),
    Leg(120, 230, turn=120),
    Leg(480, 230),
    Leg(240, 200, turn=-360, climb=-1200),  # down in a full circle to the left
    Leg(360, 160, climb=-4500),
    Leg(90, 130, turn=135, climb=-1000),
    Leg(250, 75, climb=-2500),
    Leg(60, 10),  # landing run
    Leg(20, 0),
    Leg(80, 0),  # at rest
)
"""One hour: take-off, climbs, turns both ways, two full circles, descent and landing."""


@lru_cache(maxsize=4)
def flight(
    lat: float,
    lon: float,
    h: float,
    heading: float = 0.0,
    plan: Sequence[Leg] = PLAN,
) -> Motion:
    """A flight over the turning Earth; at rest to begin with and where the plan ends so.

    Every quantity is a spline of degree 7 through control points 5 s apart that the plan gives by
    dead reckoning, so the motion has six continuous derivatives and all of it is in closed form.
    Turns are banked as their speed and rate ask for; the nose follows the climb and is raised a
    little in the air.

    Args:
        lat, lon, h: where it begins, rad, rad, m.
        heading: of the runway, rad.
        plan: the legs.
    """
    meridian, prime_vertical = radii(sin(lat))
    north, east, up = [0.0], [0.0], [0.0]
    angles = [(0.0, 0.0, heading)]
    speed = level = 0.0
    for leg in plan:
        steps = round(leg.seconds / STEP)
        turn_rate, climb_rate = radians(leg.turn) / leg.seconds, leg.climb / leg.seconds
        for step in range(steps):
            middle = speed + (step + 0.5) / steps * (leg.speed - speed)
            course = angles[-1][2] + 0.5 * turn_rate * STEP
            here = lat + north[-1] / (meridian + h)
            # metres over the Earth here, in metres of the starting point's radii
            m, p = radii(sin(here))
            stretch_north = (meridian + h) / (m + h + up[-1])
            stretch_east = (prime_vertical + h) * cos(lat) / ((p + h + up[-1]) * cos(here))
            north.append(north[-1] + STEP * middle * cos(course) * stretch_north)
            east.append(east[-1] + STEP * middle * sin(course) * stretch_east)
            up.append(level + (step + 1) / steps * leg.climb)
            airborne = up[-1] > 1.0
            angles.append(
                (
                    atan2(middle * turn_rate, BANK_GRAVITY),
                    (atan2(climb_rate, middle) + _RAISED if airborne else 0.0),
                    angles[-1][2] + turn_rate * STEP,
                )
            )
        speed, level = leg.speed, level + leg.climb
    roll, pitch, course_angle = (Spline(points, STEP) for points in np.array(angles).T.tolist())
    return Motion(
        lat,
        lon,
        h,
        north=Spline(north, STEP),
        east=Spline(east, STEP),
        up=Spline(up, STEP),
        turns=euler_turns(roll, pitch, course_angle),
        name="flight",
    )


def seconds(plan: Sequence[Leg] = PLAN) -> float:
    """Length of a plan, s."""
    return sum(leg.seconds for leg in plan)


_RAISED = radians(2.5)
