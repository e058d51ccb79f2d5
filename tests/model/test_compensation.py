"""Known errors taken out before the core in exact integers: the plan, both models, the host."""

from __future__ import annotations

import random
from fractions import Fraction
from math import radians
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sculler_model.algorithms import fractional_delay, pi_to
from sculler_model.design import (
    STATUS_FAULT,
    STATUS_RAIL,
    STATUS_SHORT_HISTORY,
    CompensationPlan,
    Design,
    Interval,
    SensorErrors,
    Term,
)
from sculler_model.design.matrices import inverse
from sculler_model.design.size_effect import size_effect
from sculler_model.errors import InputError
from sculler_model.fast import FastCompensator, FastModel, VectorBlock
from sculler_model.frames import STANDARD_GRAVITY
from sculler_model.golden import GoldenModel
from sculler_model.host import major_increments
from sculler_model.motion import as_felt, spin_rock_size
from sculler_model.samples import Calibration, Imperfect, Quantiser, Undo, interval_ends

ERRORS: dict[str, Any] = {
    "gyro": {
        "bias": [2000.0, -4000.0, 1000.0],
        "scale_factor": [500.0, -300.0, 200.0],
        "misalignment": [1.0, -0.5, 0.3, 0.8, -0.2, 0.4],
        "g_sensitivity": [500.0, -300.0, 200.0],
    },
    "accel": {
        "bias": [20.0, -10.0, 30.0],
        "scale_factor": [300.0, 200.0, -100.0],
        "misalignment": [-1.0, 0.5, 0.3, -0.8, 0.2, -0.4],
    },
}


ARMS = [[0.1, 0.02, -0.03], [0.05, -0.2, 0.01], [0.0, 0.03, 0.15]]


def design(
    compensation: dict[str, Any] | None, kind: str = "increment", bits: int = 24, **more: Any
) -> Design:
    scale = 1000.0 if kind == "rate" else 1.0
    data: dict[str, Any] = {
        "name": "d",
        "sensor": {
            "kind": kind,
            "sample_rate_hz": 1000.0,
            "gyro": {"bits": bits, "lsb": 1e-8 * scale},
            "accel": {"bits": bits, "lsb": 1e-7 * scale},
        },
        "algorithm": {"family": "frequency-taylor", "samples": 4, "history": 1, "minors": 2}
        if kind == "increment"
        else {"family": "filtered-rate", "samples": 2, "minors": 3},
    }
    data |= {} if compensation is None else {"compensation": compensation}
    return Design.parse(data | more)


def plan_of(one: Design) -> CompensationPlan:
    assert one.compensation_plan is not None
    return one.compensation_plan


def random_counts(rng: np.random.Generator, one: Design, count: int) -> NDArray[np.int64]:
    """Many at full scale."""
    lo, hi = one.words.gyro.lo, one.words.gyro.hi
    counts = rng.integers(lo, hi + 1, (count, 6))
    edges = rng.random((count, 6)) < 0.02
    return np.where(edges, rng.choice([lo, hi], (count, 6)), counts)


class TestDelay:
    def test_half_a_sample_is_the_published_filter(self) -> None:
        """Of even length about the middle: 3, -25, 150, 150, -25, 3 over 256."""
        found = fractional_delay(Fraction(1, 2), 6)
        assert [256 * found[o] for o in range(-2, 4)] == [3, -25, 150, 150, -25, 3]
        assert fractional_delay(Fraction(1, 2), 2) == {0: Fraction(1, 2), 1: Fraction(1, 2)}
        assert fractional_delay(Fraction(-3), 8) == {-3: 1}

    @pytest.mark.parametrize("taps", [2, 4, 6, 12])
    def test_polynomials_come_out_exactly(self, taps: int) -> None:
        rng = random.Random(taps)
        for _ in range(5):
            at = Fraction(rng.randrange(-9999, 9999), 1000)
            weights = fractional_delay(at, taps)
            assert sum(weights.values()) == 1
            for degree in range(taps):
                assert sum(w * Fraction(o) ** degree for o, w in weights.items()) == at**degree


