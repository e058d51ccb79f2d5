"""Spectra of random vibration: power spectral densities, and profiles by name."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from itertools import pairwise
from math import log, sqrt
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler_model.errors import InputError
from sculler_model.inputs import read_small

Array = NDArray[np.float64]

HIGHEST = 1e5
"""Highest frequency of a spectrum, Hz: the sums have a term each `STEP`."""

DENSEST = 1e6
"""Largest density of a spectrum, g²/Hz, far above any vibration."""

SPECTRUM_COLUMNS = ("freq_hz", "psd_g2_per_hz")
"""Header of a spectrum file."""


@dataclass(frozen=True)
class Spectrum:
    """One-sided power spectral density, straight lines between points on log-log paper.

    Outside the points it is zero; a frequency given twice is a step.

    Attributes:
        frequencies: Hz, > 0, not falling.
        densities: g²/Hz, > 0.
        name: what it is.

    Raises:
        InputError: fewer than two points, or one that is not of this form.
    """

    frequencies: tuple[float, ...]
    densities: tuple[float, ...]
    name: str = "spectrum"

    def __post_init__(self) -> None:
        if len(self.frequencies) < 2 or len(self.frequencies) != len(self.densities):
            raise InputError(f"{self.name}: a vibration spectrum needs two points or more")
        for number, (frequency, density) in enumerate(
            zip(self.frequencies, self.densities, strict=True), start=1
        ):
            if not (0 < frequency <= HIGHEST and 0 < density <= DENSEST):
                raise InputError(
                    f"{self.name}: point {number}: {frequency:g} Hz, {density:g} g²/Hz is not"
                    f" allowed, give frequencies > 0 and <= {HIGHEST:,.0f} Hz and densities > 0 and"
                    f" <= {DENSEST:g} g²/Hz (outside its points a spectrum is zero)"
                )
        for before, after in pairwise(self.frequencies):
            if after < before:
                raise InputError(
                    f"{self.name}: {after:g} Hz follows {before:g} Hz, sort the points by frequency"
                )
        if self.frequencies[0] == self.frequencies[-1]:
            raise InputError(f"{self.name}: all points are at one frequency, give a band")

    @classmethod
    def flat(cls, low: float, high: float, density: float) -> Spectrum:
        """A flat band from low to high (Hz) of a density (g²/Hz)."""
        name = f"flat {density:g} g²/Hz, {low:g} to {high:g} Hz"
        return cls((low, high), (density, density), name)

    @classmethod
    def load(cls, path: str | Path) -> Spectrum:
        """Read a CSV with the header `freq_hz,psd_g2_per_hz`.

        Raises:
            InputError: it cannot be read or is not of this form; says the line.
        """
        header_line = ",".join(SPECTRUM_COLUMNS)
        text = read_small(path, "spectrum", f"a CSV {header_line}")
        try:
            lines = list(csv.reader(io.StringIO(text, newline="")))
        except csv.Error as error:
            raise InputError(
                f"{path}: not a CSV ({error}), give {','.join(SPECTRUM_COLUMNS)}"
            ) from error
        header = tuple(word.strip() for word in lines[0]) if lines else ()
        if header != SPECTRUM_COLUMNS:
            raise InputError(f"{path}: line 1: the header must be {header_line}")
        points = []
        for number, words in enumerate(lines[1:], start=2):
            if not any(word.strip() for word in words):
                continue
            try:
                frequency, density = map(float, words)
            except ValueError:
                raise InputError(
                    f"{path}: line {number}: {','.join(words)!r} is not two numbers, give a"
                    " frequency in Hz and a density in g²/Hz"
                ) from None
            points.append((frequency, density))
        frequencies, densities = zip(*points, strict=True) if points else ((), ())
        return cls(frequencies, densities, str(path))

    @property
    def highest(self) -> float:
        """The highest frequency, Hz."""
        return self.frequencies[-1]

    @property
    def rms(self) -> float:
        """Root mean square of all of it, g."""
        return sqrt(float(self.power(np.array([self.frequencies[0], self.highest]))[0]))

    def density(self, frequency: ArrayLike) -> Array:
        """g²/Hz at frequencies (Hz)."""
        frequency = np.asarray(frequency, np.float64)
        inside = (frequency >= self.frequencies[0]) & (frequency <= self.highest)
        value = np.exp(
            np.interp(
                np.log(np.where(inside, frequency, self.highest)),
                np.log(self.frequencies),
                np.log(self.densities),
            )
        )
        result: Array = np.where(inside, value, 0.0)
        return result

    def power(self, edges: Array) -> Array:
        """Mean square (g²) in each band between consecutive edges (Hz): the exact integral."""
        power: Array = np.diff(self._power_below(edges))
        return power

    def _power_below(self, frequency: Array) -> Array:
        """∫ of the density up to frequency, line by line: density = S (f/f0)^m."""
        total = np.zeros_like(frequency)
        for (f0, s0), (f1, s1) in pairwise(zip(self.frequencies, self.densities, strict=True)):
            if f1 == f0:
                continue
            slope = log(s1 / s0) / log(f1 / f0)
            x = np.log(np.clip(frequency, f0, f1) / f0)
            # ∫ = s0 f0 (e^((m+1)x) - 1)/(m+1), which is x where m = -1
            m1 = slope + 1
            total += s0 * f0 * (np.expm1(m1 * x) / m1 if abs(m1) > 1e-9 else x)
        return total


PROFILES: dict[str, Spectrum] = {
    # Savage-98 section VI, Savage-20: 0.04 g²/Hz to 1 kHz, falling to 0.01 g²/Hz at 2 kHz
    "savage-98": Spectrum((20.0, 1000.0, 2000.0), (0.04, 0.04, 0.01), "savage-98"),
    # the shape and level (4.1 g rms) of jet-fuselage curves of DO-160 section 8; not its letter
    "do160-like": Spectrum(
        (10.0, 28.0, 40.0, 500.0, 2000.0), (0.012, 0.012, 0.02, 0.02, 0.00125), "do160-like"
    ),
    # road and rail, unpaved: much of it below the isolators' resonance
    "vehicle-like": Spectrum(
        (5.0, 10.0, 40.0, 500.0), (0.015, 0.015, 0.002, 0.0001), "vehicle-like"
    ),
}
