"""What many runs say: quantiles with their confidence intervals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler.units import ARCSEC, MILES_PER_HOUR
from sculler_model.errors import InputError

Array = NDArray[np.float64]
Told = tuple[float, float, float]
"""A quantile, and the ends of its confidence interval of 95 %."""

SHARES = (0.5, 0.95)
"""Of the runs that are no worse; 0.5 of the horizontal error is the CEP."""


def require_scipy() -> None:
    """Ask for SciPy before any work is done.

    Raises:
        InputError: it is absent; says how to get it.
    """
    try:
        from scipy.stats import quantile_test  # noqa: F401
    except ImportError as error:
        raise InputError(
            "a campaign needs SciPy 1.12 or newer, run: pip install 'sculler[campaign]'"
        ) from error


@dataclass(frozen=True)
class Statistics:
    """Errors of one design's runs.

    Attributes:
        runs: how many.
        time: (C,) s, the checkpoints.
        track: (C, 2) the horizontal error that `SHARES` of the runs do not exceed, m.
        horizontal, vertical, growth, heading, tilt: at the end, by share: horizontal and vertical
            error (m), horizontal error over the time (nmi/h), heading and tilt (arcsec).
    """

    runs: int
    time: Array
    track: Array
    horizontal: Mapping[float, Told]
    vertical: Mapping[float, Told]
    growth: Mapping[float, Told]
    heading: Mapping[float, Told]
    tilt: Mapping[float, Told]

    @classmethod
    def of(cls, rows: Mapping[str, NDArray[Any]]) -> Statistics:
        """From the rows of one design, in order of seed and time."""
        runs = len(np.unique(rows["seed"]))
        time = rows["time_s"].reshape(runs, -1)[0]

        def of_runs(name: str) -> Array:
            values: Array = np.abs(rows[name].reshape(runs, -1))
            return values

        horizontal = np.hypot(of_runs("position_north_m"), of_runs("position_east_m"))
        tilt = np.hypot(of_runs("tilt_north_rad"), of_runs("tilt_east_rad"))
        end = horizontal[:, -1]
        return cls(
            runs,
            time,
            np.quantile(horizontal, SHARES, axis=0).T,
            _quantiles(end),
            _quantiles(of_runs("position_down_m")[:, -1]),
            _quantiles(end / time[-1] * MILES_PER_HOUR),
            _quantiles(of_runs("tilt_down_rad")[:, -1] * ARCSEC),
            _quantiles(tilt[:, -1] * ARCSEC),
        )

    def as_json(self) -> dict[str, Any]:
        """Plain data: each quantile with the ends of its interval."""
        told = {
            "horizontal_m": self.horizontal,
            "vertical_m": self.vertical,
            "growth_nmi_per_h": self.growth,
            "heading_arcsec": self.heading,
            "tilt_arcsec": self.tilt,
        }
        return {"runs": self.runs} | {
            name: {
                f"{100 * share:g} %": {"value": value, "from": low, "to": high}
                for share, (value, low, high) in shares.items()
            }
            for name, shares in told.items()
        }


def _quantiles(values: Array) -> dict[float, Told]:
    """By share: the sample's quantile and its interval from order statistics (binomial).

    An end that too few runs tell is that of the runs: the smallest or the largest value.
    """
    from scipy.stats import quantile_test

    found = {}
    for share in SHARES:
        interval = quantile_test(values, q=0.0, p=share).confidence_interval(0.95)
        low, high = float(interval.low), float(interval.high)
        low = low if np.isfinite(low) else float(values.min())
        high = high if np.isfinite(high) else float(values.max())
        found[share] = (float(np.quantile(values, share)), low, high)
    return found
