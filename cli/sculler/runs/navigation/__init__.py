"""A file of vectors navigated: from a plan to files, pictures and an `Outcome`."""

from sculler.runs.navigation.against_truth import AgainstTruth
from sculler.runs.navigation.files import navigate_file
from sculler.runs.navigation.outcome import Outcome, told
from sculler.runs.navigation.plan import Carrier, Given, Plan
from sculler.runs.navigation.run import NavigationRun
from sculler.runs.navigation.seen import STATUSES, Seen

__all__ = [
    "STATUSES",
    "AgainstTruth",
    "Carrier",
    "Given",
    "NavigationRun",
    "Outcome",
    "Plan",
    "Seen",
    "navigate_file",
    "told",
]
