"""Units and names in which a run's errors are shown."""

from __future__ import annotations

from math import degrees

from sculler_model.navigation import NAUTICAL_MILE

ARCSEC = degrees(1) * 3600
"""Arcseconds in a radian."""

MILES_PER_HOUR = 3600 / NAUTICAL_MILE
"""Nautical miles per hour in a metre per second."""

UNITS = {
    "attitude": ("arcsec", ARCSEC, "attitude_arcsec"),
    "velocity": ("m/s", 1.0, "velocity_m_s"),
    "position": ("m", 1.0, "position_m"),
}
"""By quantity: unit, how many of them an SI unit is, and the key in JSON."""

NAMES = {
    "attitude": ("tilt about north", "tilt about east", "heading", "in all"),
    "velocity": ("north", "east", "down", "in all"),
    "position": ("north", "east", "down", "horizontal"),
}
"""By quantity: its components north, east, down, and their sum."""
