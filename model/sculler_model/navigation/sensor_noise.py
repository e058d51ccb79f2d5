"""What the sensors' noise is: as given, or as a window at rest shows it.

At rest, resolved by attitudes that the gyros carry on, the direction of gravity seems to wander.
That wander, two series of tilts about north and east, is a sum of three kinds of noise:

    walk    the gyros' random walk N: in the tilt a random walk, N²τ more variance each τ
    white   the accelerometers' random walk K: of a mean over τ the variance (K/g)²/τ
    blue    noise of the velocity at an instant (counts, vibration) σ_v: (σ_v/(gτ))², differenced

Sway that the gyros follow is in none of them.  The gyros' angle by itself shows N more sharply, its
counts apart, but takes sway for noise.  So N is the mean over what it may be in the light of the
tilts: most likely what the gyros show, or less (the unit sways), hardly more (the accelerometers'
bias walks); where the tilts contradict the gyros they go before.  The gyros are taken to be alike.

The variances are those of most likelihood, from the series' cosine transform, in which a random
walk and white noise fall apart into independent modes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from math import isfinite, radians, sqrt

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError

Array = NDArray[np.float64]

_ROUNDS = 300
_FEWER = 40
_NOTHING = 1e-40  # rad², of a series without any noise
_POINTS = 16
_AS_SHOWN, _LESS, _MORE = 4.0, 1.0, 0.1  # the odds that N is the gyros', up to it, up to any
_SMALLEST_VELOCITY_NOISE = 1e-12  # m/s


@dataclass(frozen=True)
class SensorNoise:
    """What is known of the sensors' errors, one standard deviation, each axis.

    What is left out of the noise is estimated from the window at rest.  A constant bias cannot be:
    an accelerometer's is taken for tilt, the east gyro's for heading.  What is given here for the
    biases is in the stated sigmas; what is left out is not.

    Attributes:
        angle_random_walk: N, rad/√s.
        velocity_random_walk: K, m/s/√s.
        gyro_bias: constant over the window, rad/s.
        velocity_noise: of the velocity at one instant, m/s: quantisation, and sway of the unit.
        accel_bias: constant over the window, m/s².

    Raises:
        InputError: a number is negative or not finite, or `velocity_noise` is 0.

    Examples:
        >>> import math, sculler
        >>> noise = sculler.SensorNoise(gyro_bias=math.radians(0.01) / 3600)
        >>> noise.angle_random_walk is None
        True
    """

    angle_random_walk: float | None = None
    velocity_random_walk: float | None = None
    gyro_bias: float | None = None
    velocity_noise: float | None = None
    accel_bias: float | None = None

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if value is None:
                continue
            if not (isfinite(value) and value >= 0) or (name == "velocity_noise" and value == 0):
                raise InputError(
                    f"sensor noise: {name} {value} is not allowed, give a positive number"
                )

    def completed(self, shown: SensorNoise) -> SensorNoise:
        """With what `shown` says in the place of what is left out."""
        given = {name: value for name, value in vars(self).items() if value is not None}
        return replace(shown, **given)


NAVIGATION_GRADE = SensorNoise(radians(0.002) / 60, 5e-5, radians(0.01) / 3600, 1e-3)
"""0.002 °/√h, 5 µg/√Hz, 0.01 °/h, 1 mm/s."""


def estimated_noise(tilts: Array, angles: Array, step: float, gravity: float) -> SensorNoise:
    """The noise that a unit at rest shows; nothing of biases.

    Straight lines in the series (attitude, biases, Earth's rotation) are of no account.

    Args:
        tilts: (S, 2) means over S consecutive steps, rad, about two level axes.
        angles: (S, 3) that the gyros have gone through at the ends of the steps, rad.
        step: s.
        gravity: m/s².
    """
    modes, spectra = _modes(len(tilts))
    power, gyros = (np.square(modes @ series).mean(axis=1) + _NOTHING for series in (tilts, angles))
    shown = sqrt(_most_likely(gyros, spectra[:, :2])[0])  # counts are white in an angle
    known = _mean_walk(power, spectra, tilts.shape[1], shown)
    walk, white, blue = _most_likely(power, spectra, np.array([known]))[0].tolist()
    return SensorNoise(
        angle_random_walk=sqrt(walk / step),
        velocity_random_walk=gravity * sqrt(white * step),
        velocity_noise=max(gravity * step * sqrt(blue), _SMALLEST_VELOCITY_NOISE),
    )


def _mean_walk(power: Array, spectra: Array, axes: int, shown: float) -> float:
    """The walk's variance (a step's, rad²), its mean over what it may be.

    Args:
        power: (P,) of the tilts' modes, a mean over so many `axes`.
        spectra: (P, 3) for variances of 1.
        axes: how many.
        shown: the walk that the gyros show, rad.
    """
    free = _most_likely(power, spectra)

    def chances(walks: Array) -> Array:
        expected = _most_likely(power, spectra, walks * walks, free) @ spectra.T
        fit = -0.5 * axes * np.sum(np.log(expected) + power / expected, axis=1)
        chance: Array = np.exp(np.minimum(fit - best, 0.0))
        return chance

    expected = spectra @ free
    best = -0.5 * axes * float(np.sum(np.log(expected) + power / expected))
    # three times what would explain all of the tilts at the lowest modes: more than they allow
    largest = 3 * sqrt(float((power[:4] / spectra[:4, 0]).max()))
    weights, squares = [_AS_SHOWN * chances(np.array([shown]))], [np.array([shown**2])]
    for limit, weight in ((shown, _LESS), (largest, _MORE)):
        walks = np.union1d(limit * np.linspace(0, 1, _POINTS) ** 2, min(limit, sqrt(free[0])))
        if len(walks) > 1:
            spread = np.gradient(walks)  # every walk up to the limit as likely as another
            weights.append(weight * chances(walks) * spread / spread.sum())
            squares.append(walks**2)
    chance = np.concatenate(weights)
    total = float(chance.sum())
    return float(chance @ np.concatenate(squares)) / total if total > 0 else float(free[0])


def _most_likely(
    power: Array, spectra: Array, first: Array | None = None, start: Array | None = None
) -> Array:
    """Variances of most likelihood for the modes' powers, each with its spectrum.

    The powers' mean values are the variances times the spectra.  The rule that lifts the
    likelihood with every round, and keeps the variances positive, is that of non-negative
    factorisation for the Itakura-Saito divergence.

    Args:
        power: (P,) of the modes.
        spectra: (P, V) for variances of 1.
        first: (W,) the first variance, where it is known: as many cases.
        start: (V,) variances to begin from, for fewer rounds.

    Returns:
        (V,), or (W, V) with `first`.
    """
    cases = 1 if first is None else len(first)
    even: Array = power.mean() / spectra.mean(axis=0)
    variances: Array = np.tile(
        even if start is None else np.maximum(start, 1e-3 * even), (cases, 1)
    )
    for _ in range(_ROUNDS if start is None else _FEWER):
        if first is not None:
            variances[:, 0] = first
        expected = np.maximum(variances @ spectra.T, 1e-300)
        variances *= np.sqrt((power / expected**2) @ spectra / ((1 / expected) @ spectra))
    if first is not None:
        variances[:, 0] = first
    result: Array = variances[0] if first is None else variances
    return result


@lru_cache(maxsize=8)
def _modes(count: int) -> tuple[Array, Array]:
    """Cosine modes of a series less its best line, and their power for each unit of variance."""
    place = np.arange(count)
    lines = np.linalg.qr(np.stack((np.ones(count), place - place.mean()), axis=1))[0]
    order = np.arange(2, count)[:, None]  # mode 0 is the mean, 1 nearly all of the line
    modes = sqrt(2 / count) * np.cos(np.pi / count * order * (place + 0.5))
    modes -= (modes @ lines) @ lines.T
    walk = np.minimum(place[:, None], place) - np.eye(count) / 6  # of means over the steps
    blue = 2 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1)
    spectra = [np.einsum("ij,jk,ik->i", modes, C, modes, optimize=True) for C in (walk, blue)]
    white = np.square(modes).sum(axis=1)
    return modes, np.stack((spectra[0], white, spectra[1]), axis=1)
