"""Quaternions, rotation vectors, direction cosines and Euler angles.

A quaternion (w, x, y, z), scalar first, here rotates vectors from the body frame (x forward,
y right, z down) into the navigation frame (north, east, down): ``v_n = rotate(q_nb, v_b)``.
Functions that are arithmetic only take tuples of floats (the navigator's fast path) as well as
tuples of arrays (truth motions).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import asin, atan2, copysign, cos, hypot, sin, sqrt
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError

Real = TypeVar("Real", float, NDArray[np.float64])

Vector = tuple[float, float, float]
"""Three components."""

Quaternion = tuple[float, float, float, float]
"""(w, x, y, z), scalar first, of length 1."""

Vectors = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
"""The three components of many vectors, an array each."""

Quaternions = tuple[
    NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]
]
"""w, x, y, z of many quaternions, an array each."""


def cross(a: tuple[Real, Real, Real], b: tuple[Real, Real, Real]) -> tuple[Real, Real, Real]:
    """a x b, of floats or arrays; `algorithms` has it for exact integers."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def plus(
    a: tuple[Real, Real, Real], b: tuple[Real, Real, Real], factor: float
) -> tuple[Real, Real, Real]:
    """a + factor b."""
    return (a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2])


def product(
    p: tuple[Real, Real, Real, Real], q: tuple[Real, Real, Real, Real]
) -> tuple[Real, Real, Real, Real]:
    """Quaternion product: first rotates by q, then by p."""
    pw, px, py, pz = p
    qw, qx, qy, qz = q
    return (
        pw * qw - px * qx - py * qy - pz * qz,
        pw * qx + px * qw + py * qz - pz * qy,
        pw * qy - px * qz + py * qw + pz * qx,
        pw * qz + px * qy - py * qx + pz * qw,
    )


def conjugate(q: tuple[Real, Real, Real, Real]) -> tuple[Real, Real, Real, Real]:
    """The opposite rotation, of a quaternion of length 1."""
    return (q[0], -q[1], -q[2], -q[3])


def rotate(q: tuple[Real, Real, Real, Real], v: tuple[Real, Real, Real]) -> tuple[Real, Real, Real]:
    """v turned by q, in v's unit: body components to navigation components where q is q_nb."""
    w, x, y, z = q
    tx, ty, tz = cross((x, y, z), v)
    tx, ty, tz = tx + tx, ty + ty, tz + tz
    return (
        v[0] + w * tx + y * tz - z * ty,
        v[1] + w * ty + z * tx - x * tz,
        v[2] + w * tz + x * ty - y * tx,
    )


def normalised(q: Quaternion) -> Quaternion:
    """q brought back to length 1 from a rounding error away.

    A length of 1 + ε becomes 1 - 3/2 ε², so however often it is done the length stays within the
    rounding of the last time: it cannot drift.
    """
    w, x, y, z = q
    scale = 1.5 - 0.5 * (w * w + x * x + y * y + z * z)
    return (w * scale, x * scale, y * scale, z * scale)


def about_z(angle: float) -> Quaternion:
    """Quaternion of a turn about z (rad)."""
    return (cos(0.5 * angle), 0.0, 0.0, sin(0.5 * angle))


def from_rotation_vector(phi: Vector) -> Quaternion:
    """Quaternion of a rotation vector (rad), exact; |phi| may be any size (Savage-20 Eq. 1)."""
    x, y, z = phi
    square = x * x + y * y + z * z
    if square < 1e-4:  # sin(a/2)/a by series, the next terms are below 3e-17
        half_sinc = 0.5 - square * (1 / 48 - square * (1 / 3840))
        w = 1 - square * (1 / 8 - square * (1 / 384))
    else:
        angle = sqrt(square)
        half_sinc, w = sin(0.5 * angle) / angle, cos(0.5 * angle)
    return (w, x * half_sinc, y * half_sinc, z * half_sinc)


