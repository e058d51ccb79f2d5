"""What a design takes in hardware and work, counted from its word lengths and its tap table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from sculler_model.design import (
    FOURTH_ORDER_VECTORS,
    THIRD_ORDER_VECTORS,
    Design,
    DualRange,
    HigherOrderWords,
    Interval,
)


@dataclass(frozen=True)
class Cost:
    """What a design takes.

    Attributes:
        rows: non-zero tap rows a minor interval.
        additions: of shifted samples, to form A, B, θ and v once (canonical signed digits, three
            axes, both sensors); a minor interval's work.
        multiplications: a sample, on average; of third and fourth order those by whole numbers
            are not among them.
        widest: bits of the widest accumulator.
        area: full adders of all products and tap sums, each counted once whatever is shared,
            and bits of history and accumulators.
        work: full-adder operations a second.
    """

    rows: int
    additions: int
    multiplications: float
    widest: int
    area: int
    work: float


def signed_digit_count(value: int) -> int:
    """Non-zero digits of the canonical signed-digit form: 7 = 8 - 1 has two."""
    value = abs(value)
    return (value ^ (3 * value)).bit_count()


class _Further(NamedTuple):
    """What third and fourth order take in a minor interval.

    Attributes:
        products: multiplications.
        cells: full-adder operations, those of multiples by whole numbers included.
    """

    products: int = 0
    cells: int = 0


def _further(design: Design) -> _Further:
    """Count the page of `algorithms.higher_order`."""
    higher = design.words.higher
    if higher is None:
        return _Further()
    plain, taps = design.words, design.composition.taps
    theta = DualRange(plain.theta, plain.v)
    alpha = theta.repeated(max(design.algorithm.minors - 1, 1))
    crosses: list[tuple[DualRange, DualRange]] = []
    sums: list[tuple[Sequence[int], DualRange]] = []
    if not taps.third_is_zero:
        if any(taps.curvature):
            crosses += [(theta, higher.c), (theta, higher.theta_c)]
            sums.append((taps.curvature, higher.c))
        crosses += [(theta, higher.m), (higher.slope, higher.theta_m)]
        sums += [(taps.partner, higher.m), (taps.slope, higher.slope)]
        if design.order > 3:
            crosses += [(theta, x) for x in (higher.f, higher.theta_f, higher.theta_theta_f)]
            sums.append((taps.fourth, higher.f))
    if design.algorithm.minors > 1:
        crosses += [(higher.b, theta), (alpha, higher.k)]
        sums += _multiples(design, higher)
        if design.order > 3:
            crosses += [(higher.P, theta), (alpha, higher.P), (higher.b, higher.k)]
            crosses += [(higher.g, theta), (alpha, higher.h)]
    cells = 0
    for a, b in crosses:
        pairs = ((a.angle, b.angle), (a.angle, b.velocity), (a.velocity, b.angle))
        cells += sum(6 * left.bits * right.bits for left, right in pairs)
    for factors, made in sums:
        digits = sum(map(signed_digit_count, factors))
        cells += 3 * digits * (made.angle.bits + made.velocity.bits)
    return _Further(18 * len(crosses), cells)


def _multiples(design: Design, words: HigherOrderWords) -> list[tuple[Sequence[int], DualRange]]:
    """The whole numbers that letters are multiplied by to make others."""
    c = design.composition
    f, t, Dc = c.third_composed, c.third_triple, c.within
    found: list[tuple[Sequence[int], DualRange]] = [
        ((6, 3 * Dc, Dc), words.b),
        ((6, Dc), words.k),
        ((t, f), words.third),
    ]
    if design.order > 3:
        found += [
            ((6, 2 * f, 2 * f * Dc, f * Dc), words.g),
            ((6 * t, 2 * f, f * Dc, 2 * f * Dc), words.h),
            ((c.fourth_inner, c.fourth_outer, c.fourth_pairs), words.fourth),
        ]
    return found


def cost(design: Design) -> Cost:
    """Count a design's hardware and work."""
    table, words = design.table, design.words
    n, between = table.samples, design.algorithm.minors > 1
    gyro, accel, A, B = words.gyro, words.accel, words.gyro_taps, words.accel_taps
    minors = design.algorithm.minors
    alpha, nu = (item.repeated(max(minors - 1, 1)) for item in (words.theta, words.v))

    def products(pairs: Sequence[tuple[Interval, Interval]]) -> int:
        """Full adders of the cross products of these pairs, six products each."""
        return sum(6 * left.bits * right.bits for left, right in pairs)

    within_cells = products([(A, gyro), (A, accel), (B, gyro)])
    between_cells = products([(alpha, words.theta), (alpha, words.v), (nu, words.theta)])
    between_cells *= between

    rows = [row for row in table.taps if any(row)]
    digits = [sum(map(signed_digit_count, row)) - 1 for row in [*rows, table.weights]]
    # each addition for three axes of both sensors; weights make θ and v
    widths = [A.bits + B.bits] * len(rows) + [words.theta.bits + words.v.bits]
    tap_cells = [3 * count * width for count, width in zip(digits, widths, strict=True)]

    vectors = ["alpha", "nu", "coning_within", "sculling_within"]
    vectors += ["coning_between", "sculling_between"] * between
    registers = 3 * sum(getattr(words, vector).bits for vector in vectors)
    registers += 3 * table.history * (gyro.bits + accel.bits)
    fine_cells = 0
    if words.s_alpha and words.s_nu and words.scrolling:  # the pairs of Savage-98 Eq. 61 and 105
        s_alpha, s_nu = words.s_alpha, words.s_nu
        pairs = [(words.alpha, accel), (words.nu, gyro), (s_alpha, accel), (s_nu, gyro)]
        fine_cells = products([*pairs, (words.alpha, words.nu)])
        registers += 3 * sum(item.bits for item in (s_alpha, s_nu, words.scrolling))
    further = _further(design)
    higher = (*THIRD_ORDER_VECTORS, *FOURTH_ORDER_VECTORS)[: 2 * (design.order - 2)]
    vectors += higher
    registers += 3 * sum(getattr(words, vector).bits for vector in higher)
    # what a minor interval forms
    minor = len(rows) * within_cells + between_cells + sum(tap_cells) + further.cells
    return Cost(
        rows=len(rows),
        additions=6 * sum(digits),
        multiplications=18 * (len(rows) + between) / n
        + further.products / n
        + (30 if fine_cells else 0),
        widest=max(getattr(words, vector).bits for vector in vectors),
        area=within_cells + between_cells + fine_cells + sum(tap_cells) + registers + further.cells,
        work=(minor / n + fine_cells) * design.sensor.sample_rate_hz,
    )
