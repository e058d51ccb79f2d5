"""The recursion of common flight stacks beside ours."""

from __future__ import annotations

from math import pi, radians

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import frequency_taylor
from sculler_model.analysis import frequency
from sculler_model.analysis.advice import PER_HOUR
from sculler_model.analysis.oscillation import Scull
from sculler_model.analysis.vibration import G
from sculler_model.frames import conjugate, from_rotation_vector, product, to_rotation_vector
from sculler_model.motion import Coning
from studies.accuracy.coning import coning_left, coning_whole, fine_design, true_attitude
from studies.accuracy.section import Section, number


def float32_recursion_drift(half_angle: float, hertz: float, T: float, per_major: int) -> float:
    """Drift (°/h) of ½(α + Δα_prev/6) × Δα summed in single precision, as flight stacks do.

    The sums are handed over every `per_major` samples; attitude is put together in double.
    """
    omega = 2 * pi * hertz
    motion = Coning(half_angle, omega)
    turns = 200
    majors = round(turns / (hertz * T * per_major))
    s = motion.increments(majors * per_major + 1, T, -1)[:, :3].astype(np.float32)
    before = s[:-1].reshape(majors, per_major, 3)
    now = s[1:].reshape(majors, per_major, 3)
    alpha: NDArray[np.float32] = np.zeros((majors, 3), np.float32)
    beta: NDArray[np.float32] = np.zeros((majors, 3), np.float32)
    half, sixth = np.float32(0.5), np.float32(1 / 6)
    for k in range(per_major):
        turned: NDArray[np.float32] = np.cross(alpha + before[:, k] * sixth, now[:, k])
        beta = beta + half * turned
        alpha = alpha + now[:, k]
    q = true_attitude(motion, 0.0)
    for x, y, z in (alpha + beta).astype(np.float64).tolist():
        q = product(q, from_rotation_vector((x, y, z)))
    seconds = majors * per_major * T
    truth = true_attitude(motion, seconds)
    return to_rotation_vector(product(q, conjugate(truth)))[2] / seconds * PER_HOUR


def recursion() -> Section:
    """Flight stacks' recursion beside ours."""
    section = Section(
        "The recursion of common flight stacks",
        "½(α + Δα_prev/6) × Δα, sample by sample (Savage-98 Eq. 61's twin): n = 1, p = 1 here."
        " Classical coning of 0.1° at 50 Hz; 10 ms major intervals; the coning itself is 98.7 °/h."
        " Flight stacks do it in single precision, and no sculling at all.",
        pictures=(
            (
                "accuracy-recursion.png",
                "Drift of the recursion and of four samples over the coning frequency",
            ),
        ),
    )
    a, hertz = radians(0.1), 50.0
    for rate in (1000, 2000):
        T, span = 1 / rate, rate // 100
        for name, n, p in (("recursion, n = 1, p = 1", 1, 1), ("ours, n = 4, p = 0", 4, 0)):
            if span % n:
                continue
            table = frequency_taylor(n, p)
            section.add(
                f"{name}, {rate} Hz, closed form",
                "",
                f"{number(coning_left(table, a, hertz, T), 3)} °/h",
                "`closed_form.drift_rate`",
            )
            section.add(
                f"{name}, {rate} Hz, attitude",
                "",
                f"{number(coning_whole(table, span // n, a, hertz, T), 3)} °/h",
                "`advice.coning_drift`",
            )
        section.add(
            f"recursion in single precision, {rate} Hz, attitude",
            "",
            f"{number(float32_recursion_drift(a, hertz, T, span), 3)} °/h",
            "`accuracy.float32_recursion_drift`",
        )
    motion = Scull(radians(0.1), 10.0)
    without = abs(float(frequency.uncorrected(motion, np.array([35.0]))[0])) / G * 1e6
    design = fine_design("frequency-taylor", 4, 0, 5, 2000.0)
    left = abs(float(frequency.drift(design, motion, np.array([35.0]))[0])) / G * 1e6
    section.add(
        "no sculling: 0.1° with 10 m/s² at 35 Hz", "", f"{number(without, 3)} µg", "uncorrected"
    )
    section.add(
        "the same, ours, n = 4, 2 kHz", "", f"{number(left)} µg", "`sculler analyze sculling`"
    )
    section.after = (
        "The recursion leaves what any two-sample table leaves. With four samples the triple"
        " products are the limit, not the table. Where sums are handed over every 10 ms, single"
        " precision does not show in this drift; what flight stacks lose is the sculling.",
    )
    return section
