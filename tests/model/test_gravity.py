"""Gravity: the normal field against zonal harmonics in 60 digits; constants and tables."""

from __future__ import annotations

from decimal import Decimal, localcontext
from functools import cache, partial
from math import cos, radians, sin, sqrt
from typing import Any

import numpy as np
import pytest

from sculler_model.errors import InputError
from sculler_model.frames import earth
from sculler_model.host import MajorIncrements
from sculler_model.motion import at_rest
from sculler_model.navigation import (
    NORMAL,
    GeographicNavigator,
    Gravity,
    Navigator,
    align,
    constant_gravity,
    exact_increments,
    gravity_at,
    table_of_gravity,
)
from sculler_model.navigation.compiled import compiled_run
from sculler_model.navigation.gravity import covers, refuse_outside

A, GM, RATE = Decimal(6378137), Decimal("3.986004418e14"), Decimal("7.292115e-5")
F = 1 / Decimal("298.257223563")
SINES = [-1.0, -0.99999, -0.87, -0.4, 0.0, 1e-9, 0.1, 0.70710678, 0.95, 0.999, 1.0]
HEIGHTS = [-10e3, -1.0, 0.0, 5e3, 10e3, 20e3, 100e3, 400e3, 990e3, 1000e3]


@cache
def zonal_harmonics(degrees: int = 15) -> tuple[Decimal, list[Decimal]]:
    """E² and J_2, J_4, ... of the level ellipsoid (Heiskanen and Moritz, Eq. 2-90 to 2-92)."""
    with localcontext() as context:
        context.prec = 60
        e2 = F * (2 - F)
        b = A * (1 - F)
        second = ((A * A - b * b) / (b * b)).sqrt()
        arctan = sum((-1) ** k * second ** (2 * k + 1) / (2 * k + 1) for k in range(40))
        q0 = ((1 + 3 / second**2) * arctan - 3 / second) / 2
        m = RATE**2 * A * A * b / GM
        j2 = e2 / 3 * (1 - 2 * m * second / (15 * q0))
        return e2 * A * A, [
            (-1) ** (n + 1) * 3 * e2**n / ((2 * n + 1) * (2 * n + 3)) * (1 - n + 5 * n * j2 / e2)
            for n in range(1, degrees + 1)
        ]


def by_harmonics(sin_lat: float, height: float) -> tuple[float, float]:
    """Gravity north and down (m/s²), by V = GM/r (1 - Σ J_2n (A/r)^2n P_2n) and ω²p²/2."""
    focus, harmonics = zonal_harmonics()
    with localcontext() as context:
        context.prec = 60
        s, h = Decimal(sin_lat), Decimal(height)
        c = (1 - s * s).sqrt()
        e2 = focus / (A * A)
        normal = A / (1 - e2 * s * s).sqrt()
        p, z = (normal + h) * c, (normal * (1 - e2) + h) * s
        r = (p * p + z * z).sqrt()
        t = z / r
        # Legendre polynomials and their derivatives, by recursion
        P, dP = [Decimal(1), t], [Decimal(0), Decimal(1)]
        for n in range(2, 2 * len(harmonics) + 1):
            P.append(((2 * n - 1) * t * P[n - 1] - (n - 1) * P[n - 2]) / n)
            dP.append(n * P[n - 1] + t * dP[n - 1])
        along_r, along_t = Decimal(1), Decimal(0)
        for n, J in enumerate(harmonics, start=1):
            part = J * (A / r) ** (2 * n)
            along_r -= (2 * n + 1) * part * P[2 * n]
            along_t -= part * dP[2 * n]
        # ∂t/∂p = -z p/r³, ∂t/∂z = p²/r³
        g_p = -GM / r**2 * along_r * p / r - GM / r * along_t * z * p / r**3 + RATE**2 * p
        g_z = -GM / r**2 * along_r * z / r + GM / r * along_t * p * p / r**3
        return float(-s * g_p + c * g_z), float(-c * g_p - s * g_z)


