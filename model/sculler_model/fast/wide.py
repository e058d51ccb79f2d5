"""Arrays of integers of more than 64 bits, without a Python integer for each.

An element is W limbs of 64 bits in two's complement, the lowest limb first.  `WideIntegers` behaves
as far as results need it: slices, rows as Python integers, exactly rounded floats.
"""

from __future__ import annotations

from collections.abc import Sequence
from operator import index
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

LIMB_BITS = 64

Integers: TypeAlias = "NDArray[np.int64] | WideIntegers"
"""Exact integers: int64 where they fit, else limbs."""


def limbs_for(bits: int) -> int:
    """How many limbs hold a two's complement word of so many bits."""
    return -(-bits // LIMB_BITS)


class WideIntegers:
    """An array of signed integers of W limbs each.

    `numpy.asarray` makes Python integers of it (dtype object), `astype(float)` the nearest floats.

    Args:
        limbs: (..., W) int64, the lowest limb first; the bits of all but the highest are unsigned.

    Attributes:
        limbs: the same.
    """

    def __init__(self, limbs: NDArray[np.int64]) -> None:
        self.limbs = limbs

    @classmethod
    def from_integers(cls, numbers: ArrayLike, words: int) -> WideIntegers:
        """Of an array of Python or numpy integers.

        Args:
            numbers: of any shape.
            words: W.

        Raises:
            OverflowError: a number does not fit W limbs.
            TypeError: a number is no integer.
        """
        array = _as_array(numbers)
        if array.dtype.kind in "iu":
            if words == 1 and array.dtype.kind == "u" and (array >> np.uint64(63)).any():
                raise OverflowError(f"{array.max()} does not fit 64 bits")
            low = array.astype(np.int64)
            sign = low >> (LIMB_BITS - 1) if array.dtype.kind == "i" else np.zeros_like(low)
            return cls(np.stack([low, *[sign] * (words - 1)], axis=-1))
        if array.dtype != object and array.size:
            raise TypeError(f"numbers of type {array.dtype}, give integers")
        size = words * LIMB_BITS // 8
        data = b"".join(index(n).to_bytes(size, "little", signed=True) for n in array.flat)
        return cls(np.frombuffer(data, "<i8").astype(np.int64).reshape(*array.shape, words))

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the array of integers, as numpy's."""
        return self.limbs.shape[:-1]

    @property
    def words(self) -> int:
        """W, limbs of an element."""
        return int(self.limbs.shape[-1])

    def __len__(self) -> int:
        return len(self.limbs)

    def __getitem__(self, part: Any) -> WideIntegers:
        """A part of the array, as numpy cuts; for one integer use `tolist`."""
        parts = part if isinstance(part, tuple) else (part,)
        rest = () if any(each is Ellipsis for each in parts) else (...,)
        return WideIntegers(self.limbs[(*parts, *rest, slice(None))])

    def widened(self, words: int) -> WideIntegers:
        """The same integers in so many limbs, not fewer than they have."""
        sign = self.limbs[..., -1:] >> (LIMB_BITS - 1)
        return WideIntegers(np.concatenate([self.limbs, *[sign] * (words - self.words)], axis=-1))

    def tolist(self) -> Any:
        """Nested lists of Python integers."""
        return self.astype(object).tolist()

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        return self.astype(object if dtype is None else dtype)

    def astype(self, dtype: DTypeLike) -> NDArray[Any]:
        """As an array of Python integers (object) or of the nearest floats (float64).

        Raises:
            TypeError: another type, which could not hold the integers.
        """
        kind = np.dtype(dtype)
        if kind == np.dtype(object):
            size = self.words * LIMB_BITS // 8
            data = np.ascontiguousarray(self.limbs, "<i8").tobytes()
            numbers = np.empty(len(data) // size, object)
            numbers[:] = [
                int.from_bytes(data[i : i + size], "little", signed=True)
                for i in range(0, len(data), size)
            ]
            return numbers.reshape(self.shape)
        if kind == np.dtype(np.float64):
            return nearest_floats(self.limbs)
        raise TypeError(f"integers of {self.words * LIMB_BITS} bits as {kind}: object or float64")


def as_integers(numbers: ArrayLike | WideIntegers, words: int | None = None) -> Integers:
    """Integers of any kind as they are kept in results.

    Args:
        numbers: of any shape; Python or numpy integers, or limbs.
        words: limbs of an element, 1 for int64; as many as the widest of them needs if not given.

    Raises:
        OverflowError: a number does not fit so many.
        TypeError: a number is no integer.
    """
    if isinstance(numbers, WideIntegers):
        if words is None or words == numbers.words:
            return numbers
        if words > numbers.words:
            return numbers.widened(words)
    array = _as_array(numbers)
    if words is None:
        ends = [int(array.min()), int(array.max())] if array.size else [0]
        words = limbs_for(max((~n if n < 0 else n).bit_length() + 1 for n in ends))
    if words == 1 and array.dtype == np.int64:
        return array
    wide = WideIntegers.from_integers(array, words)
    return wide.limbs[..., 0] if words == 1 else wide


def _as_array(numbers: ArrayLike) -> NDArray[Any]:
    """An array; Python integers stay such, which numpy would round if only some pass 63 bits."""
    return np.asarray(numbers, None if hasattr(numbers, "dtype") else object)


def limbs_of(numbers: Integers) -> NDArray[np.int64]:
    """(..., W) the limbs of each integer, the lowest first; W is 1 for int64."""
    return numbers.limbs if isinstance(numbers, WideIntegers) else numbers[..., None]


def from_limbs(limbs: NDArray[np.int64]) -> Integers:
    """The integers of (..., W) limbs, the lowest first: int64 for W = 1."""
    return WideIntegers(limbs) if limbs.shape[-1] > 1 else limbs[..., 0]


def concatenate(parts: Sequence[Integers]) -> Integers:
    """Join along the first axis, in as many limbs as the widest part has.

    Raises:
        ValueError: there is no part.
    """
    words = max((p.words for p in parts if isinstance(p, WideIntegers)), default=1)
    return from_limbs(np.concatenate([limbs_of(as_integers(part, words)) for part in parts]))


def nearest_floats(limbs: NDArray[np.int64]) -> NDArray[np.float64]:
    """The float nearest to each integer, ties to even, as `float` rounds.

    The 64 bits from the highest set one on are taken, and their last bit is set where any bit below
    them is: a float has fewer, so the one rounding that follows is that of the whole integer.

    Args:
        limbs: (..., W), see `WideIntegers`.
    """
    words = limbs.shape[-1]
    negative = limbs[..., -1] < 0
    magnitude = _magnitudes(limbs, negative)
    top = np.zeros(magnitude.shape[:-1], np.uint64)  # the 64 bits
    lower = np.zeros_like(top)  # the limb below them
    sticky = np.zeros(top.shape, np.bool_)
    place = np.zeros(top.shape, np.int64)
    for word in range(words):  # the last one that is not zero wins
        limb = magnitude[..., word]
        here = limb != 0
        below = magnitude[..., word - 1] if word else np.zeros_like(limb)
        rest = (magnitude[..., : max(word - 1, 0)] != 0).any(axis=-1)
        top, lower = np.where(here, limb, top), np.where(here, below, lower)
        sticky, place = np.where(here, rest, sticky), np.where(here, word, place)
    shift = LIMB_BITS - np.frexp(top.astype(np.float64))[1].astype(np.int64)
    shift = np.where(top == 0, 0, np.maximum(shift, 0))
    # a float of 64 bits may have been rounded up to the next power of two
    shift += ((top << shift.astype(np.uint64)) >> np.uint64(63) == 0) & (top != 0)
    left = shift.astype(np.uint64)
    right = np.where(shift == 0, 0, LIMB_BITS - shift).astype(np.uint64)
    moved_in = np.where(shift == 0, np.uint64(0), lower >> right)
    left_out = np.where(shift == 0, lower, lower << left) != 0
    bits = (top << left) | moved_in | (left_out | sticky).astype(np.uint64)
    size: NDArray[np.float64] = np.ldexp(bits.astype(np.float64), place * LIMB_BITS - shift)
    return np.where(negative, -size, size)


def _magnitudes(limbs: NDArray[np.int64], negative: NDArray[np.bool_]) -> NDArray[np.uint64]:
    """|x| of each integer, in unsigned limbs."""
    unsigned = limbs.view(np.uint64) ^ np.where(negative, ~np.uint64(0), np.uint64(0))[..., None]
    carry = negative.astype(np.uint64)
    for word in range(limbs.shape[-1]):
        unsigned[..., word] += carry
        carry = carry * (unsigned[..., word] == 0)
    return unsigned
