"""Quaternions, rotation vectors, Euler angles and axis maps, against scipy and plain geometry."""

from itertools import permutations
from itertools import product as all_of
from math import cos, pi, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sculler_model.errors import InputError
from sculler_model.frames import AxisMap, Quaternion, Vector, rotation

component = st.floats(-3, 3)
vectors = st.tuples(component, component, component)


def scipy_of(q: Quaternion) -> Rotation:
    return Rotation.from_quat([q[1], q[2], q[3], q[0]])


@given(vectors)
def test_rotation_vector_to_quaternion_is_scipys(phi: Vector) -> None:
    q = rotation.from_rotation_vector(phi)
    expected = Rotation.from_rotvec(phi).as_matrix()
    assert np.allclose(rotation.to_dcm(q), expected, atol=3e-15, rtol=0)


@pytest.mark.parametrize("angle", [1e-200, 1e-9, 1e-3, 9.9999e-3, 1.00001e-2, 0.3, 3.0, 7.0])
def test_rotation_vector_to_quaternion_is_exact_on_both_sides_of_the_switch(angle: float) -> None:
    w, x, y, z = rotation.from_rotation_vector((0.0, angle, 0.0))
    assert w == pytest.approx(cos(angle / 2), abs=2e-16)
    assert y == pytest.approx(sin(angle / 2), rel=3e-16, abs=0)
    assert x == z == 0


@given(vectors)
def test_rotation_vector_comes_back(phi: Vector) -> None:
    size = np.linalg.norm(phi)
    back = rotation.to_rotation_vector(rotation.from_rotation_vector(phi))
    if size < pi - 1e-6:
        assert np.allclose(back, phi, rtol=1e-13, atol=1e-15)
    else:
        assert np.linalg.norm(back) <= pi + 1e-9


@given(vectors)
def test_a_quaternion_and_its_negative_are_one_rotation(phi: Vector) -> None:
    w, x, y, z = rotation.from_rotation_vector(phi)
    one, other = (rotation.to_rotation_vector(q) for q in ((w, x, y, z), (-w, -x, -y, -z)))
    if abs(w) > 1e-9:  # at a half turn both signs are right
        assert one == other


@given(vectors, vectors, vectors)
def test_product_and_rotate_are_matrix_products(a: Vector, b: Vector, v: Vector) -> None:
    p, q = rotation.from_rotation_vector(a), rotation.from_rotation_vector(b)
    P, Q = np.array(rotation.to_dcm(p)), np.array(rotation.to_dcm(q))
    assert np.allclose(rotation.to_dcm(rotation.product(p, q)), P @ Q, atol=5e-15)
    assert np.allclose(rotation.rotate(p, v), P @ v, atol=1e-14)
    assert np.allclose(rotation.rotate(rotation.conjugate(p), v), P.T @ v, atol=1e-14)


@given(vectors)
def test_dcm_comes_back(phi: Vector) -> None:
    q = rotation.from_rotation_vector(phi)
    back = rotation.from_dcm(rotation.to_dcm(q))
    assert abs(np.dot(q, back)) == pytest.approx(1, abs=3e-15)
    assert back[0] >= 0


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.6, 0.8, 0)])
def test_dcm_of_a_half_turn_comes_back(axis: Vector) -> None:
    q = (0.0, *map(float, axis))
    assert np.allclose(np.abs(rotation.from_dcm(rotation.to_dcm(q))), np.abs(q), atol=1e-15)


@given(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1))
def test_euler_angles_are_heading_pitch_roll(roll: float, pitch: float, heading: float) -> None:
    q = rotation.from_euler(roll, pitch, heading)
    expected = Rotation.from_euler("ZYX", [heading, pitch, roll]).as_matrix()
    assert np.allclose(rotation.to_dcm(q), expected, atol=3e-15)
    assert np.allclose(rotation.to_euler(q), (roll, pitch, heading), atol=2e-14)


def test_a_vehicle_heading_east_and_climbing() -> None:
    q = rotation.from_euler(0.0, radians(10), radians(90))
    assert np.allclose(rotation.rotate(q, (1, 0, 0)), (0, cos(radians(10)), -sin(radians(10))))
    assert np.allclose(rotation.rotate(q, (0, 1, 0)), (-1, 0, 0), atol=1e-15)  # right is south


@pytest.mark.parametrize("pitch", [90, -90])
def test_straight_up_and_down_keep_the_attitude(pitch: float) -> None:
    q = rotation.from_euler(0.3, radians(pitch), 1.0)
    again = rotation.from_euler(*rotation.to_euler(q))
    assert np.allclose(rotation.to_dcm(q), rotation.to_dcm(again), atol=1e-9)
    assert rotation.to_euler(q)[0] == 0


def test_many_euler_angles_at_once() -> None:
    rows = [(0.1, 0.2, 0.3), (-0.1, -1.0, 3.0)]
    q = np.array([rotation.from_euler(*row) for row in rows])
    assert np.allclose(rotation.euler_angles(q), rows)
    # straight up and down among others: as one by one
    q = np.array([q[0], [0.5**0.5, 0, 0.5**0.5, 0], [0.5, -0.5, -0.5, -0.5], q[1]])
    one_by_one = [rotation.to_euler(tuple(row)) for row in q.tolist()]
    # to rounding: numpy's arctangent may differ from the interpreter's in the last bit
    assert np.abs(rotation.euler_angles(q) - one_by_one).max() < 5e-16
    assert rotation.euler_angles(np.zeros((0, 4))).shape == (0, 3)


def _all_maps() -> list[tuple[str, np.ndarray]]:
    out = []
    for axes in permutations(range(3)):
        for signs in all_of((1, -1), repeat=3):
            matrix = np.zeros((3, 3))
            for row, (axis, sign) in enumerate(zip(axes, signs, strict=True)):
                matrix[row, axis] = sign
            names = [("-" if s < 0 else "") + "xyz"[a] for a, s in zip(axes, signs, strict=True)]
            out.append((",".join(names), matrix))
    return out


@pytest.mark.parametrize(("text", "matrix"), _all_maps())
def test_axis_maps_are_rotations_or_refused(text: str, matrix: np.ndarray) -> None:
    if np.isclose(np.linalg.det(matrix), -1):
        with pytest.raises(InputError, match="mirror image"):
            AxisMap.parse(text)
        return
    vectors = np.random.default_rng(0).normal(size=(4, 3))
    assert np.array_equal(AxisMap.parse(text).apply(vectors), vectors @ matrix.T)


def test_right_forward_up_becomes_forward_right_down() -> None:
    right_forward_up = np.array([[1.0, 2.0, 3.0]])
    assert AxisMap.parse(" Y, +x ,-z").apply(right_forward_up).tolist() == [[2.0, 1.0, -3.0]]


@pytest.mark.parametrize("text", ["", "x,y", "x,y,z,x", "x,x,z", "a,b,c", "x,--y,z", "x y z"])
def test_axis_map_faults_are_named(text: str) -> None:
    with pytest.raises(InputError, match=r"axes: .* is not allowed, give each of x, y, z once"):
        AxisMap.parse(text)
