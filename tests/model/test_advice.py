"""Advice: costs against the hardware's own parts, drifts against the integer path, the ranking."""

from __future__ import annotations

import random
from math import degrees, pi, radians, sin

import numpy as np
import pytest

from sculler_hdl.plan import dot_product
from sculler_hdl.plan.cross_array import CONING_AND_SCULLING, FOLDINGS
from sculler_hdl.plan.schedule import (
    AdderTiming,
    Configuration,
    Schedule,
    tap_rows,
    weight_rows,
)
from sculler_hdl.plan.weighted_sum import terms_of
from sculler_model.algorithms import filtered_rate, frequency_taylor, time_taylor
from sculler_model.analysis import frequency
from sculler_model.analysis.advice import (
    Candidate,
    Environment,
    Requirement,
    advise,
    by_order,
    coning_drift,
    cost,
    signed_digit_count,
)
from sculler_model.analysis.closed_form import drift_rate
from sculler_model.analysis.flight import Profile
from sculler_model.analysis.integer_path import rotation_vectors, running_attitude, unquantised
from sculler_model.analysis.oscillation import Cone
from sculler_model.analysis.vibration import PROFILES, G, Mount, respond
from sculler_model.design import Design, at_another_rate
from sculler_model.errors import InputError
from sculler_model.frames import conjugate, rotate
from sculler_model.motion import Coning
from strategies import make_design

STIM = Design.preset("stim300")
SHAKEN = Environment(
    spectrum=PROFILES["savage-98"], mount=Mount.worst(0.05, 0.014), peak_rate=radians(200)
)
CONED = Environment(half_angle=radians(0.1), hertz=50.0, peak_rate=radians(200))


# costs


def test_signed_digits_are_the_hardwares() -> None:
    rng = random.Random(2)
    values = [*range(-300, 300), *(rng.randrange(-(2**40), 2**40) for _ in range(300))]
    assert [signed_digit_count(v) for v in values] == [
        len(dot_product.signed_digits(v)) for v in values
    ]


@pytest.mark.parametrize(
    "algorithm",
    [
        {"samples": 4, "history": 0, "minors": 5},
        {"samples": 3, "history": 2, "minors": 1},
        {"samples": 3, "history": 0, "minors": 7, "family": "time-taylor"},
    ],
)
def test_cost_is_what_the_core_is_made_of(algorithm: dict[str, object]) -> None:
    design = Design.preset("stim300", **algorithm)
    found = cost(design)
    n = design.table.samples
    shared = FOLDINGS[0] if design.algorithm.minors > 1 else None
    made = Configuration(FOLDINGS[0], shared, None, 0, AdderTiming(64, 64, 64, 1))
    arrays = Schedule(design, made).arrays

    def products(place: str) -> int:
        operands = arrays[place].operands
        return sum(
            6 * operands[f"left{a}"].range.bits * operands[f"right{b}"].range.bits
            for a, b in CONING_AND_SCULLING.crosses
        )

    within = products("within")
    between = products("between") if "between" in arrays else 0
    words = design.words
    rows = len(design.table.active_phases)

    def terms(phase: int) -> int:
        return len(terms_of({phase: tap_rows(design.table)[phase]}))

    weights = len(terms_of(weight_rows(design.table)))
    taps = [terms(phase) - 1 for phase in tap_rows(design.table)]
    assert found.rows == rows
    assert found.additions == 6 * (sum(taps) + weights - 1)
    assert found.multiplications == pytest.approx(18 * (rows + (between > 0)) / n)
    adders = 3 * sum(taps) * (words.gyro_taps.bits + words.accel_taps.bits)
    adders += 3 * (weights - 1) * (words.theta.bits + words.v.bits)
    rate = design.sensor.sample_rate_hz
    assert found.work == pytest.approx((rows * within + between + adders) * rate / n)
    assert found.area > within + between + adders
    held = ["alpha", "nu", "coning_within", "sculling_within"]
    held += ["coning_between", "sculling_between"] if "between" in arrays else []
    assert found.widest == max(getattr(words, name).bits for name in held)


def test_a_dense_table_costs_more_than_a_compressed_one() -> None:
    dense, compressed = (
        cost(Design.preset("stim300", family=family))
        for family in ("uncompressed", "frequency-taylor")
    )
    assert dense.rows == 3  # nothing comes before the first sample
    assert compressed.rows == 1
    assert dense.work > 1.5 * compressed.work


