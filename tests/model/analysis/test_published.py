"""The papers' own residuals: their printed constants, and what they mean in numbers."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from sculler_model.algorithms import filtered_rate
from sculler_model.analysis.published import runge_kutta_residual, zeng_residual


@pytest.mark.parametrize(
    ("samples", "constant", "power"),
    [(2, Fraction(337, 60480), 7), (4, Fraction(-5177, 26611200), 11)],
)
def test_zeng_eq_27(samples: int, constant: Fraction, power: int) -> None:
    """The constants were worked out by hand from the printed sum."""
    assert zeng_residual(samples) == type(zeng_residual(samples))(constant, power)


@pytest.mark.parametrize("samples", [1, 2, 3])
def test_zeng_eq_27_is_what_is_left_of_eq_17_and_22(samples: int) -> None:
    """Φ_cx - Σ C_p x_p as functions of λ, at a small λ: neither is a series."""
    n, phase = samples, np.float64(0.05)
    sinc2 = np.sinc(phase / (2 * np.pi)) ** 2
    true = 0.5 * n * phase * (1 - sinc2 * np.sinc(n * phase / np.pi))
    table = filtered_rate(n)
    taps = np.array(table.taps[-1][:n]) / table.denominator
    computed = phase**2 * sinc2 * float(taps @ np.sin(phase * np.arange(1, n + 1)))
    term = zeng_residual(n)
    left = float(term.coefficient) * phase**term.power
    assert true - computed == pytest.approx(left, rel=0.02)


def test_runge_kutta_by_one_rotating_rate() -> None:
    """Eq. 28 within a step, from the four stages of a step over a²; the series' next term is h⁷."""
    h = 0.5  # Ω h
    first, middle, last = (np.exp(1j * x) for x in (0.0, h / 2, h))  # rates over a Ω

    def second(u: complex, v: complex) -> float:
        """Half the third component of u × v, rates of a quaternion's two."""
        return 0.5 * float((np.conj(u) * v).imag)

    # q' = ½ q ω: the stages' first-order parts are plane vectors; each multiplies the next rate
    k = [first / 2, middle / 2, middle / 2, last / 2]
    at = [0, h / 2 * k[0], h / 2 * k[1], h * k[2]]
    rates = [first, middle, middle, last]
    third = h / 6 * sum(w * second(a, r) for w, a, r in zip((1, 2, 2, 1), at, rates, strict=True))
    # the rotation vector's third component is twice the quaternion's
    assert 2 * third - (h - np.sin(h)) / 2 == pytest.approx(h**5 / 1440, rel=0.02)
    assert runge_kutta_residual(between_steps=False).coefficient == Fraction(-(2**5), 1440)
    assert runge_kutta_residual().coefficient == Fraction(-1, 30)