def test_the_harmonics_are_those_of_wgs84() -> None:
    """NIMA TR8350.2, Table 3.3 and its C_20."""
    _, (j2, j4, j6, j8, *_) = zonal_harmonics()
    assert float(j2) == pytest.approx(0.484166774985e-3 * sqrt(5), abs=1e-12)
    assert float(j4) == pytest.approx(-2.37091e-6, abs=1e-10)
    assert float(j6) == pytest.approx(6.08347e-9, abs=1e-13)
    assert float(j8) == pytest.approx(-1.42681e-11, abs=1e-15)


@pytest.mark.parametrize("height", HEIGHTS)
@pytest.mark.parametrize("sin_lat", SINES)
def test_normal_gravity_is_that_of_the_harmonics(sin_lat: float, height: float) -> None:
    lean, down = earth.normal_gravity(sin_lat, height)
    north, true = by_harmonics(sin_lat, height)
    assert down == pytest.approx(true, rel=0, abs=2e-14)
    assert sqrt(1 - sin_lat**2) * lean == pytest.approx(north, rel=0, abs=4e-15)


@pytest.mark.parametrize("height", [-10e3, 0.0, 9e3, 1000e3])
@pytest.mark.parametrize("sin_lat", [-0.99, 0.0, 0.3, 0.8])
def test_normal_gravity_is_the_slope_of_the_closed_potential(sin_lat: float, height: float) -> None:
    """Heiskanen and Moritz, Eq. 2-62 with 2-126, differentiated by mpmath in 40 digits.

    V = GM/E arctan(E/u) + ½ ω² a² q/q_0 (sin²β - 1/3) + ½ ω² p²
    """
    mp = pytest.importorskip("mpmath", reason="mpmath is missing").mp.clone()
    mp.dps = 40
    a, f = mp.mpf(6378137), 1 / mp.mpf("298.257223563")
    rate, e2, b = mp.mpf("7.292115e-5"), f * (2 - f), a * (1 - f)
    focus = a * mp.sqrt(e2)

    def q(u: Any) -> Any:
        return ((1 + 3 * u**2 / focus**2) * mp.atan(focus / u) - 3 * u / focus) / 2

    def potential(p: Any, z: Any) -> Any:
        inner = p**2 + z**2 - focus**2
        u2 = (inner + mp.sqrt(inner**2 + 4 * focus**2 * z**2)) / 2
        u, sin2 = mp.sqrt(u2), z**2 / u2
        turning = rate**2 * (a**2 * q(u) / q(b) * (sin2 - mp.mpf(1) / 3) + p**2) / 2
        return mp.mpf("3.986004418e14") / focus * mp.atan(focus / u) + turning

    s, h = mp.mpf(sin_lat), mp.mpf(height)
    c, normal = mp.sqrt(1 - s**2), a / mp.sqrt(1 - e2 * s**2)
    at = (normal + h) * c, (normal * (1 - e2) + h) * s
    g_p, g_z = mp.diff(potential, at, (1, 0)), mp.diff(potential, at, (0, 1))
    lean, down = earth.normal_gravity(sin_lat, height)
    assert float(-c * g_p - s * g_z - down) == pytest.approx(0, abs=1e-9)
    assert float(-s * g_p + c * g_z - c * lean) == pytest.approx(0, abs=1e-9)
    assert float(-c * g_p - s * g_z - down) == pytest.approx(0, abs=2e-14)


def test_published_figures() -> None:
    """NIMA TR8350.2, Table 3.4; the free-air gradient; the lean that Groves gives (Eq. 2.140)."""
    assert earth.gravity(0.0, 0.0) == pytest.approx(9.7803253359, abs=5e-11)
    assert earth.gravity(1.0, 0.0) == pytest.approx(9.8321849378, abs=1e-10)
    assert earth.gravity(0.0, 0.0) == earth.GRAVITY_EQUATOR
    assert earth.gravity(0.0, 0.0) - earth.gravity(0.0, 1.0) == pytest.approx(3.0877e-6, abs=1e-9)
    for lat in (0.2, 0.8, -1.2):
        assert abs(earth.gravity_lean(sin(lat), 0.0)) < 2e-17  # square to the ellipsoid
        north = cos(lat) * earth.gravity_lean(sin(lat), 5e3)
        assert north == pytest.approx(-8.08e-9 * 5e3 * sin(2 * lat), rel=0.01, abs=0)


