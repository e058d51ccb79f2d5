"""Quantisation: the bilinear form against the algorithm itself, theory against Monte Carlo."""

from __future__ import annotations

from dataclasses import replace
from math import radians

import numpy as np
import pytest

from host_path import fine_design
from sculler_model.analysis.integer_path import unquantised
from sculler_model.analysis.quantisation import deviation, form, levels, monte_carlo, products_with
from sculler_model.design import Design

CASES = [(2, 0, 3, "increment"), (3, 2, 2, "increment"), (2, 0, 2, "rate"), (4, 0, 1, "rate")]


def designed(samples: int, history: int, minors: int, kind: str) -> Design:
    return fine_design(samples, history, minors, kind=kind, rate=1.0 if kind == "rate" else 2000.0)


@pytest.mark.parametrize("case", CASES)
def test_the_form_is_the_correction_of_the_whole_record(case: tuple[int, int, int, str]) -> None:
    """s_xᵀ K s_y against the algorithm, its major intervals put together to second order."""
    design = designed(*case)
    s = np.random.default_rng(1).normal(size=(6 * design.samples_per_major, 3))
    phi, alpha = unquantised(design, np.hstack([s, np.zeros_like(s)]))
    before = np.cumsum(alpha, axis=0) - alpha
    whole = (phi - alpha + 0.5 * np.cross(before, alpha)).sum(axis=0)
    found = s[:, 0] @ products_with(design.table, s[:, 1])
    assert found == pytest.approx(whole[2], rel=1e-12)
    assert s[:, 1] @ products_with(design.table, s[:, 0]) == pytest.approx(-whole[2], rel=1e-12)


@pytest.mark.parametrize("case", CASES[:2])
def test_only_near_remainders_meet_where_all_samples_count_alike(
    case: tuple[int, int, int, str],
) -> None:
    design = designed(*case)
    B = form(design.table, 8)
    reach = design.table.reach + design.table.samples
    far = np.abs(np.subtract.outer(np.arange(len(B)), np.arange(len(B)))) > reach + 1
    assert np.abs(B[far]).max() < 1e-13
    assert np.abs(B).max() > 0.5


def test_far_remainders_meet_where_weights_differ() -> None:
    B = form(designed(*CASES[2]).table, 8)
    assert abs(B[2, -3]) > 0.1


def test_theory_of_a_record_is_its_matrix() -> None:
    """The square term by the whole matrix, at an LSB so large that it rules."""
    design = fine_design(4, rate=2000.0)
    n, minors = 4, 60
    square = float(np.sum(form(design.table, minors) ** 2))
    expected = np.sqrt(1 / 144 * square) / (n * minors / 2000.0)
    found = deviation(design, 1e-9, 50.0, 1.0, n * minors)
    assert found == pytest.approx(expected, rel=0.03)  # the record's ends


@pytest.mark.parametrize(
    "case", [(4, 0, 5, "increment"), (2, 1, 4, "increment"), (2, 0, 2, "rate")]
)
def test_monte_carlo_agrees_with_theory(case: tuple[int, int, int, str]) -> None:
    samples, history, minors, kind = case
    design = fine_design(samples, history, minors, kind=kind)
    trials, ratios = 60, []
    for lsb in (3e-9, 4e-7):
        level = monte_carlo(design, radians(0.1), 37.0, lsb, trials, seed=2)
        assert abs(level.mean) < 4 * level.theory / np.sqrt(trials)
        ratios.append(level.deviation / level.theory)
        assert (level.angle_error is None) == (kind == "rate")
        assert level.angle_error is None or 0 < level.angle_error <= 1.001
    assert np.sqrt(np.mean(np.square(ratios))) == pytest.approx(1, abs=0.25)


def test_drift_grows_with_the_lsb_and_the_seed_decides() -> None:
    design, angle = fine_design(4, minors=5), radians(0.1)
    one, two = (monte_carlo(design, angle, 50.0, lsb, 20, seed=5) for lsb in (1e-9, 1e-7))
    assert two.deviation / one.deviation == pytest.approx(100, rel=0.6)
    assert two.theory / one.theory == pytest.approx(100, rel=1e-3)
    assert monte_carlo(design, angle, 50.0, 1e-9, 20, seed=5) == one
    assert monte_carlo(design, angle, 50.0, 1e-9, 20, seed=6) != one
    assert replace(one, mean=0.0) != one


def test_levels_span_what_32_bits_hold() -> None:
    for kind in ("increment", "rate"):
        design = fine_design(4, kind=kind)
        lsbs = levels(design, radians(0.1), 50.0, 5)
        assert len(lsbs) == 5
        assert lsbs == sorted(lsbs)
        finest = monte_carlo(design, radians(0.1), 50.0, lsbs[0], 2, seed=1)
        assert 2**28 < finest.counts < 2**30


def test_a_tuned_design_is_studied_behind_its_filter() -> None:
    """Rates tuned to sinc take the same samples as filtered rates, so noise and mean are alike."""
    zeng = fine_design(2, minors=2, kind="rate")
    data = zeng.as_json()
    data["algorithm"] |= {"family": "tuned", "filter": [{"kind": "sinc"}]}
    pair = [
        monte_carlo(design, radians(0.1), 37.0, 3e-9, 5, seed=1)
        for design in (zeng, Design.parse(data))
    ]
    assert pair[0].theory == pytest.approx(pair[1].theory, rel=1e-6)
    assert pair[0].deviation == pytest.approx(pair[1].deviation, rel=1e-3)
