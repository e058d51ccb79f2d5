"""Integers in limbs against Python's own."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sculler_model.fast import WideIntegers, as_integers, from_limbs, limbs_of

WIDTHS = st.integers(2, 8)


def corners(words: int) -> list[int]:
    """Where limbs carry, floats round and ties are broken, to both sides."""
    top = 64 * words - 1
    found = {0, 1, 2**top - 1, -(2**top)}
    for bit in {1, 52, 53, 54, 63, 64, 65, 116, 117, 118, 127, 128, top - 1} & {*range(top)}:
        for low in (0, 1, 2 ** max(bit - 53, 0), 2 ** max(bit - 54, 0), 2 ** max(bit - 53, 0) * 3):
            found |= {2**bit + low, 2**bit - low, 2**bit + low - 1, 2**bit + low + 1}
    numbers = found | {-n for n in found} | {~n for n in found}
    return sorted(n for n in numbers if -(2**top) <= n < 2**top)


@st.composite
def numbers(draw: st.DrawFn) -> tuple[list[int], int]:
    words = draw(WIDTHS)
    top = 2 ** (64 * words - 1)
    sparse = st.builds(
        lambda bits, sign: sign * sum(1 << bit for bit in bits),
        st.sets(st.integers(0, 64 * words - 2), max_size=4),
        st.sampled_from([1, -1]),
    )
    return draw(st.lists(st.integers(-top, top - 1) | sparse, min_size=1, max_size=40)), words


@pytest.mark.parametrize("words", [2, 3, 4, 8])
def test_corners_come_back_and_round_as_python_rounds_them(words: int) -> None:
    found = corners(words)
    wide = WideIntegers.from_integers(np.array(found, object), words)
    assert wide.shape == (len(found),)
    assert wide.words == words
    assert wide.tolist() == found
    assert wide.astype(np.float64).tolist() == [float(n) for n in found]


@settings(max_examples=200, deadline=None)
@given(numbers())
def test_any_numbers(drawn: tuple[list[int], int]) -> None:
    found, words = drawn
    wide = WideIntegers.from_integers(found, words)
    assert wide.tolist() == found
    assert all(type(n) is int for n in wide.tolist())
    assert np.asarray(wide).dtype == object
    floats = wide.astype(float)
    assert floats.dtype == np.float64
    for ours, exact in zip(floats.tolist(), found, strict=True):
        # exactly rounded: no nearer float on either side
        off = abs(Fraction(ours) - exact)
        assert off <= abs(Fraction(np.nextafter(ours, np.inf)) - exact)
        assert off <= abs(Fraction(np.nextafter(ours, -np.inf)) - exact)
        assert ours == float(exact)


@pytest.mark.parametrize("dtype", ["i1", "i8", ">i4", "u1", "u4", "u8", ">u8"])
def test_of_numpy_integers(dtype: str) -> None:
    info = np.iinfo(dtype)
    array = np.array([[info.min, info.max], [0, 1]], dtype)
    assert WideIntegers.from_integers(array, 2).tolist() == array.tolist()
    assert as_integers(array).tolist() == array.tolist()
    assert as_integers(array, 3).tolist() == array.tolist()


def test_cut_as_arrays_are() -> None:
    table = [[10**30 * (i - j) for j in range(4)] for i in range(6)]
    wide, array = as_integers(table), np.array(table, object)
    assert isinstance(wide, WideIntegers)
    for part in (slice(2, 5), 3, (slice(None), slice(1, 3)), np.array([0, 5]), (..., 2)):
        assert wide[part].tolist() == array[part].tolist()
    assert len(wide) == 6
    assert limbs_of(wide).shape == (6, 4, 2)
    assert from_limbs(limbs_of(wide)).tolist() == table


def test_the_fewest_limbs_that_hold_all() -> None:
    assert isinstance(as_integers([2**63 - 1, -(2**63)]), np.ndarray)
    for number, words in [(2**63, 2), (-(2**63) - 1, 2), (2**127 - 1, 2), (2**127, 3)]:
        found = as_integers([0, number])
        assert isinstance(found, WideIntegers)
        assert (found.words, found.tolist()) == (words, [0, number])
    assert as_integers(as_integers([2**70]), 4).tolist() == [2**70]


def test_what_does_not_fit_or_is_no_integer_is_refused() -> None:
    for numbers, words in [([2**63], 1), ([-(2**127) - 1], 2), (as_integers([2**130]), 2)]:
        with pytest.raises(OverflowError):
            as_integers(numbers, words)
    with pytest.raises(OverflowError):
        as_integers(np.array([2**63], np.uint64), 1)
    for wrong in ([1.5], ["1"], np.array([1.0], object), np.array([True])):
        with pytest.raises(TypeError):
            as_integers(wrong, 2)
    with pytest.raises(TypeError, match="object or float64"):
        as_integers([2**70]).astype(np.int64)
