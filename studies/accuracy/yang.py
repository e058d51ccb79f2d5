"""Yang: any number of samples, any history."""

from __future__ import annotations

from math import radians

from sculler_model.algorithms import frequency_taylor
from sculler_model.analysis import frequency
from sculler_model.analysis.closed_form import leading_term
from sculler_model.analysis.oscillation import Cone
from studies.accuracy.coning import coning_left, coning_whole, fine_design
from studies.accuracy.section import Section, minus, number

HZ, T, MAJOR = 100.0, 1 / 2000, 10
"""Samples a major interval: 5 ms."""


def yang() -> Section:
    """The order for any n and p, and the floor."""
    section = Section(
        "Yang: any number of samples, any history",
        "Eq. 11-12 match n + p - 1 powers of λ = Ω·T, λ³ to λ^(2(n+p)-1). The first that is left"
        " is the next odd one, λ^(2(n+p)+1) a minor interval; the drift's share falls as"
        " λ^(2(n+p)).",
        pictures=(
            (
                "accuracy-yang.png",
                "Drift over n + p: closed form and attitude, at three half angles",
            ),
        ),
    )
    for n, p in ((2, 0), (1, 1), (3, 0), (2, 1), (4, 0), (3, 1), (2, 2), (5, 0)):
        term = leading_term(frequency_taylor(n, p))
        constant = float(term.coefficient)
        design = fine_design("frequency-taylor", n, p, 1, 1 / T)
        measured = frequency.law(design, Cone(radians(0.1)))
        section.add(
            f"n = {n}, p = {p}: first term left, a minor interval",
            f"λ^{2 * (n + p) - 1} matched",
            f"{minus(str(term.coefficient))} λ^{term.power}; measured"
            f" {number(measured.measured_constant, 3)} (exact {number(constant, 3)})",
            "`closed_form.leading_term`; integer path, `frequency.law`",
        )
    for degree in (0.01, 0.1, 1.0):
        a = radians(degree)
        wholes = [coning_whole(frequency_taylor(2, p), MAJOR // 2, a, HZ, T) for p in range(6)]
        lefts = [coning_left(frequency_taylor(2, p), a, HZ, T) for p in range(6)]
        floor = wholes[-1]
        enough = next(p for p in range(6) if abs(lefts[p]) < abs(floor))
        section.add(
            f"{degree:g}° at {HZ:g} Hz, 2 kHz, 5 ms major intervals: floor of the attitude",
            "",
            f"{number(floor)} °/h; more than n + p = {2 + enough} gains nothing",
            "`advice.coning_drift`",
        )
    section.after = (
        "**As it really comes out.** The order depends on n + p alone, and so does the whole"
        " closed-form drift of these tables: n = 1, p = 1 leaves exactly what n = 2, p = 0"
        " leaves, with the same number of taps, but forms its products every sample. (Measured:"
        " two runs of the integer path, extrapolated to λ = 0 with the power given.)",
        "**Where it stops paying.** All these algorithms form φ = α + ½∫α×ω and leave out the"
        " triple products of the rotation-vector equation (Savage-20 Eq. 3). The drift of those"
        " goes with the fourth power of the angle and does not know n and p; a shorter major"
        " interval makes it smaller.",
    )
    return section