def test_arrays_and_floats_agree() -> None:
    sines, heights = np.linspace(-0.99, 0.99, 7), np.linspace(0, 900e3, 7)
    singly = [
        earth.normal_gravity(*at) for at in zip(sines.tolist(), heights.tolist(), strict=True)
    ]
    assert np.allclose(np.stack(earth.normal_gravity(sines, heights), 1), singly, rtol=1e-15)


def local(value: float, lat: float = 0.8, h: float = 400.0) -> Gravity:
    return table_of_gravity(np.array([lat]), np.array([h]), np.array([[value]]))


def test_a_constant_is_the_same_everywhere() -> None:
    assert gravity_at(constant_gravity(9.81), 0.3, 5e3) == (0.0, 9.81)
    assert constant_gravity().value == 9.80665
    assert str(constant_gravity(9.81)) == "constant, 9.81 m/s²"
    assert str(NORMAL) == "normal field of WGS-84"


def test_a_measured_value_holds_everywhere_as_an_excess() -> None:
    model = local(earth.gravity(sin(0.8), 400.0) + 3e-4)
    for lat, h in ((0.8, 400.0), (-1.5, -5e3), (0.1, 900e3)):
        lean, down = gravity_at(model, sin(lat), h)
        assert down == pytest.approx(earth.gravity(sin(lat), h) + 3e-4, abs=1e-14)
        assert lean == earth.gravity_lean(sin(lat), h)
        assert covers(model, lat, h)
    assert not covers(model, 0.8, 1.1e6)
    assert "30 mGal" in str(model)


def test_a_table_is_met_at_its_points_and_straight_in_between() -> None:
    lats, heights = np.radians([40.0, 50.0, 52.0]), np.array([0.0, 1000.0])
    excess = np.array([[0.0, 4.0], [2.0, 6.0], [-1.0, 0.0]]) * 1e-4
    values = earth.gravity(np.sin(lats)[:, None], heights) + excess
    model = table_of_gravity(lats, heights, values)
    for i, lat in enumerate(lats.tolist()):
        for j, h in enumerate(heights.tolist()):
            assert gravity_at(model, sin(lat), h)[1] == pytest.approx(values[i, j], abs=1e-13)
    # halfway in latitude and a quarter of the height: (3/4 (2 - 1) + 1/4 (6 + 0))/2
    lat, h = radians(51.0), 250.0
    down = earth.gravity(sin(lat), h) + (0.75 * 1 + 0.25 * 6) / 2 * 1e-4
    assert gravity_at(model, sin(lat), h)[1] == pytest.approx(down, abs=1e-13)
    assert covers(model, radians(40.0), 0.0)
    assert not covers(model, radians(39.99), 0.0)
    assert not covers(model, radians(45), -0.1)


REST = at_rest(radians(47.0), 0.1, 400.0, heading=1.0)


@pytest.mark.parametrize("kind", ["wander", "geographic", "compiled"])
@pytest.mark.parametrize("excess", [2e-3, -1e-3])
def test_navigators_fall_by_what_the_model_has_more(kind: str, excess: float) -> None:
    """At rest in normal gravity for 10 s: ½·excess·t², as a constant and as a table."""
    if kind == "compiled" and compiled_run() is None:
        pytest.skip("Numba (extra `fast`) is missing")
    increments = exact_increments(REST, 1000, 0.01)
    start = REST.state(np.zeros(1)).state(0)
    here = earth.gravity(sin(start.lat), start.h)
    for model in (constant_gravity(here + excess), local(here + excess, start.lat, start.h)):
        if kind == "geographic":
            end = GeographicNavigator(start, 0.01, model).run(increments).state(-1)
        else:
            navigator = Navigator(start, 0.01, gravity=model)
            end = navigator.run(increments, compiled=kind == "compiled").state(-1)
        assert end.v[2] == pytest.approx(excess * 10, rel=1e-4, abs=0)
        assert end.h - start.h == pytest.approx(-50 * excess, rel=1e-4, abs=0)


