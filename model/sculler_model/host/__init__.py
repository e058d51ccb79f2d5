"""What the host makes of a core's integers: Φ, α, ΔV_SF and ΔR_SF of each major interval.

`major_increments` is the whole of it; `calibrated` takes known errors of the sensor out.  It
imports `algorithms`, `design`, `fast`, `frames` and `samples`.
"""

from sculler_model.host.compensation import (
    displacement,
    half_minus_cosine,
    one_minus_cosine,
    one_minus_sine,
    position_rotation,
    velocity_higher_orders,
    velocity_rotation,
)
from sculler_model.host.increments import MajorIncrements
from sculler_model.host.known_errors import calibrated, refuse_of_samples
from sculler_model.host.next_orders import next_orders
from sculler_model.host.scaling import (
    increments_of,
    major_increments,
    refuse_third_order,
    second_order_corrections,
    uncorrected,
)
from sculler_model.host.third_order import (
    ThirdOrder,
    rotation_terms,
    slopes,
    third_order_terms,
    velocity_terms,
)

__all__ = [
    "MajorIncrements",
    "ThirdOrder",
    "calibrated",
    "displacement",
    "half_minus_cosine",
    "increments_of",
    "major_increments",
    "next_orders",
    "one_minus_cosine",
    "one_minus_sine",
    "position_rotation",
    "refuse_of_samples",
    "refuse_third_order",
    "rotation_terms",
    "second_order_corrections",
    "slopes",
    "third_order_terms",
    "uncorrected",
    "velocity_higher_orders",
    "velocity_rotation",
    "velocity_terms",
]
