"""`hardware.hardening`: what a design file may ask for, and how the models carry status bit 4."""

from __future__ import annotations

import pytest

from sculler_model.design import STATUS_BITS, STATUS_UPSET, Design
from sculler_model.errors import InputError
from sculler_model.golden import CycleModel, Dropping, GoldenModel, Timing
from strategies import DESIGNS, with_hardware

PLAIN = with_hardware(DESIGNS["smallest"], core="compact")
HARD = with_hardware(DESIGNS["smallest"], core="compact", hardening="detect")
SAMPLE = ((1, 2, 3), (4, 5, 6), 0)


def test_off_is_left_unsaid():
    off = with_hardware(DESIGNS["smallest"], core="compact", hardening="off")
    assert off.hardware.hardening is None
    assert off.digest == PLAIN.digest
    assert HARD.digest != PLAIN.digest
    assert (PLAIN.status_bits, HARD.status_bits) == (STATUS_BITS, STATUS_BITS + 1) == (4, 5)


@pytest.mark.parametrize(
    ("hardware", "told"),
    [
        (
            {"core": "pipelined", "hardening": "detect", "handover": "stream"},
            'hardware.hardening: "detect" is not built for core = "pipelined" with'
            ' handover = "stream": leave that out, or give core = "compact"',
        ),
        (
            {"core": "pipelined", "hardening": "recover", "bus": {"result": "axi-lite"}},
            'hardware.hardening: "recover" is not built for core = "pipelined" with'
            ' [hardware.bus]: leave one out, or give core = "compact"',
        ),
        (
            {"core": "compact", "hardening": "always"},
            'hardware.hardening: \'always\' is not allowed, give "off", "detect" or "recover"',
        ),
    ],
)
def test_what_is_not_built_is_refused_in_one_line(hardware, told):
    data = {**DESIGNS["smallest"].as_json(), "hardware": hardware}
    with pytest.raises(InputError) as caught:
        Design.parse(data)
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_the_golden_model_marks_the_present_interval_only():
    model = GoldenModel(HARD)
    model.upset()
    marked, next_one = model.step(*SAMPLE), model.step(*SAMPLE)
    assert marked.status & STATUS_UPSET
    assert not next_one.status & STATUS_UPSET
    assert marked._replace(status=0, major=1) == next_one._replace(status=0)


def run(model, clocks, upset_at):
    """Rows taken, each with whether `upset` was high when it was shown."""
    rows, words = [], []
    for clock in range(clocks):
        if clock in upset_at:
            model.upset()
        shown = model.clock(SAMPLE, 1)
        if shown.result_valid:
            words.append(shown.result[0])
            if shown.result[1]:
                rows.append((words, shown.upset))
                words = []
    return rows


@pytest.mark.parametrize(
    ("timing", "under_way"),
    [(Timing(4, spacing=30), 2), (Timing(4, spacing=30, dropping=Dropping(3, 1)), 3)],
)
def test_the_cycle_model_marks_as_many_results_as_may_be_hurt(timing, under_way):
    """Words apart from bit 4 of the status are those of a run without an upset."""
    assert timing.under_way == under_way
    clean = run(CycleModel(HARD, timing), 1000, ())
    hurt = run(CycleModel(HARD, timing), 1000, {100})
    assert len(clean) == len(hurt) > 8
    marked = [
        number
        for number, ((before, _), (after, _)) in enumerate(zip(clean, hurt, strict=True))
        if before != after
    ]
    place = len(clean[0][0]) // len(HARD.columns)
    for number in marked:
        changed = [
            i
            for i, pair in enumerate(zip(clean[number][0], hurt[number][0], strict=True))
            if pair[0] != pair[1]
        ]
        assert changed == [place]
        assert hurt[number][0][place] == clean[number][0][place] | STATUS_UPSET
    # the one whose status came before the upset cannot be marked any more
    assert len(marked) in (under_way - 1, under_way)
    assert marked == list(range(marked[0], marked[0] + len(marked)))


@pytest.mark.parametrize("dropping", [None, Dropping(1, 1)])
def test_an_upset_is_told_clock_by_clock_by_hand(dropping):
    """Results of one sample each, three clocks apart, on the pipelined core's parallel ports.

    Seen in clock 10, told from clock 11 on until two results more are taken whole, or three.
    """
    design = with_hardware(DESIGNS["smallest"], hardening="detect", handover="parallel")
    timing = Timing(1, spacing=3, dropping=dropping)
    clean, hurt = CycleModel(design, timing), CycleModel(design, timing)
    for clock in range(30):
        if clock == 10:
            hurt.upset()
        before, after = clean.clock(SAMPLE, 1), hurt.clock(SAMPLE, 1)
        # taken in clocks 0, 3, 6 ...; so valid in 1, 4, ... 13 and 16, or 19 too
        told = 11 <= clock <= (16 if dropping is None else 19)
        assert (before.upset, after.upset) == (0, int(told))
        assert before.result_valid == after.result_valid == int(clock % 3 == 1)
        marked = list(before.result)
        if told and before.result_valid:
            marked[1] |= STATUS_UPSET
        assert after.result == tuple(marked)
        assert after[:2] == before[:2]
    assert STATUS_UPSET == 16
