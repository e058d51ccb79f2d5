"""Position over a major interval: trapezoid or high resolution (Savage-98 section VI, Eq. 106-109).

The paper's procedure: hold the error of the trapezoid (Eq. 75) against the limit, under a manoeuvre
and under a vibration.  If it is too large take high resolution (Eq. 84), and of its terms those
that are larger than the limit.  `selection` does this with closed forms; `left` runs a motion
through trapezoid, high resolution with exact integrals, and the core's integers (Eq. 103-105).

Rate and specific force are square to each other, which is the worst case; the plane that the force
turns in is then one of complex numbers, and ``C(t) a`` is ``a exp(iα)``: the truth needs no more
than an integral.
"""

from __future__ import annotations

from cmath import exp
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

from sculler_model.analysis.integer_path import changed, through_core, with_fine_sensor
from sculler_model.analysis.sensed import require_known
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.host import half_minus_cosine, major_increments, one_minus_sine
from sculler_model.motion import Curve, legendre_nodes

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


SMOOTH = 4.0
"""Phase (rad) by which a rule for waves is finer, for what they are multiplied with."""


def true_ramps(A: Array, B: Array, C: Array, D: Array, interval: float) -> Array:
    """ΔR_SF of the rate A + Bt and the specific force C + Dt, to first order (Eq. 108).

    Args:
        A, B, C, D: (3,), rad/s, rad/s², m/s², m/s³.
        interval: T_m, s.

    Returns:
        (3,) m.
    """
    T = interval
    moved: Array = (
        C * (T**2 / 2)
        + (D + np.cross(A, C)) * (T**3 / 6)
        + (np.cross(A, D) + np.cross(B, C) / 2) * (T**4 / 12)
        + np.cross(B, D) * (T**5 / 40)
    )
    return moved


def trapezoid_ramps(A: Array, B: Array, C: Array, D: Array, interval: float) -> Array:
    """What the trapezoid makes of the same, ½ Δv_SF T_m (Eq. 107, 108); see `true_ramps`."""
    T = interval
    moved: Array = (
        C * (T**2 / 2)
        + (D + np.cross(A, C)) * (T**3 / 4)
        + (np.cross(A, D) + np.cross(B, C) / 2) * (T**4 / 6)
        + np.cross(B, D) * (T**5 / 16)
    )
    return moved


def first_order(
    alpha: Callable[[Array], Array],
    force: Callable[[Array], Array],
    interval: float,
    fastest: float = 0.0,
) -> tuple[Array, Array]:
    """Δv_SF and ΔR_SF over an interval to first order in the angle (Eq. 25, 106).

    Args:
        alpha, force: α (rad, zero at time 0) and the specific force (m/s²) at times (N,), (N, 3).
        interval: T_m, s.
        fastest: the highest frequency in their product, rad/s.

    Returns:
        (3,) m/s and (3,) m.
    """
    nodes, weights = legendre_nodes(fastest * interval + SMOOTH)
    t, w = nodes * interval, (weights * interval)[:, None]
    seen = force(t) + np.cross(alpha(t), force(t))
    return np.sum(w * seen, axis=0), np.sum(w * (interval - t)[:, None] * seen, axis=0)


@dataclass(frozen=True)
class Conditions:
    """What the position must bear, and how wrong it may be.

    Attributes:
        force, force_ramp: largest specific force and its rate of change, m/s² and m/s³.
        rate, rate_ramp: of turning, rad/s and rad/s², square to the force.
        vibration, hertz: root mean square of a sinusoid of specific force, m/s², and its frequency.
        rocking: amplitude of a rotation in phase with it, rad.
        limit, seconds: m over so long.

    Raises:
        InputError: a number is negative, or a vibration has no frequency.
    """

    force: float = 0.0
    force_ramp: float = 0.0
    rate: float = 0.0
    rate_ramp: float = 0.0
    vibration: float = 0.0
    hertz: float = 0.0
    rocking: float = 0.0
    limit: float = 1e-4
    seconds: float = 10.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not 0 <= value < float("inf"):
                raise InputError(f"{name.replace('_', ' ')}: {value:g} is not allowed, give >= 0")
        if (self.vibration or self.rocking) and not self.hertz:
            raise InputError("the vibration: it has no frequency, give one in Hz")
        if not (self.limit and self.seconds):
            raise InputError("the limit: give m and seconds above 0")


