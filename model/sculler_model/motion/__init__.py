"""Truth motions: known attitude, velocity and position, and the exact samples a sensor would give.

`Motion` moves over the rotating WGS-84 Earth: a path and an attitude made of analytic functions,
from which angular rate and specific force follow without any integration; `catalogue` has
ready-made ones, `through` makes one of given points, `Vibration` shakes any of them.  `Coning`,
`Sculling` and `SpinAccel` are the classical motions in inertial space.  Body frame: x forward, y
right, z down; navigation frame: north, east, down.  It imports `algorithms`, `design`, `frames` and
`samples`.
"""

from sculler_model.motion.catalogue import (
    MOTIONS,
    PLACE,
    at_rest,
    coning,
    demo_motion,
    great_circle,
    hour_flight,
    over_the_pole,
    sculling,
    spin_accel,
    spin_cone,
    spin_rock_size,
    steady_turn,
    turn_motion,
)
from sculler_model.motion.curves import Curve, EvenPace, Smooth, Spline
from sculler_model.motion.earthbound import Motion
from sculler_model.motion.filtered import Filtered, delivered
from sculler_model.motion.flight_plan import Leg, flight
from sculler_model.motion.inertial import Coning, Sculling, SpinAccel
from sculler_model.motion.placed import Placed, as_felt
from sculler_model.motion.points import SMOOTHNESS, Knots, PointCurve, Tumble
from sculler_model.motion.sampling import Sampled, legendre_nodes
from sculler_model.motion.trajectory import Points, through
from sculler_model.motion.turns import (
    Rotation,
    Turn,
    X,
    Y,
    Z,
    attitude,
    coning_turns,
    euler_turns,
    steady_attitude,
)
from sculler_model.motion.vibration import Vibration

__all__ = [
    "MOTIONS",
    "PLACE",
    "SMOOTHNESS",
    "Coning",
    "Curve",
    "EvenPace",
    "Filtered",
    "Knots",
    "Leg",
    "Motion",
    "Placed",
    "PointCurve",
    "Points",
    "Rotation",
    "Sampled",
    "Sculling",
    "Smooth",
    "SpinAccel",
    "Spline",
    "Tumble",
    "Turn",
    "Vibration",
    "X",
    "Y",
    "Z",
    "as_felt",
    "at_rest",
    "attitude",
    "coning",
    "coning_turns",
    "delivered",
    "demo_motion",
    "euler_turns",
    "flight",
    "great_circle",
    "hour_flight",
    "legendre_nodes",
    "over_the_pole",
    "sculling",
    "spin_accel",
    "spin_cone",
    "spin_rock_size",
    "steady_attitude",
    "steady_turn",
    "through",
    "turn_motion",
]
