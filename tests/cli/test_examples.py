"""The design files of examples/: each loads, and is what its comments say."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from sculler_model.design import Design

FOLDER = Path(__file__).parents[2] / "examples"


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.toml")), ids=lambda path: path.stem)
def test_loads_under_its_own_name(path: Path) -> None:
    assert Design.load(path).name == path.stem or path.stem in Design.load(path).name


def test_all_are_there() -> None:
    names = {path.stem for path in FOLDER.glob("*.toml")}
    assert names == {"stim300_4x5", "filtered_rate_2x10", "user_table_3x4", "hg4930", "lasergyro"}


def test_stim300_is_the_design_page() -> None:
    design = Design.load(FOLDER / "stim300_4x5.toml")
    assert design.as_json() == {
        "name": "stim300_4x5",
        "sensor": {
            "kind": "increment",
            "sample_rate_hz": 2000.0,
            "gyro": {"bits": 24, "lsb": 8.322346e-09},
            "accel": {"bits": 24, "lsb": 2.384186e-07},
        },
        "algorithm": {"family": "frequency-taylor", "samples": 4, "history": 0, "minors": 5},
        "hardware": {"core": "pipelined", "target": "generic", "handover": "parallel"},
    }
    assert design.major_interval == 0.01


def test_user_table_fits_a_quadratic_rate() -> None:
    """Coning of a quadratic rate, exactly: ½ ∫ (∫ω) x ω over three samples (Savage-20 Eq. 5)."""
    table = Design.load(FOLDER / "user_table_3x4.toml").table
    # x = t² and y = t on 0..3, for the angle about x and y: the samples are their differences
    x, y = [Fraction(2 * k + 1) for k in range(3)], [Fraction(1)] * 3
    x3 = [Fraction((k + 1) ** 3 - k**3) for k in range(3)]

    def algorithm(x: list[Fraction], y: list[Fraction]) -> Fraction:
        total = Fraction(0)
        for k in range(1, 4):
            for d in range(1, k):
                tap = Fraction(table.tap(k, d), table.denominator)
                total += tap * (x[k - 1 - d] * y[k - 1] - y[k - 1 - d] * x[k - 1])
        return total

    # the rest of ½ ∫ (X y' - Y x') dt that alpha x alpha cannot give: the same integral itself
    assert algorithm(x, y) == Fraction(1, 2) * (Fraction(9) - 2 * Fraction(9))  # ½ ∫ t² - 2 t² dt
    assert algorithm(x3, y) == Fraction(1, 2) * Fraction(-2 * 81, 4)  # ½ ∫ t³ - 3 t³ dt
    # a cubic and a square angle: ½ ∫ t³ 2t - t² 3t² dt = -½ 3⁵/5
    assert algorithm(x3, x) == -Fraction(1, 2) * Fraction(3**5, 5)
