"""Drift against frequency: closed form, integers and host hold each other to account."""

from __future__ import annotations

from fractions import Fraction
from math import degrees, gcd, pi, radians, sin

import numpy as np
import pytest

from host_path import attitude_error, chained, fine_design, through_core
from sculler_model.analysis.frequency import (
    drift,
    fine,
    fits,
    integer_point,
    law,
    record,
    uncorrected,
)
from sculler_model.analysis.oscillation import Cone, Oscillation, Scull
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.motion import Coning

CONE, SCULL = Cone(radians(0.1)), Scull(radians(0.1), 10.0)
PER_HOUR = degrees(1) * 3600

DENSE = {  # time-taylor n = 3 (Savage-20 method 1): 57/80, 57/80, 33/80
    "denominator": 80,
    "taps": [[], [57], [57, 33]],
}


def dense_design() -> Design:
    data = fine_design(3).as_json()
    data["algorithm"] = {"family": "table", "samples": 3, "minors": 2, "table": DENSE}
    return Design.parse(data)


DESIGNS = {
    "n=2": fine_design(2, minors=3),
    "n=4": fine_design(4, minors=5),
    "n=2 p=1": fine_design(2, 1, minors=4),
    "rate n=2": fine_design(2, minors=2, kind="rate"),
    "dense": dense_design(),
}


@pytest.mark.parametrize("vibration", [CONE, SCULL], ids=["coning", "sculling"])
@pytest.mark.parametrize("name", DESIGNS)
def test_integers_leave_what_the_closed_form_says(name: str, vibration: Oscillation) -> None:
    design = fine(DESIGNS[name], vibration, 400.0)
    for hertz in (90.0, 237.0, 390.0):
        point = integer_point(design, vibration, hertz)
        assert abs(point.hertz / hertz - 1) < 0.01
        floor = 2e-10 * abs(float(uncorrected(vibration, np.array([hertz]))[0]))  # of 32 bits
        assert point.second_order == pytest.approx(point.closed_form, rel=1e-5, abs=floor)
        # what the host arrives at differs by higher orders of the amplitude alone
        assert point.complete == pytest.approx(point.second_order, rel=0.1, abs=1e-8)


@pytest.mark.parametrize("vibration", [CONE, SCULL], ids=["coning", "sculling"])
def test_published_laws_come_out_of_the_integers(vibration: Oscillation) -> None:
    for samples, constant in ((2, Fraction(1, 30)), (3, Fraction(3, 280)), (4, Fraction(1, 315))):
        found = law(fine_design(samples, minors=2), vibration)
        assert (found.constant, found.order) == (-constant, 2 * samples + 1)
        assert found.measured_constant == pytest.approx(float(-constant), rel=3e-3)
        assert found.measured_order == pytest.approx(2 * samples + 1, abs=0.15)


def test_yang_and_zeng_at_one_degree_and_20_hz() -> None:
    """n = 4, M = 5, 1 kHz: 0.11 °/h; filtered rates, n = 2: 1.07e-2 °/h (DESIGN, misprints)."""
    cone = Cone(radians(1.0))
    yang = fine(fine_design(4, minors=5, rate=1000.0), cone, 25.0)
    assert PER_HOUR * abs(integer_point(yang, cone, 20.0).complete) == pytest.approx(0.11, rel=0.1)
    zeng = fine(fine_design(2, minors=1, rate=1000.0, kind="rate"), cone, 25.0)
    point = integer_point(zeng, cone, 20.0)
    assert PER_HOUR * point.closed_form * (20 / point.hertz) ** 5 == pytest.approx(
        1.07e-2, rel=0.01
    )
    assert point.second_order == pytest.approx(point.closed_form, rel=1e-4)


def test_complete_drift_is_that_of_the_chained_attitude() -> None:
    """Against quaternions chained one by one and the motion's own attitude."""
    cone, hertz, rate, majors = Cone(radians(1.0)), 40.0, 1000.0, 50
    design = fine_design(2, minors=5, rate=rate, gyro_lsb=5e-12)
    point = integer_point(design, cone, hertz)
    periods, samples = point.periods, point.samples
    motion = Coning(cone.half_angle, 2 * pi * point.hertz)
    increments = through_core(design, [motion.increments(samples, 1 / rate)])
    start, end = motion.attitude(np.array([0.0, samples / rate]))
    found = chained(tuple(start.tolist()), increments.phi)
    error = attitude_error(found, tuple(end.tolist()))[2] / (samples / rate)
    assert len(increments) > majors
    assert periods * rate / samples == point.hertz
    assert point.complete == pytest.approx(error, rel=1e-4)
    # 4th order of the amplitude: more than a thousandth of what is left here
    assert abs(point.complete / point.second_order - 1) > 1e-3


