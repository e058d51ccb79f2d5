"""The host's numbers as pairs of floats, and as floats: arithmetic, flights, and programs in C."""

from __future__ import annotations

import ctypes
import math
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from sculler.host_c import HostInC, NavigatorInC, align_in_c, host_texts, library_texts
from sculler_model.design import Design
from sculler_model.host import MajorIncrements
from sculler_model.motion import at_rest
from sculler_model.navigation import Navigator, NavState, align, exact_increments, navigation_errors

pytestmark = pytest.mark.skipif(shutil.which("g++") is None, reason="needs g++")

DESIGN = Design.preset("stim300", position="high-resolution")

ARITHMETIC = """
#include "sculler_real.h"
extern "C" void all(const float *a, const float *b, float *out);
static void put(float *out, int place, sculler_real x)
{
    out[2 * place] = x.high;
    out[2 * place + 1] = x.low;
}
void all(const float *a, const float *b, float *out)
{
    sculler_real x(a[0], a[1]), y(b[0], b[1]);
    put(out, 0, x + y); put(out, 1, x - y); put(out, 2, x * y); put(out, 3, x / y);
    put(out, 4, sqrt(fabs(x))); put(out, 5, sin(x)); put(out, 6, cos(x)); put(out, 7, atan2(x, y));
    put(out, 8, asin(x * 0.0625)); put(out, 9, exp(x)); put(out, 10, log(fabs(x)));
}
"""
FUNCTIONS: dict[str, Callable[[float, float], float]] = {
    "sqrt": lambda x, y: math.sqrt(abs(x)),
    "sin": lambda x, y: math.sin(x),
    "cos": lambda x, y: math.cos(x),
    "atan2": lambda x, y: math.atan2(x, y),
    "asin": lambda x, y: math.asin(x / 16),
    "exp": lambda x, y: math.exp(x),
    "log": lambda x, y: math.log(abs(x)),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("pairs")
    for name, text in {**library_texts(), **host_texts(DESIGN)}.items():
        (folder / name).write_text(text)
    return folder


def called(folder: Path, *command: str) -> str:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stdout


def pair(number: Fraction) -> tuple[float, float]:
    high = np.float32(float(number))
    return float(high), float(np.float32(float(number - Fraction(float(high)))))


def test_arithmetic_and_functions(folder: Path) -> None:
    """Against exact rationals, and against doubles, whose functions are right to 2^-52."""
    (folder / "all.cpp").write_text(ARITHMETIC)
    flags = "-DSCULLER_DOUBLE_SINGLE -ffp-contract=off -std=c++11 -O1 -fPIC -shared".split()
    called(folder, "g++", *flags, "all.cpp", "-o", "all.so")
    library = ctypes.CDLL(str(folder / "all.so"))
    random, floats = np.random.default_rng(1), ctypes.c_float * 2
    out = (ctypes.c_float * 22)()
    largest = dict.fromkeys(FUNCTIONS, 0.0)
    for _ in range(3000):
        size = 10.0 ** random.uniform(-6, 1, 2) * random.choice([-1, 1], 2)
        a, b = (pair(Fraction(float(x))) for x in size)
        x, y = (Fraction(high) + Fraction(low) for high, low in (a, b))
        library.all(floats(*a), floats(*b), out)
        found = [Fraction(out[2 * k]) + Fraction(out[2 * k + 1]) for k in range(11)]
        for value, exact in zip(found[:4], (x + y, x - y, x * y, x / y), strict=True):
            assert abs(value - exact) <= abs(exact) / 2**44
        for k, (name, function) in enumerate(FUNCTIONS.items(), 4):
            exact = Fraction(function(float(x), float(y)))
            # sines and logarithms that nearly vanish are right against 1
            scale = max(abs(exact), Fraction(1)) if name in ("cos", "sin", "log") else abs(exact)
            largest[name] = max(largest[name], float(abs(found[k] - exact) / scale))
    assert max(largest.values()) < 2.0**-42, largest


START = NavState(0.0, (1.0, 0.0, 0.0, 0.0), (100.0, -20.0, 1.0), 0.7, -2.0, 500.0, 0.3)


def increments(count: int) -> MajorIncrements:
    random = np.random.default_rng(4)
    phi, dv = 2e-3 * random.normal(size=(count, 3)), 0.02 * random.normal(size=(count, 3))
    phi[::50] *= 100  # rotations that no series serves
    dv[:, 2] -= 0.0981
    return MajorIncrements(phi, phi, dv, 0.005 * dv)


@pytest.mark.parametrize(
    ("precision", "attitude", "velocity", "position", "least"),
    [
        ("double-single", 1e-11, 1e-8, 1e-5, 1e-14),
        pytest.param("single", 1e-4, 1e-1, 1e2, 1e-8, marks=pytest.mark.deep),
    ],
)
def test_flight(
    precision: str, attitude: float, velocity: float, position: float, least: float
) -> None:
    moved = increments(1000)
    expected = Navigator(START, DESIGN.major_interval).run(moved)
    found = NavigatorInC(HostInC(DESIGN, "-O0", precision=precision), START).run(moved)  # type: ignore[arg-type]
    errors = navigation_errors(found, expected)
    assert least < np.abs(errors.attitude).max() < attitude
    assert np.abs(errors.velocity).max() < velocity
    assert np.abs(errors.position).max() < position


@pytest.mark.deep
def test_alignment_in_pairs() -> None:
    T, random = DESIGN.major_interval, np.random.default_rng(2)
    exact = exact_increments(at_rest(0.8, 0.2, 300.0, 0.02, -0.03, 1.0), 6000, T)
    noisy = replace(exact, phi=exact.phi + 3e-7 * random.normal(size=(6000, 3)))
    expected = align(noisy, T, 0.8, 300.0)
    found = align_in_c(HostInC(DESIGN, precision="double-single"), noisy, 0.8, 300.0)
    assert np.abs(np.subtract(found.q, expected.q)).max() < 1e-6
    np.testing.assert_allclose(found.covariance, expected.covariance, rtol=1e-3, atol=1e-16)
    assert found.down_rate == pytest.approx(expected.down_rate, rel=1e-4)


PROGRAM = """
#include <stdio.h>
#include "sculler_telemetry.h"
int main(void)
{
    static sculler_nav nav;
    sculler_settings settings = sculler_defaults(sculler_real_of(0.01));
    sculler_state state;
    sculler_increments still;
    sculler_real none = sculler_real_of(0.0);
    state.time = none;
    state.q.w = sculler_real_of(1.0);
    state.q.x = state.q.y = state.q.z = none;
    state.v.x = state.v.y = state.v.z = none;
    state.lat = sculler_real_of(0.84);
    state.lon = none;
    state.h = sculler_real_of(500.0);
    state.wander = none;
    still.phi.x = still.phi.y = still.phi.z = none;
    still.alpha = still.phi;
    still.dv_sf = still.phi;
    still.dv_sf.z = sculler_real_of(-0.0980665);
    still.displaced = false;
    int error = (int)sculler_nav_begin(&nav, &settings, &state);
    for (int i = 0; i < 100; i++) {
        error += (int)sculler_nav_update(&nav, &still);
    }
    sculler_nav_state(&nav, &state);
    uint8_t frame[SCULLER_TELEMETRY_BYTES];
    sculler_telemetry_write(frame, &state, 7, 0);
    printf("%d %.9f %.9f %.12f\\n", error, sculler_double_of(state.time),
           sculler_double_of(state.v.z), sculler_double_of(state.lat));
    return 0;
}
"""


@pytest.mark.deep
def test_a_program_in_c_uses_a_library_of_pairs(folder: Path) -> None:
    """Compiled in C, with all warnings, and linked with the library's objects of C++."""
    (folder / "program.c").write_text(PROGRAM)
    warnings = "-Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Werror".split()
    pairs = ["-O1", "-ffp-contract=off", "-DSCULLER_DOUBLE_SINGLE", *warnings]
    sources = sorted(path.name for path in folder.glob("*.c") if path.name != "program.c")
    for source in sources:
        called(folder, "g++", "-x", "c++", "-std=c++11", *pairs, "-c", source)
    called(folder, "gcc", "-std=c99", *pairs, "-c", "program.c")
    objects = [f"{Path(source).stem}.o" for source in (*sources, "program.c")]
    called(folder, "gcc", *objects, "-o", "program", "-lm")
    error, time, down, lat = called(folder, "./program").split()
    assert (error, float(time)) == ("0", 1.0)
    level = NavState(0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.84, 0.0, 500.0)
    still = np.zeros((100, 3))
    pushed = np.tile([0.0, 0.0, -0.0980665], (100, 1))
    expected = Navigator(level, 0.01).run(MajorIncrements(still, still, pushed)).state(99)
    assert float(down) == pytest.approx(expected.v[2], abs=2e-9)
    assert float(lat) == pytest.approx(expected.lat, abs=2e-12)


def test_integers_beyond_a_float_are_refused_by_the_compiler(folder: Path) -> None:
    name = f"{DESIGN.name}_host"
    text = (folder / f"{name}.h").read_text()
    (folder / f"{name}.h").write_text(text.replace("_BITS ", "_BITS 99", 1))
    command = ["gcc", "-x", "c++", "-std=c++11", "-DSCULLER_DOUBLE_SINGLE", "-fsyntax-only"]
    done = subprocess.run(
        [*command, f"{name}.c"], cwd=folder, capture_output=True, text=True, check=False
    )
    (folder / f"{name}.h").write_text(text)
    assert done.returncode
    assert "beyond the range of a float: use doubles" in done.stderr
