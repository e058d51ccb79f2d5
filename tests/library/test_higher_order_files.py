"""Results of third and fourth order in files, and what does not go with them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sculler
from higher_order_designs import HIGHER_ORDER
from sculler_model.host import major_increments
from strategies import random_counts


@pytest.mark.parametrize("ending", ["csv", "npz", "parquet"])
@pytest.mark.parametrize("name", ["third_order", "one_sample"])
def test_vectors_come_back_from_files(name: str, ending: str, tmp_path: Path) -> None:
    if ending == "parquet":
        pytest.importorskip("pyarrow")
    design = HIGHER_ORDER[name]
    counts = random_counts(design, 3 * design.samples_per_major, np.random.default_rng(9))
    vectors = sculler.FastModel(design).feed(counts)
    file = tmp_path / f"vectors.{ending}"
    sculler.write_vectors(file, vectors, design)
    back = sculler.read_vectors(file, design)
    assert back.columns == design.columns
    assert [*back.rows()] == [*vectors.rows()]
    other, said = (
        ("fourth_order", "order = 4") if design.order == 3 else ("third_order", "order = 3")
    )
    with pytest.raises(sculler.InputError, match=said):
        sculler.read_vectors(file, HIGHER_ORDER[other])


def test_host_s_own_third_order_is_refused() -> None:
    design = HIGHER_ORDER["third_order"]
    vectors = sculler.FastModel(design).feed(np.ones((20, 6), int))
    said = "third order: the integers of third_order, with order = 3, hold these terms already;"
    for call in (
        lambda: major_increments(design, vectors, third_order=True),
        lambda: sculler.increments(design, vectors, third_order=True),
    ):
        with pytest.raises(sculler.InputError) as fault:
            call()
        assert said in str(fault.value)


def test_constant_rate_and_force_have_no_higher_terms() -> None:
    """All brackets vanish, and the velocity is the closed form of Savage-98 Eq. 51."""
    design = HIGHER_ORDER["fourth_order"]
    counts = np.tile([30_000, -7_000, 11_000, 500, 90_000, -20_000], (60, 1))
    vectors = sculler.FastModel(design).feed(counts)
    for name in design.vectors[2:]:
        if name != "nu":
            assert not np.asarray(vectors.vector(name)).any(), name
    found = sculler.increments(design, vectors)
    phi, upsilon = found.phi[0], counts[0, 3:] * 20 * design.accel_scale
    angle = float(np.linalg.norm(phi))
    once = np.cross(phi, upsilon)
    expected = upsilon + (1 - np.cos(angle)) / angle**2 * once
    expected = expected + (1 - np.sin(angle) / angle) / angle**2 * np.cross(phi, once)
    np.testing.assert_allclose(found.dv_sf[0], expected, rtol=1e-13)
