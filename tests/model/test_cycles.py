"""The cycle model keeps the contract of the ports, clause by clause."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sculler_model.cycles import CycleModel, Ports
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.golden import GoldenModel, Sample
from sculler_model.vectors import COLUMNS
from strategies import DESIGNS, make_design, random_counts

ZERO: Sample = ((0, 0, 0), (0, 0, 0), 0)


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
    latency: int,
    clocks: int,
    seed: int,
    offer: float = 0.7,
    take: float = 0.5,
    reset: float = 0.0,
) -> list[Clock]:
    """Clocks with random stalls; an offered sample stays on the port until it is taken."""
    model = CycleModel(design, latency)
    rng = np.random.default_rng(seed)
    stream = iter(samples(design, clocks, seed))
    waiting: Sample | None = None
    trace = []
    for offer_now, take_now, reset_now in rng.random((clocks, 3)):
        if waiting is None and offer_now < offer:
            waiting = next(stream)
        ready, rst = int(take_now < take), int(reset_now < reset)
        trace.append(Clock(waiting, ready, rst, model.clock(waiting, ready, rst)))
        if trace[-1].out.sample_ready and not rst:
            waiting = None
    return trace


def assert_keeps_contract(design: Design, latency: int, trace: list[Clock]) -> int:
    """Check every clock of a trace against the contract; the number of results taken."""
    span = design.samples_per_major
    nothing = (0,) * len(COLUMNS)
    total = 0

    # since reset: samples accepted, results taken, and (clock to rise in, row) of all results
    golden, accepted, taken = GoldenModel(design), 0, 0
    due: list[tuple[int, tuple[int, ...]]] = []
    for now, (offered, result_ready, rst, out) in enumerate(trace):
        # result_valid rises `latency` clocks after the last sample, and stays until taken
        risen = [row for clock, row in due if clock <= now]
        assert out.result_valid == int(len(risen) > taken), now
        # the ports show the newest result that rose, and change at no other time
        assert out.result == (risen[-1] if risen else nothing), now
        # sample_ready is low exactly when the next is a last one and a result not yet taken
        next_is_last = accepted % span == span - 1
        assert out.sample_ready == int(not (next_is_last and len(due) > taken)), now

        if rst:
            golden, accepted, taken, due = GoldenModel(design), 0, 0, []
            continue
        if out.result_valid and result_ready:
            taken += 1
            total += 1
        if offered is not None and out.sample_ready:
            accepted += 1
            result = golden.step(*offered)
            if result is not None:
                due.append((now + latency, result.row()))
    return total


SHORT = ["smallest", "rate_1p0", "taylor_7p0", "taylor_3p3", "late_sum_2", "wide_5p0"]


@pytest.mark.parametrize("latency", [1, 2, 9, 40])
@pytest.mark.parametrize("name", SHORT)
def test_random_stalls(name: str, latency: int) -> None:
    design = DESIGNS[name]
    trace = drive(design, latency, 600, seed=latency)
    assert assert_keeps_contract(design, latency, trace) > 3


@pytest.mark.parametrize("latency", [1, 7, 30])
@pytest.mark.parametrize("name", SHORT)
def test_resets_at_any_time(name: str, latency: int) -> None:
    design = DESIGNS[name]
    trace = drive(design, latency, 900, seed=5, reset=0.01)
    assert sum(clock.rst for clock in trace) > 3
    assert_keeps_contract(design, latency, trace)


@settings(max_examples=60, deadline=None)
@given(
    n=st.integers(1, 3),
    minors=st.integers(1, 3),
    latency=st.integers(1, 20),
    seed=st.integers(0, 2**32),
    rates=st.tuples(st.floats(0.1, 1), st.floats(0.05, 1), st.sampled_from([0, 0.03])),
)
def test_any_stalls(
    n: int, minors: int, latency: int, seed: int, rates: tuple[float, float, float]
) -> None:
    design = make_design("any", n, 1, minors, (8, 9))
    assert_keeps_contract(design, latency, drive(design, latency, 150, seed, *rates))


def test_no_stall_when_results_are_taken_at_once() -> None:
    design = make_design("flow", 2, 1, 3, (8, 8))
    trace = drive(design, latency=4, clocks=200, seed=1, offer=1, take=1)
    assert all(clock.out.sample_ready for clock in trace)
    # one result each six clocks, from the clock of the sixth sample on
    rises = [t for t, clock in enumerate(trace) if clock.out.result_valid]
    assert rises == list(range(5 + 4, 200, 6))


def test_a_result_never_taken_stops_the_samples_before_anything_is_lost() -> None:
    design = make_design("stop", 2, 1, 3, (8, 8))
    model = CycleModel(design, 4)
    taken = 0
    for sample in samples(design, 60, 2):
        taken += model.clock(sample, result_ready=0).sample_ready
    assert taken == 6 + 5
    before = model.ports()
    assert (before.sample_ready, before.result_valid) == (0, 1)
    # within the clock that takes it, sample_ready is still low
    assert model.clock(ZERO, result_ready=1) == before
    assert model.ports() == Ports(1, 0, before.result)


def test_reset_forgets_everything_and_clears_the_ports() -> None:
    design = make_design("reset", 1, 1, 1, (8, 8))
    model = CycleModel(design, 3)
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


def test_nothing_is_taken_while_reset_is_high() -> None:
    design = make_design("reset", 1, 1, 1, (8, 8))
    model = CycleModel(design, 1)
    for _ in range(5):
        model.clock(((1, 2, 3), (4, 5, 6), 0), 1, rst=1)
    assert model.ports() == Ports(1, 0, (0,) * len(COLUMNS))


def test_a_sample_is_not_even_looked_at_while_reset_is_high() -> None:
    model = CycleModel(DESIGNS["smallest"], 1)
    model.clock(((0, 128, 0), (0, 0, 0), 0), 1, rst=1)
    assert model.ports().sample_ready == 1


def test_major_wraps_at_64_bits() -> None:
    model = CycleModel(DESIGNS["smallest"], 1)
    model._golden.major = 2**64 - 1
    majors = []
    for _ in range(6):
        shown = model.clock(ZERO, 1)
        majors += [shown.result[0]] if shown.result_valid else []
    assert majors == [2**64 - 1, 0, 1]


def test_a_count_outside_the_width_is_refused() -> None:
    with pytest.raises(InputError, match="sample 0: gyro_y = 128 does not fit 8 bits"):
        CycleModel(DESIGNS["smallest"], 1).clock(((0, 128, 0), (0, 0, 0), 0), 1)
