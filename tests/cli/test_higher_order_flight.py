"""The demonstration's motion with order 2 and 4, from the truth to the navigated errors."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Run = Callable[..., Any]
Refused = Callable[..., str]

DESIGN = (
    'preset = "stim300"\nname = "d{0}"\n[algorithm]\norder = {0}\n[hardware]\ncore = "compact"\n'
)


@pytest.mark.deep
def test_order_four_leaves_hundreds_of_times_less(run: Run, tmp_path: Path) -> None:
    """Ten seconds: the third-order drift of coning in a turn, and of sculling."""
    log, truth, vectors = (tmp_path / name for name in ("imu.csv", "truth.csv", "vectors.csv"))
    left = {}
    for order in (2, 4):
        design = tmp_path / f"d{order}.toml"
        design.write_text(DESIGN.format(order))
        if order == 2:
            words = ("--design", design, "--duration", 10, "-o", log, "--truth", truth)
            assert run("motion", "demo", *words).status == 0
        assert run("model", design, log, "-o", vectors).status == 0
        words = ("-o", tmp_path / "nav.csv", "--truth", truth, "--no-plots", "--json")
        errors = json.loads(run("navigate", design, vectors, *words).out)["errors"]
        left[order] = [errors[kind]["total"]["max"] for kind in ("attitude_arcsec", "velocity_m_s")]
    assert left[4][0] < left[2][0] / 50
    assert left[4][1] < left[2][1] / 50


def test_navigate_refuses_its_own_third_order_of_order_four(
    run: Run, refused: Refused, tmp_path: Path
) -> None:
    design, log, vectors = (tmp_path / name for name in ("d.toml", "imu.csv", "vectors.csv"))
    design.write_text(DESIGN.format(4))
    log.write_text(
        "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\n" + "\n".join(["1,2,3,4,5,6"] * 40) + "\n"
    )
    assert run("model", design, log, "-o", vectors).status == 0
    where = ("--lat", 48, "--lon", 11, "--height", 0, "--no-plots", "-o", tmp_path / "nav.csv")
    said = refused("navigate", design, vectors, *where, "--third-order")
    assert "the integers of d4, with order = 4, hold these terms already" in said
