"""Ready-made motions over the turning Earth, by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import atan2, cos, pi, radians, sin, sqrt

from sculler_model.frames import cross, from_dcm
from sculler_model.motion.curves import Curve, EvenPace
from sculler_model.motion.earthbound import Motion, earth_axis
from sculler_model.motion.flight_plan import BANK_GRAVITY, flight, seconds
from sculler_model.motion.turns import Turn, X, Z, coning_turns, euler_turns, steady_attitude

PLACE = (radians(48.0), radians(11.0), 500.0)
"""Where motions begin if nothing else is said: latitude, longitude (rad), height (m)."""


def at_rest(
    lat: float, lon: float, h: float, roll: float = 0.0, pitch: float = 0.0, heading: float = 0.0
) -> Motion:
    """Standing still on the Earth; angles in rad, height in m."""
    return Motion(lat, lon, h, turns=steady_attitude(roll, pitch, heading), name="at rest")


def turn_motion(
    lat: float = PLACE[0],
    lon: float = PLACE[1],
    h: float = PLACE[2],
    speed: float = 30.0,
    turn_rate: float = radians(6.0),
    bank: float | None = radians(5.0),
    coning_half_angle: float = 0.0,
    coning_hz: float = 50.0,
    rocking: float = 0.0,
    shaking: float = 0.0,
    sculling_hz: float = 35.0,
) -> Motion:
    """A vehicle in a steady level turn to the right, with vibration.

    But for the Earth's rotation, rate and specific force are constant in the body.

    Args:
        lat, lon, h: starting point, rad, rad, m.
        speed, turn_rate: m/s, rad/s.
        bank: rad; None as a coordinated turn has it, so that the specific force is square to the
            floor.
        coning_half_angle, coning_hz: classical coning about the body's z axis.
        rocking, shaking, sculling_hz: roll amplitude (rad) and vertical acceleration amplitude
            (m/s²) of one vibration, in phase, so that it rectifies sideways (see `Sculling`).
    """
    radius = speed / turn_rate
    sculling = 2 * pi * sculling_hz
    if bank is None:
        bank = atan2(speed * turn_rate, BANK_GRAVITY)
    turns = [Turn(Z, Curve((0.0, turn_rate))), Turn(X, Curve((bank,)))]
    if coning_half_angle:
        turns += coning_turns(coning_half_angle, 2 * pi * coning_hz)
    if rocking:
        turns.append(Turn(X, Curve(waves=((rocking, sculling, 0.0),))))
    return Motion(
        lat,
        lon,
        h,
        north=Curve(waves=((radius, turn_rate, 0.0),)),
        east=Curve((radius,), ((-radius, turn_rate, pi / 2),)),
        up=Curve(waves=((-shaking / sculling**2, sculling, 0.0),) if shaking else ()),
        turns=tuple(turns),
        name="turn with vibration" if coning_half_angle or rocking or shaking else "turn",
    )


def steady_turn(
    lat: float, lon: float, h: float, speed: float = 30.0, turn_rate: float = radians(6.0)
) -> Motion:
    """A coordinated level turn to the right: constant rate and specific force but for the Earth's.

    Args:
        lat, lon, h: where it begins, rad, rad, m.
        speed, turn_rate: m/s, rad/s.
    """
    return turn_motion(lat, lon, h, speed, turn_rate, bank=None)


def demo_motion() -> Motion:
    """The demonstration: 30 m/s in a 6 °/s turn, 0.1° coning at 50 Hz, sculling at 35 Hz.

    Uncorrected, the coning drifts 99 °/h about the body's z, and 0.1° of roll with 10 m/s² of
    vertical vibration at 35 Hz rectifies to 8.7 mm/s² sideways.
    """
    return turn_motion(coning_half_angle=radians(0.1), rocking=radians(0.1), shaking=10.0)


def coning(
    lat: float, lon: float, h: float, half_angle: float = radians(1.0), hertz: float = 20.0
) -> Motion:
    """Classical coning about the vertical, in one place; Yang's and Zeng's example by default."""
    return Motion(lat, lon, h, turns=coning_turns(half_angle, 2 * pi * hertz), name="coning")


def spin_cone(
    lat: float,
    lon: float,
    h: float,
    elevation: float = radians(60.0),
    cone_rate: float = radians(90.0),
    spin_rate: float = radians(60.0),
) -> Motion:
    """A body spins about its x axis while that axis goes round a cone about the vertical.

    Args:
        lat, lon, h: where, rad, rad, m.
        elevation: of the spin axis above the horizontal, rad; the cone's half angle is 90° less it.
        cone_rate: of the spin axis about the vertical, rad/s.
        spin_rate: of the body about the spin axis, rad/s.
    """
    turns = euler_turns(Curve((0.0, spin_rate)), Curve((elevation,)), Curve((0.0, cone_rate)))
    return Motion(lat, lon, h, turns=turns, name="spin-cone")


def spin_accel(
    lat: float,
    lon: float,
    h: float,
    roll_rate: float = 0.0,
    pitch_rate: float = 0.0,
    yaw_rate: float = radians(20.0),
    forward: float = 3.0,
    right: float = 0.0,
    down: float = 0.0,
) -> Motion:
    """Constant rate and acceleration in body axes, but for the Earth's: spin-accel.

    The closed forms of `SpinAccel` over the local level: from rest over the Earth, nose north.

    Args:
        lat, lon, h: where it begins, rad, rad, m.
        roll_rate, pitch_rate, yaw_rate: about body axes, rad/s.
        forward, right, down: acceleration along body axes, m/s².
    """
    rate, force = (roll_rate, pitch_rate, yaw_rate), (forward, right, down)
    size = sqrt(sum(w * w for w in rate))
    if size == 0:
        curves = [Curve((0.0, 0.0, 0.5 * f)) for f in force]
        turns: tuple[Turn, ...] = ()
    else:
        axis = (roll_rate / size, pitch_rate / size, yaw_rate / size)
        along = sum(n * f for n, f in zip(axis, force, strict=True))
        curves = []
        for n, f, beside in zip(axis, force, cross(axis, force), strict=True):
            across = (f - along * n) / size**2
            poly = (across, beside / size, 0.5 * along * n)
            waves = ((-across, size, pi / 2), (-beside / size**2, size, 0.0))
            curves.append(Curve(poly, waves))
        turns = (Turn(axis, Curve((0.0, size))),)
    north, east, fall = curves
    up = Curve(tuple(-c for c in fall.powers), tuple((-a, w, p) for a, w, p in fall.waves))
    return Motion(lat, lon, h, north=north, east=east, up=up, turns=turns, name="spin-accel")


def spin_rock_size(
    lat: float,
    lon: float,
    h: float,
    spin_rate: float = radians(30.0),
    rocking: float = radians(5.0),
    hertz: float = 5.0,
    arm: float = 0.5,
) -> Motion:
    """A body spins about the vertical and rocks in roll and pitch; its sensors sit off the centre.

    Args:
        lat, lon, h: the centre, rad, rad, m.
        spin_rate: about the vertical, rad/s.
        rocking, hertz: amplitude (rad) and frequency of roll and of pitch, a quarter cycle apart.
        arm: from the centre to the sensors, m, along each body axis.
    """
    omega = 2 * pi * hertz
    roll = Curve(waves=((rocking, omega, 0.0),))
    pitch = Curve(waves=((rocking, omega, pi / 2),))
    turns = euler_turns(roll, pitch, Curve((0.0, spin_rate)))
    lever = Curve((arm,))
    return Motion(lat, lon, h, turns=turns, arm=(lever,) * 3, name="spin-rock-size")


def sculling(
    lat: float,
    lon: float,
    h: float,
    angle: float = radians(0.1),
    force: float = 10.0,
    hertz: float = 35.0,
) -> Motion:
    """Classical sculling in one place: rolling and shaking sideways, in phase.

    Args:
        lat, lon, h: where, rad, rad, m.
        angle: amplitude of roll, rad.
        force: amplitude of the acceleration along body y, m/s².
        hertz: frequency of both.
    """
    omega = 2 * pi * hertz
    return Motion(
        lat,
        lon,
        h,
        turns=(Turn(X, Curve(waves=((angle, omega, 0.0),))),),
        east=Curve(waves=((-force / omega**2, omega, 0.0),)),
        name="sculling",
    )


def great_circle(
    lat: float,
    lon: float,
    h: float,
    heading: float = radians(60.0),
    speed: float = 250.0,
    gone: float = 0.0,
) -> Motion:
    """Along a great circle at constant speed over the Earth and constant height, level.

    The ellipsoid's normal goes along a great circle of directions, which is as near to a geodesic
    as a closed form needs to be; the body's x axis points along that circle.  It passes over poles
    as over any other place.

    Args:
        lat, lon, h: where it begins, rad, rad, m.
        heading: of the circle there, rad.
        speed: m/s, at height h.
        gone: metres along the circle at time 0; negative to begin before the place given.
    """
    # grid axes on the Earth: x the normal at the start, y along the circle, z completing them
    sin_lat, cos_lat, sin_lon, cos_lon = sin(lat), cos(lat), sin(lon), cos(lon)
    normal = (cos_lat * cos_lon, cos_lat * sin_lon, sin_lat)
    north = (-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat)
    east = (-sin_lon, cos_lon, 0.0)
    c, s = cos(heading), sin(heading)
    along = tuple(c * n + s * e for n, e in zip(north, east, strict=True))
    across = tuple(c * e - s * n for n, e in zip(north, east, strict=True))  # to the right
    rows = [(n, a, -r) for n, a, r in zip(normal, along, across, strict=True)]
    grid = from_dcm((rows[0], rows[1], rows[2]))
    return Motion(
        0.0,
        0.0,
        h,
        east=EvenPace(earth_axis(grid), h, speed, gone),
        turns=steady_attitude(0.0, 0.0, pi / 2),  # in the grid, whose equator is the path
        grid=grid,
        name="great circle",
    )


def over_the_pole(
    lon: float = PLACE[1], h: float = 10_000.0, speed: float = 250.0, before: float = 300.0
) -> Motion:
    """Across the north pole along the meridian `lon`, at constant speed and height.

    Args:
        lon: of the approach, rad.
        h: m.
        speed: m/s.
        before: seconds from the start to the pole.
    """
    return great_circle(pi / 2, lon, h, 0.0, speed, -speed * before)


def hour_flight(lat: float, lon: float, h: float, heading: float = radians(60.0)) -> Motion:
    """`flight` of one hour: take-off, climbs, turns, two full circles, descent, landing."""
    return flight(lat, lon, h, heading)


@dataclass(frozen=True)
class Entry:
    """A motion of the catalogue.

    Attributes:
        make: the function; its parameters (SI, angles in rad) are the motion's options.
        seconds: how long it goes on if nothing else is said.
    """

    make: Callable[..., Motion]
    seconds: float = 60.0

    @property
    def summary(self) -> str:
        """What it is, in a line."""
        return (self.make.__doc__ or "").splitlines()[0]


MOTIONS: dict[str, Entry] = {
    "rest": Entry(at_rest),
    "coning": Entry(coning),
    "sculling": Entry(sculling),
    "spin-cone": Entry(spin_cone),
    "spin-rock-size": Entry(spin_rock_size),
    "spin-accel": Entry(spin_accel),
    "turn": Entry(steady_turn),
    "great-circle": Entry(great_circle, 3600.0),
    "pole": Entry(over_the_pole, 600.0),
    "flight": Entry(hour_flight, seconds()),
    "demo": Entry(demo_motion),
}
