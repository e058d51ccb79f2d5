"""The vertical channel: what holds it, and a height that is measured."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, isfinite, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler_model.errors import InputError
from sculler_model.frames import GRAVITY_EQUATOR, SEMI_MAJOR_AXIS
from sculler_model.navigation.state import MAX_HEIGHT, MIN_HEIGHT

Array = NDArray[np.float64]

Held = tuple[float, float]
"""A height (m) to hold to, and its age (s) at the start of the interval; an age below 0: none."""

RESTING: Held = (0.0, -1.0)
"""No height to hold to: the loop rests."""

HOLD = 10.0
"""s, how long a measured height serves if nothing else is said."""


@dataclass(frozen=True)
class HeightDamping:
    """A third-order loop that holds the unstable vertical channel to a known height.

    With e the height less the reference: ḣ gets -k1 e, the acceleration upward -k2 e - k3 ∫e dt,
    where k1 = 3/τ, k2 = 3/τ² + 2g/R, k3 = 1/τ³ put all three poles at -1/τ.  A constant
    accelerometer error is absorbed by the integral and leaves no height error behind.

    A measured height of age a is held against the height that the navigator had then, which is the
    present one and a times the velocity down: neither lag nor a slow rate costs in a steady climb.

    Attributes:
        reference: height above the ellipsoid, m, held to as long as no other is measured; None to
            rest until then.
        seconds: τ; many major intervals long, usually a minute or more.
        hold: s, the age at which a measured height is held to no longer, and the loop rests.

    Raises:
        InputError: a time is not > 0, or a number is not finite.
    """

    reference: float | None = None
    seconds: float = 100.0
    hold: float = HOLD

    def __post_init__(self) -> None:
        if not (isfinite(self.seconds) and self.seconds > 0):
            raise InputError(
                f"height damping: time constant {self.seconds} s is not allowed, give a number > 0"
            )
        if not (isfinite(self.hold) and self.hold > 0):
            raise InputError(f"height damping: hold {self.hold} s is not allowed, give more than 0")
        if self.reference is not None and not MIN_HEIGHT <= self.reference <= MAX_HEIGHT:
            raise InputError(
                f"height damping: reference {self.reference:.6g} m is not allowed, give"
                f" {MIN_HEIGHT:.0f} m to {MAX_HEIGHT:.0f} m above the ellipsoid"
            )

    @property
    def gains(self) -> tuple[float, float, float]:
        """k1 (1/s), k2 (1/s²), k3 (1/s³)."""
        rate = 1 / self.seconds
        instability = 2 * GRAVITY_EQUATOR / SEMI_MAJOR_AXIS
        return 3 * rate, 3 * (rate * rate) + instability, rate * rate * rate

    def fits(self, interval: float) -> None:
        """See that the loop is slow against major intervals of so many seconds.

        Raises:
            InputError: it is not.
        """
        if self.seconds < 10 * interval:
            raise InputError(
                f"height damping: time constant {self.seconds:g} s is too short for"
                f" intervals of {interval:g} s, give at least {10 * interval:g} s"
            )

    def transient(self, acceleration: float) -> float:
        """How far (m) a constant error of the vertical acceleration (m/s²) moves the height.

        The height answers with ½ a t² exp(-t/τ), whose largest value is at t = 2τ.
        """
        return 2 * exp(-2) * abs(acceleration) * self.seconds**2

    def noise_left(self, sigma: float, every: float) -> float:
        """What white noise of the reference leaves in the height, m, one sigma.

        The height follows the reference by (3s²/τ + 3s/τ² + 1/τ³)/(s + 1/τ)³, whose noise
        bandwidth is 33/(16τ): sigma √(33 every/(16τ)).

        Args:
            sigma: of a measurement, m.
            every: seconds from one to the next, few against τ.
        """
        return sigma * sqrt(33 * every / (16 * self.seconds))


class HeightKeeper:
    """What an interval is held to: the damping's own height, or the one measured last, ageing.

    Args:
        damping: the loop; None for none.
        interval: a major interval, s.

    Attributes:
        held: for the next interval.
    """

    def __init__(self, damping: HeightDamping | None, interval: float) -> None:
        self._damping, self._interval = damping, interval
        self._measured = False
        fixed = 0.0 if damping is None else damping.reference
        self.held: Held = RESTING if fixed is None else (fixed, 0.0)

    def measured(self, height: float, age: float) -> None:
        """Hold to a measured height from the next interval on.

        Args:
            height: m above the ellipsoid.
            age: s, between the instant it stands for and the next interval's start; below 0 to
                rest.

        Raises:
            InputError: nobody asked for damping, or a number is not allowed.
        """
        if self._damping is None:
            raise InputError("height: nothing holds to it, give the navigator a height damping")
        if not (isfinite(age) and MIN_HEIGHT <= height <= MAX_HEIGHT):
            raise InputError(
                f"height: {height:.6g} m of {age:g} s ago is not allowed, give {MIN_HEIGHT:.0f} m"
                f" to {MAX_HEIGHT:.0f} m above the ellipsoid"
            )
        self._measured = True
        self.held = self._fresh(height, age)

    def passed(self) -> None:
        """An interval is over."""
        height, age = self.held
        if self._measured and age >= 0:
            self.held = self._fresh(height, age + self._interval)

    def ahead(self, count: int) -> Array:
        """What the next intervals are held to if nothing is measured; they are over then.

        Returns:
            (count, 2), or one row for all.
        """
        if not self._measured:
            return np.array([self.held])
        rows = np.empty((count, 2))
        for row in range(count):
            rows[row] = self.held
            self.passed()
        return rows

    def told(self, heights: Array | None, count: int) -> Array:
        """What the next intervals are held to, of increments that tell it or do not.

        Args:
            heights: (R, 2) height and age, or None.
            count: R.

        Raises:
            InputError: as `measured`, or they do not fit.
        """
        if heights is None:
            return self.ahead(count)
        if heights.shape != (count, 2):
            raise InputError(f"heights: shape {heights.shape}, give ({count}, 2)")
        if not count:
            return heights
        none = ~(np.isfinite(heights).all(1) & _allowed(heights[:, 0]))
        row = int(np.argmax(none)) if none.any() else count - 1
        self.measured(*heights[row].tolist())
        rows = heights.copy()
        assert self._damping is not None
        rows[(rows[:, 1] < 0) | (rows[:, 1] > self._damping.hold)] = RESTING
        self.passed()
        return rows

    def _fresh(self, height: float, age: float) -> Held:
        assert self._damping is not None
        return RESTING if age < 0 or age > self._damping.hold else (height, age)


class HeightReference:
    """A measured height, such as a barometer's: a column with its own rate, noise and lag.

    Args:
        times: (N,) s, stamps on the log's clock, rising: when each value is there to be used.
        heights: (N,) above the ellipsoid, m.
        lag: s, how long before its stamp a value was true.
        noise: m, one sigma of a value.

    Raises:
        InputError: the columns differ in length, times do not rise, or a number is not allowed.

    Examples:
        >>> import sculler
        >>> barometer = sculler.HeightReference([0.0, 0.1], [500.0, 500.2], lag=0.05, noise=0.3)
        >>> barometer.add(0.2, 500.4)
        >>> barometer.at([0.1, 0.15]).round(3).tolist()
        [[500.2, 0.05], [500.2, 0.1]]
    """

    KEPT = 4096
    """Values that a stream keeps behind the last one asked for."""

    def __init__(
        self,
        times: ArrayLike = (),
        heights: ArrayLike = (),
        *,
        lag: float = 0.0,
        noise: float = 0.0,
    ) -> None:
        for name, value in (("lag", lag), ("noise", noise)):
            if not (isfinite(value) and value >= 0):
                raise InputError(f"height reference: {name} {value} is not allowed, give 0 or more")
        self.lag, self.noise = float(lag), float(noise)
        stamps, values = (np.atleast_1d(np.asarray(a, np.float64)) for a in (times, heights))
        if stamps.shape != values.shape or stamps.ndim != 1:
            raise InputError(
                f"height reference: {stamps.shape} times do not fit {values.shape} heights"
            )
        _require_rising(stamps, values)
        self._times, self._heights = stamps, values
        self._more: list[tuple[float, float]] = []

    def add(self, time: float, height: float) -> None:
        """Take the next value of a stream.

        Raises:
            InputError: time runs back, or a number is not allowed.
        """
        last = self._more[-1][0] if self._more else (self._times[-1:].tolist() or [-np.inf])[0]
        _require_rising(np.array([last, time])[int(last == -np.inf) :], np.array([height]))
        self._more.append((float(time), float(height)))

    def at(self, instants: ArrayLike) -> Array:
        """What there is to hold to at some instants.

        Args:
            instants: (R,) s, rising.

        Returns:
            (R, 2) the last value stamped by then (m) and how long ago it was true (s); an age
            below 0 where there is none.
        """
        self._settle()
        asked = np.asarray(instants, np.float64)
        last = np.searchsorted(self._times, asked + 1e-9, side="right") - 1
        found = np.empty((len(asked), 2))
        found[:] = RESTING
        there = last >= 0
        found[there, 0] = self._heights[last[there]]
        age = asked[there] - self._times[last[there]]
        found[there, 1] = np.maximum(age, 0.0) + self.lag
        return found

    @property
    def times(self) -> Array:
        """(N,) the stamps, s."""
        self._settle()
        return self._times

    @property
    def every(self) -> float:
        """The median of the times between values, s; 0 where there are less than two."""
        return float(np.median(np.diff(self.times))) if len(self.times) > 1 else 0.0

    @property
    def hold(self) -> float:
        """s, the age to which a value serves: `HOLD`, longer where they come seldom or late."""
        return self.lag + max(HOLD, 3 * self.every)

    def _settle(self) -> None:
        if self._more:
            times, heights = zip(*self._more, strict=True)
            self._times = np.concatenate((self._times, times))
            self._heights = np.concatenate((self._heights, heights))
            if len(self._times) > 2 * self.KEPT:
                self._times, self._heights = self._times[-self.KEPT :], self._heights[-self.KEPT :]
            self._more = []


def _allowed(heights: Array) -> NDArray[np.bool_]:
    return (heights >= MIN_HEIGHT) & (heights <= MAX_HEIGHT)


def _require_rising(times: Array, heights: Array) -> None:
    wrong = ~_allowed(heights)
    if wrong.any():
        raise InputError(
            f"height reference: {heights[wrong][0]:.6g} m is not allowed, give {MIN_HEIGHT:.0f} m"
            f" to {MAX_HEIGHT:.0f} m above the ellipsoid"
        )
    if not np.isfinite(times).all():
        raise InputError("height reference: a time is not finite")
    back = np.flatnonzero(np.diff(times) <= 0)
    if len(back):
        before, after = times[back[0] : back[0] + 2].tolist()
        raise InputError(
            f"height reference: time {after:.15g} s does not come after {before:.15g} s, put the"
            " rows in order and leave out what came twice"
        )
