"""Pure vibrations of one frequency: their samples, and the drift that is put together from them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from sculler_model.analysis.integer_path import rotation_vectors, running_attitude
from sculler_model.analysis.iteration import attitude_on, blocks_of
from sculler_model.design import Design
from sculler_model.fast import VectorBlock
from sculler_model.frames import product, rotate
from sculler_model.host import major_increments, second_order_corrections
from sculler_model.motion import Coning, Sculling

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Oscillation(ABC):
    """A pure vibration of one frequency, by its two amplitudes.

    `Cone` and `Scull` say what they are; drifts are rad/s and m/s² about and along z.
    """

    @abstractmethod
    def amplitudes(self, omega: Array) -> Array:
        """a·b of `closed_form` at Ω (rad/s)."""

    @abstractmethod
    def samples(self, design: Design, omega: float, count: int) -> Array:
        """(count, 6) samples from time 0, as the design's sensor gives them."""

    @abstractmethod
    def peaks(self, design: Design, omega: float) -> tuple[float, float]:
        """Bounds of gyro and accelerometer samples at Ω and below, for a fine sensor."""

    @abstractmethod
    def second_order(self, design: Design, block: VectorBlock) -> float:
        """Drift times the record's time that the vectors of whole periods give, to 2nd order."""

    @abstractmethod
    def complete(self, design: Design, block: VectorBlock, omega: float, start: float) -> float:
        """Drift times time of the host's attitude or velocity, minus truth, to all orders.

        Args:
            design: the design.
            block: vectors over whole periods.
            omega: Ω, rad/s.
            start: time at which the block begins, s.
        """

    @abstractmethod
    def iterated(
        self, design: Design, samples: Array, omega: float, degree: int, edge: int
    ) -> float:
        """Drift times time that samples of whole periods allow (`iteration`), minus truth.

        Args:
            design: the design.
            samples: from time 0 on, with `edge` more at each end.
            omega: Ω, rad/s.
            degree, edge: as for `iteration.iterated`.
        """


@dataclass(frozen=True)
class Cone(Oscillation):
    """Classical coning about z (`motion.Coning`); half_angle in rad."""

    half_angle: float

    def amplitudes(self, omega: Array) -> Array:
        """See `Oscillation`."""
        return np.full_like(omega, sin(self.half_angle) ** 2)

    def samples(self, design: Design, omega: float, count: int) -> Array:
        """See `Oscillation`."""
        motion, T = Coning(self.half_angle, omega), design.sample_interval
        response = design.sensor_response
        if design.sensor.kind == "increment":
            samples = motion.increments(count, T)
        else:
            samples = motion.rates(count, T, 1, filtered=response is None)
        if response is not None:  # both axes pass it alike, so its phase is only a later start
            samples[:, :2] *= abs(response.value(omega * T))
        return samples

    def peaks(self, design: Design, omega: float) -> tuple[float, float]:
        """See `Oscillation`."""
        T = design.sample_interval
        swing = 2 * sin(self.half_angle) * min(0.5 * omega * T, 1.0)
        spin = 2 * omega * T * sin(self.half_angle / 2) ** 2
        return (swing + spin) / (T if design.sensor.kind == "rate" else 1.0), 0.0

    def second_order(self, design: Design, block: VectorBlock) -> float:
        """See `Oscillation`."""
        return float(second_order_corrections(design, block)[0][2])

    def complete(self, design: Design, block: VectorBlock, omega: float, start: float) -> float:
        """See `Oscillation`."""
        increments = major_increments(design, block)
        turned = self._about_axis(running_attitude(increments.phi)[-1:], omega, start)
        # the last LSB of the cone's constant rate waits in the quantiser: no drift, so taken off
        seconds = len(block) * design.major_interval
        constant = -2 * omega * sin(self.half_angle / 2) ** 2 * seconds
        return float(turned - (increments.alpha[:, 2].sum() - constant))

    def iterated(
        self, design: Design, samples: Array, omega: float, degree: int, edge: int
    ) -> float:
        """See `Oscillation`."""
        last = attitude_on(design, samples, degree=degree, edge=edge)[-1:]
        return self._about_axis(last, omega, edge * design.sample_interval)

    def _about_axis(self, turned: Array, omega: float, start: float) -> float:
        """Angle about the cone's axis, rad, of a turn (1, 4) that begins at time `start`."""
        w, i, j, k = Coning(self.half_angle, omega).attitude(np.array([start])).T
        x, y, z = rotation_vectors(turned).T
        return float(rotate((w, i, j, k), (x, y, z))[2].item())


