"""Which designs meet a requirement in an environment, and which of them is cheapest.

Errors come from closed forms: under a vibration the bound (V4) of `analysis.vibration`, under
classical coning the drift of the whole computation, of any order (`coning_drift`);
under classical sculling that of the table.  Manoeuvres run through the integers (`flight.flown`);
position is held against Savage-98's closed forms by the trapezoid, and at high resolution run
through the core (`position.left`), which does not depend on the family.
Cost is counted from the word lengths and the tap table, in one-bit full-adder operations, which is
what additions and multiplications come down to in gates: an addition of w bits is w of them, a
product of l by r bits is l·r.
"""

from sculler_model.analysis.advice.candidates import (
    FITTED_BITS,
    FITTED_POINTS,
    MAX_TURN,
    WIDEST_BAND,
    Environment,
    Requirement,
    candidates,
    fitted_band,
)
from sculler_model.analysis.advice.coning import coning_drift
from sculler_model.analysis.advice.cost import Cost, cost, signed_digit_count
from sculler_model.analysis.advice.judgement import PER_HOUR, Candidate, advise, by_order

__all__ = [
    "FITTED_BITS",
    "FITTED_POINTS",
    "MAX_TURN",
    "PER_HOUR",
    "WIDEST_BAND",
    "Candidate",
    "Cost",
    "Environment",
    "Requirement",
    "advise",
    "by_order",
    "candidates",
    "coning_drift",
    "cost",
    "fitted_band",
    "signed_digit_count",
]
