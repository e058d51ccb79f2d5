"""The host's navigation in double precision: wander azimuth over WGS-84."""

from sculler_model.navigation.alignment import Alignment, align
from sculler_model.navigation.fine_alignment import (
    NAVIGATION_GRADE,
    FineAlignment,
    SensorNoise,
    align_finely,
)
from sculler_model.navigation.geographic import GeographicNavigator
from sculler_model.navigation.navigator import (
    HeightDamping,
    Mechanisation,
    Navigator,
    navigate,
    trajectory,
)
from sculler_model.navigation.rotation import AxisMap
from sculler_model.navigation.state import NavHistory, NavState

__all__ = [
    "NAVIGATION_GRADE",
    "Alignment",
    "AxisMap",
    "FineAlignment",
    "GeographicNavigator",
    "HeightDamping",
    "Mechanisation",
    "NavHistory",
    "NavState",
    "Navigator",
    "SensorNoise",
    "align",
    "align_finely",
    "navigate",
    "trajectory",
]
