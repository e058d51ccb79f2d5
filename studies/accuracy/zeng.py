"""Zeng: coning from filtered rates; Runge-Kutta, two samples and four."""

from __future__ import annotations

from math import pi, radians, sqrt

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import filtered_rate
from sculler_model.analysis import frequency
from sculler_model.analysis.advice import PER_HOUR
from sculler_model.frames import Quaternion, conjugate, product, to_rotation_vector
from sculler_model.motion import Coning
from studies.accuracy.coning import coning_left, coning_whole, fine_design, true_attitude
from studies.accuracy.section import Section, number

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
    """Drift (°/h) of two-sample Runge-Kutta: the filter's attenuation, and Zeng Eq. 28."""
    omega = 2 * pi * hertz
    a2 = HALF_ANGLE**2
    lost = 0.5 * a2 * omega * (1 - np.sinc(omega * T / (2 * pi)) ** 2)
    own = a2 * (2 * omega * T) ** 5 / 1440 / (2 * T)
    law: Array = PER_HOUR * (lost - own)
    return law


def zeng() -> Section:
    """Filtered rates: Runge-Kutta, two samples, four samples."""
    section = Section(
        "Zeng: coning from filtered rates",
        "Classical coning, half angle 1°, 20 Hz; rate samples at 1 kHz that passed sinc(ΩT/2);"
        " one minor interval a major one. The paper shows curves, not figures.",
        picture=(
            "accuracy-zeng.png",
            "Drift of Runge-Kutta, two and four filtered samples over the coning frequency",
        ),
    )
    runge_kutta, excess = _runge_kutta_rows(section)
    complete = {n: _sample_rows(section, n) for n in (2, 4)}
    better, four = (abs(x / y) for x, y in ((runge_kutta, complete[2]), (complete[2], complete[4])))
    section.add("Runge-Kutta over 2 samples", "100", number(better), "attitude")
    section.add("2 samples over 4 samples", "", number(four), "attitude")
    section.after = (
        f"**Agrees.** Two orders: {number(better)} times. **But** nearly all of Runge-Kutta's drift"
        " here is the filter's attenuation, which it knows nothing of. On unfiltered samples it"
        f" has {number(excess, 3)} times the drift of Eq. 28: that counts what Runge-Kutta"
        " makes of the coning within a step, a²(Ωh)⁵/1440, and Simpson's rule in it adds half as"
        " much between steps, a²(Ωh)⁵/2880. What two samples leave is likewise not coning but the"
        " error of Simpson's rule, which the paper takes for exact.",
        f"**Four samples.** {number(four)} times better in the attitude, more by closed form: the"
        " rest is the triple products, which no algorithm of this kind forms (see Yang below).",
    )
    return section


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
    law = HALF_ANGLE**2 * (2 * pi * HZ * 2 * T) ** 5 / 1440 / (2 * T) * PER_HOUR
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
    cone = frequency.Cone(HALF_ANGLE)
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
