"""The design file's keys for the families: what they mean, and one clear line for each fault."""

from __future__ import annotations

from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from sculler_model.algorithms import Balance, Band, Fit, Recipe, Response, frequency_taylor, make
from sculler_model.algorithms.catalogue import Made
from sculler_model.algorithms.uncompressed import Uncompressed
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.golden import GoldenModel


def parse(kind: str = "increment", **algorithm: Any) -> Design:
    return Design.parse(
        {
            "name": "keys",
            "sensor": {
                "kind": kind,
                "sample_rate_hz": 1000.0,
                "gyro": {"bits": 16, "lsb": 1e-6},
                "accel": {"bits": 16, "lsb": 1e-5},
            },
            "algorithm": {"samples": 4, "minors": 5, **algorithm},
        }
    )


def refusal(kind: str = "increment", **algorithm: Any) -> str:
    with pytest.raises(InputError) as caught:
        parse(kind, **algorithm)
    message = str(caught.value)
    assert "\n" not in message
    return message.removeprefix("design: ")


BAND = {"high_hz": 200.0}
SINC = {"kind": "sinc"}
POINTS = [[0, 1], [200, 0.9], [300, 0.5]]


def fitted(**band: Any) -> dict[str, Any]:
    return {"family": "least-squares", "band": band}


def tuned(**keys: Any) -> dict[str, Any]:
    return {"family": "tuned", **keys}


def with_filter(kind: str, **keys: Any) -> dict[str, Any]:
    return tuned(filter={"kind": kind, **keys})


