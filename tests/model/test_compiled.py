"""Whole arrays, compiled: the same numbers as one result at a time."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from dataclasses import replace
from math import cos, radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler_model.errors import InputError
from sculler_model.host import MajorIncrements
from sculler_model.motion import turn_motion
from sculler_model.navigation import (
    NORMAL,
    Gravity,
    HeightDamping,
    NavHistory,
    Navigator,
    NavState,
    compiled_run,
    constant_gravity,
    exact_increments,
)
from sculler_model.navigation import navigator as module

NAMES = ("time", "q", "v", "lat", "lon", "h", "wander")
WHERE = turn_motion(rocking=radians(1), shaking=3.0)
START = WHERE.state(np.zeros(1)).state(0)

needs_numba = pytest.mark.skipif(compiled_run() is None, reason="Numba (extra `fast`) is missing")


def same(a: NavHistory, b: NavHistory) -> bool:
    return all(
        np.allclose(getattr(a, name), getattr(b, name), rtol=1e-15, atol=1e-15) for name in NAMES
    )


@pytest.fixture(scope="module")
def increments() -> MajorIncrements:
    return exact_increments(WHERE, 300, 0.01)


@needs_numba
@pytest.mark.parametrize("position_every", [1, 3])
@pytest.mark.parametrize("damping", [None, HeightDamping(500.0, 20.0)])
@pytest.mark.parametrize("fine", [False, True])
def test_run_is_update_many_times(
    increments: MajorIncrements, position_every: int, damping: HeightDamping | None, fine: bool
) -> None:
    ways = 0.005 * increments.dv_sf if fine else None
    increments = replace(increments, dr_sf=ways)

    def navigator() -> Navigator:
        return Navigator(START, 0.01, position_every=position_every, height_damping=damping)

    live = navigator()
    states = [
        live.update(*(tuple(row) for row in rows))
        for rows in zip(
            increments.phi.tolist(),
            increments.dv_sf.tolist(),
            *([ways.tolist()] if ways is not None else []),
            strict=True,
        )
    ]
    whole = navigator().run(increments, compiled=True)
    assert same(navigator().run(increments, compiled=False), whole)
    assert same(NavHistory.from_states(states), whole)
    # in parts, and some of them one at a time
    mixed = navigator()
    parts = [mixed.run(increments[:100], compiled=True)]
    for i in range(100, 107):
        rows = [increments.phi[i], increments.dv_sf[i], *([] if ways is None else [ways[i]])]
        parts.append(NavHistory.from_states([mixed.update(*(tuple(r.tolist()) for r in rows))]))
    parts.append(mixed.run(increments[107:], compiled=True))
    assert same(NavHistory.concatenate(parts), whole)
    assert mixed.state == whole.state(-1)


@needs_numba
@pytest.mark.parametrize("gravity", [NORMAL, constant_gravity()])
@pytest.mark.parametrize("position_every", [1, 3])
@pytest.mark.parametrize("damping", [None, HeightDamping(500.0, 20.0)])
@pytest.mark.parametrize("fine", [False, True])
def test_compiled_updates_are_the_run_to_the_last_bit(
    increments: MajorIncrements,
    gravity: Gravity,
    position_every: int,
    damping: HeightDamping | None,
    fine: bool,
) -> None:
    ways = 0.005 * increments.dv_sf if fine else None
    increments = replace(increments, dr_sf=ways)

    def navigator(compiled: bool | None) -> Navigator:
        return Navigator(
            START,
            0.01,
            position_every=position_every,
            height_damping=damping,
            gravity=gravity,
            compiled=compiled,
        )

    whole = navigator(None).run(increments, compiled=True)
    rows = [increments.phi, increments.dv_sf, *([] if ways is None else [ways])]
    live = navigator(True)
    for i in range(len(increments)):
        found = live.update(*(array[i] for array in rows))
        assert found == live.state == whole.state(i)
        assert {type(x) for x in (found.time, *found.q, *found.v, *found[3:])} == {float}
    # blocks and single updates of one navigator, in Python in between
    mixed = navigator(True)
    parts = [mixed.run(increments[:50]), mixed.run(increments[50:120], compiled=True)]
    singles = [mixed.update(*(array[i].tolist() for array in rows)) for i in range(120, 200)]
    parts += [NavHistory.from_states(singles), mixed.run(increments[200:])]
    for name in NAMES:
        assert np.array_equal(getattr(NavHistory.concatenate(parts), name), getattr(whole, name))
    assert mixed.position_dcm == live.position_dcm
    assert same(navigator(True).run(increments, compiled=False), whole)


@needs_numba
@pytest.mark.parametrize("compiled", [None, True])
def test_what_an_update_refuses_leaves_the_state(compiled: bool | None) -> None:
    live = Navigator(START, 0.01, compiled=compiled)
    still = (0.0, 0.0, 0.0)
    for phi, message in (
        ((0.0, float("nan"), 0.0), "an increment is not finite"),
        ((0.0, 1.0), "phi: tuple is not allowed"),
        (("0", "0", "0"), "phi: tuple is not allowed"),
        (np.zeros((3, 1)), r"phi: ndarray of shape \(3, 1\) is not allowed"),
        ([0.0, 1j, 0.0], "phi: list is not allowed"),
    ):
        with pytest.raises(InputError, match=message):
            live.update(phi, still)  # type: ignore[arg-type]
        assert live.state is START
    after = live.update(np.zeros(3, np.float32), [0, 0, np.int16(-1)])
    assert after == Navigator(START, 0.01, compiled=compiled).update(still, (0.0, 0.0, -1.0))


@needs_numba
def test_a_height_that_runs_away_is_told_by_compiled_updates() -> None:
    live = Navigator(START, 0.01, compiled=True)
    with pytest.raises(
        InputError, match=r"time 0\.010 s: the height has run away to -5.927e\+04 m"
    ):
        live.update((0.0, 0.0, 0.0), (0.0, 0.0, 1.2e7))
    # half of 1.2e7 m/s over 10 ms, banked by 5 degrees
    assert live.state.h == pytest.approx(START.h - 60_000 * cos(radians(5)), rel=1e-3)


@needs_numba
def test_arrays_of_any_kind_take_the_same_code(increments: MajorIncrements) -> None:
    """Numba compiles anew for arrays that may not be written to or lie otherwise in memory."""
    whole = Navigator(START, 0.01).run(increments, compiled=True)
    run: Any = compiled_run()
    loaded = list(run.signatures)
    kept = np.asfortranarray(increments.phi)
    kept.flags.writeable = False
    other = replace(increments, phi=kept, dv_sf=increments.dv_sf.astype(object))
    found = Navigator(START, 0.01).run(other, compiled=True)
    assert run.signatures == loaded
    assert np.array_equal(found.to_numpy(), whole.to_numpy())


@needs_numba
def test_long_runs_are_compiled_by_themselves(monkeypatch: pytest.MonkeyPatch) -> None:
    """From so many intervals on, whether they come at once or in blocks."""
    asked = []
    monkeypatch.setattr(module, "compiled_run", lambda: asked.append(True))
    monkeypatch.setattr(module, "WORTH_COMPILING", 250)
    navigator = Navigator(START, 1e-3)
    nothing = MajorIncrements(*np.zeros((3, 100, 3)))
    for expected in (0, 0, 1, 2):
        navigator.run(nothing)
        assert len(asked) == expected


def test_what_is_kept_knows_the_text_of_what_was_compiled() -> None:
    """Numba cannot read what it kept of types that are gone, and knows no file but the caller's."""
    pytest.importorskip("numba")
    modules = ("frames/earth", "navigation/gravity", "frames/rotation", "navigation/wander")
    room = Path(module.__file__).parents[1]
    text = "".join((room / f"{name}.py").read_text() for name in modules)
    digest = hashlib.sha256(text.encode()).hexdigest()
    compiled: Any = compiled_run()
    assert compiled.py_func.__qualname__ == f"loop_{digest[:16]}"


