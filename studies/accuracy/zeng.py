"""Zeng: coning from filtered rates; Runge-Kutta, two samples and four."""

from __future__ import annotations

from math import pi, radians, sqrt

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import filtered_rate
from sculler_model.analysis import frequency
from sculler_model.analysis.advice import PER_HOUR, coning_drift
from sculler_model.analysis.closed_form import leading_term
from sculler_model.analysis.oscillation import Cone
from sculler_model.analysis.published import runge_kutta_residual, zeng_residual
from sculler_model.frames import Quaternion, conjugate, product, to_rotation_vector
from sculler_model.motion import Coning
from studies.accuracy.coning import coning_left, coning_whole, fine_design, true_attitude
from studies.accuracy.section import Section, minus, number

Array = NDArray[np.float64]


HALF_ANGLE, HZ, T = radians(1), 20.0, 1e-3


def runge_kutta_drift(hertz: float, filtered: bool, turns: int = 40) -> float:
    """Drift (°/h) of two-sample fourth-order Runge-Kutta on coning rate samples, by simulation.

    The quaternion equation ``q' = ½ q ω`` in steps of 2T, with ω at start, middle and end.

    Args:
        hertz: coning frequency; whole cones must be whole steps.
        filtered: whether the samples passed sinc(ΩT/2).
        turns: cones simulated.
    """
    omega = 2 * pi * hertz
    motion, h = Coning(HALF_ANGLE, omega), 2 * T
    steps = round(turns / (hertz * h))
    rates = motion.rates(2 * steps + 1, T, filtered=filtered)[:, :3].tolist()
    q = true_attitude(motion, 0.0)

    def slope(at: Quaternion, rate: list[float]) -> Quaternion:
        w, x, y, z = product(at, (0.0, rate[0], rate[1], rate[2]))
        return 0.5 * w, 0.5 * x, 0.5 * y, 0.5 * z

    def moved(at: Quaternion, by: Quaternion, much: float) -> Quaternion:
        w, x, y, z = (a + much * b for a, b in zip(at, by, strict=True))
        return w, x, y, z

    for i in range(steps):
        first, middle, last = rates[2 * i : 2 * i + 3]
        k1 = slope(q, first)
        k2 = slope(moved(q, k1, h / 2), middle)
        k3 = slope(moved(q, k2, h / 2), middle)
        k4 = slope(moved(q, k3, h), last)
        for k, weight in ((k1, 1), (k2, 2), (k3, 2), (k4, 1)):
            q = moved(q, k, weight * h / 6)
        w, x, y, z = q
        size = sqrt(w * w + x * x + y * y + z * z)
        q = (w / size, x / size, y / size, z / size)
    truth = true_attitude(motion, steps * h)
    return to_rotation_vector(product(q, conjugate(truth)))[2] / (steps * h) * PER_HOUR


def runge_kutta_law(hertz: Array) -> Array:
    """Drift (°/h) of two-sample Runge-Kutta, of second order in the half angle.

    A step of x = 2ΩT turns the rates' plane vectors into ``x² sin(x/2)/6`` about the cone's axis
    (its four stages, multiplied out) and into the plane vector of Simpson's rule,
    ``x (4 + 2 cos(x/2))/6``, whose sums turn by a quarter of its square times cot(x/2) a step.
    For small x that is Zeng Eq. 28 and half as much again (`published.runge_kutta_residual`).
    """
    omega = 2 * pi * hertz
    x = 2 * omega * T
    simpson = x / 6 * (4 + 2 * np.cos(x / 2))
    computed = x**2 * np.sin(x / 2) / 6 + simpson**2 / (4 * np.tan(x / 2))
    passed = np.sinc(omega * T / (2 * pi)) ** 2
    law: Array = PER_HOUR * HALF_ANGLE**2 * (passed * computed - x / 2) / (2 * T)
    return law


UNFILTERED = {"kind": "digital", "numerator": [1.0]}


def improved_drift(filtered: bool) -> float:
    """Drift (°/h) of the best two-sample table for unfiltered rates, angle by Simpson's rule.

    Args:
        filtered: whether the samples passed sinc(ΩT/2) all the same.
    """
    design = fine_design("tuned", 2, 0, 1, 1 / T, "rate", sum="zeng", filter=UNFILTERED)
    passed = None if filtered else design.sensor_response
    omega = 2 * pi * HZ
    return coning_drift(design.table, 1, HALF_ANGLE, omega, T, "rate", passed) * PER_HOUR


