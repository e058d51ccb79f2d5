"""What an algorithm may leave: from a navigator's nautical miles an hour (Savage-20, requirements).

An unaided navigator's position error grows with the average rate ε at which its computed vertical
turns away, by R ε; one nautical mile is a minute of arc, so 1 nmi/h is 1/60 °/h.  The same rate
swings the vertical with Schuler's frequency ω_S = √(g/R), 84 minutes:

    γ(t) = ε/ω_S · sin ω_S t

(R the Earth's radius; for small ε of a level platform γ' = ε - δv/R, δv' = g γ).  The paper allows
the algorithm a hundredth of both.  What sensors and gravity take of them stands beside it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees, hypot, sqrt

from sculler_model.errors import InputError
from sculler_model.frames import EARTH_RATE, STANDARD_GRAVITY

EARTH_RADIUS = 6_371_000.0
"""Mean, m."""

NAUTICAL_MILE = 1852.0
"""m."""

SCHULER = sqrt(STANDARD_GRAVITY / EARTH_RADIUS)
"""ω_S, rad/s: a period of 84.4 minutes."""

ALGORITHM_SHARE = 0.01
"""Of drift and angle that the algorithm may take (Savage-20)."""

SCULLING_SHARE = 0.05
"""Of the accelerometers' bias that the algorithm may take (Savage-98 section VI)."""

_HOUR = 3600.0


@dataclass(frozen=True)
class Grade:
    """Errors of a navigator's sensors, and of the gravity that it computes with.

    Attributes:
        gyro_bias: °/h.
        scale_factor: of the gyros, ppm.
        accel_bias: µg.
        misalignment: from sensor to sensor, µrad.
        gravity: uncertainty of gravity, µg.

    Raises:
        InputError: one is negative.
    """

    gyro_bias: float
    scale_factor: float
    accel_bias: float
    misalignment: float
    gravity: float

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not 0 <= value < float("inf"):
                raise InputError(f"{name.replace('_', ' ')}: {value:g} is not allowed, give >= 0")

    @classmethod
    def of(cls, nmi_per_hour: float) -> Grade:
        """Savage-20's for 1 nmi/h, smaller in proportion.

        Alignment has a floor of 1 µrad, and gravity stays as uncertain as it is.
        """
        r = nmi_per_hour
        return cls(0.01 * r, 5 * r, 40 * r, max(10 * r, 1.0), 20.0)


@dataclass(frozen=True)
class Part:
    """What one source takes.

    Attributes:
        source: its name.
        value, unit: its size.
        drift: average rate of the computed vertical, °/h.
        angle: of attitude, °.
    """

    source: str
    value: float
    unit: str
    drift: float
    angle: float

    @property
    def nmi_per_hour(self) -> float:
        """What `drift` makes of position."""
        return self.drift / drift_of(1.0)


@dataclass(frozen=True)
class Budget:
    """What a navigator may have in all, what its sources take, and what the algorithm may.

    Attributes:
        nmi_per_hour: the requirement.
        parts: of sensors and gravity.
        share: of the whole that the algorithm may take.

    Examples:
        >>> found = budget(0.1)
        >>> f"{found.algorithm_drift:.1e} °/h, {found.algorithm_angle:.0e}°"
        '1.7e-05 °/h, 4e-06°'
    """

    nmi_per_hour: float
    parts: tuple[Part, ...]
    share: float = ALGORITHM_SHARE

    @property
    def drift(self) -> float:
        """The average rate that makes the position error, °/h."""
        return drift_of(self.nmi_per_hour)

    @property
    def angle(self) -> float:
        """Schuler's swing of that rate, °."""
        return schuler_angle(self.drift)

    @property
    def algorithm_drift(self) -> float:
        """What coning may leave, °/h."""
        return self.share * self.drift

    @property
    def algorithm_angle(self) -> float:
        """What manoeuvres may leave, °."""
        return self.share * self.angle

    @property
    def algorithm_force(self) -> float:
        """What sculling may leave, µg (Savage-98 section VI)."""
        return SCULLING_SHARE * next(p.value for p in self.parts if p.source == "accelerometer")

    @property
    def taken(self) -> tuple[float, float]:
        """Drift (°/h) and angle (°) of all parts together, roots of sums of squares."""
        return hypot(*(p.drift for p in self.parts)), hypot(*(p.angle for p in self.parts))

    @property
    def too_much(self) -> tuple[str, ...]:
        """Sources that alone take more than the whole angle or drift."""
        return tuple(p.source for p in self.parts if p.angle > self.angle or p.drift > self.drift)


def drift_of(nmi_per_hour: float) -> float:
    """The average rate (°/h) of the vertical that makes a position error."""
    return degrees(nmi_per_hour * NAUTICAL_MILE / EARTH_RADIUS)


def schuler_angle(drift: float) -> float:
    """Amplitude (°) of the Schuler oscillation that a constant rate (°/h) excites: ε/ω_S."""
    return drift / (SCHULER * _HOUR)


def budget(
    nmi_per_hour: float, grade: Grade | None = None, share: float = ALGORITHM_SHARE
) -> Budget:
    """The requirement of a navigator taken apart.

    A turn of half a circle is what scale factor and misalignment are counted over: κ·180°, and two
    times the misalignment μ (a vector that turns by Θ adds up to 2 sin(Θ/2)).  In steady flight
    they see the Earth's rate.

    Args:
        nmi_per_hour: growth of its position error.
        grade: errors of its sensors; None: `Grade.of`.
        share: of the whole, for the algorithm.

    Raises:
        InputError: a number is out of its range.
    """
    if not 0 < nmi_per_hour < float("inf"):
        raise InputError(f"nmi/h: {nmi_per_hour:g} is not allowed, give more than 0")
    if not 0 < share <= 1:
        raise InputError(f"the algorithm's share: {share:g} is not allowed, give > 0 and <= 1")
    g = grade or Grade.of(nmi_per_hour)
    earth = degrees(EARTH_RATE) * _HOUR
    micro = 1e-6
    parts = (
        Part("gyro bias", g.gyro_bias, "°/h", g.gyro_bias, schuler_angle(g.gyro_bias)),
        Part(
            "gyro scale factor",
            g.scale_factor,
            "ppm",
            g.scale_factor * micro * earth,
            g.scale_factor * micro * 180,
        ),
        Part("accelerometer", g.accel_bias, "µg", 0.0, degrees(g.accel_bias * micro)),
        Part(
            "misalignment",
            g.misalignment,
            "µrad",
            g.misalignment * micro * earth,
            degrees(2 * g.misalignment * micro),
        ),
        Part("gravity", g.gravity, "µg", 0.0, degrees(g.gravity * micro)),
    )
    return Budget(nmi_per_hour, parts, share)
