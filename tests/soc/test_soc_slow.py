"""What a chip does beyond a plain flight: it aligns, falls behind, hears noise, has another sensor.

In Verilator, with slow clocks.  Frames come from independent makers; a processor that is too slow
is held against coasting and navigation piece by piece.
"""

from __future__ import annotations

import random

import numpy as np
import pytest

import front_designs
import raw_datagrams
from sculler.library import motions
from sculler.runs.chip import make_chip
from sculler.runs.chip_flight import Flown, differences, figures, flown
from sculler.soc import ChipRecord, SocPlan, chip_alignment, fly_log, follow
from sculler_model.design import Design
from sculler_model.fast import FastModel
from sculler_model.frames import EARTH_RATE, conjugate, product, to_rotation_vector
from sculler_model.front import FrontModel
from sculler_model.golden import GoldenModel
from soc.conftest import START, needs_compiler, needs_verilator
from studies.soc.designs import ORDER_FOUR, SLOW, TOO_SLOW, spi_design
from studies.soc.more import ALIGNMENT_S, NOISE

pytestmark = [pytest.mark.deep, needs_compiler, needs_verilator]


def counts_of(design: Design, name: str, seconds: float) -> list[list[int]]:
    found: list[list[int]] = motions.record(design, motions.motion(name), seconds).counts.tolist()
    return found


def exact(record: ChipRecord, plan: SocPlan) -> None:
    """All states came that should, attitude and velocity to the last bit.

    Over gaps to rounding: coasting calls sine and cosine, which two libraries round each its way.
    So is the state at an alignment's end, which the firmware tells as its navigator has it.
    """
    followed = follow(plan, record)
    assert record.states["number"].tolist() == record.numbers[followed.rows].tolist()
    attitude, velocity, position = differences(record, followed)
    if followed.coasted or plan.align:
        assert (attitude < 1e-14, velocity < 1e-12) == (True, True)
    else:
        assert (attitude, velocity) == (0.0, 0.0)
    assert position < 1e-8
    assert np.array_equal(record.states["time"], followed.states.time)


def test_order_four() -> None:
    """The terms of third and fourth order; the model's integers, Python's states."""
    plan = SocPlan(ORDER_FOUR, START)
    assert plan.memory == 128
    counts = counts_of(ORDER_FOUR, "spin-cone", 5.12)
    flight = flown(make_chip(plan), counts, [0] * len(counts))
    assert flight.same
    assert len(flight.record.results) == 10
    assert np.any(np.abs(flight.record.results.components[:, -1]) > 0)
    exact(flight.record, plan)


def aligned(fine: bool, after: float) -> tuple[Flown, SocPlan]:
    """At rest, and some seconds on."""
    start = motions.motion("rest").state(np.zeros(1)).state(0)
    align = chip_alignment(SLOW, ALIGNMENT_S, fine, NOISE, start.lat)
    plan = SocPlan(SLOW, start._replace(q=(0.0, 1.0, 0.0, 0.0)), align=align)
    counts = counts_of(SLOW, "rest", ALIGNMENT_S + after)
    chip = make_chip(plan)
    flight = flown(chip, counts, [0] * len(counts))
    assert figures(chip, flight)["alignments"][0]["error"] == 0
    return flight, plan


def test_it_aligns() -> None:
    """Coarsely, as Python does, and the true attitude; no result is lost while it computes."""
    flight, plan = aligned(False, 1.0)
    assert flight.same
    assert len(flight.record.results) == 69
    (one,) = flight.followed.alignments
    assert one.expected is not None
    rounding = 2e-15 * 12 / (EARTH_RATE * ALIGNMENT_S) ** 2
    assert 0 < one.apart < rounding
    expected = one.expected.covariance
    np.testing.assert_allclose(one.told["covariance"], expected, rtol=0.15, atol=1e-9)
    assert one.told["down_rate"] == pytest.approx(one.expected.down_rate, rel=1e-9)
    assert flight.record.states["number"].tolist() == list(range(62, 69))
    exact(flight.record, plan)
    truth = motions.motion("rest").state(np.zeros(1)).state(0).q
    x, y, z, w = one.told["q"].tolist()
    off = to_rotation_vector(product((w, x, y, z), conjugate(truth)))
    assert np.abs(off[:2]).max() < 1e-4  # counts of 2^-21 degree
    assert abs(off[2]) < 0.05


def test_it_aligns_finely_and_falls_behind() -> None:
    """That takes longer than results can wait: placeholders stand for samples, and are flagged."""
    flight, plan = aligned(True, 9.0)
    (one,) = flight.followed.alignments
    assert one.expected is not None
    assert one.apart < 2e-15 * 12 / (EARTH_RATE * ALIGNMENT_S) ** 2
    np.testing.assert_allclose(one.told["gyro_bias"], one.expected.gyro_bias, rtol=1e-3, atol=1e-10)
    record = flight.record
    assert 99 <= flight.equal_results < len(record.results) == len(flight.model)
    assert np.asarray(record.results.major).tolist() == list(range(len(flight.model)))
    flagged = np.asarray(record.results.status) & 2
    assert not flagged[: flight.equal_results].any()
    assert flagged[flight.equal_results :].any()
    assert flight.followed.coasted == 0
    exact(record, plan)