def test_third_order_of_two_samples_costs_what_a_hand_counts() -> None:
    """theta × m and slope × (theta × m): 36 products, of 9 and 9, and of 9 and 18 or 19 bits.

    theta is a sum of two counts of 8 bits, m and the slope are differences (weights of 1).
    """
    designs = [make_design("d", 2, 0, 1, (8, 8), options={"order": order}) for order in (2, 3)]
    plain, higher = map(cost, designs)
    coning, sculling = designs[1].words.coning_third, designs[1].words.sculling_third
    assert coning is not None
    assert sculling is not None
    assert higher.multiplications - plain.multiplications == 36 / 2
    products = 18 * 9 * 9 + 6 * 9 * (18 + 19 + 18)
    registers = 3 * (coning.bits + sculling.bits)
    assert higher.area - plain.area - registers - products == 2 * 3 * 2 * (9 + 9)


# drifts


@pytest.mark.parametrize(
    ("family", "kind", "n", "p", "M", "degree", "hertz"),
    [
        ("frequency-taylor", "increment", 2, 0, 3, 1.0, 60.0),
        ("uncompressed order 3", "increment", 4, 0, 3, 5.0, 45.0),
        ("uncompressed order 4", "increment", 4, 0, 3, 5.0, 45.0),
        ("frequency-taylor order 4", "increment", 1, 1, 5, 3.0, 15.0),
        ("frequency-taylor", "increment", 4, 0, 3, 5.0, 45.0),
        ("frequency-taylor", "increment", 2, 1, 1, 10.0, 70.0),
        ("time-taylor", "increment", 3, 0, 4, 2.0, 30.0),
        ("filtered-rate", "rate", 2, 0, 1, 1.0, 20.0),
        ("filtered-rate", "rate", 4, 0, 2, 1.0, 20.0),
    ],
)
def test_coning_drift_is_that_of_the_integer_path(
    family: str, kind: str, n: int, p: int, M: int, degree: float, hertz: float
) -> None:
    """A long record through counts, core and host, its attitude multiplied out."""
    family, _, order = family.partition(" order ")
    options = {"order": int(order)} if order else {}
    design = Design.parse(
        {
            "name": "d",
            "sensor": {
                "kind": kind,
                "sample_rate_hz": 1000.0,
                "gyro": {"bits": 24, "lsb": 1e-9},
                "accel": {"bits": 24, "lsb": 1e-9},
            },
            "algorithm": {"family": family, "samples": n, "history": p, "minors": M, **options},
        }
    )
    cone = Cone(radians(degree))
    point = frequency.integer_point(frequency.fine(design, cone, hertz + 1), cone, hertz)
    found = coning_drift(
        design.table,
        M,
        cone.half_angle,
        2 * pi * point.hertz,
        1e-3,
        design.sensor.kind,
        order=design.order,
    )
    assert found == pytest.approx(point.complete, rel=2e-3, abs=3e-12)


def test_small_cones_leave_the_closed_form() -> None:
    a, omega = 1e-4, 2 * pi * 80
    for table, kind in (
        (frequency_taylor(2, 0), "increment"),
        (time_taylor(3, 0), "increment"),
        (filtered_rate(2, 0), "rate"),
    ):
        found = coning_drift(table, 3, a, omega, 1e-3, kind)  # type: ignore[arg-type]
        closed = drift_rate(table, a, a, omega, 1e-3, kind)  # type: ignore[arg-type]
        assert found == pytest.approx(float(closed), rel=1e-3)


# a sensor's filter

AVERAGED = Design.parse(
    {"preset": "stim300", "sensor": {"filter": {"kind": "digital", "numerator": [0.25] * 4}}}
)
"""Each sample is the mean of four increments of half a millisecond."""