@dataclass(frozen=True)
class Scull(Oscillation):
    """Classical sculling (`motion.Sculling`): angle about x in rad, specific force along y."""

    angle: float
    force: float

    def amplitudes(self, omega: Array) -> Array:
        """See `Oscillation`."""
        return self.angle * self.force / omega

    def samples(self, design: Design, omega: float, count: int) -> Array:
        """See `Oscillation`."""
        motion, T = Sculling(self.angle, self.force, omega), design.sample_interval
        gain = self._gain(design, omega)
        if design.sensor.kind == "increment":
            return gain * motion.increments(count, T)
        phase = omega * T * (1 + np.arange(count))
        out = np.zeros((count, 6))
        out[:, 0] = gain * self.angle * omega * np.cos(phase)
        out[:, 4] = gain * self.force * np.sin(phase)
        return out

    def peaks(self, design: Design, omega: float) -> tuple[float, float]:
        """See `Oscillation`."""
        T = design.sample_interval
        peaks = 2 * self.angle * min(0.5 * omega * T, 1.0), self.force * T
        return (peaks[0] / T, peaks[1] / T) if design.sensor.kind == "rate" else peaks

    def second_order(self, design: Design, block: VectorBlock) -> float:
        """See `Oscillation`."""
        return float(second_order_corrections(design, block)[1][2])

    def complete(self, design: Design, block: VectorBlock, omega: float, start: float) -> float:
        """See `Oscillation`."""
        increments = major_increments(design, block)
        begin = self.angle * sin(omega * start)
        gained = self._upward(increments.phi, increments.dv_sf, begin)
        return gained - self._true(omega) * len(block) * design.major_interval

    def iterated(
        self, design: Design, samples: Array, omega: float, degree: int, edge: int
    ) -> float:
        """See `Oscillation`."""
        found = blocks_of(design, samples, degree=degree, edge=edge)
        T = design.sample_interval
        begin = self._gain(design, omega) * self.angle * sin(omega * edge * T)
        gained = self._upward(found[:, :3], found[:, 3:], begin)
        return gained - self._true(omega) * (len(samples) - 2 * edge) * T

    def _true(self, omega: float) -> float:
        """Rectified specific force, m/s²."""
        return Sculling(self.angle, self.force, omega).mean_force

    @staticmethod
    def _upward(phi: Array, dv: Array, begin: float) -> float:
        """Velocity along z of intervals' φ and ΔV (R, 3); the first begins turned so about x."""
        first = np.array([[cos(begin / 2), sin(begin / 2), 0.0, 0.0]])
        after = running_attitude(phi)
        q = np.concatenate((first, np.stack(product(tuple(first.T), tuple(after[:-1].T)), 1)))
        w, i, j, k = q.T
        x, y, z = dv.T
        return float(rotate((w, i, j, k), (x, y, z))[2].sum())

    @staticmethod
    def _gain(design: Design, omega: float) -> float:
        """|F|, of a rate sensor's usual mean if no filter is stated."""
        T, response = design.sample_interval, design.sensor_response
        if response is not None:
            return abs(response.value(omega * T))
        return 1.0 if design.sensor.kind == "increment" else float(np.sinc(omega * T / (2 * pi)))
