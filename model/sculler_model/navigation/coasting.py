"""Over a break in the data: attitude and velocity are kept, the position goes on with the velocity.

A guess, not navigation; `sculler navigate --breaks split` says where it had to be made.
"""

from __future__ import annotations

from math import sin

from sculler_model.frames import (
    about_z,
    from_rotation_vector,
    normalised,
    product,
    radii,
    rotate,
)
from sculler_model.navigation.state import NavState
from sculler_model.navigation.wander import NOT_YET, Earth, Level, geographic, place_at


def coasted(state: NavState, seconds: float) -> NavState:
    """The state so much later if attitude and velocity stay as they are, over poles too.

    The path is a straight line in the level frame that does not turn about the vertical (the wander
    angle's), on the curvature of the ellipsoid where it begins.

    Args:
        state: at the break.
        seconds: length of the break.

    Returns:
        The state at the end of the break, with a wander angle that carries on.
    """
    to_level = about_z(-state.wander)
    place = place_at(state.lat, state.lon, state.wander)
    meridian, prime_vertical = radii(sin(state.lat))
    north, east, down = state.v
    turn = (
        seconds * east / (prime_vertical + state.h),
        -seconds * north / (meridian + state.h),
        0.0,
    )
    place = normalised(product(place, from_rotation_vector(rotate(to_level, turn))))
    nowhere = Earth(NOT_YET, NOT_YET, NOT_YET)  # `geographic` asks for places only
    q, v = product(to_level, state.q), rotate(to_level, state.v)
    h = state.h - seconds * down
    there = Level(q, v, v, place, h, nowhere, nowhere, 0, NOT_YET, 0.0, 0.0)
    return NavState(state.time + seconds, *geographic(there))
