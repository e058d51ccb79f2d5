"""Coning in a steady turn: what the triple products leave, and who can mend it.

The core's φ is of second order.  Under vibration in a turn the third-order terms drift; the host
can estimate them from its sums (`host.ThirdOrder`), and exact accumulators at the minor rate could
form them (`sculler_model.analysis.third_order`, a study).  All three run on the same counts here.
"""

from __future__ import annotations

from cmath import phase
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import asin, copysign, pi, sin

import numpy as np
from numpy.typing import NDArray

from sculler_model.analysis.integer_path import changed, running_attitude, with_fine_sensor
from sculler_model.analysis.iteration import DEGREE, attitude_on
from sculler_model.analysis.sensed import Felt, delay, passed, require_known
from sculler_model.analysis.third_order import composed, minor_vectors
from sculler_model.design import Design
from sculler_model.fast import run_fast
from sculler_model.frames import Quaternion, conjugate, product, to_rotation_vector
from sculler_model.host import major_increments
from sculler_model.motion import Curve, Turn, X, Z, attitude, coning_turns, legendre_nodes
from sculler_model.samples import Quantiser

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ConingTurn:
    """Classical coning on a body that turns about the vertical, banked.

    Attributes:
        half_angle: of the cone, rad.
        hertz: of the cone.
        turn: rate about the vertical, rad/s.
        bank: of the body, rad.
        spin: rate about the body's own axis, which goes round the cone, rad/s.
        phase: of the cone at time 0, rad.
    """

    half_angle: float
    hertz: float
    turn: float = 0.0
    bank: float = 0.0
    spin: float = 0.0
    phase: float = 0.0

    def turns(self) -> tuple[Turn, ...]:
        """The motion as `motion.attitude` takes it."""
        coning = coning_turns(self.half_angle, 2 * pi * self.hertz, self.phase)
        about, spin = Turn(Z, Curve((0.0, self.turn))), Turn(Z, Curve((0.0, self.spin)))
        return (about, Turn(X, Curve((self.bank,))), *coning, *([spin] if self.spin else []))

    @property
    def fastest(self) -> float:
        """Of the rates in the body, rad/s: up to twice the cone's frequency, and the spin's."""
        return 4 * pi * self.hertz + abs(self.spin) + abs(self.turn)

    def increments(self, interval: float, count: int, first: int = 0) -> Array:
        """(count, 6) angle increments from sample `first` on, rad; accelerometers see nothing."""
        nodes, weights = legendre_nodes(self.fastest * interval)
        samples = np.zeros((count, 6))
        for node, weight in zip(nodes, weights, strict=True):
            times = (np.arange(first, first + count) + node) * interval
            _, rate = attitude(self.turns(), times)
            samples[:, :3] += weight * interval * np.stack(rate, axis=1)
        return samples

    def samples(self, design: Design, count: int, first: int = 0) -> Array:
        """(count, 6) increments, behind the filter of the design's sensor if it has one.

        Raises:
            InputError: the sensor's filter remembers for too long.
        """
        if design.sensor_response is None:
            return self.increments(design.sample_interval, count, first)

        def felt(t: Array) -> Array:
            rate = np.stack(attitude(self.turns(), t)[1], axis=1)
            return np.hstack((rate, np.zeros_like(rate)))

        return passed(design, Felt(felt, self.fastest), first, count)

    def seen(self, design: Design) -> ConingTurn:
        """The cone that the samples show: narrower, as the sensor's filter has it.

        The filter takes a part of the swing, which stays what it is.  What grows besides is the
        error: this cone goes round without drift, as the true one does.

        Raises:
            InputError: the filter's measured response ends below the cone's frequency.
        """
        response = design.sensor_response
        if response is None:
            return self
        rounds = 2 * pi * self.hertz - self.spin  # in the body's axes
        require_known(design, abs(rounds) / (2 * pi), "the cone")
        gain = response.value(abs(rounds) * design.sample_interval)
        swing = asin(min(abs(gain) * sin(self.half_angle), 1.0))
        late = copysign(phase(gain), rounds * phase(gain)) + rounds * delay(design)
        return replace(
            self,
            half_angle=swing if self.half_angle <= pi / 2 else pi - swing,
            phase=self.phase + late,
        )

    def attitude(self, time: float) -> Quaternion:
        """Body to reference frame."""
        q, _ = attitude(self.turns(), np.array([time]))
        w, x, y, z = (float(part[0]) for part in q)
        return (w, x, y, z)


@dataclass(frozen=True)
class Left:
    """Drift of the attitude, all axes together, rad/s.

    Attributes:
        minors: M.
        second_order: as the core hands it over.
        host: with the host's third-order correction.
        integers: with exact third-order accumulators.
        iteration: iterated to convergence on the same exact samples (`iteration`).
    """

    minors: int
    second_order: float
    host: float
    integers: float
    iteration: float


def left(
    design: Design,
    motion: ConingTurn,
    minors: Sequence[int],
    seconds: float,
    degree: int = DEGREE,
) -> Iterator[Left]:
    """Drift over a run on a sensor too fine to matter, for several M.

    Motion, counts and minor intervals are the same whatever M, and computed once.

    Args:
        design: sample rate and coefficients (increments).
        motion: the motion.
        minors: values of M, in place of the design's.
        seconds: length of the run, cut to whole major intervals.
        degree: of the polynomial that `iteration` puts through the samples.

    Raises:
        InputError: the sensor's filter remembers for too long, or is not known at the cone's
            frequency.
    """
    interval, n = design.sample_interval, design.algorithm.samples
    majors = {M: int(seconds / (M * n * interval)) for M in minors}
    edge = degree + 1
    longest = max(M * n * majors[M] for M in minors)
    samples = motion.samples(design, longest + 2 * edge, -edge)
    allowed = attitude_on(
        changed(design, algorithm={"minors": 1}),
        samples[: longest + 2 * edge],
        degree=degree,
        edge=edge,
    )
    samples = samples[edge:-edge]
    design = changed(design, algorithm={"order": 2})
    design = with_fine_sensor(design, float(np.abs(samples).max()))
    counts = Quantiser(design)(samples)
    theta, within = minor_vectors(design, counts)
    seen, late = motion.seen(design), delay(design)
    start = conjugate(seen.attitude(-late))
    for M in minors:
        of_this, whole = changed(design, algorithm={"minors": M}), M * majors[M]
        block = run_fast(of_this, counts[: n * whole])
        second = major_increments(of_this, block).phi
        third = composed(theta[:whole], within[:whole], M).rotation(of_this)
        corrected = major_increments(of_this, block, third_order=True).phi
        end = n * whole * interval
        true = product(start, seen.attitude(end - late))
        drifts = []
        ends = [running_attitude(phi)[-1] for phi in (second, corrected, second + third)]
        for found in (*ends, allowed[whole - 1]):
            w, x, y, z = found.tolist()
            error = to_rotation_vector(product((w, x, y, z), conjugate(true)))
            drifts.append(float(np.linalg.norm(error)) / end)
        yield Left(M, *drifts)
