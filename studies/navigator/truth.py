"""A flight over WGS-84 that shares no line of code with the navigator, its gravity or its motions.

Position is told in Earth-centred axes, and what the accelerometers feel is its second derivative
in inertial space, by jets, less gravitation from zonal harmonics; attitude is plain matrices, and
increments are integrals by Gauss-Legendre in inertial space.  Nothing here imports sculler.
"""

from __future__ import annotations

from decimal import Decimal, localcontext
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

A, GM, RATE = 6378137.0, 3.986004418e14, 7.292115e-5
FLATTENING = 1 / 298.257223563
E2 = FLATTENING * (2 - FLATTENING)

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)
_BLOCK = 20_000


class Jet(NamedTuple):
    """A function of time with two derivatives."""

    x: Array
    d: Array
    dd: Array

    def plus(self, other: Jet) -> Jet:
        """Sum."""
        return Jet(self.x + other.x, self.d + other.d, self.dd + other.dd)

    def by(self, other: Jet) -> Jet:
        """Product."""
        return Jet(
            self.x * other.x,
            self.d * other.x + self.x * other.d,
            self.dd * other.x + 2 * self.d * other.d + self.x * other.dd,
        )

    def through(self, f: Array, f1: Array, f2: Array) -> Jet:
        """f(x), of f and its derivatives there."""
        return Jet(f, f1 * self.d, f2 * self.d**2 + f1 * self.dd)

    def sin(self) -> Jet:
        """Sine."""
        return self.through(np.sin(self.x), np.cos(self.x), -np.sin(self.x))

    def cos(self) -> Jet:
        """Cosine."""
        return self.through(np.cos(self.x), -np.sin(self.x), -np.cos(self.x))

    def scaled(self, size: float, more: float = 0.0) -> Jet:
        """size x + more."""
        return Jet(size * self.x + more, size * self.d, size * self.dd)


def wave(t: Array, size: float, period: float, phase: float) -> Jet:
    """size sin(2π t/period + phase)."""
    w = 2 * np.pi / period
    s, c = np.sin(w * t + phase), np.cos(w * t + phase)
    return Jet(size * s, size * w * c, -size * w * w * s)


class Flight(NamedTuple):
    """A flight between 1 and 9 km at 46 to 48 degrees, up to 350 m/s, banks of 0.5 rad, an hour."""

    lat: float = np.radians(47.0)
    lon: float = np.radians(8.0)
    middle: float = 5000.0

    def place(self, t: Array) -> tuple[Jet, Jet, Jet]:
        """Geodetic latitude, longitude (rad) and height (m) at times t (N,), s."""
        one, zero = np.ones_like(t), np.zeros_like(t)
        lat = wave(t, 0.02, 3000.0, 0.4).plus(wave(t, 3e-5, 55.0, 1.0)).scaled(1.0, self.lat)
        lon = Jet(3e-5 * t, 3e-5 * one, zero).plus(wave(t, 0.001, 400.0, 0.0))
        h = wave(t, 3900.0, 1700.0, -1.5).plus(wave(t, 30.0, 45.0, 0.3))
        return lat, lon.scaled(1.0, self.lon), h.scaled(1.0, self.middle)

    def angles(self, t: Array) -> tuple[Array, Array, Array]:
        """Roll, pitch and heading (rad)."""
        return (
            wave(t, 0.5, 60.0, 0.0).x,
            0.05 + wave(t, 0.1, 45.0, 0.7).x,
            1.0 + wave(t, 1.2, 300.0, 0.2).x,
        )

    def ecef(self, t: Array) -> tuple[Jet, Jet, Jet]:
        """Position in Earth-centred, Earth-fixed axes, m."""
        lat, lon, h = self.place(t)
        s, c = lat.sin(), lat.cos()
        squash = s.by(s).scaled(-E2, 1.0)
        normal = squash.through(
            A * squash.x**-0.5, -0.5 * A * squash.x**-1.5, 0.75 * A * squash.x**-2.5
        )
        out = normal.plus(h).by(c)
        return out.by(lon.cos()), out.by(lon.sin()), normal.scaled(1 - E2).plus(h).by(s)

    def force(self, t: Array) -> Array:
        """(N, 3) specific force (m/s²) in inertial axes, which are the Earth's at time 0."""
        x, y, z = self.ecef(t)
        pull = gravitation(np.stack((x.x, y.x, z.x), 1))
        fx = x.dd - 2 * RATE * y.d - RATE**2 * x.x - pull[:, 0]
        fy = y.dd + 2 * RATE * x.d - RATE**2 * y.x - pull[:, 1]
        c, s = np.cos(RATE * t), np.sin(RATE * t)
        return np.stack((c * fx - s * fy, s * fx + c * fy, z.dd - pull[:, 2]), 1)

    def attitude(self, t: Array) -> Array:
        """(N, 3, 3) body to inertial axes."""
        lat, lon, _ = self.place(t)
        return turned(2, lon.x + RATE * t) @ turned(1, -0.5 * np.pi - lat.x) @ self.to_north(t)

    def to_north(self, t: Array) -> Array:
        """(N, 3, 3) body to north, east, down."""
        roll, pitch, heading = self.angles(t)
        return turned(2, heading) @ turned(1, pitch) @ turned(0, roll)

    def velocity(self, t: Array) -> Array:
        """(N, 3) over the Earth, north, east, down, m/s."""
        lat, lon, _ = self.place(t)
        x, y, z = self.ecef(t)
        to_earth = turned(2, lon.x) @ turned(1, -0.5 * np.pi - lat.x)
        v: Array = np.einsum("nji,nj->ni", to_earth, np.stack((x.d, y.d, z.d), 1))
        return v


