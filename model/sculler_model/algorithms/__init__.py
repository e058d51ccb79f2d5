"""Coning and sculling algorithms as exact rationals: tap tables and the families they come from.

`TapTable` holds a table of integer taps over one denominator; `make` designs one of any family of
`FAMILIES`.  Vectors of exact integers, the scrolling of high-resolution position and the terms of
third and fourth order are here too.  It imports no other room.
"""

from sculler_model.algorithms.balance import Balance, SensorKind, Sum
from sculler_model.algorithms.band import Band, RotaryMode
from sculler_model.algorithms.catalogue import (
    BASES,
    FAMILIES,
    SENSOR_KINDS,
    TABLES,
    Made,
    Match,
    Recipe,
    make,
)
from sculler_model.algorithms.decimals import pi_to, rational
from sculler_model.algorithms.delay import fractional_delay
from sculler_model.algorithms.dual_vectors import (
    DUAL_ZERO,
    Dual,
    dual_cross,
    dual_sum,
    dual_times,
)
from sculler_model.algorithms.higher_order import ORDERS, Composition, HigherOrder, composition
from sculler_model.algorithms.integer_vectors import (
    ZERO,
    Vec,
    cross,
    times,
    vector_sum,
    whole_numbers,
)
from sculler_model.algorithms.least_squares import Fit, fit
from sculler_model.algorithms.pairs import (
    distance_sums,
    first_manoeuvre_error,
    manoeuvre_error,
    tap_table,
)
from sculler_model.algorithms.response import Analogue, Digital, Measured, Response, Sinc, Stage
from sculler_model.algorithms.scrolling import (
    S_DENOMINATOR,
    SCROLLING_DENOMINATOR,
    DoublyIntegrated,
    HighResolution,
    high_resolution,
    scrolling_weight,
    scrolling_weights_total,
)
from sculler_model.algorithms.tap_table import (
    MAX_SAMPLES,
    TapTable,
    filtered_rate,
    frequency_taylor,
    newton_cotes,
)
from sculler_model.algorithms.time_taylor import time_taylor
from sculler_model.algorithms.triples import TripleTaps, triple_taps
from sculler_model.algorithms.uncompressed import uncompress, uncompressed

__all__ = [
    "BASES",
    "DUAL_ZERO",
    "FAMILIES",
    "MAX_SAMPLES",
    "ORDERS",
    "SCROLLING_DENOMINATOR",
    "SENSOR_KINDS",
    "S_DENOMINATOR",
    "TABLES",
    "ZERO",
    "Analogue",
    "Balance",
    "Band",
    "Composition",
    "Digital",
    "DoublyIntegrated",
    "Dual",
    "Fit",
    "HighResolution",
    "HigherOrder",
    "Made",
    "Match",
    "Measured",
    "Recipe",
    "Response",
    "RotaryMode",
    "SensorKind",
    "Sinc",
    "Stage",
    "Sum",
    "TapTable",
    "TripleTaps",
    "Vec",
    "composition",
    "cross",
    "distance_sums",
    "dual_cross",
    "dual_sum",
    "dual_times",
    "filtered_rate",
    "first_manoeuvre_error",
    "fit",
    "fractional_delay",
    "frequency_taylor",
    "high_resolution",
    "make",
    "manoeuvre_error",
    "newton_cotes",
    "pi_to",
    "rational",
    "scrolling_weight",
    "scrolling_weights_total",
    "tap_table",
    "time_taylor",
    "times",
    "triple_taps",
    "uncompress",
    "uncompressed",
    "vector_sum",
    "whole_numbers",
]