FAULTS: list[tuple[dict[str, Any], str]] = [
    # too large
    ({"family": "time-taylor", "samples": 12, "history": 8}, "algorithm.family: algorithm.samples"),
    ({"family": "uncompressed", "samples": 12, "history": 8}, "20 is too large for uncompressed"),
    ({"family": "least-squares", "samples": 12, "history": 8, "band": BAND}, "20 is too large for"),
    # options of other families, and missing ones
    ({"family": "time-taylor", "band": BAND}, 'algorithm.band: not used by family = "time-taylor"'),
    ({"family": "frequency-taylor", "denominator_bits": 8}, "algorithm.denominator_bits: not used"),
    ({"family": "time-taylor", "base": "tuned"}, "algorithm.base: not used by family"),
    (tuned(filter=SINC, fit="free"), 'algorithm.fit: not used by match = "taylor", leave it out'),
    (
        fitted(**BAND) | {"fit": "best"},
        "algorithm.fit: 'best' is not allowed, give \"constrained\"",
    ),
    ({"family": "least-squares"}, 'algorithm.band: missing, "least-squares" needs it'),
    (tuned(), 'sensor.filter: missing, "tuned" needs it: give a table with kind'),
    (tuned(filter=SINC, band=BAND), 'algorithm.band: not used by match = "taylor", leave it out'),
    (tuned(filter=SINC, match="least-squares"), 'algorithm.band: missing, "tuned" needs it'),
    (tuned(filter=SINC, sum="plain"), 'algorithm.sum: not used by sensor.kind = "increment"'),
    ({"family": "uncompressed", "filter": SINC}, 'algorithm.filter: not used by base = "frequency'),
    ({"family": "uncompressed", "base": "tuned"}, 'sensor.filter: missing, "tuned" needs it'),
    (
        tuned(filter=SINC, match="best"),
        "algorithm.match: 'best' is not allowed, give \"taylor\" or",
    ),
    (tuned(filter=SINC, denominator_bits=49), "algorithm.denominator_bits: 49 is not allowed"),
    # bands
    (fitted(high_hz=501.0), "algorithm.band: reaches to 501 Hz, above the Nyquist limit of 500 Hz"),
    (fitted(low_hz=9.0), "algorithm.band: high_hz: missing, give a number > 0, or psd or profile"),
    (fitted(low_hz=9.0, high_hz=9.0), "algorithm.band: low_hz = 9 is not below high_hz = 9"),
    (fitted(high_hz=-1.0), "algorithm.band.high_hz: -1.0 is not allowed, give a number > 0"),
    (fitted(psd=[[1, 2], [1, 3]]), "algorithm.band.psd: row 1: frequencies must rise"),
    (fitted(psd=[[5, 2], [1, 3]]), "but 1 follows 5"),
    (fitted(psd=[[-5, 2], [1, 3]]), "but -5 is negative"),
    (fitted(psd=[[1, 2], [2, -3]]), "algorithm.band.psd: row 1: -3 at 2 Hz is negative"),
    (fitted(psd=[[1, 0], [2, 0]]), "algorithm.band.psd: every value is zero"),
    (fitted(psd=[[1, 2]]), "algorithm.band.psd: [[1, 2]] is not allowed, give rows [frequency,"),
    (fitted(psd=[[1, 2, 3], [2, 3]]), "algorithm.band.psd: row 0 has 3 numbers, give [frequency"),
    (fitted(profile=[[0, 2], [2, 3]]), "algorithm.band.profile: row 0: [0, 2] has no place on log"),
    (fitted(profile=[[1, 2], [2, 0]]), "algorithm.band.profile: row 1: [2, 0] has no place on log"),
    (fitted(psd=[[1, 2], [9, 1]], profile=[[1, 2], [9, 1]]), "psd and profile are both given"),
    (fitted(psd=[[1, 2], [9, 1]], high_hz=10.0), "1 to 10 Hz reaches beyond the table's 1 to 9 Hz"),
    (fitted(mount={"natural_hz": 5.0}, **BAND), "algorithm.band.mount.damping: missing, give a"),
    (fitted(psd=[[0, 1], [600, 1]]), "above the Nyquist limit of 500 Hz"),
    # filters
    (with_filter("box"), 'algorithm.filter.kind: \'box\' is not allowed, give "sinc", "digital"'),
    (with_filter("sinc", order=0), "algorithm.filter.order: 0 is not allowed, give a whole number"),
    (
        with_filter("digital"),
        'algorithm.filter: numerator: missing, kind = "digital" needs 1 to 64',
    ),
    (with_filter("sinc", rate_hz=2.0), 'algorithm.filter: rate_hz: not used by kind = "sinc"'),
    (with_filter("sinc", with_=2.0), "algorithm.filter.with_: unknown key"),
    (with_filter("digital", numerator=[1, -1]), "algorithm.filter: the digital filter passes"),
    (
        with_filter("digital", numerator=[1], denominator=[1, -1.5]),
        "algorithm.filter: the digital filter is unstable",
    ),
    (
        tuned(filter=[SINC, {"kind": "analogue", "numerator": [1], "denominator": [1, -2]}]),
        "algorithm.filter[1]: the analogue filter is unstable",
    ),
    (
        tuned(filter=[SINC, {"kind": "sinc", "width_samples": 0}]),
        "algorithm.filter[1].width_samples",
    ),
    (with_filter("measured", points=POINTS), "sensor.filter: a measured response has no power"),
    (with_filter("measured"), "algorithm.filter: points: missing"),
    (with_filter("measured", points=[[0, 1], [1, 1, 1]]), "2 numbers in every row, or 3"),
    (with_filter("measured", points=[[5, 1], [5, 1]]), "frequencies must rise"),
    (with_filter("measured", file="none.csv"), "algorithm.filter.file: none.csv: cannot read"),
    (with_filter("measured", file="x", points=POINTS), "file and points are both given"),
    (
        tuned(
            match="least-squares",
            band={"high_hz": 400.0},
            filter={"kind": "measured", "points": POINTS},
        ),
        "algorithm.band: the measured response ends at 300 Hz, inside the band",
    ),
    (
        tuned(
            match="least-squares",
            band=BAND | {"high_hz": 400.0},
            filter=SINC | {"width_samples": 3},
        ),
        "algorithm.band: the filter passes less than 1 % at 333.3 Hz",
    ),
    (
        with_filter(
            "analogue", numerator=[1.2345678e-4, 1], denominator=[3.213456789e-9, 1.23412345e-3, 1]
        ),
        "algorithm.denominator_bits: missing, and exact taps would take",
    ),
]


@pytest.mark.parametrize(
    ("algorithm", "message"), FAULTS, ids=lambda x: x if isinstance(x, str) else ""
)
def test_fault(algorithm: dict[str, Any], message: str) -> None:
    assert message in refusal(**algorithm)


def test_rates_where_increments_are_needed() -> None:
    for family in ("time-taylor", "uncompressed", "least-squares"):
        extra = {"band": BAND} if family == "least-squares" else {}
        assert 'is for sensor.kind = "increment"' in refusal("rate", family=family, **extra)


