"""A foreign log converted: from a plan to an integer log and an `Outcome`."""

from sculler.runs.conversion.convert import convert_log
from sculler.runs.conversion.counts import Biases, Conversion
from sculler.runs.conversion.outcome import Outcome, told
from sculler.runs.conversion.plan import MAX_GAP, Layout, Plan, RunningSums

__all__ = [
    "MAX_GAP",
    "Biases",
    "Conversion",
    "Layout",
    "Outcome",
    "Plan",
    "RunningSums",
    "convert_log",
    "told",
]
