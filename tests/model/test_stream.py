"""The word stream: two's complement words, least significant first, every column alike."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from position_designs import HIGH_RESOLUTION
from sculler_model.design import COLUMNS, VECTORS
from sculler_model.golden import from_words, to_words, words_per_column, words_per_result
from strategies import DESIGNS


@pytest.mark.parametrize("design", DESIGNS.values(), ids=DESIGNS)
def test_every_component_fits_its_words_and_one_word_less_is_too_few(design):
    count = words_per_column(design)
    widest = max(getattr(design.words, vector).bits for vector in VECTORS)
    assert 16 * (count - 1) < widest <= 16 * count
    assert words_per_result(design) == 20 * count


def test_words_as_a_machine_sees_them():
    """Against numpy's own little-endian int64."""
    design = DESIGNS["stim300_4x5"]
    assert words_per_column(design) == 4
    row = [7, 3, -1, 0, -(1 << 28), *((-1) ** i * (1 << 3 * i) + i for i in range(15))]
    expected = np.array(row, "<i8").view("<u2").tolist()
    assert to_words(design, row) == expected
    assert from_words(design, expected) == tuple(row)


@given(st.data())
def test_there_and_back(data):
    design = DESIGNS[data.draw(st.sampled_from(sorted(DESIGNS)))]
    bits = 16 * words_per_column(design)
    component = st.integers(-(1 << bits - 1), (1 << bits - 1) - 1)
    row = [data.draw(st.integers(0, (1 << bits) - 1)), data.draw(st.integers(0, (1 << bits) - 1))]
    row += data.draw(st.lists(component, min_size=18, max_size=18))
    assert from_words(design, to_words(design, row)) == tuple(row)


def test_major_wraps():
    design = DESIGNS["stim300_4x5"]
    row = [(1 << 64) + 5] + [0] * (len(COLUMNS) - 1)
    assert from_words(design, to_words(design, row))[0] == 5


def test_a_part_of_a_result_is_refused():
    design = DESIGNS["stim300_4x5"]
    with pytest.raises(ValueError, match="79 words, not 80"):
        from_words(design, [0] * 79)


def test_high_resolution_position_makes_the_result_longer():
    design = HIGH_RESOLUTION["stim300_hr"]
    assert design.words.scrolling.bits == 71  # the widest: 5 words
    assert (words_per_column(design), words_per_result(design)) == (5, 29 * 5)
    row = [3, 1, *range(-27, 0)]
    row[-1] = design.words.scrolling.lo
    assert from_words(design, to_words(design, row)) == tuple(row)