def test_numba_is_not_needed() -> None:
    """Without it the loop is Python's, and only who insists is told."""
    code = """
import sys
sys.modules["numba"] = None
import numpy as np
from sculler_model.errors import InputError
from sculler_model.errors import InputError
from sculler_model.host import MajorIncrements
from sculler_model.navigation import Navigator, NavState, navigator
navigator.WORTH_COMPILING = 1
start = NavState(0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.8, 0.2, 100.0)
nothing = MajorIncrements(*np.zeros((3, 3, 3)))
assert len(Navigator(start, 0.01).run(nothing)) == 3
for insisting in (
    lambda: Navigator(start, 0.01).run(nothing, compiled=True),
    lambda: Navigator(start, 0.01, compiled=True),
):
    try:
        insisting()
    except InputError as error:
        assert "install sculler[fast]" in str(error)
    else:
        raise AssertionError("no word")
"""
    subprocess.run([sys.executable, "-c", code], check=True)


def test_no_intervals() -> None:
    nothing = Navigator(START, 0.01).run(MajorIncrements(*np.zeros((3, 0, 3))))
    assert len(nothing) == 0
    assert nothing.q.shape == (0, 4)


@pytest.mark.parametrize("compiled", [False, None])
def test_arrays_of_other_lengths_are_refused(
    increments: MajorIncrements, compiled: bool | None
) -> None:
    navigator = Navigator(START, 0.01)
    message = r"increments: shapes \(300, 3\), \(300, 3\), \(299, 3\) differ"
    with pytest.raises(InputError, match=message):
        navigator.run(replace(increments, dr_sf=increments.dv_sf[1:]), compiled=compiled)
    assert navigator.state == START


@needs_numba
def test_the_quaternions_keep_their_length() -> None:
    """No drift, by construction: each step squares what is left of the last one's error.

    `rotation.normalised` takes a length of 1 + ε to 1 - 3/2 ε², so after any number of updates
    the length is off by the rounding of the last: after 10⁴ and after 10⁶ the same.  For more,
    say how many in SCULLER_UPDATES.
    """
    updates = int(os.environ.get("SCULLER_UPDATES", 10**6))
    start = NavState(0.0, (1.0, 0.0, 0.0, 0.0), (250.0, -100.0, 0.0), 0.7, 0.2, 0.0)
    navigator = Navigator(start, 10 / updates)  # ten seconds of free fall
    block = MajorIncrements(*np.zeros((3, 10_000, 3)))
    block.phi[:] = [0.01, -0.02, 0.015]
    worst = []
    for _ in range(updates // 10_000):
        length = np.linalg.norm(navigator.run(block).q, axis=1)
        worst.append(np.abs(length - 1).max())
    assert max(worst) < 5e-16
    place = navigator._stepping.level.place
    assert abs(sum(c * c for c in place) - 1) < 1e-15


def test_a_process_of_our_own_loads_numba_without_scipy() -> None:
    """In a process of its own; what is compiled runs, and SciPy can be imported afterwards."""
    pytest.importorskip("numba")
    pytest.importorskip("scipy")
    script = """
import sys
from sculler_model import machine_code
machine_code.alone()
from sculler_model.navigation import compiled_run
assert compiled_run() is not None
assert "numba.np.arraymath" in sys.modules
assert not [name for name in sys.modules if name.startswith("scipy")]
import scipy.linalg
"""
    subprocess.run([sys.executable, "-c", script], check=True)