def seen(design: Design, conditions: Conditions) -> tuple[Conditions, float]:
    """Conditions as a design's samples show them.

    The sensor's filter takes a part of the vibration and of the rocking.  It delays slow motion,
    which changes nothing but the stamps.

    Args:
        design: its sensor may have a filter.
        conditions: as the sensor feels them.

    Returns:
        The conditions of the samples, and the amplitude (m) of the vibration's displacement that
        is not in them: it is there whatever forms the position, and does not grow.

    Raises:
        InputError: the filter's measured response ends below the vibration's frequency.
    """
    response, omega = design.sensor_response, 2 * pi * conditions.hertz
    if response is None or not omega:
        return conditions, 0.0
    require_known(design, conditions.hertz, "the vibration")
    phase = omega * design.sample_interval
    gain = response.value(phase)
    shown = replace(
        conditions,
        vibration=abs(gain) * conditions.vibration,
        rocking=abs(gain) * conditions.rocking,
    )
    amplitude = sqrt(2) * conditions.vibration / omega**2
    return shown, amplitude * abs(1 - gain * exp(1j * phase * response.delay))


@dataclass(frozen=True)
class Term:
    """Something that grows from interval to interval.

    Attributes:
        name: what it is.
        each: m an interval.
        interval: T_m, s.
        limit, seconds: of the conditions.
    """

    name: str
    each: float
    interval: float
    limit: float
    seconds: float

    @property
    def a_second(self) -> float:
        """m in a second, if it always points the same way."""
        return self.each / self.interval

    @property
    def systematic(self) -> float:
        """m over the limit's time, if it always points the same way."""
        return self.a_second * self.seconds

    @property
    def random(self) -> float:
        """m over the limit's time, if its sign is random: with the root of the intervals."""
        return self.each * sqrt(self.seconds / self.interval)

    @property
    def over(self) -> bool:
        """Whether it is larger than the limit, pointing always the same way."""
        return self.systematic > self.limit


@dataclass(frozen=True)
class Selection:
    """The paper's procedure, worked through.

    Attributes:
        trapezoid: errors of the trapezoid.
        terms: of high resolution, what would be missed without each.
        velocity_rms: of the vibration, m/s.
    """

    trapezoid: tuple[Term, ...]
    terms: tuple[Term, ...]
    velocity_rms: float

    @property
    def high_resolution(self) -> bool:
        """Whether the trapezoid is not enough."""
        return any(term.over for term in self.trapezoid)


def selection(conditions: Conditions, interval: float) -> Selection:
    """Trapezoid or high resolution, and which of its terms (Savage-98 section VI).

    Args:
        conditions: manoeuvre, vibration, limit.
        interval: T_m, s.
    """
    c, T = conditions, interval
    axes = np.eye(3)
    nothing = np.zeros(3)

    def error(A: float, B: float, C: float, D: float) -> float:
        """Of the trapezoid: rate along x, force along y."""
        ramps = (A * axes[0], B * axes[0], C * axes[1], D * axes[1], T)
        return float(np.linalg.norm(trapezoid_ramps(*ramps) - true_ramps(*ramps)))

    def term(name: str, each: float) -> Term:
        return Term(name, float(each), T, c.limit, c.seconds)

    speed = c.vibration / (2 * pi * c.hertz) if c.vibration else 0.0
    trapezoid = (
        term("trapezoid, ramp of the force", error(0, 0, 0, c.force_ramp)),
        term("trapezoid, force in a turn", error(c.rate, 0, c.force, 0)),
        term(
            "trapezoid, both with the ramp of the turn",
            error(c.rate, c.rate_ramp, c.force, c.force_ramp),
        ),
        term("trapezoid, vibration aliased", speed * T),
    )
    turned = float(np.linalg.norm(true_ramps(nothing, nothing, nothing, c.force_ramp * axes[1], T)))
    s, rotation, scrolling = _shaken(c, T)
    phase = np.exp(-1j * np.angle(s))
    terms = (
        term("S_υ, force", c.force * T**2 / 2),
        term("S_υ, ramp of the force", turned),
        term("ΔR_rot, force in a turn", c.rate * c.force * T**3 / 6),
        term("S_υ, vibration", abs(s)),
        term("ΔR_rot, vibration in a turn", abs((phase * rotation).real)),
        term("ΔR_scrl, vibration in a turn (Eq. 109)", abs((phase * scrolling).real)),
        term("ΔR_scrl, the same in its worst phase", abs(scrolling)),
    )
    return Selection(trapezoid, terms, speed)


def _shaken(c: Conditions, T: float) -> tuple[complex, complex, complex]:
    """Phasors of S_υ, ΔR_rot (Eq. 86) and ΔR_scrl (Eq. 109) of a vibration in a steady turn, m.

    The force is Re(-i A exp(iΩt + iφ)), A its amplitude; each is Re(phasor · exp(iφ)).
    """
    if not c.vibration:
        return 0j, 0j, 0j
    omega, A = 2 * pi * c.hertz, sqrt(2) * c.vibration
    nodes, weights = legendre_nodes(omega * T + SMOOTH)
    t = nodes * T
    wave = weights * T * (-1j * A) * np.exp(1j * omega * t)
    velocity, s = complex(wave.sum()), complex(wave @ (T - t))
    rotation = c.rate / 6 * (T**2 / 2 * velocity + T * s)
    return s, rotation, c.rate * complex(wave @ ((T - t) * t)) - rotation


