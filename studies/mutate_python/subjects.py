"""What is mutated, and the tests that should see it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Subject:
    """Modules that belong together.

    Attributes:
        sources: their paths, from the root.
        tests: paths of test files under `tests/`, in the order in which they run; of them the fast
            tests run.
        but: words in the names of tests that are left out.
    """

    sources: tuple[str, ...]
    tests: tuple[str, ...]
    but: tuple[str, ...]


def _sources(folder: str, names: str) -> tuple[str, ...]:
    return tuple(f"{folder}/{name}.py" for name in names.split())


def _tests(folder: str, names: str) -> tuple[str, ...]:
    return tuple(f"{folder}/test_{name}.py" for name in names.split())


_MODEL = "model/sculler_model"
_FORMATS = "cli/sculler/formats"

_TWIN = ("fast", "pass_the_words")
"""Tests of the fast model: without Numba it takes minutes, and they are not about these modules."""

_CHAIN = (
    *("simulate", "drops_others", "whole_chain"),
    *("compiled", "long_log_streams", "stamps_and_counter"),
)
"""Tests that compile a simulator or fly what they read; and that need what Numba compiles."""

DRAWS = ("First", "Second", "Third", "Fourth", "Fifth")
"""Names of the draws of mutants, on the page."""

_KERNEL = ("wide_5p0", "1p1-True")
"""Cases that go through the fast model's kernel, which Python without Numba cannot run."""

_HOURS = ("an_hour_of_flight",)
"""A test that needs Numba to end in a minute."""

SUBJECTS = {
    "golden": Subject(
        _sources(f"{_MODEL}/golden", "reference compensation channels"),
        _tests("model", "golden channels compensation higher_order high_resolution values"),
        _TWIN,
    ),
    "wordlength": Subject(
        _sources(f"{_MODEL}/design", "word_lengths interval higher_order_words"),
        _tests("model", "wordlength higher_order high_resolution values"),
        _TWIN,
    ),
    "cycles": Subject(
        _sources(f"{_MODEL}/golden", "cycles stream throughput channel_cycles pipelined_channels"),
        _tests("model", "stream throughput cycles_clocking hardening cycles channels values"),
        _TWIN,
    ),
    "coefficients": Subject(
        _sources(
            f"{_MODEL}/algorithms",
            "tap_table series decimals time_taylor pairs triples scrolling higher_order"
            " integer_vectors dual_vectors",
        ),
        (
            *_tests("model", "coefficients scrolling higher_order"),
            *_tests("model/families", "parabola manoeuvres fits response"),
            *_tests("model", "values"),
        ),
        _TWIN,
    ),
    "families": Subject(
        _sources(
            f"{_MODEL}/algorithms",
            "catalogue balance band delay lattice least_squares response tuned uncompressed",
        ),
        (
            *_tests("model/families", "response fits families design_keys manoeuvres parabola"),
            *_tests("model", "compensation"),
            *_tests("model/analysis", "behind_filters"),
            *_tests("model", "values"),
        ),
        _TWIN,
    ),
    "host": Subject(
        _sources(
            f"{_MODEL}/host",
            "compensation compiled increments known_errors next_orders scaling third_order",
        ),
        (
            *_tests("model", "host_series host third_order_host calibration scaling_compiled"),
            *_tests("model", "whole_intervals velocity_orders high_resolution increments_of"),
            *_tests("model", "compensation higher_order values"),
            *_tests("model/analysis", "manoeuvre"),
        ),
        (*_TWIN, *_KERNEL, "kept_on_disk"),
    ),
    "navigation": Subject(
        _sources(
            f"{_MODEL}/navigation",
            "alignment attitude_estimate attitude_only coasting exact fine_alignment geographic"
            " gravity height navigator sensor_noise state stepping wander",
        ),
        (
            *_tests("model", "limits exact gravity height_reference navigator alignment"),
            *_tests("model", "alignment_covariance alignment_sigmas fine_alignment"),
            *_tests("model", "whole_intervals high_resolution"),
            *_tests("model", "attitude_only"),
            *_tests("cli", "attitude_only"),
            *_tests("model", "values alternatives wander"),
        ),
        _HOURS,
    ),
    "compare": Subject(
        (
            *_sources(_FORMATS, "comparison"),
            *_sources(f"{_MODEL}/navigation", "comparison errors interpolation"),
        ),
        (
            *_tests("model", "navigation_errors"),
            *_tests("sim", "compare"),
            *_tests("cli", "binary_files channels instants"),
            *_tests("model", "values"),  # it loads Numba: what is printed then goes through loops
        ),
        _CHAIN,
    ),
    "logs": Subject(
        _sources(_FORMATS, "log log_columns log_table log_text lines plain_rows"),
        _tests("cli", "logs binary_files log_time channels"),
        _CHAIN,
    ),
}
