"""Quantiser: no angle lost, whatever the log's length and however it is cut into chunks."""

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.samples import Quantiser

STIM = Design.preset("stim300")


def design(bits: int, lsb: float, kind: str = "increment") -> Design:
    return Design.parse(
        {
            "name": "d",
            "sensor": {
                "kind": kind,
                "sample_rate_hz": 2000.0,
                "gyro": {"bits": bits, "lsb": lsb},
                "accel": {"bits": bits, "lsb": lsb},
            },
            "algorithm": {
                "family": "frequency-taylor" if kind == "increment" else "filtered-rate",
                "samples": 4,
                "minors": 5,
            },
        }
    )


def test_every_running_total_is_the_input_rounded() -> None:
    rng = np.random.default_rng(1)
    sizes = 10.0 ** rng.uniform(-12, -2, (1500, 6))
    values = sizes * rng.choice([-1.0, 1.0], sizes.shape)
    counts = Quantiser(STIM)(values)
    lsb = [Fraction(STIM.sensor.gyro.lsb)] * 3 + [Fraction(STIM.sensor.accel.lsb)] * 3
    for axis in range(6):
        total = Fraction(0)
        for value, count in zip(values[:, axis].tolist(), counts[:, axis].tolist(), strict=True):
            total += Fraction(value) / lsb[axis] - count
            assert abs(total) <= Fraction(1, 2) + Fraction(1501, 2**43)


@pytest.mark.parametrize("lsb", [2.0**-20, np.nextafter(2.0**-20, 0), 0.3e-7, 1 / 3, 5.7e-9])
def test_what_division_leaves_is_exact(lsb: float) -> None:
    """Against exact rationals, near whole, half and quarter LSBs, up to 2^30 counts."""
    rng = np.random.default_rng(7)
    whole = np.rint(2.0 ** rng.uniform(0, rng.uniform(8, 30, (200, 1)), (200, 6)))
    values = (whole + rng.choice([0, 0.25, 0.5, 1 - 2.0**-30], whole.shape)) * lsb
    values = np.nextafter(values, rng.choice([-1e9, 0, 1e9], whole.shape))
    values *= rng.choice([-1.0, 1.0], whole.shape)
    step = Fraction(lsb)
    quantiser = Quantiser(design(32, lsb))
    for part in (values[whole.max(axis=1) < 2**24 - 1], values):
        for found, value in zip(
            quantiser._rest(part).ravel().tolist(), part.ravel().tolist(), strict=True
        ):
            left = abs(Fraction(value)) % step
            if left == 0 and found:
                left = step
            assert Fraction(found) == (left if value > 0 else -left)


def test_no_angle_is_lost_over_millions_of_large_samples() -> None:
    lsb = 1.7e-9
    # most of 31 bits: a rounded division would be off by 2**-22 LSB
    values = lsb * np.array([1.23456789e9, -1.2345e9, 1.9876e9, 2.1e9, -2e9, 1.1111e9])
    quantiser = Quantiser(design(32, lsb))
    chunk = np.tile(values, (1 << 16, 1))
    total = sum(quantiser(chunk).sum(axis=0) for _ in range(8))
    bound = 1.01 * (8 << 16) / 2**43
    for axis, value in enumerate(values.tolist()):
        left = (8 << 16) * Fraction(value) / Fraction(lsb) - int(total[axis])
        assert abs(left) <= Fraction(1, 2) + Fraction(bound)
        # the remainder itself is right, so the next samples will be: 2e-5 LSB after a day
        found = quantiser.report().remainder[axis] / lsb
        assert found == pytest.approx(float(left), abs=bound)


@pytest.mark.parametrize("value", [0.5, -0.5, 0.25, 1e-4])
def test_small_constant_rate_comes_out_as_its_mean(value: float) -> None:
    lsb = STIM.sensor.gyro.lsb
    counts = Quantiser(STIM)(np.full((40000, 6), value * lsb))
    assert abs(counts[:, 0].sum() - 40000 * value) <= 1
    assert set(np.unique(counts[:, 0])) <= {-1, 0, 1}


def test_chunks_do_not_matter() -> None:
    rng = np.random.default_rng(2)
    values = rng.normal(size=(5000, 6)) * 1e-5
    whole = Quantiser(STIM)(values)
    pieces = Quantiser(STIM)
    cuts = [0, 1, 2, 2, 700, 701, 4000, 5000]
    parts = [pieces(values[a:b]) for a, b in pairwise(cuts)]
    assert np.array_equal(np.concatenate(parts), whole)
    assert pieces.report().samples == 5000


def test_blocks_inside_do_not_matter() -> None:
    values = np.random.default_rng(3).normal(size=(1000, 6)) * 1e-5
    whole = Quantiser(STIM)(values)
    assert np.array_equal(Quantiser(STIM, block=7)(values), whole)


def test_rate_samples_keep_their_sum() -> None:
    lsb = 1e-5
    counts = Quantiser(design(24, lsb, "rate"))(np.full((1000, 6), 0.3 * lsb))
    assert counts[:, 0].sum() == 300


def test_extreme_counts_fit_and_one_more_does_not() -> None:
    tiny = design(8, 1.0)
    edges = np.array([[127.0, -128.0, 0.0, 127.0, -128.0, 0.0]])
    assert Quantiser(tiny)(edges).tolist() == [[127, -128, 0, 127, -128, 0]]
    quantiser = Quantiser(tiny)
    quantiser(np.zeros((10, 6)))
    bad = np.zeros((3, 6))
    bad[1, 4] = -129.0
    with pytest.raises(InputError, match=r"sample 11: accel_y = -129 m/s .* 8 bits .*-128 to 127"):
        quantiser(bad)


@pytest.mark.parametrize("block", [1, 100])
def test_a_refused_call_changes_nothing(block: int) -> None:
    quantiser = Quantiser(design(8, 1.0), block)
    quantiser(np.full((1, 6), 0.4))
    before = quantiser.report()
    with pytest.raises(InputError):
        quantiser(np.array([[0.4] * 6, [1e300] * 6]))
    assert quantiser.report() == before


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_not_a_number_is_named(value: float) -> None:
    values = np.zeros((5, 6))
    values[3, 2] = value
    with pytest.raises(InputError, match=r"sample 3: gyro_z = (nan|inf|-inf) is not a number"):
        Quantiser(STIM)(values)


def test_wrong_shape_is_named() -> None:
    with pytest.raises(InputError, match=r"shape \(4, 5\)"):
        Quantiser(STIM)(np.zeros((4, 5)))


def test_report_says_largest_count_and_remainder() -> None:
    quantiser = Quantiser(design(8, 1.0))
    quantiser(np.array([[1.0, -90.0, 0, 0, 0, 0], [3.25, 5.0, 0, 0, 0, -0.25]]))
    report = quantiser.report()
    assert report.samples == 2
    assert report.largest_count == (3, 90, 0, 0, 0, 0)
    assert report.full_scale[1] == 90 / 127
    assert report.remainder == (0.25, 0, 0, 0, 0, -0.25)