@dataclass(frozen=True)
class Error:
    """Of a position that is put together from intervals, with true attitude and velocity.

    Attributes:
        each: largest of an interval, m.
        largest: on the way, m.
        final: at the end, m.
    """

    each: float
    largest: float
    final: float


@dataclass(frozen=True)
class Left:
    """What is left of a motion's position.

    Attributes:
        interval: T_m, s.
        trapezoid: by Eq. 75.
        exact_integrals: by Eq. 84 and 99 with the integrals of Eq. 85 exact: its own second order.
        core: by the core's integers, Eq. 103-105, whatever the family; None for a sensor of rates.
    """

    interval: float
    trapezoid: Error
    exact_integrals: Error
    core: Error | None


def left(design: Design, conditions: Conditions) -> Left:
    """What trapezoid and high resolution leave of the conditions' motion.

    Force and rate swing about their largest values so that their largest ramps are those asked
    for; the vibration is on top.  The sensor is so fine that its LSB does not show, and its filter
    is left out: `seen` has what is behind it.

    Args:
        design: sample rate, n and M; its family does not matter.
        conditions: the motion; over `seconds`.
    """
    T, angle, velocity = design.major_interval, *_motion(conditions)
    count = max(round(conditions.seconds / T), 1)
    start = T * np.arange(count, dtype=np.float64)
    fastest = 4 * pi * conditions.hertz + 2 * angle.steepest
    nodes, weights = legendre_nodes(fastest * T + SMOOTH)
    t = start[:, None] + nodes * T
    alpha = angle(t) - angle(start)[:, None]
    upsilon = velocity(t) - velocity(start)[:, None]
    wave = weights * T * velocity(t, 1)
    ahead = T - nodes * T

    turned = wave * np.exp(1j * alpha)
    true = turned @ ahead
    ends = start + T
    alpha_m, upsilon_m = angle(ends) - angle(start), velocity(ends) - velocity(start)
    s_alpha, s_upsilon = alpha @ weights * T, upsilon @ weights * T
    products = 1j * (s_alpha * upsilon_m + alpha_m * s_upsilon)
    size = np.abs(alpha_m)
    beyond = (one_minus_sine(size) - 1 / 6) + 1j * alpha_m * half_minus_cosine(size)
    whole = (wave * (1 + 1j * alpha)) @ ahead + beyond * products
    turn = np.exp(1j * angle(start))
    core = None
    if design.sensor.kind == "increment":
        core = _error(_through_core(design, angle, velocity, count) - true, turn)
    return Left(
        T, _error(T / 2 * turned.sum(axis=1) - true, turn), _error(whole - true, turn), core
    )


def _motion(c: Conditions) -> tuple[Curve, Curve]:
    """α (rad) and υ (m/s) over time."""

    def swing(level: float, ramp: float, order: float = 1.0) -> tuple[float, float]:
        """Amplitude and frequency of a level's swing with this largest slope."""
        omega = ramp / level if level else order
        return (ramp / omega if ramp else 0.0), omega

    rate, rate_omega = swing(c.rate, c.rate_ramp)
    force, force_omega = swing(c.force, c.force_ramp)
    omega = 2 * pi * c.hertz
    # the integrals of level + amplitude sin(Ωt)
    angle = Curve((0.0, c.rate), ((rate / rate_omega, rate_omega, -pi / 2),) if rate else ())
    velocity = Curve(
        (0.0, c.force), ((force / force_omega, force_omega, -pi / 2),) if force else ()
    )
    if c.rocking:
        angle = angle + Curve(waves=((c.rocking, omega, 0.0),))
    if c.vibration:
        velocity = velocity + Curve(waves=((sqrt(2) * c.vibration / omega, omega, -pi / 2),))
    return angle, velocity


def _through_core(design: Design, angle: Curve, velocity: Curve, count: int) -> Complex:
    """ΔR_SF of each interval (count,) by the core's integers."""
    design = changed(design, algorithm={"position": "high-resolution"})
    T, span = design.sample_interval, design.samples_per_major
    # an interval more before the first, which fills the history
    t = T * np.arange(-span, count * span + 1, dtype=np.float64)
    samples = np.zeros((len(t) - 1, 6))
    samples[:, 0], samples[:, 4] = np.diff(angle(t)), np.diff(velocity(t))
    peaks = np.abs(samples).max(axis=0)
    fine = with_fine_sensor(design, float(peaks[0]), float(peaks[4]))
    moved = major_increments(fine, through_core(fine, samples)).dr_sf
    assert moved is not None
    found: Complex = moved[1:, 1] + 1j * moved[1:, 2]
    return found


def _error(each: Complex, turn: Complex) -> Error:
    """Of intervals (count,), each in the body's axes at its start, which stand at `turn`."""
    sums = np.abs(np.cumsum(turn * each))
    return Error(float(np.abs(each).max()), float(sums.max()), float(sums[-1]))