def drift_of_averages(design: Design, hertz: float) -> float:
    """°/h that a design makes of coning, 0.1°, whose increments are averaged one by one."""
    cone = Coning(radians(0.1), 2 * pi * hertz)
    start = max(1, 4 // design.samples_per_major)  # what has no history yet
    count = design.samples_per_major * (start + 200)  # whole periods, of 9 and of 10 ms
    summed = round(2000 / design.sensor.sample_rate_hz)
    fine = cone.increments(summed * count + 3, 5e-4)
    mean = (fine[3:] + fine[2:-1] + fine[1:-2] + fine[:-3]) / 4
    samples = mean.reshape(count, summed, 6).sum(axis=1)
    phi, _ = unquantised(design, samples)
    q = running_attitude(phi[start:])[-1:]
    seconds = len(phi[start:]) * design.major_interval
    (x, y, z) = rotation_vectors(q)[0]
    start_time = 5e-4 * 1.5 + start * design.major_interval
    axis = rotate(tuple(conjugate(cone.attitude(np.array([start_time]))[0])), (0.0, 0.0, 1.0))
    return float(np.dot((x, y, z), axis)) / seconds * degrees(1) * 3600


@pytest.fixture(scope="module")
def behind_averages() -> dict[str, Candidate]:
    found = advise(AVERAGED, CONED, Requirement(1.0), most_samples=5, most_history=1, slowest=4)
    return {candidate.design.name: candidate for candidate in found}


@pytest.mark.parametrize(
    "name",
    [
        "frequency_taylor_5_0_x1_500hz",
        "frequency_taylor_4_0_x5_2000hz",
        "tuned_3_1_x3_1000hz",
        "tuned_fitted_5_0_x1_500hz",
    ],
)
def test_drift_behind_a_filter_is_that_of_averaged_increments(
    behind_averages: dict[str, Candidate], name: str
) -> None:
    """The averages are taken in time, one by one; the advice knows their response alone."""
    candidate = behind_averages[name]
    expected = abs(drift_of_averages(candidate.design, 50.0))
    assert candidate.drift == pytest.approx(expected, rel=1e-3, abs=3e-5)


def test_what_knows_nothing_of_the_filter_meets_no_requirement_that_the_filter_spoils(
    behind_averages: dict[str, Candidate],
) -> None:
    """1 - F² of 98.7 °/h, F the mean of four."""
    phase = 2 * pi * 50 / 2000
    mean = sin(2 * phase) / (4 * sin(phase / 2))
    lost = (1 - mean**2) * 98.7
    for name, candidate in behind_averages.items():
        if not name.startswith("tuned"):
            assert not candidate.meets
            assert candidate.drift > 0.9 * lost
    best = next(iter(behind_averages.values()))
    assert best.meets
    assert best.drift < 1e-3


def test_a_filter_at_another_rate_is_the_same_filter() -> None:
    stages = [
        {"kind": "sinc", "width_samples": 4.0, "order": 2},
        {"kind": "digital", "numerator": [0.25] * 4},
        {"kind": "analogue", "numerator": [628.0], "denominator": [1.0, 628.0]},
    ]
    data = STIM.as_json()
    whole = Design.parse(data | {"sensor": data["sensor"] | {"filter": stages}})
    slower = {"filter": at_another_rate(stages, 2000.0, 4), "sample_rate_hz": 500.0}
    summed = Design.parse(data | {"sensor": data["sensor"] | slower})
    assert whole.sensor_response is not None
    assert summed.sensor_response is not None
    for phase in (0.01, 0.3, 0.7):
        expected = whole.sensor_response.value(phase)
        assert summed.sensor_response.value(4 * phase) == pytest.approx(expected, rel=1e-12)


def test_a_filter_in_two_places_is_refused() -> None:
    filters = {"filter": {"kind": "sinc"}}
    with pytest.raises(
        InputError, match=r"^design: algorithm\.filter: sensor\.filter is given too"
    ):
        Design.parse(
            {"preset": "stim300", "sensor": filters, "algorithm": {"family": "tuned", **filters}}
        )


def test_a_filter_of_before_is_the_sensors() -> None:
    algorithm = {"family": "tuned", "filter": {"kind": "sinc"}, "samples": 3}
    old = Design.parse({"preset": "stim300", "algorithm": algorithm})
    new = Design.parse(
        {"preset": "stim300", "sensor": {"filter": {"kind": "sinc"}}}
        | {"algorithm": {"family": "tuned", "samples": 3}}
    )
    assert old.table == new.table
    assert old.sensor_response == new.sensor_response
    drifts = [
        [candidate.drift for candidate in advise(design, CONED, Requirement(1.0), most_samples=3)]
        for design in (old, new)
    ]
    assert drifts[0] == drifts[1]


# the ranking


@pytest.fixture(scope="module")
def shaken() -> list[Candidate]:
    return advise(STIM, SHAKEN, Requirement(1.7e-4, 0.1), most_samples=4, most_history=1)


def test_those_that_meet_come_first_and_cheapest_first(shaken: list[Candidate]) -> None:
    good = [c for c in shaken if c.meets]
    assert 0 < len(good) < len(shaken)
    assert all(c.meets for c in shaken[: len(good)])
    assert [c.cost.work for c in good] == sorted(c.cost.work for c in good)
    bad = shaken[len(good) :]
    assert [c.excess for c in bad] == sorted(c.excess for c in bad)
    by_area = advise(
        STIM, SHAKEN, Requirement(1.7e-4, 0.1), most_samples=4, most_history=1, by="area"
    )
    areas = [c.cost.area for c in by_area if c.meets]
    assert areas == sorted(areas)
    assert {c.design for c in by_area if c.meets} == {c.design for c in good}


def test_what_is_left_is_the_bound_of_the_vibration(shaken: list[Candidate]) -> None:
    worst = respond(PROFILES["savage-98"], Mount.worst(0.05, 0.014), 0.05).worst_phase
    for candidate in shaken[:3] + shaken[-3:]:
        left = worst.errors(candidate.design.table, candidate.design.sample_interval)
        assert candidate.drift == pytest.approx(degrees(left.coning) * 3600, rel=1e-2)
        assert candidate.force == pytest.approx(
            float(np.linalg.norm(left.sculling)) / G * 1e6, rel=1e-2
        )


def test_every_verdict_is_the_requirements(shaken: list[Candidate]) -> None:
    for candidate in shaken:
        T = candidate.design.major_interval
        fits = radians(200) * T <= 0.05 * (1 + 1e-9) and T <= 0.01 * (1 + 1e-9)
        good = candidate.drift <= 1.7e-4 and (candidate.force or 0) <= 0.1
        assert candidate.meets == (fits and good), candidate
        assert bool(candidate.faults) != candidate.meets


def test_families_rates_and_histories_are_tried(shaken: list[Candidate]) -> None:
    algorithms = [c.design.algorithm for c in shaken]
    assert {a.family for a in algorithms} == {
        "frequency-taylor",
        "time-taylor",
        "uncompressed",
        "least-squares",
    }
    assert {c.design.sensor.sample_rate_hz for c in shaken} == {2000.0, 1000.0, 500.0, 250.0}
    assert {a.history for a in algorithms} == {0, 1}
    assert len({c.design.name for c in shaken}) == len(shaken)


def test_slower_samples_are_sums_of_the_sensors(shaken: list[Candidate]) -> None:
    for candidate in shaken:
        sensor = candidate.design.sensor
        summed = 2000.0 / sensor.sample_rate_hz
        assert sensor.gyro.lsb == STIM.sensor.gyro.lsb
        # the sum of so many of the most negative counts fits
        assert 2 ** (sensor.gyro.bits - 1) >= summed * 2 ** (STIM.sensor.gyro.bits - 1)


def test_coning_counts_the_triple_products() -> None:
    """At 5° every table is held up by the same floor, which the closed form does not know."""
    found = advise(
        STIM,
        Environment(half_angle=radians(5), hertz=40.0),
        Requirement(drift=1.0),
        most_samples=4,
        most_history=2,
        slowest=1,
    )
    assert all(c.meets == (c.design.order == 4 and c.drift < 1) for c in found)
    assert all("coning leaves" in c.faults[0] for c in found if not c.meets)
    assert {c.design.order for c in found} == {2, 3, 4}
    table = frequency_taylor(4, 2)
    assert abs(float(drift_rate(table, 0.087, 0.087, 2 * pi * 40, 1 / 2000))) * 206265 < 1e-3


def test_counts_and_turns_that_do_not_fit_are_told() -> None:
    fast = Environment(half_angle=radians(0.1), hertz=50.0, peak_rate=radians(30_000))
    found = advise(STIM, fast, Requirement(1.0), most_samples=2, most_history=0, slowest=1)
    faults = " ".join(found[0].faults)
    assert "the gyro needs" in faults
    assert "turns" in faults


def test_a_turn_too_far_is_told_and_a_turn_just_allowed_is_not() -> None:
    fast = Environment(half_angle=radians(0.1), hertz=50.0, peak_rate=radians(1000))
    found = advise(STIM, fast, Requirement(100.0), most_samples=6, most_history=0)
    turned = [c.design.major_interval * radians(1000) for c in found]
    assert min(turned) < 0.05 < max(turned) < 0.45
    for candidate, turn in zip(found, turned, strict=True):
        assert any("turns" in fault for fault in candidate.faults) == (turn > 0.05)


def test_rate_sensors_get_families_for_rates() -> None:
    rate = Design.parse(
        {
            "name": "fog",
            "sensor": {
                "kind": "rate",
                "sample_rate_hz": 1000.0,
                "gyro": {"bits": 24, "lsb": 1e-6},
                "accel": {"bits": 24, "lsb": 1e-4},
            },
            "algorithm": {"family": "filtered-rate", "samples": 2, "minors": 5},
        }
    )
    found = advise(rate, SHAKEN, Requirement(1.0, 10.0), most_samples=3, most_history=1)
    assert {c.design.algorithm.family for c in found} == {"filtered-rate", "tuned"}
    assert {c.design.sensor.sample_rate_hz for c in found} == {1000.0}
    assert any(c.meets for c in found)


@pytest.mark.parametrize(
    ("environment", "requirement", "message"),
    [
        (Environment(), Requirement(1.0), "neither a vibration nor coning"),
        (SHAKEN, Requirement(), "give °/h, µg or both"),
        (CONED, Requirement(1.0, 1.0), "no specific force"),
    ],
)
def test_faults(environment: Environment, requirement: Requirement, message: str) -> None:
    with pytest.raises(InputError, match=message):
        advise(STIM, environment, requirement)


# velocity, position, manoeuvres

PULLED = Environment(half_angle=radians(0.1), hertz=50.0, peak_rate=1.0, peak_force=3 * G)


def test_peak_force_changes_the_order_where_position_is_asked_for() -> None:
    """The trapezoid errs by A C T³/12 an interval (Savage-98 Eq. 108), over 10 s; 0.1 mm here."""
    limit, few = 1e-4, {"most_samples": 4, "most_history": 0, "slowest": 2}
    free = advise(STIM, PULLED, Requirement(1e-3), **few)
    asked = advise(STIM, PULLED, Requirement(1e-3, position=limit), **few)
    assert free[0].design.name != asked[0].design.name
    for candidate in (c for c in asked if c.meets):
        T = candidate.design.major_interval
        fine = candidate.design.algorithm.position == "high-resolution"
        assert candidate.position is not None
        assert candidate.position <= limit
        if not fine:
            assert candidate.position == pytest.approx(3 * G * T**2 / 12 * 10, rel=1e-6)
    assert any(c.design.algorithm.position == "high-resolution" for c in asked if c.meets)
    assert any("position by trapezoid leaves" in fault for c in asked for fault in c.faults)


def test_sculling_tones_by_their_closed_form() -> None:
    tone = Environment(
        peak_rate=1.0, sculling_angle=radians(0.1), sculling_force=10.0, sculling_hertz=35.0
    )
    for candidate in advise(STIM, tone, Requirement(force=1.0), most_samples=2, most_history=1):
        design = candidate.design
        omega = 2 * pi * 35
        left = drift_rate(design.table, radians(0.1), 10 / omega, omega, design.sample_interval)
        assert candidate.force == pytest.approx(abs(float(left)) / G * 1e6, rel=1e-9)
        assert candidate.meets is (not candidate.faults)


def test_a_manoeuvre_makes_m_smaller() -> None:
    """Source 1 falls with the fourth power of the interval, so a smaller M mends it."""
    t = np.linspace(0, 1, 11)
    values = np.zeros((11, 6))
    values[:, 0] = 3 * np.sin(np.pi * t) ** 2 * np.sin(2 * np.pi * t)
    values[:, 1] = np.sin(np.pi * t) ** 2
    moved = Environment(peak_rate=3.0, manoeuvre=Profile("roll", t, values))

    def found(angle: float) -> list[Candidate]:
        limits = Requirement(angle=angle, host_rate=25.0)
        return advise(STIM, moved, limits, most_samples=2, most_history=0, slowest=1)

    loose = found(1.0)[0]
    assert loose.meets
    assert loose.angle is not None
    tight = found(loose.angle / 100)[0]
    assert tight.meets
    assert tight.angle is not None
    assert tight.design.algorithm.minors < loose.design.algorithm.minors
    assert tight.angle <= loose.angle / 100


@pytest.mark.parametrize(
    ("environment", "requirement", "message"),
    [
        (PULLED, Requirement(angle=1.0), "need one, give it"),
        (CONED, Requirement(position=1.0), "nothing moves the position"),
        (Environment(peak_force=1.0), Requirement(1.0), "there is no coning"),
    ],
)
def test_questions_that_do_not_go_together(
    environment: Environment, requirement: Requirement, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        advise(STIM, environment, requirement)


# orders

CONE_OF_20 = Environment(half_angle=radians(20), hertz=20.0)


def test_a_large_cone_asks_for_fourth_order() -> None:
    """And for the order that is enough where less is asked; what is left is the drift's."""
    few = {"most_samples": 4, "most_history": 0, "slowest": 1}
    found = advise(STIM, CONE_OF_20, Requirement(drift=10.0), **few)  # type: ignore[arg-type]
    assert {one.design.order for one in found if one.meets} == {4}
    best = found[0]
    each = by_order(best, CONE_OF_20, Requirement(drift=10.0))
    assert [one.design.order for one in each] == [2, 3, 4]
    assert [one.meets for one in each] == [False, False, True]
    assert each[2] == best
    assert each[0].cost.work < each[1].cost.work < each[2].cost.work
    enough = advise(STIM, CONE_OF_20, Requirement(drift=1e3), **few)  # type: ignore[arg-type]
    assert enough[0].design.order == 2
