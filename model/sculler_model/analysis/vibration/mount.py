"""The isolator mount, (V1-V2) of `analysis.vibration`: how the sensors move behind it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class Plane:
    """A rotary mode and the imbalance that excites it.

    Attributes:
        hz, damping: undamped natural frequency (Hz) and damping ratio.
        stiffness, spread: ε_k and ε_c of (V1), imbalance of stiffness and of damping.
        offset: δ of (V1), the centre of mass's offset as a share of the isolators' distance.
    """

    hz: float = 71.0
    damping: float = 0.18
    stiffness: float = 0.0
    spread: float = 0.0
    offset: float = 0.0


@dataclass(frozen=True)
class Mount:
    """A sensor assembly in isolators, (V1-V2) of `analysis.vibration`.

    Attributes:
        hz, damping: of the linear mode.
        spacing: L, m.
        y, z: the rotary modes about y and z.
        cascade: the linear mode drives the rotary ones and feels nothing of them: (V2) without κ².
    """

    hz: float = 50.0
    damping: float = 0.125
    spacing: float = 0.254
    y: Plane = Plane()
    z: Plane = Plane()
    cascade: bool = False

    @classmethod
    def worst(
        cls,
        imbalance: float,
        offset: float,
        *,
        hz: float = 50.0,
        damping: float = 0.125,
        rotary_hz: float = 71.0,
        rotary_damping: float = 0.18,
        spacing: float = 0.254,
        cascade: bool = False,
    ) -> Mount:
        """The signs of given sizes of imbalance and offset that rectify most.

        About z everything adds up, which gives the most sculling; about y stiffness and damping
        are unbalanced in opposite senses, so that the two rotations differ most in phase, which
        gives the most coning.
        """
        y = Plane(rotary_hz, rotary_damping, imbalance, -imbalance, -offset)
        z = Plane(rotary_hz, rotary_damping, imbalance, imbalance, -offset)
        return cls(hz, damping, spacing, y, z, cascade)

    def transfer(self, frequency: Array) -> tuple[Complex, Complex, Complex]:
        """Responses to 1 m/s² of the vehicle, (V2).

        Args:
            frequency: (N,) Hz.

        Returns:
            Acceleration along x (m/s²), rotations about y and z (rad); (N,) each.
        """
        s = 2j * np.pi * frequency
        omega = 2 * np.pi * self.hz
        spring, damper = omega**2, 2 * self.damping * omega * s
        denominator = s * s + spring + damper
        rotations = []
        for plane, sign in ((self.y, 1.0), (self.z, -1.0)):
            rotary = 2 * np.pi * plane.hz
            coupling = (plane.spread / 2 - plane.offset) * damper
            coupling = coupling + (plane.stiffness / 2 - plane.offset) * spring
            compliance = 1 / (s * s + rotary**2 + 2 * plane.damping * rotary * s)
            gain = 4 * (plane.hz / self.hz) ** 2 * coupling * compliance
            if not self.cascade:
                denominator = denominator - gain * coupling
            rotations.append(sign / self.spacing * gain)
        force, y, z = (
            np.asarray(numerator / denominator, np.complex128)
            for numerator in (denominator - s * s, *rotations)
        )
        return force, y, z
