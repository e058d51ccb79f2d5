"""The host's navigation in double precision: wander azimuth over WGS-84.

`Navigator` carries attitude, velocity and position from the increments of `host`; alignment finds
where it begins; `Comparison` holds a run against its truth.  It imports `frames`, `host`, and what
those import.
"""

from sculler_model.navigation.alignment import (
    ESTIMATED,
    MIN_ALIGNMENT_INTERVALS,
    MIN_ALIGNMENT_SECONDS,
    Alignment,
    align,
    alignment_warnings,
    refuse_unfit_window,
)
from sculler_model.navigation.attitude_estimate import AttitudeEstimate
from sculler_model.navigation.attitude_only import (
    AttitudeNavigator,
    RestBias,
    RestWindow,
    attitude_state,
)
from sculler_model.navigation.coasting import coasted
from sculler_model.navigation.comparison import Comparison, Figures, LeftOut, Start
from sculler_model.navigation.compiled import compiled_run
from sculler_model.navigation.errors import (
    NAUTICAL_MILE,
    NORTH_EAST_DOWN,
    NavErrors,
    known_quantities,
    navigation_errors,
)
from sculler_model.navigation.exact import exact_increments
from sculler_model.navigation.fine_alignment import FineAlignment, align_finely
from sculler_model.navigation.geographic import GeographicNavigator
from sculler_model.navigation.gravity import (
    NORMAL,
    Gravity,
    constant_gravity,
    gravity_at,
    refuse_outside,
    table_of_gravity,
)
from sculler_model.navigation.height import HeightDamping, HeightKeeper, HeightReference
from sculler_model.navigation.interpolation import interpolated
from sculler_model.navigation.navigator import (
    Mechanisation,
    Navigator,
    navigate,
    trajectory,
)
from sculler_model.navigation.sensor_noise import NAVIGATION_GRADE, SensorNoise
from sculler_model.navigation.state import (
    MAX_HEIGHT,
    MIN_HEIGHT,
    NavHistory,
    NavState,
    told_times,
)

__all__ = [
    "ESTIMATED",
    "MAX_HEIGHT",
    "MIN_ALIGNMENT_INTERVALS",
    "MIN_ALIGNMENT_SECONDS",
    "MIN_HEIGHT",
    "NAUTICAL_MILE",
    "NAVIGATION_GRADE",
    "NORMAL",
    "NORTH_EAST_DOWN",
    "Alignment",
    "AttitudeEstimate",
    "AttitudeNavigator",
    "Comparison",
    "Figures",
    "FineAlignment",
    "GeographicNavigator",
    "Gravity",
    "HeightDamping",
    "HeightKeeper",
    "HeightReference",
    "LeftOut",
    "Mechanisation",
    "NavErrors",
    "NavHistory",
    "NavState",
    "Navigator",
    "RestBias",
    "RestWindow",
    "SensorNoise",
    "Start",
    "align",
    "align_finely",
    "alignment_warnings",
    "attitude_state",
    "coasted",
    "compiled_run",
    "constant_gravity",
    "exact_increments",
    "gravity_at",
    "interpolated",
    "known_quantities",
    "navigate",
    "navigation_errors",
    "refuse_outside",
    "refuse_unfit_window",
    "table_of_gravity",
    "told_times",
    "trajectory",
]
