"""Sums of words times constant integers, by shifts and additions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from sculler_hdl.plan.adder_tree import Addend, AdderTreePlan
from sculler_hdl.plan.arrival import Limbs
from sculler_model.design import ZERO_RANGE, Interval

Weights = Mapping[str, int]
"""Constant integers, by the names of the words that they multiply."""


def signed_digits(value: int) -> list[tuple[int, int]]:
    """Canonical signed digits of an integer as (shift, +1 or -1), fewest possible, low first."""
    digits = []
    shift = 0
    while value:
        if value & 1:
            digit = 2 - value % 4  # +1 where the next bit is 0, else -1 and a carry
            digits.append((shift, digit))
            value -= digit
        value >>= 1
        shift += 1
    return digits


class DotProductPlan:
    """The plan of a sum of words times constant integers.

    Args:
        weights: the integers.
        words: what is known of the words.
        limb: how sums are cut.
        result: range of the sum, if narrower than interval arithmetic has it.

    Attributes:
        names: the word of each term of `tree`.
        tree: the additions.
        made: what is known of the sum.
    """

    def __init__(
        self,
        weights: Weights,
        words: Mapping[str, Addend],
        limb: Limbs,
        result: Interval | None = None,
    ) -> None:
        digits = [(name, *digit) for name, w in weights.items() for digit in signed_digits(w)]
        if result is None:
            result = sum((words[name].range.scaled(w) for name, w in weights.items()), ZERO_RANGE)
        self.names = [name for name, _, _ in digits]
        self.tree = AdderTreePlan(
            [
                replace(words[name], low=low, negative=sign < 0, source=name)
                for name, low, sign in digits
            ],
            result,
            limb,
        )
        self.made = Addend(result, self.tree.arrival)
