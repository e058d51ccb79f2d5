"""The host's navigation in double precision: wander azimuth over WGS-84."""

from sculler_model.navigation.alignment import Alignment, align
from sculler_model.navigation.fine_alignment import FineAlignment, align_finely
from sculler_model.navigation.geographic import GeographicNavigator
from sculler_model.navigation.gravity import Gravity, constant_gravity, table_of_gravity
from sculler_model.navigation.navigator import (
    HeightDamping,
    Mechanisation,
    Navigator,
    navigate,
    trajectory,
)
from sculler_model.navigation.rotation import AxisMap
from sculler_model.navigation.sensor_noise import NAVIGATION_GRADE, SensorNoise
from sculler_model.navigation.state import NavHistory, NavState

__all__ = [
    "NAVIGATION_GRADE",
    "Alignment",
    "AxisMap",
    "FineAlignment",
    "GeographicNavigator",
    "Gravity",
    "HeightDamping",
    "Mechanisation",
    "NavHistory",
    "NavState",
    "Navigator",
    "SensorNoise",
    "align",
    "align_finely",
    "constant_gravity",
    "navigate",
    "table_of_gravity",
    "trajectory",
]
