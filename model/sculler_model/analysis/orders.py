"""What second, third and fourth order leave: attitude and velocity at the end of a motion.

The same counts run through the core's integers with each `order`.  The truth is a closed form:
coning in a turn has its attitude, and the body is held up by a specific force that is constant in
the reference frame, so the velocity that it gives is force times time whatever the body does.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import ORDERS
from sculler_model.analysis.integer_path import changed, running_attitude, with_fine_sensor
from sculler_model.analysis.iteration import DEGREE, attitude_on
from sculler_model.analysis.manoeuvre import Manoeuvre, errors, true_attitude
from sculler_model.analysis.sensed import Felt, delay, passed, reach
from sculler_model.analysis.triple import ConingTurn
from sculler_model.design import Design
from sculler_model.fast import run_fast
from sculler_model.frames import conjugate, product
from sculler_model.host import major_increments
from sculler_model.motion import attitude, legendre_nodes
from sculler_model.samples import Quantiser

Array = NDArray[np.float64]

FORCE = np.array([1.0, -2.0, -9.80665])
"""m/s², of the reference frame."""

MICRO = 1e-6


@dataclass(frozen=True)
class Left:
    """Errors at one hand-over rate.

    Attributes:
        minors: M.
        order: 2, 3 or 4.
        attitude: at the end, rad, all axes together.
        largest: the largest on the way, rad.
        velocity: at the end, m/s, with the true attitude at the start of each interval; None for
            motions without force.
        iteration: the attitude at the end iterated to convergence on the same exact samples
            (`iteration`), rad; of every order the same.
    """

    minors: int
    order: int
    attitude: float
    largest: float
    velocity: float | None
    iteration: float


@dataclass(frozen=True)
class HeldConing:
    """Coning in a turn, held up by `FORCE`."""

    motion: ConingTurn

    def samples(self, design: Design, count: int) -> Array:
        """(count, 6) increments of gyro and accelerometer.

        Raises:
            InputError: the sensor's filter remembers for too long.
        """
        interval = design.sample_interval
        if design.sensor_response is not None:
            return passed(design, Felt(self._felt, self.motion.fastest), 0, count)
        found = self.motion.increments(interval, count)
        nodes, weights = legendre_nodes(self.motion.fastest * interval)
        for node, weight in zip(nodes, weights, strict=True):
            q, _ = attitude(self.motion.turns(), (np.arange(count) + node) * interval)
            found[:, 3:] += weight * interval * _turned(np.stack(conjugate(q), axis=1), FORCE)
        return found

    def attitudes(self, design: Design, times: Array) -> Array:
        """(R, 4) quaternions at times[1:], true to what the samples show (`ConingTurn.seen`)."""
        late, seen = delay(design), self.motion.seen(design)
        q, _ = attitude(seen.turns(), times[1:] - late)
        back = conjugate(seen.attitude(float(times[0]) - late))
        w, x, y, z = (np.full_like(times[1:], part) for part in back)
        attitudes: Array = np.stack(product((w, x, y, z), q), axis=1)
        return attitudes

    def longer(self, design: Design) -> float:
        """What a run must be longer by behind the sensor's filter, s: nothing."""
        return 0.0

    def force(self, design: Design) -> Array:
        """`FORCE` in the body's frame at the start, as `attitudes` has it."""
        start = np.array([conjugate(self.motion.seen(design).attitude(-delay(design)))])
        force: Array = _turned(start, FORCE)[0]
        return force

    def _felt(self, t: Array) -> Array:
        """What perfect sensors feel, (N, 6)."""
        q, rate = attitude(self.motion.turns(), t)
        return np.hstack((np.stack(rate, axis=1), _turned(np.stack(conjugate(q), axis=1), FORCE)))


@dataclass(frozen=True)
class Manoeuvred:
    """A manoeuvre, at rest before and after."""

    motion: Manoeuvre

    def samples(self, design: Design, count: int) -> Array:
        """(count, 6) increments of the gyro; no force."""
        return self.motion.samples(design, count)

    def attitudes(self, design: Design, times: Array) -> Array:
        """(R, 4) true quaternions at times[1:]."""
        return true_attitude(self.motion, times + self.motion.start(design) - delay(design))

    def longer(self, design: Design) -> float:
        """What a run must be longer by behind the sensor's filter, s, to have the whole of it."""
        ahead, back = reach(design, self.motion.felt)
        return ahead * design.sample_interval + back


def left_by_order(
    design: Design,
    motion: HeldConing | Manoeuvred,
    minors: Sequence[int],
    seconds: float,
    degree: int = DEGREE,
) -> Iterator[Left]:
    """Errors of each order over a run on a sensor too fine to matter, for several M.

    Args:
        design: sample rate and coefficients (increments); its order and M do not matter.
        motion: the motion.
        minors: values of M.
        seconds: length of the run, cut to whole major intervals; a manoeuvre's run is as much
            longer as the sensor's filter takes.
        degree: of the polynomial that `iteration` puts through the samples.

    Raises:
        InputError: the design can have no third order; or the sensor's filter remembers for too
            long, or is not known at the cone's frequency.
    """
    n, T = design.algorithm.samples, design.sample_interval
    longer = motion.longer(design)
    majors = {
        M: round(seconds / (M * n * T) - 0.5 + 1e-9) + ceil(longer / (M * n * T)) for M in minors
    }
    samples = motion.samples(design, max(M * n * majors[M] for M in minors))
    peaks = np.abs(samples).reshape(-1, 2, 3).max(axis=(0, 2)).tolist()
    fine = with_fine_sensor(design, *peaks)
    counts = Quantiser(fine)(samples)
    for M in minors:
        times = M * n * T * np.arange(majors[M] + 1, dtype=np.float64)
        true = motion.attitudes(design, times)
        hand_over = changed(design, algorithm={"minors": M})
        allowed = attitude_on(hand_over, samples[: M * n * majors[M]], degree=degree)
        iteration = MICRO * float(errors(allowed[-1:], true[-1:])[0])
        for order in ORDERS:
            of_this = changed(fine, algorithm={"minors": M, "order": order})
            found = major_increments(of_this, run_fast(of_this, counts[: M * n * majors[M]]))
            errors_on_the_way = MICRO * errors(running_attitude(found.phi), true)
            velocity = None
            if isinstance(motion, HeldConing):
                starts = np.concatenate(([[1.0, 0, 0, 0]], true[:-1]))
                reached = _turned(starts, found.dv_sf).sum(axis=0)
                velocity = float(np.linalg.norm(reached - times[-1] * motion.force(design)))
            end, largest = float(errors_on_the_way[-1]), float(errors_on_the_way.max())
            yield Left(M, order, end, largest, velocity, iteration)


def _turned(q: Array, vectors: Array) -> Array:
    """Vectors (R, 3) or (3,) from the frame of each quaternion (R, 4) to the outer one."""
    scalar, axis = q[:, :1], q[:, 1:]
    once = 2 * np.cross(axis, np.broadcast_to(vectors, axis.shape))
    turned: Array = vectors + scalar * once + np.cross(axis, once)
    return turned