@pytest.mark.parametrize("kind", ["wander", "geographic", "compiled"])
def test_a_track_that_leaves_the_table_is_told(kind: str) -> None:
    if kind == "compiled" and compiled_run() is None:
        pytest.skip("Numba (extra `fast`) is missing")
    start = REST.state(np.zeros(1)).state(0)._replace(v=(1000.0, 0.0, 0.0))
    lats = start.lat + np.radians([-1.0, 0.05])  # 5.6 km ahead
    model = table_of_gravity(lats, np.array([0.0]), np.full((2, 1), 9.81))
    block = MajorIncrements(*np.zeros((2, 1000, 3)), np.tile([0.0, 0.0, -0.0981], (1000, 1)))
    navigator = (
        GeographicNavigator(start, 0.01, model)
        if kind == "geographic"
        else Navigator(start, 0.01, gravity=model)
    )
    run = navigator.run
    if isinstance(navigator, Navigator):
        run = partial(navigator.run, compiled=kind == "compiled")
    with pytest.raises(
        InputError, match=r"time 5\.\d+ s: .* outside the gravity table \(latitudes"
    ):
        run(block)
    with pytest.raises(InputError, match="outside the gravity table"):
        type(navigator)(start._replace(lat=0.0), 0.01, gravity=model)


def test_alignment_holds_the_force_against_the_model() -> None:
    increments = exact_increments(REST, 3000, 0.01)
    found = align(increments, 0.01, REST.lat, REST.h, gravity=constant_gravity(9.79))
    assert found.gravity == 9.79
    assert any("off gravity" in warning for warning in found.warnings)
    assert (
        align(increments, 0.01, REST.lat, REST.h).gravity
        == gravity_at(NORMAL, sin(REST.lat), 400)[1]
    )


def test_where_a_table_ends_is_told() -> None:
    heights = np.array([0.0, 900.0])
    two = table_of_gravity(np.radians([47.0, 48.5]), heights, np.full((2, 2), 9.8))
    with pytest.raises(InputError) as raised:
        refuse_outside(two, 7.25, radians(46.9), 500.0)
    assert str(raised.value) == (
        "time 7.250 s: latitude 46.9° and height 500 m are outside the gravity table (latitudes"
        " 47 to 48.5°, heights 0 to 900 m), extend it"
    )
    one = table_of_gravity(np.radians([47.0]), heights, np.full((1, 2), 9.8))
    with pytest.raises(InputError, match=r"\(latitudes all°, heights 0 to 900 m\)"):
        refuse_outside(one, 0.0, 0.0, 901.0)
    refuse_outside(one, 0.0, 0.0, 900.0)
    for height in (-10_001.0, 1_000_001.0, float("nan")):
        with pytest.raises(InputError, match="the height has run away"):
            refuse_outside(NORMAL, 0.0, 0.0, height)
    for height in (-10_000.0, 1_000_000.0):
        refuse_outside(NORMAL, 0.0, 0.0, height)


@pytest.mark.parametrize("value", [980.665, 1.0, float("nan"), -9.8])
def test_gravity_in_other_units_is_refused(value: float) -> None:
    with pytest.raises(InputError, match=r"constant gravity .* give m/s² from 5 to 10"):
        constant_gravity(value)
    with pytest.raises(InputError, match=r"gravity table: .* give m/s² from 5 to 10"):
        local(value)


@pytest.mark.parametrize(
    ("lats", "heights", "message"),
    [
        ([0.5, 0.4], [0.0], "the latitudes must rise"),
        ([0.5, 1.6], [0.0], "the latitudes must rise"),
        ([0.5, 0.6], [0.0, 0.0], "the heights must rise"),
        ([0.5, 0.6], [0.0, 2e6], "the heights must rise"),
        ([0.5], [0.0, float("nan")], "the heights must rise"),
        ([], [], "do not fit"),
    ],
)
def test_tables_that_are_none(lats: list[float], heights: list[float], message: str) -> None:
    values = np.full((len(lats), len(heights)), 9.8)
    with pytest.raises(InputError, match=message):
        table_of_gravity(np.array(lats), np.array(heights), values)
