"""accuracy.md: what `make accuracy` computes today, and the papers' figures in it."""

from __future__ import annotations

import re
from decimal import Decimal
from math import pi, radians
from pathlib import Path

import numpy as np
import pytest

from studies import accuracy, documents
from studies.accuracy.zeng import improved_drift, runge_kutta_law

PAGES = Path(__file__).parents[2] / documents.PAGES
NUMBER = re.compile("[−-]?\\d+(?:\\.\\d+)?(?:e-?\\d+)?")


@pytest.fixture(scope="module")
def text() -> str:
    return accuracy.document()


def _split(text: str) -> tuple[list[str], list[Decimal]]:
    """Words without white space, and numbers, of a text."""
    numbers = [Decimal(n.replace("\N{MINUS SIGN}", "-")) for n in NUMBER.findall(text)]
    return NUMBER.sub("#", text).split(), numbers


def _one_digit_apart(one: Decimal, other: Decimal) -> bool:
    """Whether two numbers differ by one unit of the last digit shown, of three at least."""
    places = [max(n.as_tuple().exponent, n.adjusted() - 2) for n in (one, other)]
    return abs(one - other) <= Decimal(10) ** max(places)


@pytest.mark.deep
def test_the_document_is_up_to_date(text: str) -> None:
    """Words are the same; figures too, but for a last digit that another machine may round."""
    words, numbers = _split((PAGES / "accuracy.md").read_text(encoding="utf-8"))
    new_words, new_numbers = _split(text)
    assert "".join(words) == "".join(new_words), "run: make accuracy"
    other = [pair for pair in zip(numbers, new_numbers, strict=True) if pair[0] != pair[1]]
    assert [pair for pair in other if not _one_digit_apart(*pair)] == [], "run: make accuracy"
    assert len(other) <= len(numbers) / 50, "run: make accuracy"


def test_what_counts_as_one_digit() -> None:
    near = ("0.044 0.045", "1300 1290", "1.5e-6 1.4e-6", "-5.16 -5.15", "1.0e-6 9.9e-7")
    far = ("0.044 0.046", "1300 1280", "1.5e-6 1.3e-6", "-5.16 5.16", "61 63", "4 40")
    for pairs, expected in ((near, True), (far, False)):
        for pair in pairs:
            assert _one_digit_apart(*map(Decimal, pair.split())) is expected, pair


def test_its_pictures_are_there(text: str) -> None:
    names = re.findall(r"\]\((.*?accuracy-.*?)\)", text)
    assert len(names) == 5
    for name in names:
        assert (PAGES / name).read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_runge_kutta_by_simulation_is_its_law() -> None:
    """Eq. 28 and half as much of Simpson's rule on unfiltered samples; 5.16 °/h on filtered."""
    omega, T = 2 * pi * 20, 1e-3
    eq_28 = radians(1) ** 2 * (2 * omega * T) ** 5 / 1440 / (2 * T) * 206264.806
    assert accuracy.runge_kutta_drift(20.0, False) == pytest.approx(1.5 * eq_28, rel=0.02)
    assert accuracy.runge_kutta_drift(20.0, True) == pytest.approx(-5.16, rel=2e-3)


@pytest.mark.parametrize("hertz", [10.0, 50.0, 100.0, 125.0])
def test_the_line_of_runge_kutta_goes_through_its_marks(hertz: float) -> None:
    """What the two differ by is of fourth order in the half angle."""
    line = float(runge_kutta_law(np.array([hertz]))[0])
    assert accuracy.runge_kutta_drift(hertz, True) == pytest.approx(line, rel=2e-3)


def test_the_improved_two_samples_know_nothing_of_the_filter() -> None:
    """Simpson's rule is all that they leave on unfiltered samples: a²(Ωh)⁵/2880 a step."""
    omega, T = 2 * pi * 20, 1e-3
    half = radians(1) ** 2 * (2 * omega * T) ** 5 / 2880 / (2 * T) * 206264.806
    assert improved_drift(False) == pytest.approx(half, rel=0.02)
    attenuation = 0.5 * radians(1) ** 2 * omega * (omega * T) ** 2 / 12 * 206264.806
    assert improved_drift(True) == pytest.approx(-attenuation, rel=0.01)


@pytest.mark.parametrize(
    ("value", "digits", "shown"),
    [
        (0.0440, 2, "0.044"),
        (1297.5, 3, "1300"),
        (1.466e-6, 2, "1.5e-6"),
        (-0.5, 2, "−0.5"),
        (0, 2, "0"),
        (-9.99e-7, 2, "−1.0e-6"),
    ],
)
def test_numbers_to_read(value: float, digits: int, shown: str) -> None:
    assert accuracy.number(value, digits) == shown


def test_papers_figures_are_met(text: str) -> None:
    """Each row's figure beside the paper's, by the row's own words."""
    rows = dict(re.findall(r"^\| (.*?) \| .*? \| (.*?) \|", text, re.MULTILINE))
    for row, expected, rel in (
        ("4 samples, 4) uncompressed from 3)", 0.000002, 0.3),
        ("sculling, worst phase", 1300, 0.02),
        ("error of Eq. 61 at 2 kHz, worst phase", 0.044, 0.05),
        ("response", 3.6, 0.05),
        ("rotation", 0.00038, 0.02),
        ("two-sample Runge-Kutta", -5.16, 0.01),
        ("2 samples, closed form", 1.07e-2, 0.01),
    ):
        (_, numbers) = _split(rows[row])
        assert float(numbers[0]) == pytest.approx(expected, rel=rel), row