def to_rotation_vector(q: Quaternion) -> Vector:
    """Rotation vector (rad) of a quaternion, the short way round: |phi| <= pi."""
    w, x, y, z = q
    sine = sqrt(x * x + y * y + z * z)
    # the angle is 2 atan2(sine, |w|); its ratio to a small sine is 2/|w|
    scale = 2 * atan2(sine, abs(w)) / sine if sine > 1e-150 else 2.0
    scale = copysign(scale, w)
    return (x * scale, y * scale, z * scale)


def to_dcm(q: Quaternion) -> tuple[Vector, Vector, Vector]:
    """Rows of the direction cosine matrix C_nb (body to navigation frame)."""
    w, x, y, z = q
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def from_dcm(rows: tuple[Vector, Vector, Vector]) -> Quaternion:
    """Quaternion of a proper direction cosine matrix, w >= 0 (Shepperd's choice of divisor)."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rows
    squares = (1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz)
    largest = max(range(4), key=squares.__getitem__)
    s = squares[largest]
    q: Quaternion = (
        (s, zy - yz, xz - zx, yx - xy),
        (zy - yz, s, xy + yx, xz + zx),
        (xz - zx, xy + yx, s, yz + zy),
        (yx - xy, xz + zx, yz + zy, s),
    )[largest]
    scale = copysign(0.5 / sqrt(s), q[0])
    return (q[0] * scale, q[1] * scale, q[2] * scale, q[3] * scale)


Matrix = tuple[Vector, Vector, Vector]
"""Three rows."""


def dcm_of_rotation_vector(phi: Vector) -> Matrix:
    """Rows of I + sin a/a φ× + (1 - cos a)/a² (φ×)², a = |φ|, rad (Savage-20 Eq. 1), exact.

    The paper's series of the second coefficient is misprinted; it is 1/2! - a²/4! + a⁴/6! - ...
    """
    x, y, z = phi
    square = x * x + y * y + z * z
    if square < 1e-4:  # the next terms are below 1e-18
        sine = 1 - square * (1 / 6 - square * (1 / 120))
        cosine = 0.5 - square * (1 / 24 - square * (1 / 720))
    else:
        angle = sqrt(square)
        sine, half = sin(angle) / angle, sin(0.5 * angle) / angle
        cosine = 2 * half * half
    sx, sy, sz = sine * x, sine * y, sine * z
    xy, xz, yz = cosine * x * y, cosine * x * z, cosine * y * z
    return (
        (1 - cosine * (y * y + z * z), xy - sz, xz + sy),
        (xy + sz, 1 - cosine * (x * x + z * z), yz - sx),
        (xz - sy, yz + sx, 1 - cosine * (x * x + y * y)),
    )


def matrix_product(a: Matrix, b: Matrix) -> Matrix:
    """a b."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = b

    def row(r: Vector) -> Vector:
        i, j, k = r
        return (
            i * xx + j * yx + k * zx,
            i * xy + j * yy + k * zy,
            i * xz + j * yz + k * zz,
        )

    return row(a[0]), row(a[1]), row(a[2])


def orthonormalised(c: Matrix) -> Matrix:
    """A nearly orthonormal matrix C, one step nearer: C (3 I - CᵀC)/2.

    What is left of an error is its square.
    """
    (a, b, d), (e, f, g), (h, i, j) = matrix_product(tuple(zip(*c, strict=True)), c)  # type: ignore[arg-type]
    half: Matrix = (
        (1.5 - 0.5 * a, -0.5 * b, -0.5 * d),
        (-0.5 * e, 1.5 - 0.5 * f, -0.5 * g),
        (-0.5 * h, -0.5 * i, 1.5 - 0.5 * j),
    )
    return matrix_product(c, half)


