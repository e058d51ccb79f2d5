"""The host's navigation in double precision: local level, north-east-down, WGS-84."""

from sculler_model.navigation.alignment import Alignment, align
from sculler_model.navigation.navigator import (
    Mechanisation,
    NavHistory,
    Navigator,
    NavState,
    navigate,
    trajectory,
)
from sculler_model.navigation.rotation import AxisMap

__all__ = [
    "Alignment",
    "AxisMap",
    "Mechanisation",
    "NavHistory",
    "NavState",
    "Navigator",
    "align",
    "navigate",
    "trajectory",
]
