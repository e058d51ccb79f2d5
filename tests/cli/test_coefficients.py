"""`coefficients`: published tables out of the command line, as JSON and to read."""

from __future__ import annotations

import json
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

Run = Callable[..., Any]

EXAMPLES = Path(__file__).parents[2] / "examples"

# oldest sample first, over the denominator (Yang, Ignagni, Park; Zeng for the rates)
PUBLISHED = {
    ("frequency-taylor", 2, 0): (["2/3"], [1, 1, 0]),
    ("frequency-taylor", 3, 0): (["9/20", "27/20"], [1, 1, 1, 0]),
    ("frequency-taylor", 4, 0): (["54/105", "92/105", "214/105"], [1, 1, 1, 1, 0]),
    ("frequency-taylor", 1, 1): (["1/12"], [1, 0]),
    ("frequency-taylor", 2, 1): (["-1/30", "11/15"], [1, 1, 0]),
    ("frequency-taylor", 3, 1): (["3/280", "57/140", "393/280"], [1, 1, 1, 0]),
    ("filtered-rate", 2, 0): (
        ["1/240", "89/120"],
        [Fraction(1, 3), Fraction(4, 3), Fraction(1, 3)],
    ),
}


@pytest.mark.parametrize("case", PUBLISHED, ids=lambda case: f"{case[0]} n={case[1]} p={case[2]}")
def test_published_tables_as_json(run: Run, case: tuple[str, int, int]) -> None:
    family, samples, history = case
    oldest_first, weights = PUBLISHED[case]
    outcome = run(
        *("coefficients", "--family", family, "--samples", samples, "--history", history, "--json")
    )
    assert (outcome.status, outcome.err) == (0, "")
    table = json.loads(outcome.out)
    assert list(table) == ["denominator", "taps", "sum_denominator", "weights"]
    assert len(table["taps"]) == samples
    assert all(not any(row) for row in table["taps"][:-1])
    taps = [Fraction(tap, table["denominator"]) for tap in table["taps"][-1]]
    assert taps == [Fraction(text) for text in reversed(oldest_first)]
    assert [Fraction(w, table["sum_denominator"]) for w in table["weights"]] == weights


def test_readable_table(run: Run) -> None:
    out = run("coefficients", "--family", "frequency-taylor", "--samples", 4).out
    for number in ("214/105", "92/105", "18/35", "2.03809523809524", "-1/315 a² (Ωh)^9"):
        assert number in out
    out = run("coefficients", "--design", EXAMPLES / "user_table_3x4.toml").out
    for number in ("57/80", "33/80", "0.4125"):
        assert number in out


def test_json_is_what_a_design_reads(run: Run, tmp_path: Path) -> None:
    table = json.loads(
        run("coefficients", "--family", "frequency-taylor", "--samples", 3, "--json").out
    )
    design = tmp_path / "own.toml"
    design.write_text(
        'preset = "stim300"\nname = "own"\n[algorithm]\nfamily = "table"\nsamples = 3\n'
        f"[algorithm.table]\ndenominator = {table['denominator']}\ntaps = {table['taps']}\n"
        f"sum_denominator = {table['sum_denominator']}\nweights = {table['weights']}\n"
    )
    assert json.loads(run("coefficients", "--design", design, "--json").out) == table


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "give --family and --samples, or --design"),
        (("--family", "frequency-taylor"), "give --family and --samples"),
        (("--family", "fourier", "--samples", 4), "'fourier' is not known, give frequency-taylor"),
        (("--family", "frequency-taylor", "--samples", "four"), "'four' is not a valid integer"),
        (("--family", "frequency-taylor", "--samples", 17), "17 is not allowed, give 1 to 16"),
        (("--family", "frequency-taylor", "--samples", 1), "--samples 2 or --history 1"),
        (("--family", "filtered-rate", "--samples", 2, "--history", 17), "give 0 to 16"),
        (("--design", "stim300", "--samples", 4), "not both"),
        (("--design", "absent.toml"), "absent.toml: no such design file"),
        (("--order", 4), "--order"),
    ],
)
def test_faults(refused: Callable[..., str], words: tuple[object, ...], message: str) -> None:
    assert message in refused("coefficients", *words)
