"""Samples of sensors: when they are, how they become counts, and which counts no sensor gives.

`Quantiser` makes counts of increments, `Resampler` even steps of uneven ones, `Passing` runs the
sensor's filter, `Imperfect` adds the errors of a real sensor and `Undo` takes out those that are
known, `AllanRecord` measures their Allan deviations, `Plausibility` sees stuck counts,
rails and spikes; the functions of instants are the one definition of when a sample and an interval
are.  It imports `algorithms`, `design` and `frames`.
"""

from sculler_model.samples.allan import (
    CLUSTERS,
    AllanCurve,
    AllanRecord,
    allan_deviation,
    asked_deviation,
    deviation_of,
    worst_ratio,
)
from sculler_model.samples.calibration import Calibration, Undo
from sculler_model.samples.imperfect import Imperfect
from sculler_model.samples.instants import (
    end_after_stamp,
    interval_end,
    interval_ends,
    sample_stamp,
)
from sculler_model.samples.passing import Passing
from sculler_model.samples.plausibility import Finding, FindingKind, Plausibility, in_words
from sculler_model.samples.quantiser import Quantiser
from sculler_model.samples.resampler import Gridded, Kind, Resampler

__all__ = [
    "CLUSTERS",
    "AllanCurve",
    "AllanRecord",
    "Calibration",
    "Finding",
    "FindingKind",
    "Gridded",
    "Imperfect",
    "Kind",
    "Passing",
    "Plausibility",
    "Quantiser",
    "Resampler",
    "Undo",
    "allan_deviation",
    "asked_deviation",
    "deviation_of",
    "end_after_stamp",
    "in_words",
    "interval_end",
    "interval_ends",
    "sample_stamp",
    "worst_ratio",
]