class TestPlan:
    def test_pi(self) -> None:
        assert str(float(pi_to(30))) == "3.141592653589793"
        assert abs(pi_to(40) - pi_to(20)) < Fraction(1, 10**18)

    @pytest.mark.parametrize("kind", ["increment", "rate"])
    @pytest.mark.parametrize("delay", [0.0, 0.4, -2.5, 3.0, -6.3])
    def test_integers_are_what_the_float_calibration_does(self, kind: str, delay: float) -> None:
        """`samples.Undo` inverts in floats, with another polynomial: same units, same signs.

        An integer is off by half at most, and a filter's largest by as much as the others.
        """
        one = design(ERRORS | {"delay_samples": delay, "denominator": 1 << 20}, kind)
        plan, lsb = plan_of(one), np.repeat([one.sensor.gyro.lsb, one.sensor.accel.lsb], 3)
        rng = np.random.default_rng(7)
        counts = rng.integers(-(1 << 22), 1 << 22, (60, 6))
        known = SensorErrors.model_validate(ERRORS | {"delay_samples": delay})
        undo = Undo(design(None, kind), Calibration.of(known))
        want = np.concatenate((undo(counts * lsb), undo.finish())) / lsb
        golden = GoldenModel(one)
        found = np.zeros((60, 6))
        for t, row in enumerate(counts.tolist()):
            golden.step(tuple(row[:3]), tuple(row[3:]))
            found[t] = np.array([*golden.s[-1], *golden.r[-1]], float) / plan.denominator
        off = np.abs(found[plan.delay :] - want[: 60 - plan.delay])[12:-12]
        terms = max(len(terms) for terms in plan.outputs)
        assert off.max() < terms * (1 << 22) / (1 << 20) + 1
        assert np.abs(want - counts).max() > 1000

    def test_a_steady_count_is_not_changed_by_the_filters_rounding(self) -> None:
        one = design({"delay_samples": 0.37, "denominator": 1000})
        for terms in plan_of(one).outputs[3:]:
            assert sum(term.factor for term in terms) == 1000
        assert plan_of(one).delay == 3
        assert plan_of(one).outputs[0] == (Term(0, 3, 1000),)

    def test_a_bias_of_a_degree_an_hour(self) -> None:
        """1 °/h is π/180/3600 rad/s; 1 mg is 9.80665e-3 m/s²."""
        one = design({"gyro": {"bias": 1.0}, "accel": {"bias": 1.0}, "denominator": 1 << 20})
        gyro = -radians(1) / 3600 * 1e-3 / 1e-8 * (1 << 20)
        accel = -STANDARD_GRAVITY * 1e-3 * 1e-3 / 1e-7 * (1 << 20)
        assert plan_of(one).offsets == (round(gyro),) * 3 + (round(accel),) * 3

    def test_no_counts_pass_the_ranges_and_some_reach_them(self) -> None:
        one = design(ERRORS | {"delay_samples": 0.4})
        plan, words = plan_of(one), one.words
        ranges = plan.ranges(words.gyro, words.accel)
        reached: list[list[int]] = [[], []]
        for i, terms in enumerate(plan.outputs):
            for sign in (1, -1):
                total = 0  # a sum on the way to an output counts, too
                for term in terms:
                    count = words.gyro.hi if sign * term.factor > 0 else words.gyro.lo
                    total += term.factor * count
                reached[i // 3] += [total, total + plan.offsets[i]]
        assert [(min(each), max(each)) for each in reached] == [(r.lo, r.hi) for r in ranges]
        inner = one.inner.sensor
        assert [inner.gyro.bits, inner.accel.bits] == [each.bits for each in ranges]
        assert words.alpha == Interval.signed(inner.gyro.bits).repeated(8)
        assert (words.gyro.bits, words.accel.bits) == (24, 24)


def golden_block(one: Design, counts: NDArray[Any], faults: NDArray[Any]) -> VectorBlock:
    samples = zip(counts.tolist(), faults.tolist(), strict=True)
    run = GoldenModel(one).run((tuple(r[:3]), tuple(r[3:]), int(f)) for r, f in samples)
    return VectorBlock.from_results(run, one)


ORDERS = {"third order": {"order": 3}, "position": {"position": "high-resolution"}}
CASES = {
    "matrix": ({**ERRORS}, "increment", 24),
    "late": ({**ERRORS, "delay_samples": 0.4, "taps": 4}, "increment", 16),
    "early": ({"delay_samples": -3.5, "denominator": 1 << 17}, "rate", 32),
    "wide": ({**ERRORS, "delay_samples": 2.5, "denominator": 1 << 16}, "increment", 32),
    "arms": (
        {**ERRORS, "arms_m": [[0.1, 0.02, -0.03]] * 3, "accel_denominator": 1 << 30},
        "increment",
        24,
    ),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_fast_twin_is_the_golden_model(case: tuple[dict[str, Any], str, int]) -> None:
    """Every integer and every status, whatever the chunks."""
    one = design(*case)
    rng = np.random.default_rng(11)
    counts, faults = random_counts(rng, one, 150), rng.random(150) < 0.02
    want = golden_block(one, counts, faults)
    for cuts in ([], [0, 1, 2, 9, 77, 78, 79]):
        model = FastModel(one)
        parts = zip(np.split(counts, cuts), np.split(faults, cuts), strict=True)
        got = VectorBlock.concatenate([model.feed(*part) for part in parts])
        assert len(got) == 150 // one.samples_per_major
        assert got.first_difference(want) is None
    model = FastModel(one)
    with pytest.raises(InputError, match="does not fit"):
        model.feed_to(lambda *_: None, np.vstack([counts, [[1 << 40] * 6]]), None, 5)
    assert VectorBlock.first_difference(model.feed(counts, faults), want) is None


@pytest.mark.parametrize("more", ORDERS.values(), ids=ORDERS)
def test_what_comes_behind_follows(more: dict[str, Any]) -> None:
    """Third order and high-resolution position of samples of 58 bits, golden and fast."""
    algorithm = {"family": "frequency-taylor", "samples": 4, "minors": 2, **more}
    one = design({"arms_m": ARMS, "accel_denominator": 1 << 30}, algorithm=algorithm)
    assert one.inner.sensor.accel.bits == 58
    counts = random_counts(np.random.default_rng(2), one, 64)
    want = golden_block(one, counts, np.zeros(64, int))
    assert FastModel(one).feed(counts).first_difference(want) is None


def test_status_tells_of_every_sample_that_is_used() -> None:
    """A fault, a rail and the beginning reach as far as the filter: here six samples."""
    one = design({"delay_samples": 0.5})  # 8 samples a major interval, reach 5
    counts, faults = np.zeros((48, 6), np.int64), np.zeros(48, np.int64)
    faults[18] = 1  # goes into 18 ... 23
    counts[19, 4] = one.words.accel.hi  # goes into 19 ... 24
    counts[47, 0] = 1
    status = golden_block(one, counts, faults).status.tolist()
    assert status == [
        STATUS_SHORT_HISTORY,
        0,
        STATUS_FAULT | STATUS_RAIL,
        STATUS_RAIL,
        0,
        0,
    ]
    assert one.short_majors == 1
    assert one.short_samples[:8] == (True,) * 5 + (False, False, True)  # phase 4 reaches 4 back


def test_nothing_to_take_out_is_the_core_of_finer_counts() -> None:
    """D times the counts through the plain core of a sensor of 1/D: the host gets the same."""
    one, plain = design({"denominator": 1000}), design(None)
    rng = np.random.default_rng(3)
    counts = rng.integers(-(1 << 20), 1 << 20, (64, 6))
    found, want = FastModel(one).feed(counts), FastModel(plain).feed(counts)
    for vector, factor in (("alpha", 1000), ("coning_within", 10**6), ("sculling_between", 10**6)):
        scaled = factor * np.asarray(want.vector(vector), object)
        assert (np.asarray(found.vector(vector), object) == scaled).all()
    ours, theirs = major_increments(one, found), major_increments(plain, want)
    np.testing.assert_allclose(ours.phi, theirs.phi, rtol=1e-14)
    np.testing.assert_allclose(ours.dv_sf, theirs.dv_sf, rtol=1e-13)


def test_an_interval_ends_where_its_samples_do() -> None:
    late, plain = design({"delay_samples": 0.5}), design(None)
    intervals = np.arange(5)
    np.testing.assert_allclose(
        interval_ends(late, intervals), interval_ends(plain, intervals) - 3e-3
    )
    early = design({"delay_samples": -4.5})  # accelerometers are delayed, gyros are not
    np.testing.assert_array_equal(interval_ends(early, intervals), interval_ends(plain, intervals))


@pytest.mark.parametrize("kind", ["increment", "rate"])
def test_what_a_sensor_does_wrong_is_gone_at_the_host(kind: str) -> None:
    """Increments of spinning and rocking through a wrong sensor, against those of a perfect one."""
    errors = ERRORS | {"delay_samples": 0.4}
    motion = spin_rock_size(radians(48), radians(11), 500.0, arm=0.0)
    wrong = design(None, kind, 32)
    sensor = wrong.as_json()["sensor"]
    wrong = Design.parse({**wrong.as_json(), "sensor": {**sensor, "errors": errors}})
    count = 12 * 24 + 3
    (perfect,) = motion.chunks(wrong.sensor.kind, count, 1e-3)
    (placed,) = as_felt(motion, wrong).chunks(wrong.sensor.kind, count, 1e-3)
    counts = Quantiser(wrong)(Imperfect(wrong)(placed))
    right = Design.parse({**wrong.as_json(), "compensation": errors | {"denominator": 1 << 16}})
    found = major_increments(right, FastModel(right).feed(counts))
    left = major_increments(wrong, FastModel(wrong).feed(counts))
    # the same instants: intervals of samples that are three later
    want = major_increments(wrong, FastModel(wrong).feed(Quantiser(wrong)(perfect)))
    span = wrong.samples_per_major
    shifted = np.vstack([np.zeros((3, 6)), perfect])[: len(perfect)]
    late = major_increments(wrong, FastModel(wrong).feed(Quantiser(wrong)(shifted)))
    assert len(want) == len(late) == count // span
    inner = slice(3, None)
    T = wrong.major_interval
    rates = np.abs(found.phi - late.phi)[inner].max() / T
    forces = np.abs(found.dv_sf - late.dv_sf)[inner].max() / T
    # an integer is off by 1/2 of D at most, a filter's six together by a few
    scales, per = right.count_scales, 1e3 if kind == "increment" else 1.0
    rate, force = (
        per * np.abs(perfect[:, part]).max(axis=0).sum() for part in (slice(0, 3), slice(3, 6))
    )
    unit = 0.5 / (1 << 16)
    assert rates < unit * (rate + force * scales[0] / scales[1]) * 1.1
    assert forces < unit * force * 3
    assert np.abs(left.phi - want.phi)[inner].max() / T > 100 * rates
    assert np.abs(left.dv_sf - want.dv_sf)[inner].max() / T > 100 * forces


class TestSizeEffect:
    def test_it_is_that_of_a_rate_that_is_a_polynomial(self) -> None:
        """ω̇×r over a sample and ω×(ω×r) of its mean rate, exact in fractions, M and b included."""
        rng = random.Random(5)

        def some(many: int) -> list[Fraction]:
            return [Fraction(rng.randrange(-999, 999), 1000) for _ in range(many)]

        arm, bias, T = some(3), some(3), Fraction(1, 100)
        units = (Fraction(3, 1000), Fraction(7, 1000))
        felt = [
            [1 + each / 9 if i == j else each / 9 for j, each in enumerate(some(3))]
            for i in range(3)
        ]
        polynomial = [some(6) for _ in range(3)]  # of fifth degree, rad/s over t/T

        def rate(axis: int, at: Fraction) -> Fraction:
            return sum(c * at**k for k, c in enumerate(polynomial[axis]))

        def mean(axis: int, at: int) -> Fraction:
            return sum(
                c * (Fraction(at + 1) ** (k + 1) - Fraction(at) ** (k + 1)) / (k + 1)
                for k, c in enumerate(polynomial[axis])
            )

        counts = {  # of the samples about sample 0: b + L s
            o: [
                bias[i] + sum(felt[i][j] * mean(j, o) / units[0] for j in range(3))
                for i in range(3)
            ]
            for o in range(-3, 4)
        }
        change = [rate(axis, Fraction(1)) - rate(axis, Fraction(0)) for axis in range(3)]
        turn = [mean(axis, 0) for axis in range(3)]
        inward = fraction_cross(turn, fraction_cross(turn, arm))
        for axis in range(3):
            found = size_effect(axis, tuple(arm), inverse(felt), tuple(bias), units, T)
            total = found.constant
            for source, weights in found.linear.items():
                total += sum(w * counts[o][source] for o, w in weights.items())
            for (one, two), factor in found.products.items():
                total += factor * counts[0][one] * counts[0][two]
            wanted = fraction_cross(change, arm)[axis] / T + inward[axis]
            assert total * units[1] == wanted

    def test_a_steady_turn_is_centripetal(self) -> None:
        """At 0.2 m from the axis of 1 rad/s the x accelerometer feels 0.2 m/s² inward."""
        one = design({"arms_m": [[0.2, 0.0, 0.0]] * 3, "accel_denominator": 1 << 30}, kind="rate")
        counts = np.tile([0, 0, 100_000, -2000, 0, 0], (40, 1))  # 1e-5 rad/s, 1e-4 m/s²
        golden = GoldenModel(one)
        for row in counts.tolist():
            golden.step(tuple(row[:3]), tuple(row[3:]))
        x, y, z = (each / (1 << 30) for each in golden.r[-1])
        assert abs(x) < 2000 * 0.003  # a unit of the factor is 1/215 of it
        assert y == 0  # at (0.2, 0, 0) too, and the axis is z: across ω × (ω × r)
        assert z == 0

    @pytest.mark.parametrize("kind", ["increment", "rate"])
    def test_accelerometers_apart_are_brought_together(self, kind: str) -> None:
        """Spinning and rocking, against the motion's own samples where there are no arms."""
        errors = {**ERRORS, "arms_m": ARMS, "delay_samples": 0.4}
        motion = spin_rock_size(radians(48), radians(11), 500.0, arm=0.0)
        sensor = design(None, kind).as_json()["sensor"]
        wrong = Design.parse(
            {**design(None, kind).as_json(), "sensor": {**sensor, "errors": errors}}
        )
        (perfect,) = motion.chunks(wrong.sensor.kind, 300, 1e-3)
        (placed,) = as_felt(motion, wrong).chunks(wrong.sensor.kind, 300, 1e-3)
        counts = Quantiser(wrong)(Imperfect(wrong)(placed))
        sizes = {"denominator": 1 << 20, "accel_denominator": 1 << 31}
        offs = []
        for known in (errors, {k: v for k, v in errors.items() if k != "arms_m"}):
            one = design(known | sizes, kind)
            plan = plan_of(one)
            found = FastCompensator(plan)(counts)[:, 3:] / plan.accel_denominator
            want = perfect[:, 3:] / one.sensor.accel.lsb
            behind = plan.delay
            offs.append(np.abs(found[behind:] - want[: 300 - behind])[12:-12].max())
        with_arms, without = (each * 1e-4 for each in offs)  # m/s²
        # a gyro's count, 1e-5 rad/s, in (S2), over 1 ms and at 0.2 m, makes 2e-3 m/s²
        assert with_arms < 4e-3
        assert without > 50 * with_arms


def fraction_cross(a: list[Fraction], b: list[Fraction]) -> list[Fraction]:
    return [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]


REFUSED: dict[str, tuple[dict[str, Any], dict[str, Any], str]] = {
    "random": (
        {"gyro": {"flicker": 1.0}},
        {},
        "compensation: gyro.flicker: is random or a limit",
    ),
    "drawn": ({"accel": {"bias": {"sigma": 1.0}}}, {}, "accel.bias: is random"),
    "bent": ({"gyro": {"square": 1.0}}, {}, "gyro.square: is not linear in the samples"),
    "arms": ({"arms_m": [[0.1, 0.0]] * 3}, {}, "arms_m"),
    "odd": ({"taps": 5}, {}, "taps: 5 is not allowed, give an even number"),
    "late": ({"delay_samples": 9.0}, {}, "delay_samples: 9 is not allowed"),
    "wide": (
        {"denominator": 1 << 40},
        {},
        r"compensation.denominator: 1099511627776 makes samples of 64 bits, more than the 62 that"
        r" a core can take; give 2\^38 = 274877906944 or less",
    ),
    "singular": (
        {"gyro": {"scale_factor": [-1e6, 0.0, 0.0]}},
        {},
        "compensation.gyro: scale_factor and misalignment make a matrix without an inverse",
    ),
    "hardened": ({}, {"hardware": {"hardening": "detect"}}, "with hardware.hardening: leave"),
    "unknown": ({"denominater": 3}, {}, "denominater: unknown key, did you mean denominator"),
}


@pytest.mark.parametrize("case", REFUSED.values(), ids=REFUSED)
def test_what_is_not_built_is_refused_in_a_line(
    case: tuple[dict[str, Any], dict[str, Any], str],
) -> None:
    compensation, more, said = case
    with pytest.raises(InputError, match=said) as caught:
        design(compensation, **more)
    assert "\n" not in str(caught.value)


def test_the_denominator_that_is_said_to_fit_fits() -> None:
    assert design({"denominator": 1 << 38}).inner.sensor.gyro.bits == 62
    with pytest.raises(InputError, match="more than the 62"):
        design({"denominator": 1 << 39})
    with pytest.raises(InputError, match="accel_denominator: 1099511627776 makes samples of 64"):
        design({"accel_denominator": 1 << 40})


def test_factors_that_all_round_to_nothing_leave_constant_samples() -> None:
    """Scale factors of 9 parts in one over a denominator of 2: a tenth of a count is none."""
    bent = {"scale_factor": [9e6] * 3}
    made = design({"denominator": 2, "gyro": bent, "accel": bent})
    plan = made.compensation_plan
    assert plan is not None
    assert (plan.reach, plan.offsets) == (0, (0,) * 6)
    counts = np.arange(12 * made.samples_per_major).reshape(-1, 6)
    block = FastModel(made).feed(counts)
    assert len(block) == 2
    assert not any(block.vector(name).any() for name in ("alpha", "nu"))