def test_a_window_that_moves_is_refused() -> None:
    """And the next one, without an end, is no reason to stop."""
    align = chip_alignment(SLOW, ALIGNMENT_S, False, NOISE, START.lat)
    plan = SocPlan(SLOW, START, align=align)
    counts = counts_of(SLOW, "turn", ALIGNMENT_S + 0.5)
    flight = flown(make_chip(plan), counts, [0] * len(counts))
    assert flight.same
    (one,) = flight.followed.alignments
    assert (int(one.told["error"]), one.expected) == (7, None)  # SCULLER_TURNING
    assert not len(flight.record.states)


def test_a_processor_that_is_too_slow() -> None:
    """Results are dropped; those that come are the model's, and it coasts between them."""
    plan = SocPlan(TOO_SLOW, START)
    chip = make_chip(plan)
    counts = counts_of(TOO_SLOW, "turn", 3.2)
    flight = fly_log(plan, chip.generated, chip.firmware, counts)
    model = [
        list(r.row()) for r in GoldenModel(TOO_SLOW).run([(r[:3], r[3:], False) for r in counts])
    ]
    record = flight.record
    rows = [list(row) for row in record.results.rows() if row[0] < len(model)]
    majors = [row[0] for row in rows]
    assert rows == [model[major] for major in majors]
    assert len(rows) > 15
    assert majors == sorted(set(majors))
    assert majors[-1] > len(majors) + 2  # some were dropped
    # on to the end: what is the next one's was begun within an update
    assert flight.clocks - int(record.free[-1]) < 1_000_000
    assert record.numbers.tolist() == list(range(len(record.numbers)))
    exact(record, plan)
    assert follow(plan, record).coasted > 0.1


def test_noise_and_silence_on_the_line() -> None:
    """Any bytes, cut frames, then nothing for a second: marked, and it flies on."""
    plan, rng = SocPlan(SLOW, START), random.Random(1)
    chip, counts = make_chip(plan), counts_of(SLOW, "turn", 4.0)
    silence = range(200, 330)

    def wire(number: int, frame: bytes) -> bytes:
        assert frame[:-9] == raw_datagrams.stim300(*_halves(counts[number]), number * 16)[:-9]
        if number in silence:
            return b""
        if number % 97 == 5:
            return rng.randbytes(len(frame))
        return frame[:9] if number % 97 == 30 else frame

    flight = fly_log(plan, chip.generated, chip.firmware, counts, wire=wire)
    link = SLOW.front
    assert link is not None
    rng.seed(1)
    front, samples = FrontModel(link), []
    for number in range(len(counts)):
        frame = raw_datagrams.stim300(*_halves(counts[number]), number * 16)
        for byte in wire(number, frame):
            samples += front.take(byte, round((number + 0.3) * link.interval))
    model = FastModel(SLOW).feed(
        np.array([[*s.gyro, *s.accel] for s in samples]),
        np.array([s.fault for s in samples], np.uint8),
    )
    record = flight.record.first(len(model))
    assert len(model) >= 24
    assert list(record.results.rows()) == list(model.rows())
    flagged = np.asarray(record.results.status) & 2
    assert 10 <= np.count_nonzero(flagged) < len(model)
    assert record.counters[-1][3] >= len(silence) - 1
    exact(record, plan)


def _halves(row: list[int]) -> tuple[list[int], list[int]]:
    return row[:3], row[3:]


@pytest.mark.parametrize("sensor", ["adis16505", "adis16488"])
def test_a_sensor_on_spi(sensor: str) -> None:
    """Bursts, and registers one by one."""
    design = spi_design(sensor)
    plan = SocPlan(design, START)
    chip, counts = make_chip(plan), counts_of(design, "turn", 1.28)

    def wire(number: int, frame: bytes) -> bytes:
        own = front_designs.made(sensor, *_halves(counts[number]), number)
        return b"" if number in (41, 42) else own

    flight = fly_log(plan, chip.generated, chip.firmware, counts, wire=wire)
    expected = []
    for number, row in enumerate(counts):
        lost = number in (41, 42)
        kept = expected[-1][:2] if lost else (tuple(row[:3]), tuple(row[3:]))
        expected.append((*kept, lost))
    model = [list(result.row()) for result in GoldenModel(design).run(expected)]
    record = flight.record.first(len(model))
    assert list(map(list, record.results.rows())) == model
    assert [row[1] & 2 for row in model] == [0, 0, 2, 0, 0, 0, 0, 0]
    exact(record, plan)