@pytest.mark.parametrize("hertz", [0.7, 33.3, 999.0])
def test_records_are_whole_periods_without_a_common_factor(hertz: float) -> None:
    design = fine_design(4, minors=5)
    periods, samples = record(design, hertz)
    assert gcd(periods, samples) == 1
    assert samples % design.samples_per_major == 0
    assert periods >= 7
    assert periods * 2000.0 / samples == pytest.approx(hertz, rel=0.15)


@pytest.mark.parametrize("hertz", [0.0, 1000.0, -3.0])
def test_refuses_what_is_not_below_nyquist(hertz: float) -> None:
    with pytest.raises(InputError, match="Nyquist limit of 1000 Hz of fine"):
        integer_point(fine_design(4), CONE, hertz)


def test_uncorrected_is_half_the_product_of_the_amplitudes() -> None:
    hertz = np.array([1.0, 50.0])
    a = sin(radians(0.1))
    assert uncorrected(CONE, hertz) == pytest.approx(-0.5 * a * a * 2 * pi * hertz)
    assert uncorrected(SCULL, hertz) == pytest.approx(-0.5 * radians(0.1) * 10.0)


def test_a_thousand_frequencies_at_once() -> None:
    hertz = np.geomspace(1.0, 999.0, 1000)
    one_by_one = [float(drift(DESIGNS["n=4"], CONE, np.array(f))) for f in hertz]
    assert drift(DESIGNS["n=4"], CONE, hertz) == pytest.approx(one_by_one, rel=1e-9, abs=1e-20)


@pytest.mark.parametrize("name", ["n=2", "rate n=2"])
@pytest.mark.parametrize("vibration", [CONE, SCULL], ids=["coning", "sculling"])
def test_fits_tells_what_the_quantiser_would_refuse(name: str, vibration: Oscillation) -> None:
    design = fine(DESIGNS[name], vibration, 100.0)
    assert fits(design, vibration, 100.0)
    integer_point(design, vibration, 100.0)
    data = design.as_json()
    data["sensor"]["gyro"]["bits"] = 29
    narrow = Design.parse(data)
    assert not fits(narrow, vibration, 100.0)
    with pytest.raises(InputError, match="does not fit 29 bits"):
        integer_point(narrow, vibration, 100.0)


SINC = {"kind": "sinc", "width_samples": 1.0}


@pytest.mark.parametrize("vibration", [CONE, SCULL], ids=["coning", "sculling"])
def test_tuned_designs_are_studied_behind_their_filter(vibration: Oscillation) -> None:
    """Rates tuned to sinc are Zeng's filtered rates; increments behind a wide mean too."""
    data = fine_design(2, minors=2, kind="rate").as_json()
    data["algorithm"] |= {"family": "tuned", "filter": [SINC]}
    tuned, zeng = (
        fine(Design.parse(data), vibration, 400.0),
        fine(DESIGNS["rate n=2"], vibration, 400.0),
    )
    hertz = np.array([50.0, 200.0])
    assert drift(tuned, vibration, hertz) == pytest.approx(drift(zeng, vibration, hertz), rel=1e-6)
    assert integer_point(tuned, vibration, 200.0).second_order == pytest.approx(
        integer_point(zeng, vibration, 200.0).second_order, rel=1e-6
    )
    data = fine_design(3, minors=2).as_json()
    data["algorithm"] |= {"family": "tuned", "filter": [SINC | {"width_samples": 2.0}]}
    wide = fine(Design.parse(data), vibration, 400.0)
    point = integer_point(wide, vibration, 200.0)
    assert point.second_order == pytest.approx(point.closed_form, rel=1e-4)
    without = fine(DESIGNS["n=2"], vibration, 400.0)
    assert abs(point.closed_form) < abs(integer_point(without, vibration, 200.0).closed_form)
    assert law(wide, vibration).measured_order == pytest.approx(7, abs=0.2)
