"""Residuals of the papers in exact rationals, to hold beside what an algorithm really leaves.

Each is the first term of what is left of coning over one interval, as the paper has it: the true
correction minus the computed one, over the square of the (small) half angle a, in powers of
λ = ΩT with T the sample interval.
"""

from __future__ import annotations

from fractions import Fraction
from math import factorial

from sculler_model.algorithms import distance_sums, filtered_rate
from sculler_model.analysis.closed_form import LeadingTerm

RUNGE_KUTTA_STEP = 2
"""Samples that a step of fourth-order Runge-Kutta takes: start, middle and end are rates."""


def zeng_residual(samples: int) -> LeadingTerm:
    """What Zeng's taps leave beside the sums: his Eq. 27, true minus computed, over a².

    He takes the angle that the weights of his Eq. 15 form for the true one.  What they miss comes
    on top, and is of a lower power (`closed_form.leading_term`).

    Args:
        samples: n, his M.

    Examples:
        >>> zeng_residual(2)
        LeadingTerm(coefficient=Fraction(337, 60480), power=7)
    """
    n = samples
    sign = (-1) ** n
    # 2 sin²(a/2) is a²/2, and sin² a is a²
    true = Fraction(sign * _second_difference(n, 2 * n + 5), 2 * factorial(2 * n + 5))
    computed = sum(
        (
            x * Fraction(sign * _second_difference(p, 2 * n + 3), factorial(2 * n + 3))
            for p, x in enumerate(distance_sums(filtered_rate(n)), start=1)
        ),
        Fraction(0),
    )
    return LeadingTerm(true - computed, 2 * n + 3)


def runge_kutta_residual(*, between_steps: bool = True) -> LeadingTerm:
    """What fourth-order Runge-Kutta leaves of unfiltered coning in a step: Zeng Eq. 28, over a².

    Within a step of h = 2T it is -a²(Ωh)⁵/1440.  The angle of a step is Simpson's rule, too large
    by (Ωh)⁴/2880 of itself, so what turns from step to step, ½ a² sin Ωh of the coning, is too
    large by twice that: -a²(Ωh)⁵/2880 more, half as much again.

    Args:
        between_steps: whether with that half, which the paper leaves out.

    Examples:
        >>> runge_kutta_residual(between_steps=False)
        LeadingTerm(coefficient=Fraction(-1, 45), power=5)
    """
    within = Fraction(-(RUNGE_KUTTA_STEP**5), 1440)
    return LeadingTerm(within * (Fraction(3, 2) if between_steps else 1), 5)


def _second_difference(p: int, power: int) -> int:
    """(p-1)^k - 2 p^k + (p+1)^k."""
    return int((p - 1) ** power - 2 * p**power + (p + 1) ** power)
