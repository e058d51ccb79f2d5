"""Campaigns: many runs of a motion through imperfect sensors, exact cores and the navigator.

`Campaign` is the file; `run_campaign` flies it and writes results, statistics and pictures, and
runs some of it through the hardware.
"""

from sculler.runs.campaign.hardware import told as hardware_told
from sculler.runs.campaign.plan import Campaign
from sculler.runs.campaign.run import Outcome, run_campaign

__all__ = ["Campaign", "Outcome", "hardware_told", "run_campaign"]
