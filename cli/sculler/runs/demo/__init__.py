"""The main job from end to end on a motion whose truth is known, into a folder."""

from sculler.runs.demo.outcome import CORRECTED, LABELS, QUANTITIES, UNCORRECTED, UNITS, Outcome
from sculler.runs.demo.run import run_demo

__all__ = ["CORRECTED", "LABELS", "QUANTITIES", "UNCORRECTED", "UNITS", "Outcome", "run_demo"]