def test_several_faults_come_together() -> None:
    message = refusal(
        family="least-squares",
        band={"low_hz": 5.0, "high_hz": 2.0},
        denominator_bits=0,
        match="taylor",
    )
    for key in ("algorithm.band: ", "algorithm.denominator_bits: ", "algorithm.match: "):
        assert key in message


@pytest.mark.parametrize(
    "algorithm",
    [
        {"family": "time-taylor"},
        {"family": "uncompressed", "base": "least-squares", "band": BAND},
        fitted(profile=[[20, 0.1], [400, 0.2]], mount={"natural_hz": 50.0, "damping": 0.1}),
        tuned(filter=[SINC, {"kind": "digital", "numerator": [1, 1], "rate_hz": 8000.0}]),
    ],
)
def test_a_design_survives_its_json(algorithm: dict[str, Any]) -> None:
    design = parse(**algorithm)
    again = Design.parse(design.as_json())
    assert (again.digest, again.table) == (design.digest, design.table)


def test_designs_without_the_new_keys_are_written_as_before() -> None:
    written = parse(family="frequency-taylor").as_json()["algorithm"]
    assert set(written) == {"family", "samples", "history", "minors"}


def test_measured_file_lies_beside_the_design(tmp_path: Path) -> None:
    (tmp_path / "gyro.csv").write_text("freq_hz,gain\n0,1\n200,0.9\n300,0.5\n")
    (tmp_path / "d.toml").write_text(
        'name = "beside"\n[sensor]\nkind = "increment"\nsample_rate_hz = 1000.0\n'
        "gyro = { bits = 16, lsb = 1e-6 }\naccel = { bits = 16, lsb = 1e-5 }\n"
        '[algorithm]\nfamily = "tuned"\nsamples = 4\nminors = 5\nmatch = "least-squares"\n'
        'band = { high_hz = 200.0 }\nfilter = { kind = "measured", file = "gyro.csv" }\n'
    )
    design = Design.load(tmp_path / "d.toml")
    inline = parse(
        **tuned(match="least-squares", band=BAND, filter={"kind": "measured", "points": POINTS})
    )
    assert design.table == inline.table
    assert design.algorithm == inline.algorithm  # the design stands by itself
    (tmp_path / "gyro.csv").unlink()
    with pytest.raises(InputError, match=r"gyro\.csv: cannot read the response"):
        Design.load(tmp_path / "d.toml")


def test_rounded_taps_stand_over_the_stated_denominator() -> None:
    for bits in (10, 24):
        table = parse(**fitted(**BAND), denominator_bits=bits, fit="free").table
        assert (1 << bits) % table.denominator == 0
        table = parse(**fitted(**BAND), denominator_bits=bits).table
        assert (3 << bits) % table.denominator == 0
    assert parse(**fitted(**BAND)).made.fit is not None


def test_report_says_what_rounding_cost_and_what_is_left() -> None:
    design = parse(family="uncompressed", base="least-squares", band=BAND, denominator_bits=12)
    slow, rounding, manoeuvres = design.made.report()
    assert slow == "Slow motion is held: the sum of d K_d is 16/3."
    assert rounding.startswith("Rounded to 1/12288: weighted rms residual ")
    assert manoeuvres.startswith("Manoeuvres ")
    [manoeuvres] = parse(family="uncompressed").made.report()
    assert "a + b < 5 vanishes" in manoeuvres
    assert "g0×g5: -64/63" in manoeuvres
    # 2/3 of θ1 × θ2: 7/3 for 12/5 of g0 × g3, and 4/9 for 8/15 of g1 × g2
    assert parse(family="uncompressed", samples=2).made.report() == [
        "Manoeuvres ω = Σ g_a τ^a: every term g_a × g_b with a + b < 3 vanishes;"
        " left per minor interval (τ in samples): g0×g3: -1/15, g1×g2: -4/45."
    ]
    [manoeuvres] = parse(family="uncompressed", samples=5).made.report()
    assert "a + b < 5 vanishes, and g1×g4; left per minor interval" in manoeuvres


FIT = Fit(
    (Decimal(1),), (5,), 4, None,
    rms_real=1e-3, rms_rounded=2e-3, rms_nearest=4e-3,
    worst_real=5e-3, worst_rounded=6e-3, worst_hz=70.0,
)  # fmt: skip
ROUNDED = (
    "Rounded to 1/4: weighted rms residual 0.001 before, 0.002 after (0.004 by nearest integers);"
    " largest 0.005 before, 0.006 after, at 70 Hz (rad per minor interval, unit amplitudes)."
)