def from_euler(roll: float, pitch: float, heading: float) -> Quaternion:
    """q_nb of roll, pitch and heading (rad): heading about down first, then pitch, then roll."""
    cr, sr = cos(0.5 * roll), sin(0.5 * roll)
    cp, sp = cos(0.5 * pitch), sin(0.5 * pitch)
    ch, sh = cos(0.5 * heading), sin(0.5 * heading)
    return (
        ch * cp * cr + sh * sp * sr,
        ch * cp * sr - sh * sp * cr,
        ch * sp * cr + sh * cp * sr,
        sh * cp * cr - ch * sp * sr,
    )


def to_euler(q: Quaternion) -> Vector:
    """Roll, pitch, heading (rad) of q_nb: roll and heading in -pi..pi, pitch in -pi/2..pi/2.

    At a pitch of ±90° only heading minus (plus) roll is defined; roll is then given as 0.
    """
    w, x, y, z = q
    sin_pitch = 2 * (w * y - x * z)
    forward_n, forward_e = 1 - 2 * (y * y + z * z), 2 * (x * y + w * z)
    cos_pitch = hypot(forward_n, forward_e)
    if cos_pitch < 1e-9:
        return (
            0.0,
            copysign(asin(1.0), sin_pitch),
            atan2(2 * (w * z - x * y), 1 - 2 * (x * x + z * z)),
        )
    roll = atan2(2 * (y * z + w * x), 1 - 2 * (x * x + y * y))
    return (roll, atan2(sin_pitch, cos_pitch), atan2(forward_e, forward_n))


def euler_angles(q: NDArray[np.float64]) -> NDArray[np.float64]:
    """`to_euler` for many, to rounding: (N, 4) quaternions to (N, 3) roll, pitch, heading, rad."""
    w, x, y, z = np.ascontiguousarray(q.T)
    sin_pitch = 2 * (w * y - x * z)
    forward_n, forward_e = 1 - 2 * (y * y + z * z), 2 * (x * y + w * z)
    cos_pitch = np.hypot(forward_n, forward_e)
    angles = np.empty((len(q), 3))
    angles[:, 0] = np.arctan2(2 * (y * z + w * x), 1 - 2 * (x * x + y * y))
    angles[:, 1] = np.arctan2(sin_pitch, cos_pitch)
    angles[:, 2] = np.arctan2(forward_e, forward_n)
    for row in np.flatnonzero(cos_pitch < 1e-9).tolist():  # straight up or down
        angles[row] = to_euler(tuple(q[row].tolist()))
    return angles


@dataclass(frozen=True)
class AxisMap:
    """Which sensor axis becomes which body axis, e.g. "y,x,-z" for a unit that is right-forward-up.

    Attributes:
        axes: sensor axis (0..2) of body x, y, z.
        signs: +1.0 or -1.0 for each.
    """

    axes: tuple[int, int, int]
    signs: tuple[float, float, float]

    @classmethod
    def parse(cls, text: str) -> AxisMap:
        """Read "y,x,-z": body x is the sensor's y, body y its x, body z its -z.

        Raises:
            InputError: not three distinct signed axes, or they do not form a right-handed frame.
        """
        names = [part.strip().lower() for part in text.split(",")]
        bare = [name.lstrip("+-") for name in names]
        if sorted(bare) != ["x", "y", "z"] or any(len(name) > 2 for name in names):
            raise InputError(
                f'axes: "{text}" is not allowed, give each of x, y, z once with an optional -,'
                ' as in "y,x,-z"'
            )
        axes = ["xyz".index(name) for name in bare]
        signs = [-1.0 if name.startswith("-") else 1.0 for name in names]
        matrix = np.zeros((3, 3))
        matrix[range(3), axes] = signs
        if np.linalg.det(matrix) < 0:
            raise InputError(
                f'axes: "{text}" is a mirror image, not a rotation, change the sign of one axis'
            )
        return cls((axes[0], axes[1], axes[2]), (signs[0], signs[1], signs[2]))

    def apply(self, vectors: NDArray[np.float64]) -> NDArray[np.float64]:
        """Vectors (N, 3) in sensor axes to body axes."""
        turned: NDArray[np.float64] = vectors[:, self.axes] * np.array(self.signs)
        return turned
