"""`LiveNavigator`: the states of `sculler navigate`, however the samples or results come in."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import sculler
from sculler.library.navigating import Begin
from sculler_model.design import STATUS_FAULT, STATUS_LOST
from sculler_model.golden import to_words
from sculler_model.navigation import NAVIGATION_GRADE, compiled_run

DESIGN = sculler.Design.preset("stim300")
BEGIN: Begin = {"lat": 48.0, "lon": 11.0, "height": 500.0, "vn": 30.0}
TURN = sculler.motion("turn", lat=48, lon=11, height=500, speed=30.0)
T, SPAN = DESIGN.sample_interval, DESIGN.samples_per_major


def _log(seconds: float = 0.5, design: sculler.Design = DESIGN) -> sculler.Log:
    return sculler.record(design, TURN, seconds)


def _same(a: sculler.NavHistory, b: sculler.NavHistory) -> None:
    assert len(a) == len(b)
    assert np.allclose(a.time, b.time, rtol=0, atol=1e-9)
    assert np.array_equal(a.to_numpy()[:, 1:], b.to_numpy()[:, 1:])


def _fed(live: sculler.LiveNavigator, counts: Any, size: int, **others: Any) -> sculler.NavHistory:
    parts = [
        live.feed(counts[k : k + size], **{n: v[k : k + size] for n, v in others.items()})
        for k in range(0, len(counts), size)
    ]
    return sculler.NavHistory.concatenate(parts)


@pytest.mark.parametrize("size", [1, 7, SPAN, 333, 5000])
@pytest.mark.parametrize("history", [0, 2])
def test_bursts_of_any_size_give_the_states_of_navigate(size: int, history: int) -> None:
    # with history the first interval is of short history, and is left out
    design = sculler.Design.preset("stim300", history=history)
    log = _log(design=design)
    vectors = sculler.FastModel(design).feed(log.counts)
    run = sculler.navigate(design, vectors, **BEGIN)
    assert run.left_out == (1 if history else 0)
    live = sculler.LiveNavigator(design, **BEGIN)
    _same(_fed(live, log.counts, size), run.history)
    assert live.state is not None
    assert live.state[1:] == run.end[1:]
    assert live.warnings == []


def test_states_come_as_soon_as_an_interval_is_complete() -> None:
    live = sculler.LiveNavigator(DESIGN, **BEGIN)
    new = [len(live.feed(sample)) for sample in _log(3 * SPAN * T).counts]
    assert np.flatnonzero(new).tolist() == [SPAN - 1, 2 * SPAN - 1, 3 * SPAN - 1]
    assert sum(new) == 4  # with the first one


@pytest.mark.parametrize("size", [1, 5, 64, 10_000])
def test_words_of_the_stream_give_the_same_states(size: int) -> None:
    vectors = sculler.FastModel(DESIGN).feed(_log().counts)
    words = np.array([word for row in vectors.rows() for word in to_words(DESIGN, row)], np.uint16)
    live = sculler.LiveNavigator(DESIGN, **BEGIN)
    parts = [live.feed_words(words[k : k + size]) for k in range(0, len(words), size)]
    _same(sculler.NavHistory.concatenate(parts), sculler.navigate(DESIGN, vectors, **BEGIN).history)


def test_results_one_by_one_give_the_same_states() -> None:
    vectors = sculler.FastModel(DESIGN).feed(_log())
    run = sculler.navigate(DESIGN, vectors, **BEGIN)
    live = sculler.LiveNavigator(DESIGN, **BEGIN)
    model = sculler.FastModel(DESIGN)
    log = _log()
    parts = []
    for k in range(0, len(log), 100):
        part = sculler.Log(log.counts[k : k + 100], times=log.times[k : k + 100])  # type: ignore[index]
        parts.append(live.feed_vectors(model.feed(part)))
    _same(sculler.NavHistory.concatenate(parts), run.history)


SLOW = sculler.Design.preset("hg4930")
"""100 Hz and four samples an interval: an alignment takes 10 s at least."""

ALIGNED: Begin = {"lat": 48.0, "lon": 11.0, "height": 500.0, "align": 10.0}


def _at_rest(seconds: float) -> sculler.Log:
    rest = sculler.motion("rest", lat=48, lon=11, height=500, heading=1.0, roll=0.02)
    return sculler.record(SLOW, rest, seconds)


def test_alignment_is_that_of_navigate() -> None:
    log = _at_rest(12)
    run = sculler.navigate(SLOW, sculler.FastModel(SLOW).feed(log.counts), **ALIGNED)
    live = sculler.LiveNavigator(SLOW, **ALIGNED)
    _same(_fed(live, log.counts, 37), run.history)
    assert live.aligned is not None
    assert run.start.time == pytest.approx(10.0)
    assert run.start.euler[0] == pytest.approx(0.02, abs=1e-4)
    assert live.warnings == list(live.aligned.warnings)


def test_faults_rails_and_losses_are_told() -> None:
    log = _log(0.1)
    counts = log.counts.copy()
    counts[45, 2] = DESIGN.words.gyro.hi
    live = sculler.LiveNavigator(DESIGN, **BEGIN)
    live.feed(counts, faults=(np.arange(len(counts)) // 60 == 1).astype(int))
    assert live.warnings == [
        "3 results with faulty samples (status bit 1), the first one ends at 0.04 s",
        "1 result with a count at its rail (status bit 2), the first one ends at 0.03 s",
    ]
    block = sculler.FastModel(DESIGN).feed(log.counts)
    block.status[4] = STATUS_LOST | STATUS_FAULT
    other = sculler.LiveNavigator(DESIGN, **BEGIN)
    assert len(other.feed_vectors(block)) == len(block) + 1
    assert [warning.split(" (")[1] for warning in other.warnings] == [
        "status bit 1), the first one ends at 0.05 s",
        "status bit 3), the first one ends at 0.05 s",
    ]


STILL = np.zeros((200, 6), int)


def _ways(log: sculler.Log, first: int, missing: int) -> dict[str, dict[str, Any]]:
    """How a loss of samples can be told: by the counter, by stamps, by both."""
    kept = np.r_[0:first, first + missing : len(log)]
    assert log.times is not None
    sequence, times = (np.arange(len(log)) + 65_400)[kept] % 65_536, log.times[kept]
    return {
        "counter": {"sequence": sequence},
        "stamps": {"times": times},
        "both": {"sequence": sequence, "times": times},
    }


@pytest.mark.parametrize("way", ["counter", "stamps", "both"])
@pytest.mark.parametrize("size", [1, 13, 1000])
@pytest.mark.parametrize("first", [200, 207, 213])
def test_over_missing_samples_it_coasts(way: str, size: int, first: int) -> None:
    missing = 31
    log = _log(0.5)
    kept = np.r_[0:first, first + missing : len(log)]
    live = sculler.LiveNavigator(DESIGN, sequence_bits=16, **BEGIN)
    states = _fed(live, log.counts[kept], size, **_ways(log, first, missing)[way])
    # the interval that the loss cuts short is lost whole
    lost = first % SPAN + missing
    assert [each["seconds"] for each in live.breaks] == pytest.approx([lost * T])
    assert live.warnings[0].startswith(f"a break of {lost * T:.6g} s (")
    before = first // SPAN + 1
    last, after = states.state(before - 1), states.state(before)
    assert last.time == pytest.approx(first // SPAN * SPAN * T)
    assert after.time == pytest.approx(last.time + lost * T)
    assert after.v == pytest.approx(last.v, abs=1e-9)
    assert after.euler == pytest.approx(last.euler, abs=1e-9)
    # 30 m/s north goes on over the gap, on the meridian's radius
    assert (after.lat - last.lat) * 6.38e6 == pytest.approx(last.v[0] * lost * T, rel=5e-3)
    assert np.all(np.diff(states.time) > 0)


def test_a_silence_that_is_told_is_coasted_over() -> None:
    log = _log(0.2)
    live = sculler.LiveNavigator(DESIGN, **BEGIN)
    live.feed(log.counts[:100])
    live.gap(1.5)
    states = live.feed(log.counts[100:])
    assert states.time[0] == pytest.approx(0.05 + 1.5)
    assert [each["seconds"] for each in live.breaks] == pytest.approx([1.5])


def test_a_core_that_was_reset_is_coasted_over_where_the_time_is_told() -> None:
    vectors = sculler.FastModel(DESIGN).feed(_log(0.1).counts)
    words = [word for row in vectors.rows() for word in to_words(DESIGN, row)]
    live = sculler.LiveNavigator(DESIGN, **BEGIN)
    live.feed_words(words + words[:17])
    with pytest.raises(sculler.InputError, match=r"core was reset: say how long .* gap\(seconds\)"):
        sculler.LiveNavigator(DESIGN, **BEGIN).feed_words(words + words)
    assert live.drop_words() == 17
    live.gap(0.25)
    states = live.feed_words(words)
    assert states.time[0] == pytest.approx(0.1 + 0.25)
    assert states.time[-1] == pytest.approx(0.1 + 0.25 + 0.1)
    # results that the core dropped are a break too, by `major` alone
    rows = [word for row in vectors.rows() for word in to_words(DESIGN, row) if row[0] != 4]
    other = sculler.LiveNavigator(DESIGN, **BEGIN)
    other.feed_words(rows)
    assert [each["seconds"] for each in other.breaks] == pytest.approx([DESIGN.major_interval])


def test_a_break_in_the_window_of_alignment_begins_it_anew() -> None:
    log = _at_rest(16)
    live = sculler.LiveNavigator(SLOW, **ALIGNED)
    assert len(live.feed(log.counts[:500])) == 0
    live.gap(1.0)
    states = live.feed(log.counts[500:])
    assert states.time[0] == pytest.approx(5 + 1.0 + 10)
    assert len(states) == 26


def test_after_a_break_nothing_is_aligned_anew() -> None:
    log = _at_rest(12)
    live = sculler.LiveNavigator(SLOW, **ALIGNED)
    live.feed(log.counts[:1100])
    live.gap(1.0)
    assert len(live.feed(log.counts[1100:])) == 26
    assert "position goes on with the velocity" in live.warnings[-1]


def test_a_counter_that_goes_back_is_refused_and_nothing_taken() -> None:
    log = _log(0.1)
    live = sculler.LiveNavigator(DESIGN, sequence_bits=16, **BEGIN)
    live.feed(log.counts[:50], sequence=np.arange(50))
    for sequence in (49, 20):  # twice, and out of order
        with pytest.raises(sculler.InputError, match=f"goes back from 49 to {sequence}"):
            live.feed(log.counts[50], sequence=[sequence])
    live.feed(log.counts[50:], sequence=np.arange(50, 200))
    assert live.warnings == []
    live.gap(0.1)  # the sensor began anew, and so did its counter
    live.feed(log.counts, sequence=np.arange(200))
    assert [each["seconds"] for each in live.breaks] == pytest.approx([0.1])


def test_nothing_is_compiled_in_flight(monkeypatch: pytest.MonkeyPatch) -> None:
    def never() -> None:
        raise AssertionError("compiled in flight")

    monkeypatch.setattr("sculler_model.navigation.navigator.WORTH_COMPILING", 1)
    monkeypatch.setattr("sculler_model.navigation.navigator.compiled_run", never)
    live = sculler.LiveNavigator(DESIGN, **BEGIN)
    assert len(live.feed(_log(0.1).counts)) == 11


def test_compiled_code_is_loaded_before_the_first_sample() -> None:
    pytest.importorskip("numba")
    live = sculler.LiveNavigator(DESIGN, **BEGIN, compiled=True)
    run: Any = compiled_run()
    loaded = list(run.signatures)
    counts = _log(0.5).counts
    found = [live.feed(counts[:333]), *map(live.feed, counts[333:400]), live.feed(counts[400:])]
    assert run.signatures == loaded
    states = sculler.NavHistory.concatenate(found)
    plain = sculler.LiveNavigator(DESIGN, **BEGIN).feed(counts)
    assert np.allclose(states.to_numpy(), plain.to_numpy(), rtol=1e-14, atol=1e-13)
    with pytest.raises(sculler.InputError, match="compiled is for the wander azimuth"):
        sculler.LiveNavigator(DESIGN, **BEGIN, compiled=True, mechanisation="geographic")


def test_the_clock_does_not_drift() -> None:
    # as after a day of samples one by one
    live = sculler.LiveNavigator(DESIGN, **BEGIN)
    live._count = 86_400 * 2000
    for sample in _log(0.01).counts:
        states = live.feed(sample)
    assert states.time[-1] == pytest.approx(86_400.01, abs=1e-10)


def test_what_is_at_fault_is_refused_in_a_line_and_not_taken() -> None:
    live = sculler.LiveNavigator(DESIGN, **BEGIN)
    live.feed(STILL[:7])
    for counts in (np.full((3, 6), 2**23), np.full((3, 6), 0.5)):
        with pytest.raises(sculler.InputError):
            live.feed(counts)
    assert len(live.feed(STILL[7:20])) == 2
    with pytest.raises(sculler.InputError, match="fed with samples before"):
        live.feed_words([0])
    with pytest.raises(sculler.InputError, match="unsigned 16-bit words"):
        sculler.LiveNavigator(DESIGN, **BEGIN).feed_words([65_536])
    with pytest.raises(sculler.InputError, match="height: missing"):
        sculler.LiveNavigator(DESIGN, lat=1.0, lon=2.0)
    with pytest.raises(sculler.InputError, match="heading and align contradict"):
        sculler.LiveNavigator(DESIGN, **BEGIN, heading=3.0, align=2.0)
    with pytest.raises(sculler.InputError, match="noise is for align, give that too"):
        sculler.LiveNavigator(DESIGN, **BEGIN, noise=NAVIGATION_GRADE)
    with pytest.raises(TypeError, match="unexpected keyword 'latitude'"):
        sculler.LiveNavigator(DESIGN, **BEGIN, latitude=3.0)  # type: ignore[call-arg]
    with pytest.raises(sculler.InputError, match="seconds: -1 is not allowed"):
        live.gap(-1)