@pytest.mark.parametrize(
    ("slow", "told"),
    [
        (None, []),
        (Fraction(5, 4), ["5/4."]),
        (Fraction(3, 2), ["3/2, but for -0.25 by rounding."]),
        (Fraction(1, 999_999), ["1/999999, but for 1.2 by rounding."]),
        (Fraction(1, 10**6), ["1e-06, but for 1.2 by rounding."]),
        (Fraction(123456789012345, 10**14), ["1.23456789012, but for 0.015 by rounding."]),
    ],
)
def test_report_of_a_fit(slow: Fraction | None, told: list[str]) -> None:
    made = Made(frequency_taylor(2, 0), Balance(2), replace(FIT, slow=slow))
    held = [f"Slow motion is held: the sum of d K_d is {each}" for each in told]
    assert made.report() == [*held, ROUNDED]
    assert FIT.loss == pytest.approx(1.0)
    assert replace(FIT, rms_real=0.0).loss == 0


def test_report_of_a_table_that_errs_at_once() -> None:
    table = frequency_taylor(2, 0)
    spread = Uncompressed(table, (), 1, {(0, 1): Fraction(1, 6)})
    assert Made(table, Balance(2), uncompressed=spread).report() == [
        "Manoeuvres ω = Σ g_a τ^a: no order vanishes whole;"
        " left per minor interval (τ in samples): g0×g1: 1/6."
    ]
    (zeng,) = make(Recipe("filtered-rate", 2, kind="rate")).report()
    assert zeng.startswith("The sum's Newton-Cotes weights are taken to give the integral, as Zeng")


def test_a_recipe_says_the_rest_by_itself() -> None:
    """No history, increments, the sample rate as the unit, exact taps, slow motion held."""
    band = Band(Fraction(0), Fraction(1, 5))
    for family in ("least-squares", "tuned"):
        said = Recipe(
            family, 4, 0, "increment", Fraction(1), "frequency-taylor", "taylor", "plain",
            Response(), band, None, True,
        )  # fmt: skip
        assert make(Recipe(family, 4, band=band)) == make(said)
    assert make(Recipe("uncompressed", 4)).table == make(Recipe("uncompressed", 4, 0)).table


def test_a_band_may_reach_to_half_the_rate() -> None:
    assert parse(**fitted(high_hz=500.0)).made.fit is not None


def test_a_table_of_the_users_own_is_not_computed() -> None:
    design = parse(family="table", table={"denominator": 2, "taps": [1]})
    with pytest.raises(ValueError, match='family = "table"'):
        _ = design.made


def test_defaults_of_the_sum() -> None:
    """Zeng's premise with his matching, the true sum where the drift itself is fitted."""
    rate = parse("rate", **tuned(filter=SINC))
    assert rate.made.balance.sum == "zeng"
    fit = parse("rate", **tuned(filter=SINC, match="least-squares", band=BAND))
    assert fit.made.balance.sum == "plain"


def test_history_and_status_are_unchanged() -> None:
    """The hardware's reference takes a dense table as it takes any."""
    design = parse(family="uncompressed")
    samples = [((k, k * k % 50, -k), (3, k, 7), 0) for k in range(40)]
    results = list(GoldenModel(design).run(samples))
    assert [result.status for result in results] == [0, 0]
    first = results[0].coning_within
    c = {k: Fraction(v, 315) for k, v in {(1, 2): 232, (3, 4): 232, (2, 3): 178}.items()}
    c |= {(1, 3): Fraction(46, 105), (2, 4): Fraction(46, 105), (1, 4): Fraction(54, 105)}
    total = Fraction(0)
    for minor in range(5):
        for (i, j), value in c.items():
            s, t = (samples[4 * minor + m - 1][0] for m in (i, j))
            total += value * (s[0] * t[1] - s[1] * t[0])
    assert Fraction(first[2], design.table.denominator) == total


def test_made_tables_are_kept() -> None:
    assert parse(family="frequency-taylor").table == frequency_taylor(4, 0)
    before = make.cache_info().misses
    assert parse(family="frequency-taylor").table
    assert make.cache_info().misses == before
