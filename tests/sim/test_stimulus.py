from dataclasses import replace
from itertools import groupby, pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sculler_model.errors import InputError
from sculler_sim.stimulus import Stimulus


def test_always_is_busy_on_every_clock():
    offer, take, rst, give_up, enable = Stimulus.always().giving_up().levels(7, 100)
    assert offer.tolist() == take.tolist() == enable.tolist() == [1] * 100
    assert rst.tolist() == give_up.tolist() == [0] * 100


@given(
    seed=st.integers(0, 2**40),
    longest=st.integers(1, 5000),
    cuts=st.lists(st.integers(0, 40_000), min_size=2, max_size=6).map(sorted),
)
def test_levels_do_not_depend_on_the_chunks(seed, longest, cuts):
    stimulus = Stimulus.stalls(seed, longest).giving_up().with_resets(0, 17, 16_384, 20_000)
    whole = replace(stimulus).levels(0, 40_000)
    for start, end in pairwise(cuts):
        for part, all_ in zip(stimulus.levels(start, end - start), whole, strict=True):
            assert part.dtype == np.uint8
            assert part.flags.c_contiguous
            assert part.tolist() == all_[start:end].tolist()


def test_seeds_and_handshakes_differ():
    one, other = Stimulus.stalls(1).levels(0, 1000), Stimulus.stalls(2).levels(0, 1000)
    assert (one.offer != other.offer).any()
    assert (one.take != other.take).any()
    assert (one.offer != one.take).any()


@pytest.mark.parametrize("seed", range(3))
def test_stalls_have_idle_and_busy_runs_and_mixed_stretches(seed):
    for levels in Stimulus.stalls(seed, longest=256).levels(0, 1 << 16)[:2]:
        runs = {0: [], 1: []}
        for level, run in groupby(levels.tolist()):
            runs[level].append(len(list(run)))
        # idle for long, busy for long, and single clocks of both
        assert max(runs[0]) > 128
        assert max(runs[1]) > 128
        assert runs[0].count(1) > 100
        assert runs[1].count(1) > 100
        assert 0.35 < levels.mean() < 0.65


def test_resets_are_where_they_are_asked_for():
    stimulus = Stimulus.stalls(3).with_resets(5, 6, 30_000)
    assert np.flatnonzero(stimulus.levels(0, 40_000).rst).tolist() == [5, 6, 30_000]
    assert np.flatnonzero(stimulus.levels(6, 10).rst).tolist() == [0]


def test_bad_parameters_are_refused():
    with pytest.raises(InputError, match="stall seed: -1 is not allowed"):
        Stimulus.stalls(-1)
    with pytest.raises(ValueError, match="longest: 0"):
        Stimulus.stalls(1, longest=0)


def test_samples_are_given_up_in_stretches_and_only_where_asked_for():
    patient, hasty = Stimulus.stalls(4), Stimulus.stalls(4).giving_up()
    before, after = patient.levels(0, 1 << 16), hasty.levels(0, 1 << 16)
    assert not before.give_up.any()
    assert all((a == b).all() for a, b in zip(before[:3], after[:3], strict=True))
    runs = [(level, len(list(run))) for level, run in groupby(after.give_up.tolist())]
    assert max(run for level, run in runs if level == 0) > 128  # patient for long
    assert 0.05 < after.give_up.mean() < 0.3
