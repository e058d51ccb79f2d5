"""`tuned`: coefficients for samples that passed a sensor's filter (Zeng; Mark and Tazartes).

The products carry |F|², the true coning does not; what the coefficients must make good is set out
in `sculler_model.algorithms.balance`.
"""

from __future__ import annotations

from fractions import Fraction

from sculler_model.algorithms.balance import Balance
from sculler_model.algorithms.band import Band
from sculler_model.algorithms.least_squares import Fit, round_taps
from sculler_model.algorithms.tap_table import TapTable
from sculler_model.errors import InputError

WIDEST_TAP = 128
"""Bits of the largest exact tap; more is past any use in hardware."""

ROUNDING_BAND = Fraction(1, 8)
"""Matched taps are rounded for a flat band from 0 to this share of the sample rate."""


def matched(balance: Balance, history: int) -> TapTable:
    """Taps that match the powers of the frequency one after another, exact.

    Raises:
        InputError: no product to form, no power series, or exact taps beyond 128 bits.
    """
    sums = matched_sums(balance, history)
    rows: list[list[Fraction]] = [[] for _ in range(balance.samples - 1)]
    table = TapTable.from_rationals([*rows, sums], balance.weights)
    widest = max(abs(tap) for tap in table.taps[-1]).bit_length()
    if max(widest, table.denominator.bit_length()) > WIDEST_TAP:
        raise InputError(
            f"algorithm.denominator_bits: missing, and exact taps would take {widest} bits; give"
            " a whole number from 1 to 48"
        )
    return table


def matched_sums(balance: Balance, history: int) -> list[Fraction]:
    """K_d of `matched`.

    Raises:
        InputError: no product to form, or no power series.
    """
    count = balance.distances(history)
    if count < 1:
        raise InputError(
            "algorithm.samples + algorithm.history: 1 sample gives no cross product, give"
            " samples + history >= 2"
        )
    return balance.taylor(count)


def matched_and_rounded(
    balance: Balance, history: int, sample_rate: Fraction, denominator_bits: int
) -> Fit:
    """Matched taps over 2^denominator_bits, the best rounding for 0 to an eighth of the rate.

    Raises:
        InputError: no product to form, no power series, or a filter that passes nothing there.
    """
    band = Band(Fraction(0), sample_rate * ROUNDING_BAND)
    reals = matched_sums(balance, history)
    return round_taps(reals, balance, band, sample_rate, denominator_bits)
