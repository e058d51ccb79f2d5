"""What a vibration behind a mount rectifies to, (V3-V4) of `vibration`, and what is left."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import Response, SensorKind, TapTable
from sculler_model.analysis import closed_form, drift
from sculler_model.analysis.vibration.mount import Mount
from sculler_model.analysis.vibration.spectrum import Spectrum
from sculler_model.errors import InputError
from sculler_model.frames import STANDARD_GRAVITY

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

G = STANDARD_GRAVITY
"""m/s²: vibration is specified in multiples of it."""

STEP = 0.05
"""Widest step of the sums over frequency, Hz."""


@dataclass(frozen=True)
class Errors:
    """What an algorithm leaves of rectified vibration, computed minus true.

    Attributes:
        coning: about x, rad/s.
        sculling: (3,) m/s².
    """

    coning: float
    sculling: Array


@dataclass(frozen=True)
class Rectified:
    """Rectified vibration, band by band (V3).

    Attributes:
        frequency: (N,) band centres, Hz.
        coning: (N,) about x, rad/s.
        sculling: (N, 3) m/s².
        bound: whether these are bounds (V4), so that errors must not cancel between bands either.
    """

    frequency: Array
    coning: Array
    sculling: Array
    bound: bool = False

    @property
    def coning_rate(self) -> float:
        """Of all bands, rad/s."""
        return float(self.coning.sum())

    @property
    def sculling_force(self) -> Array:
        """(3,) of all bands, m/s²."""
        total: Array = self.sculling.sum(axis=0)
        return total

    def errors(
        self,
        table: TapTable,
        interval: float,
        kind: SensorKind = "increment",
        passed: Response | None = None,
    ) -> Errors:
        """What a tap table leaves of it.

        Args:
            table: the tap table.
            interval: T, s.
            kind: what the samples are; for rates take a response of `step_for`.
            passed: the filter they passed; None: increments none, rates sinc(ΩT/2).
        """
        share = relative_error(table, 2 * np.pi * self.frequency * interval, kind, passed)
        if self.bound:
            share = np.abs(share)
        return Errors(float(self.coning @ share), share @ self.sculling)


@dataclass(frozen=True)
class MountResponse:
    """The sensor assembly under a spectrum, in narrow bands of equal width.

    Attributes:
        frequency: (N,) band centres, Hz.
        step: their distance, Hz.
        power: (N,) mean square of the vehicle's acceleration in each band, (m/s²)².
        force, y, z: (N,) transfer functions of `Mount.transfer`.
    """

    frequency: Array
    step: float
    power: Array
    force: Complex
    y: Complex
    z: Complex

    @property
    def input_rms(self) -> float:
        """m/s²."""
        return sqrt(float(self.power.sum()))

    @property
    def force_rms(self) -> float:
        """Acceleration of the sensor assembly, m/s²."""
        return self._rms(self.force)

    @property
    def angle_rms(self) -> tuple[float, float]:
        """Rotations about y and z, rad."""
        return self._rms(self.y), self._rms(self.z)

    def _rms(self, transfer: Complex) -> float:
        return sqrt(float(np.sum(self.power * np.abs(transfer) ** 2)))

    @property
    def rectified(self) -> Rectified:
        """As the model's phases have it (V3)."""
        return self._rectified(
            np.imag(self.y * np.conj(self.z)),
            np.real(self.z * np.conj(self.force)),
            -np.real(self.y * np.conj(self.force)),
        )

    @property
    def worst_phase(self) -> Rectified:
        """The bound with every pair of motions in its worst phase (V4)."""
        y, z, force = np.abs(self.y), np.abs(self.z), np.abs(self.force)
        return self._rectified(y * z, z * force, y * force, bound=True)

    def _rectified(
        self, x: Array, along_y: Array, along_z: Array, bound: bool = False
    ) -> Rectified:
        omega = 2 * np.pi * self.frequency
        sculling = np.stack((np.zeros_like(along_y), along_y, along_z), axis=1)
        return Rectified(
            self.frequency, self.power * omega * x, self.power[:, None] * sculling, bound
        )


def relative_error(
    table: TapTable, phase: Array, kind: SensorKind = "increment", passed: Response | None = None
) -> Array:
    """Computed minus true rate over true rate of classical motion: 2 residual(λ)/(nλ).

    Args:
        table: the tap table.
        phase: λ > 0.
        kind, passed: as for `Rectified.errors`.

    Raises:
        InputError: the filter's response is not known at one of the frequencies.
    """
    if passed is None:
        left = closed_form.residual(table, phase, kind)
    else:
        left = drift.filtered_residual(table, phase, kind, passed)
        if np.isnan(left).any():
            raise InputError(
                "the vibration reaches above the sensor's measured response, give the response to"
                " higher frequencies or a lower spectrum"
            )
    share: Array = 2 * left / (table.samples * phase)
    return share


def step_for(samples: int, sample_rate: float) -> float:
    """A step (Hz) that places the bands' edges on the multiples of 1/(nT).

    There a rate sensor's sums alias to a constant rate and the residual has poles, odd ones, which
    cancel between the bands on their two sides (the principal value of the integral).
    """
    period = sample_rate / samples
    return period / ceil(period / STEP)


def respond(spectrum: Spectrum, mount: Mount, step: float = STEP) -> MountResponse:
    """The mount under a spectrum.

    Args:
        spectrum: the vehicle's vibration.
        mount: the mount.
        step: width of a band, Hz; the spectrum's power in each is exact.
    """
    count = ceil(spectrum.highest / step)
    edges = step * np.arange(count + 1, dtype=np.float64)
    frequency = edges[:-1] + step / 2
    power = G * G * spectrum.power(edges)
    used = power > 0
    frequency, power = frequency[used], power[used]
    return MountResponse(frequency, step, power, *mount.transfer(frequency))