def turned(axis: int, angle: Array) -> Array:
    """(N, 3, 3) rotations about a coordinate axis, which take turned components to plain ones."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.zeros((len(angle), 3, 3))
    matrix[:, axis, axis] = 1
    matrix[:, i, i] = matrix[:, j, j] = np.cos(angle)
    matrix[:, j, i] = np.sin(angle)
    matrix[:, i, j] = -np.sin(angle)
    return matrix


@cache
def harmonics(degrees: int = 12) -> tuple[float, ...]:
    """J_2, J_4, ... of the level ellipsoid (Heiskanen and Moritz, Eq. 2-90 to 2-92)."""
    with localcontext() as context:
        context.prec = 50
        f = 1 / Decimal("298.257223563")
        e2 = f * (2 - f)
        second = (e2 / (1 - e2)).sqrt()
        arctan = sum((-1) ** k * second ** (2 * k + 1) / (2 * k + 1) for k in range(40))
        q0 = ((1 + 3 / second**2) * arctan - 3 / second) / 2
        m = Decimal(RATE) ** 2 * Decimal(A) ** 3 * (1 - f) / Decimal(GM)
        j2 = e2 / 3 * (1 - 2 * m * second / (15 * q0))
        return tuple(
            float(
                (-1) ** (n + 1)
                * 3
                * e2**n
                / ((2 * n + 1) * (2 * n + 3))
                * (1 - n + 5 * n * j2 / e2)
            )
            for n in range(1, degrees + 1)
        )


def gravitation(place: Array) -> Array:
    """(N, 3) m/s² at (N, 3) m, Earth-centred axes: V = GM/r (1 - Σ J_2n (A/r)^2n P_2n(z/r))."""
    r = np.sqrt((place**2).sum(1))
    t = place[:, 2] / r
    along_r, along_t = np.ones_like(r), np.zeros_like(r)
    before, now, slope = np.ones_like(t), t, np.ones_like(t)
    found = harmonics()
    for n in range(2, 2 * len(found) + 1):
        before, now = now, ((2 * n - 1) * t * now - (n - 1) * before) / n
        slope = n * before + t * slope
        if n % 2 == 0:
            part = found[n // 2 - 1] * (A / r) ** n
            along_r -= (n + 1) * part * now
            along_t -= part * slope
    # ∂t/∂X = (k - t X/r)/r
    pull: Array = (-GM / r**3 * (along_r + along_t * t))[:, None] * place
    pull[:, 2] += GM / r**2 * along_t
    return pull


def increments(flight: Flight, count: int, interval: float) -> tuple[Array, Array]:
    """φ (rad) and ΔV_SF (m/s) of the intervals from time 0 on, each (count, 3), without a model."""
    phi, dv = np.empty((count, 3)), np.zeros((count, 3))
    for first in range(0, count, _BLOCK):
        part = slice(first, min(first + _BLOCK, count))
        begin = interval * np.arange(part.start, part.stop, dtype=np.float64)
        back = flight.attitude(begin).transpose(0, 2, 1)
        phi[part] = rotation_vectors(back @ flight.attitude(begin + interval))
        for node, weight in zip(_NODES.tolist(), _WEIGHTS.tolist(), strict=True):
            force = flight.force(begin + interval * (0.5 + 0.5 * node))
            dv[part] += 0.5 * interval * weight * np.einsum("nij,nj->ni", back, force)
    return phi, dv


def rotation_vectors(matrices: Array) -> Array:
    """(N, 3) rad, of (N, 3, 3) less than half a turn."""
    m = matrices
    v = 0.5 * np.stack(
        (m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0], m[:, 1, 0] - m[:, 0, 1]), 1
    )
    sine = np.sqrt((v**2).sum(1))
    angle = np.arctan2(sine, 0.5 * (np.trace(m, axis1=1, axis2=2) - 1))
    found: Array = v * np.where(sine > 0, angle / np.where(sine > 0, sine, 1.0), 1.0)[:, None]
    return found


def series(lat: Array, h: Array) -> Array:
    """Gravity down (m/s²), by Somigliana and a series in height (TR8350.2, Eq. 4-3)."""
    s2 = np.sin(lat) ** 2
    equator, pole = 9.7803253359, 9.8321849378
    b = A * (1 - FLATTENING)
    k = b * pole / (A * equator) - 1
    surface = equator * (1 + k * s2) / np.sqrt(1 - E2 * s2)
    m = RATE**2 * A * A * b / GM
    free: Array = 1 - 2 / A * (1 + FLATTENING + m - 2 * FLATTENING * s2) * h + 3 * h * h / A**2
    return surface * free