def zeng() -> Section:
    """Filtered rates: Runge-Kutta, two samples, four samples."""
    section = Section(
        "Zeng: coning from filtered rates",
        "Classical coning, half angle 1°, 20 Hz; rate samples at 1 kHz that passed sinc(ΩT/2);"
        " one minor interval a major one. The paper shows curves, not figures.",
        pictures=(
            ("accuracy-zeng-1.png", "Coning and what a filter of sinc(ΩT/2) lets through of it"),
            (
                "accuracy-zeng.png",
                "Drift of Runge-Kutta, two and four filtered samples over the coning frequency",
            ),
        ),
    )
    runge_kutta, excess = _runge_kutta_rows(section)
    ideal, behind = _improved_rows(section)
    complete = {n: _sample_rows(section, n) for n in (2, 4)}
    better, four = (abs(x / y) for x, y in ((runge_kutta, complete[2]), (complete[2], complete[4])))
    section.add("Runge-Kutta over 2 samples", "100", number(better), "attitude")
    section.add("2 samples over 4 samples", "", number(four), "attitude")
    section.add(
        "improved two samples over 2 samples", "10", number(abs(behind / complete[2])), "attitude"
    )
    _dominant_rows(section)
    section.after = (
        f"**Agrees.** Two orders: {number(better)} times. **But** nearly all of Runge-Kutta's drift"
        " here is the filter's attenuation, which it knows nothing of. On unfiltered samples it"
        f" has {number(excess, 3)} times the drift of Eq. 28: that counts what Runge-Kutta"
        " makes of the coning within a step, a²(Ωh)⁵/1440, and Simpson's rule in it adds half as"
        " much between steps, a²(Ωh)⁵/2880. What two samples leave is likewise not coning but the"
        " error of Simpson's rule, which the paper takes for exact.",
        "**Eq. 27.** It is right for the taps, and gives 337/60480 λ⁷ and −5177/26611200 λ¹¹ over"
        " a². But the angle of Eq. 15 is not the true one. Simpson's rule (n = 2) and Boole's"
        " (n = 4) miss it, and what they miss shows between the intervals in a lower power of λ:"
        " that is what remains. `tuned` with `sum` plain has no such term"
        " ([families](families.md#how-a-rates-sum-is-formed)).",
        "**The improved two samples.** The paper's Ref. 11 is not at hand; taken is the best table"
        " for unfiltered rates with Simpson's angle. On unfiltered samples it leaves"
        f" {number(ideal, 3)} °/h, {number(abs(excess * _eq_28() / ideal))} times less than"
        " Runge-Kutta: less than an order, as the paper says of such algorithms. On filtered ones"
        " it leaves as much as Runge-Kutta does. So does every algorithm that does not know of the"
        " filter, so the paper's one order over the improved table is more than two here.",
        f"**Four samples.** {number(four)} times better in the attitude, more by closed form: the"
        " rest is the triple products, which no algorithm of this kind forms (see Yang below).",
    )
    return section


def _eq_28() -> float:
    """Drift of Runge-Kutta by Zeng Eq. 28, °/h."""
    term = runge_kutta_residual(between_steps=False)
    left = -float(term.coefficient) * (2 * pi * HZ * T) ** term.power
    return HALF_ANGLE**2 * left / (2 * T) * PER_HOUR


def _improved_rows(section: Section) -> tuple[float, float]:
    """Drift of the improved two samples (°/h), on unfiltered samples and on filtered ones."""
    drifts = improved_drift(False), improved_drift(True)
    for name, drift in zip(("unfiltered", "filtered"), drifts, strict=True):
        section.add(
            f"improved two samples, made for unfiltered rates, on {name} ones",
            "less than an order better than Runge-Kutta" if name == "unfiltered" else "",
            f"{number(drift, 3)} °/h",
            "`accuracy.improved_drift`",
        )
    return drifts


def _dominant_rows(section: Section) -> None:
    """Eq. 27 beside the first term of what really remains."""
    for n in (2, 4):
        paper, ours = zeng_residual(n), leading_term(filtered_rate(n), "rate")
        rates = [
            float(term.coefficient) * (2 * pi * HZ * T) ** term.power * HALF_ANGLE**2 / (n * T)
            for term in (paper, ours)
        ]
        section.add(
            f"{n} samples, first term left of an interval, over a²",
            f"{minus(str(-paper.coefficient))} λ^{paper.power} (Eq. 27):"
            f" {number(-rates[0] * PER_HOUR)} °/h",
            f"{minus(str(ours.coefficient))} λ^{ours.power}: {number(rates[1] * PER_HOUR, 3)} °/h",
            "`published.zeng_residual`, `closed_form.leading_term`",
        )


def _runge_kutta_rows(section: Section) -> tuple[float, float]:
    """Drift of Runge-Kutta (°/h); and on unfiltered samples, by how much it passes Eq. 28."""
    runge_kutta = runge_kutta_drift(HZ, True)
    section.add(
        "two-sample Runge-Kutta",
        "",
        f"{number(runge_kutta, 3)} °/h",
        "`accuracy.runge_kutta_drift`",
    )
    ideal = runge_kutta_drift(HZ, False)
    law = _eq_28()
    section.add(
        "the same on unfiltered samples",
        f"{number(law, 3)} °/h (Eq. 28)",
        f"{number(ideal, 3)} °/h",
        "the same",
    )
    return runge_kutta, ideal / law


def _sample_rows(section: Section, n: int) -> float:
    """Rows of n filtered samples; drift of the attitude, °/h."""
    table = filtered_rate(n, 0)
    second = coning_left(table, HALF_ANGLE, HZ, T, "rate")
    whole = coning_whole(table, 1, HALF_ANGLE, HZ, T, "rate")
    design = fine_design("filtered-rate", n, 0, 1, 1 / T, "rate")
    cone = Cone(HALF_ANGLE)
    point = frequency.integer_point(frequency.fine(design, cone, 50.0), cone, HZ)
    section.add(
        f"{n} samples, closed form", "", f"{number(second, 3)} °/h", "`closed_form.drift_rate`"
    )
    section.add(
        f"{n} samples, attitude (triple products included)",
        "2 orders better than Runge-Kutta" if n == 2 else "better than 2 samples",
        f"{number(whole, 3)} °/h",
        "`advice.coning_drift`",
    )
    section.add(
        f"the same through counts and core, {point.hertz:g} Hz",
        "",
        f"{number(point.complete * PER_HOUR, 3)} °/h",
        "`sculler analyze coning`, integer path",
    )
    return whole
