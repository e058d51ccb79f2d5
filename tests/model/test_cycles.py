"""The cycle model keeps the contract of the ports, clause by clause."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sculler_model.design import COLUMNS, Design, Result
from sculler_model.errors import InputError
from sculler_model.golden import (
    ChannelTiming,
    CycleModel,
    Dropping,
    GoldenModel,
    Ports,
    Sample,
    Timing,
    result_ports,
)
from strategies import DESIGNS, make_design, random_counts, with_hardware
from tiers import few_of

ZERO: Sample = ((0, 0, 0), (0, 0, 0), 0)
NOTHING = Result(0, 0, *[(0, 0, 0)] * 6)
STREAM = {"handover": "stream"}


class Clock(NamedTuple):
    offered: Sample | None
    result_ready: int
    rst: int
    out: Ports


def samples(design: Design, count: int, seed: int) -> list[Sample]:
    rng = np.random.default_rng(seed)
    rows = random_counts(design, count, rng).tolist()
    faults = (rng.random(count) < 0.1).astype(int).tolist()
    return [
        ((a, b, c), (d, e, f), fault)
        for (a, b, c, d, e, f), fault in zip(rows, faults, strict=True)
    ]


def drive(
    design: Design,
    timing: Timing,
    clocks: int,
    seed: int,
    offer: float = 0.7,
    take: float = 0.5,
    reset: float = 0.0,
    give_up: float = 0.0,
) -> list[Clock]:
    """Clocks with random stalls; an offered sample stays on the port until it is taken or lost."""
    model = CycleModel(design, timing)
    rng = np.random.default_rng(seed)
    stream = iter(samples(design, clocks, seed))
    waiting: Sample | None = None
    trace = []
    pause = False
    for offer_now, take_now, reset_now, give_up_now in rng.random((clocks, 4)):
        if waiting is None and offer_now < offer and not pause:
            waiting = next(stream)
        ready, rst = int(take_now < take), int(reset_now < reset)
        trace.append(Clock(waiting, ready, rst, model.clock(waiting, ready, rst)))
        taken = trace[-1].out.sample_ready and not rst
        pause = waiting is not None and not taken and give_up_now < give_up
        if taken or pause:
            waiting = None
    return trace


def losses(trace: list[Clock]) -> list[int]:
    """The clocks in which a sample turns out to be lost, from the definition."""
    return [
        now
        for now in range(1, len(trace))
        for before, this in [trace[now - 1 : now + 1]]
        if before.offered and not before.out.sample_ready and not before.rst
        if not this.offered and not this.rst
    ]


def words_of(design: Design, result: Result) -> list[tuple[int, int]]:
    """(data, last) of each word of a result, by Python's own conversion to bytes."""
    vectors = ("alpha", "coning_within", "coning_between")
    vectors += ("nu", "sculling_within", "sculling_between")
    size = 2 * max(-(-getattr(design.words, vector).bits // 16) for vector in vectors)
    major, status, *components = result.row()
    data = (major % 256**size).to_bytes(size, "little") + status.to_bytes(size, "little")
    data += b"".join(number.to_bytes(size, "little", signed=True) for number in components)
    pairs = zip(data[0::2], data[1::2], strict=True)
    return [(low + 256 * high, int(2 * i + 2 == len(data))) for i, (low, high) in enumerate(pairs)]


def assert_keeps_contract(design: Design, timing: Timing, trace: list[Clock]) -> int:
    """Check every clock of a trace against the contract; the number of results taken whole."""
    span, phases = design.samples_per_major, design.algorithm.samples
    stream = design.hardware.handover == "stream"
    words = len(words_of(design, NOTHING)) if stream else 1
    work = timing.work or (0,) * phases
    total = 0

    lost = losses(trace)
    # since reset: its clock, samples accepted (clocks), what is to be shown (clock from which the
    # first part of its result is due, content), and what was taken of it (clocks)
    started, golden = 0, GoldenModel(design)
    accepted: list[int] = []
    parts: list[tuple[int, tuple[int, ...]]] = []
    taken: list[int] = []
    ends: list[int] = []  # clocks of the intervals' last samples
    drops: list[int] = []  # clocks in which a result was dropped
    for now, (offered, result_ready, rst, out) in enumerate(trace):
        # the next part is valid when its result is due, and a word some clocks after the last one
        valid = len(taken) < len(parts) and now >= parts[len(taken)][0]
        if taken:
            spacing = timing.handover_spacing
            if timing.dropping and len(taken) % words == 0:
                spacing = timing.dropping.refill
            valid = valid and now >= taken[-1] + spacing
        assert out.result_valid == int(valid), now
        # what the ports show without being valid means nothing and is masked
        nothing = (0, 0) if stream else (0,) * len(COLUMNS)
        assert out.result == (parts[len(taken)][1] if valid else nothing), now
        # sample_ready is low exactly for one of four reasons
        last_is_next = len(accepted) % span == span - 1
        busy = [clock + work[i % phases] for i, clock in enumerate(accepted) if work[i % phases]]
        reasons = [
            now < started + timing.startup,
            bool(accepted) and now < accepted[-1] + timing.spacing,
            work[len(accepted) % phases] > 0 and bool(busy) and now < busy[-1],
            last_is_next
            and not timing.dropping
            and len(parts) // words - len(taken) // words >= timing.results,
        ]
        # counters
        told = bisect_right(lost, now - 2) - bisect_left(lost, started)
        assert out.samples_lost == max(told, 0), now
        assert out.results_dropped == sum(drop <= now - 2 for drop in drops), now
        assert out.sample_ready == int(not any(reasons)), (now, reasons)

        if rst:
            started, golden = now + 1, GoldenModel(design)
            accepted, parts, taken, ends, drops = [], [], [], [], []
            continue
        is_last = bool(offered is not None and out.sample_ready and last_is_next)
        if timing.dropping and now - timing.dropping.claim in [*ends, *[now] * is_last]:
            # results made before that are not taken whole before this clock: the second is dropped
            older = sum(end < now - timing.dropping.claim for end in ends)
            first = len(taken) // words * words  # its first part
            if older - len(drops) - first // words > 1:
                del parts[first + words : first + 2 * words]
                drops.append(now)
        if out.result_valid and result_ready:
            taken.append(now)
            total += len(taken) % words == 0
        if offered is not None and out.sample_ready:
            accepted.append(now)
            result = golden.step(*offered)
            if result is not None:
                since = ends[-1] if ends else started - 1
                if bisect_left(lost, now) > bisect_right(lost, since):
                    result = result._replace(status=result.status | 8)
                ends.append(now)
                shown = words_of(design, result) if stream else [result.row()]
                parts += [(now + timing.latency, part) for part in shown]
    return total


SHORT = ["smallest", "rate_1p0", "taylor_7p0", "taylor_3p3", "late_sum_2", "wide_5p0"]


@pytest.mark.parametrize("latency", [1, 2, 9, 40])
@pytest.mark.parametrize("name", SHORT)
def test_random_stalls(name: str, latency: int) -> None:
    design, timing = DESIGNS[name], Timing(latency)
    trace = drive(design, timing, 600, seed=latency)
    assert assert_keeps_contract(design, timing, trace) > 3


@pytest.mark.parametrize("latency", [1, 7, 30])
@pytest.mark.parametrize("name", SHORT)
def test_resets_at_any_time(name: str, latency: int) -> None:
    design, timing = DESIGNS[name], Timing(latency)
    trace = drive(design, timing, 900, seed=5, reset=0.01)
    assert sum(clock.rst for clock in trace) > 3
    assert_keeps_contract(design, timing, trace)


SLOW = {
    "at once": Timing(1),
    "spacing": Timing(20, spacing=3),
    "startup": Timing(5, startup=17, handover_spacing=4),
    "everything": Timing(90, spacing=7, startup=40, work=(50, 0, 30), handover_spacing=2),
    "work at the end": Timing(12, work=(0, 0, 25)),
    "two results": Timing(24, handover_spacing=10, results=2),
    "long work": Timing(300, spacing=9, work=(300, 0, 0)),
}
HANDOVERS = ("parallel", "stream")


@pytest.mark.parametrize(
    "case",
    few_of(
        {f"{name}, {how}": (timing, how) for name, timing in SLOW.items() for how in HANDOVERS},
        [
            *("everything, parallel", "everything, stream", "startup, stream"),
            *("two results, stream", "long work, parallel", "long work, stream"),
        ],
    ),
)
def test_every_number_of_the_timing(case: tuple[Timing, str]) -> None:
    timing, handover = case
    design = with_hardware(DESIGNS["dense_odd_3"], handover=handover)
    for seed, rates in enumerate([(1, 1, 0), (0.7, 0.5, 0), (0.9, 0.9, 0.001)]):
        trace = drive(design, timing, 3000, seed, *rates)
        assert assert_keeps_contract(design, timing, trace) >= 1


DROPPING = {
    "drops": Timing(5, dropping=Dropping(0, 3)),
    "drops, spacing": Timing(11, spacing=2, handover_spacing=1, dropping=Dropping(0, 10)),
    "drops, everything": Timing(
        90, spacing=7, startup=40, work=(50, 0, 30), dropping=Dropping(88, 3)
    ),
    "drops late": Timing(20, spacing=3, handover_spacing=3, dropping=Dropping(18, 3)),
}


@pytest.mark.parametrize(
    "case",
    few_of(
        {
            f"{name}, {how}": (timing, how)
            for name, timing in (SLOW | DROPPING).items()
            for how in HANDOVERS
        },
        [
            *("everything, parallel", "everything, stream", "two results, stream"),
            *("drops, everything, parallel", "drops, everything, stream"),
            *("drops, spacing, parallel", "drops late, stream"),
        ],
    ),
)
def test_lost_samples_and_dropped_results(case: tuple[Timing, str]) -> None:
    timing, handover = case
    design = with_hardware(DESIGNS["dense_odd_3"], handover=handover)
    dropped = lost = 0
    for seed, rates in enumerate([(0.9, 0.02), (0.3, 0.3), (1, 1), (0.9, 0.0005)]):
        trace = drive(design, timing, 2500, seed, *rates, 0.0005, 0.3)
        assert_keeps_contract(design, timing, trace)
        dropped += max(clock.out.results_dropped for clock in trace)
        lost += max(clock.out.samples_lost for clock in trace)
    assert (dropped > 0) == (timing.dropping is not None)
    waits = timing.dropping is None or timing.spacing > 1
    assert (lost > 0) == waits


def test_a_result_that_is_dropped_by_hand() -> None:
    """A result a clock for ten clocks, to a host that takes the first one in clock 6."""
    design = make_design("drop", 1, 1, 1, (8, 8))
    model = CycleModel(design, Timing(latency=2, dropping=Dropping(claim=1, refill=1)))
    seen = []
    for now in range(20):
        sample = ((now, 0, 0), (0, 0, 0), 0) if now < 10 else None
        seen.append(model.clock(sample, int(now == 6 or now > 12)))
    assert all(ports.sample_ready for ports in seen)
    # interval i ends in clock i and claims in i + 1; 1 is dropped in clock 3, 4 in 6, for the first
    # is taken in that clock; 5 in 7 is first then, and 6 dropped in 8
    taken = [ports.result[0] for now, ports in enumerate(seen) if now == 6 or now > 12]
    assert taken[:3] == [0, 5, 9]
    shown = [ports.result[0] if ports.result_valid else None for ports in seen]
    assert shown == [None, None, *[0] * 5, *[5] * 7, 9, *[None] * 5]
    assert [ports.results_dropped for ports in seen] == [
        *[0] * 5,
        *[1, 2, 3, 4],
        *[4, 5, 6, 7],
        *[7] * 7,
    ]


def test_counters_stay_at_their_highest() -> None:
    model = CycleModel(DESIGNS["smallest"], Timing(1, startup=1 << 18))
    for _ in range(65535):
        model.clock(ZERO, 1)
        model.clock(None, 1)
    assert model.ports().samples_lost == 65534
    for _ in range(10):
        model.clock(ZERO, 1)
        model.clock(None, 1)
    assert model.ports().samples_lost == 65535


@settings(max_examples=80, deadline=None)
@given(
    n=st.integers(1, 3),
    minors=st.integers(1, 3),
    seed=st.integers(0, 2**32),
    rates=st.tuples(st.floats(0.1, 1), st.floats(0.05, 1), st.sampled_from([0, 0.003, 0.03])),
    handover=st.sampled_from(["parallel", "stream"]),
    data=st.data(),
)
def test_any_timing_and_stalls(
    n: int,
    minors: int,
    seed: int,
    rates: tuple[float, float, float],
    handover: str,
    data: st.DataObject,
) -> None:
    design = make_design("any", n, 1, minors, (8, 9), hardware={"handover": handover})
    clocks = st.integers(0, 30)
    timing = Timing(
        latency=data.draw(st.integers(1, 20)),
        spacing=data.draw(st.integers(1, 5)),
        startup=data.draw(clocks),
        work=data.draw(st.just(()) | st.tuples(*[st.just(0) | clocks] * n)),
        handover_spacing=data.draw(st.integers(1, 4)),
        results=data.draw(st.integers(1, 3)),
    )
    give_up = data.draw(st.sampled_from([0, 0.1, 0.5]))
    assert_keeps_contract(design, timing, drive(design, timing, 300, seed, *rates, give_up))


def test_a_sample_is_compensated_before_the_core_by_hand() -> None:
    """Taken in 0, by the core in 4, the next in 5; what is lost meanwhile marks the next."""
    design = make_design("ahead", 1, 1, 1, (8, 8))
    model = CycleModel(design, Timing(3, compensation=4))
    offers = [ZERO, ZERO, None, None, None, *[ZERO] * 18]
    seen = [model.clock(offered, 1) for offered in offers]
    assert [t for t, ports in enumerate(seen) if ports.sample_ready] == [0, 5, 10, 15, 20]
    # 4 and 3 clocks later; of the first the sample before it lacks, before the second one was lost
    shown = {t: ports.result[:2] for t, ports in enumerate(seen) if ports.result_valid}
    assert shown == {7: (0, 1), 12: (1, 8), 17: (2, 0), 22: (3, 0)}
    assert [ports.samples_lost for ports in seen] == [0] * 4 + [1] * 19


def test_a_compensated_sample_waits_for_room_and_a_reset_takes_it_back() -> None:
    """The core takes the second one when the first one's result is taken, in clock 12.

    The third one waits for ever: nobody takes the second one's result.
    """
    design = make_design("ahead", 1, 1, 1, (8, 8))
    model = CycleModel(design, Timing(3, compensation=4))
    seen = [model.clock(ZERO, int(t == 12)) for t in range(20)]
    assert [t for t, ports in enumerate(seen) if ports.sample_ready] == [0, 5, 14]
    assert [t for t, ports in enumerate(seen) if ports.result_valid] == [
        *range(7, 13),
        *range(16, 20),
    ]
    assert {ports.samples_lost for ports in seen} == {0}
    model.clock(ZERO, 1, rst=1)
    again = [model.clock(ZERO, 1) for _ in range(12)]
    assert [t for t, ports in enumerate(again) if ports.sample_ready] == [0, 5, 10]
    assert [t for t, ports in enumerate(again) if ports.result_valid] == [7]


def test_a_clock_of_work_waits_for_the_engine_too() -> None:
    """Phase 1 keeps it for five clocks, phase 2 for one."""
    design = make_design("busy", 2, 0, 2, (8, 8))
    model = CycleModel(design, Timing(1, work=(5, 1)))
    ready = [t for t in range(18) if model.clock(ZERO, 1).sample_ready]
    assert ready == [0, 5, 6, 11, 12, 17]


def test_no_stall_when_results_are_taken_at_once() -> None:
    design = make_design("flow", 2, 1, 3, (8, 8))
    trace = drive(design, Timing(4), clocks=200, seed=1, offer=1, take=1)
    assert all(clock.out.sample_ready for clock in trace)
    # one result each six clocks, from the clock of the sixth sample on
    rises = [t for t, clock in enumerate(trace) if clock.out.result_valid]
    assert rises == list(range(5 + 4, 200, 6))


def test_a_result_never_taken_stops_the_samples_before_anything_is_lost() -> None:
    design = make_design("stop", 2, 1, 3, (8, 8))
    model = CycleModel(design, Timing(4))
    taken = 0
    for sample in samples(design, 60, 2):
        taken += model.clock(sample, result_ready=0).sample_ready
    assert taken == 6 + 5
    before = model.ports()
    assert (before.sample_ready, before.result_valid) == (0, 1)
    # within the clock that takes it, sample_ready is still low
    assert model.clock(ZERO, result_ready=1) == before
    assert model.ports() == Ports(1, 0, (0,) * len(COLUMNS))


def test_a_stream_stops_the_samples_until_its_last_word_is_taken() -> None:
    design = make_design("words", 1, 1, 1, (8, 8), hardware=STREAM)
    model = CycleModel(design, Timing(latency=3, handover_spacing=2))
    sample = ((1, -2, 3), (4, 5, -6), 1)
    assert model.clock(sample, 1) == Ports(1, 0, (0, 0))
    # the vectors take 17 bits and more, hence two words a column: 40 words, one each two clocks
    shown = [model.clock(None, 1) for _ in range(90)]
    first = 3 - 1
    valid = range(first, first + 2 * 40, 2)
    assert [t for t, ports in enumerate(shown) if ports.result_valid] == list(valid)
    assert [t for t, ports in enumerate(shown) if ports.result[1]] == [valid[-1]]
    assert [t for t, ports in enumerate(shown) if ports.sample_ready] == list(range(valid[-1], 90))[
        1:
    ]
    words = [shown[t].result[0] for t in valid]
    # major 0; status: no sample before the first, and a fault; alpha is the sample
    assert words[:10] == [0, 0, 3, 0, 1, 0, 0xFFFE, 0xFFFF, 3, 0]


def test_a_word_waits_unchanged() -> None:
    design = make_design("words", 1, 1, 1, (8, 8), hardware=STREAM)
    model = CycleModel(design, Timing(latency=1))
    model.clock(((7, 0, 0), (0, 0, 0), 1), 0)
    model.clock(None, 1)
    model.clock(None, 1)
    assert [model.clock(None, 0) for _ in range(5)] == [Ports(0, 1, (3, 0))] * 5


def test_reset_forgets_everything_and_clears_the_ports() -> None:
    design = make_design("reset", 1, 1, 1, (8, 8))
    model = CycleModel(design, Timing(3))
    powered_up = model.ports()
    assert powered_up == Ports(1, 0, (0,) * len(COLUMNS))
    model.clock(((1, 2, 3), (4, 5, 6), 1), 0)
    for _ in range(3):
        model.clock(None, 0)
    assert model.ports().result[:3] == (0, 3, 1)
    model.clock(None, 1)
    model.clock(((7, 7, 7), (0, 0, 0), 0), 1)  # on its way when reset comes
    model.clock(None, 1, rst=1)
    for _ in range(10):
        assert model.clock(None, 1) == powered_up


def test_after_reset_the_start_takes_its_clocks_again() -> None:
    model = CycleModel(DESIGNS["smallest"], Timing(1, spacing=9, startup=4))
    assert [model.clock(None, 1).sample_ready for _ in range(6)] == [0, 0, 0, 0, 1, 1]
    assert model.clock(ZERO, 1).sample_ready == 1
    assert model.clock(ZERO, 1, rst=1).sample_ready == 0
    assert [model.clock(None, 1).sample_ready for _ in range(6)] == [0, 0, 0, 0, 1, 1]


def test_nothing_is_taken_while_reset_is_high() -> None:
    design = make_design("reset", 1, 1, 1, (8, 8))
    model = CycleModel(design, Timing(1))
    for _ in range(5):
        model.clock(((1, 2, 3), (4, 5, 6), 0), 1, rst=1)
    assert model.ports() == Ports(1, 0, (0,) * len(COLUMNS))


def test_a_sample_is_not_even_looked_at_while_reset_is_high() -> None:
    model = CycleModel(DESIGNS["smallest"], Timing(1))
    model.clock(((0, 128, 0), (0, 0, 0), 0), 1, rst=1)
    assert model.ports().sample_ready == 1


def test_major_wraps_at_64_bits() -> None:
    model = CycleModel(DESIGNS["smallest"], Timing(1))
    model.golden.major = 2**64 - 1
    majors = []
    for _ in range(6):
        shown = model.clock(ZERO, 1)
        majors += [shown.result[0]] if shown.result_valid else []
    assert majors == [2**64 - 1, 0, 1]


def test_a_streams_major_wraps_at_its_columns_width() -> None:
    design = with_hardware(DESIGNS["smallest"], handover="stream")
    model = CycleModel(design, Timing(1))
    model.golden.major = 2**32 - 1
    words = []
    while len(words) < 3 * 40:
        shown = model.clock(ZERO, 1)
        words += [shown.result[0]] if shown.result_valid else []
    assert [words[i : i + 2] for i in (0, 40, 80)] == [[0xFFFF, 0xFFFF], [0, 0], [1, 0]]


def test_a_count_outside_the_width_is_refused() -> None:
    with pytest.raises(InputError, match="sample 0: gyro_y = 128 does not fit 8 bits"):
        CycleModel(DESIGNS["smallest"], Timing(1)).clock(((0, 128, 0), (0, 0, 0), 0), 1)


def test_timings_that_cannot_be() -> None:
    for bad in (
        {"latency": 0},
        {"latency": 1, "spacing": 0},
        {"latency": 1, "startup": -1},
        {"latency": 1, "handover_spacing": 0},
        {"latency": 1, "results": 0},
        {"latency": 1, "work": (3, -1)},
    ):
        with pytest.raises(ValueError, match="is not allowed, give"):
            Timing(**bad)  # type: ignore[arg-type]
    for claim, refill in ((-1, 1), (0, 0)):
        with pytest.raises(ValueError, match="is not allowed, give"):
            Dropping(claim, refill)
    with pytest.raises(ValueError, match="work: 2 phases are not the design's 3"):
        CycleModel(DESIGNS["dense_odd_3"], Timing(1, work=(1, 2)))


def test_the_names_of_the_result_ports() -> None:
    assert result_ports(DESIGNS["smallest"]) == COLUMNS
    assert result_ports(with_hardware(DESIGNS["smallest"], handover="stream")) == ("data", "last")
    many = with_hardware(DESIGNS["smallest"], core="compact", handover="stream", channels=2)
    assert result_ports(many) == ("data", "last", "channel")


def test_figures_that_follow_from_a_timing_by_hand() -> None:
    """Of results: one is handed over, one waits, one is being formed."""
    plain = Timing(7, spacing=3, startup=2, work=(0, 5), handover_spacing=4)
    assert (plain.before, plain.samples_apart, plain.under_way) == (0, 3, 2)
    assert plain.longest_wait == 2 + 3 + 5 + 7 + 4
    more = replace(plain, dropping=Dropping(1, 6), compensation=8)
    assert (more.before, more.samples_apart, more.under_way) == (8, 9, 3)
    assert more.longest_wait == 2 + 3 + 5 + 7 + 4 + 6 + 8
    channels = ChannelTiming(7, spacing=3, work=(2, 5), results=2, clearing=9)
    assert (channels.under_way, channels.longest_wait) == (3, 3 + 5 + 7 + 1 + 9 + 5)
