"""Designs and counts that every test of exactness runs on.

`DESIGNS` are named designs that between them cover the parameter space; `designs` is the
hypothesis strategy for arbitrary legal ones; `random_counts` makes the inputs, with many
full-scale counts among them, because those are what breaks words that are too short.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from sculler_model.design import Design

Counts = NDArray[np.int64]

Samples = tuple[Counts, NDArray[Any]]
"""Counts (N, 6) and faults (N,)."""


def make_design(
    name: str,
    samples: int,
    history: int,
    minors: int,
    bits: tuple[int, int],
    family: str = "frequency-taylor",
    kind: str = "increment",
    options: dict[str, Any] | None = None,
    hardware: dict[str, Any] | None = None,
    **table: Any,
) -> Design:
    """A design of n samples, p history, M minors and (gyro, accel) bits.

    `options` are more keys of [algorithm], `table` is [algorithm.table].
    """
    algorithm: dict[str, Any] = {
        "family": "table" if table else family,
        "samples": samples,
        "history": history,
        "minors": minors,
        **(options or {}),
    }
    if table:
        algorithm["table"] = table
    return Design.parse(
        {
            "name": name,
            "sensor": {
                "kind": kind,
                "sample_rate_hz": 1000.0,
                "gyro": {"bits": bits[0], "lsb": 1e-8},
                "accel": {"bits": bits[1], "lsb": 1e-7},
            },
            "algorithm": algorithm,
            "hardware": hardware or {},
        }
    )


def with_hardware(design: Design, **hardware: Any) -> Design:
    """The same design with another [hardware]: these keys, the others as they come."""
    return Design.parse({**design.as_json(), "hardware": hardware})


_ALL = [
    Design.preset("stim300"),
    make_design("savage_1p1", 1, 1, 64, (16, 12)),
    make_design("taylor_2p0", 2, 0, 8, (8, 32)),
    make_design("taylor_2p1", 2, 1, 7, (24, 16)),
    make_design("taylor_3p1", 3, 1, 4, (20, 17)),
    make_design("taylor_3p3", 3, 3, 2, (9, 25)),
    # 32-bit as the HG4930: the accumulators pass 64 bits
    make_design("wide_5p0", 5, 0, 3, (32, 32)),
    make_design("taylor_6p2", 6, 2, 1, (13, 29)),
    make_design("taylor_7p0", 7, 0, 1, (11, 8)),
    # taps of some 40 bits
    make_design("taylor_8p8", 8, 8, 2, (31, 10)),
    make_design("rate_1p0", 1, 0, 5, (18, 22), "filtered-rate", "rate"),
    make_design("rate_2p0", 2, 0, 10, (16, 19), "filtered-rate", "rate"),
    make_design("rate_4p1", 4, 1, 3, (24, 28), "filtered-rate", "rate"),
    # Savage-20 method 1, n = 3: c12 = c23 = 57/80, c13 = 33/80
    make_design("dense_time_3", 3, 0, 6, (24, 20), denominator=80, taps=[[], [57], [57, 33]]),
    # Savage-20 method 4, n = 4: c12 = c34 = 232, c23 = 178, c13 = c24 = 138, c14 = 162 over 315
    make_design(
        "dense_uncompressed_4",
        4,
        0,
        5,
        (21, 24),
        denominator=315,
        taps=[[], [232], [178, 138], [232, 138, 162]],
    ),
    # a user's table that nothing can be guessed from: every phase but one has taps, of both signs,
    # with gaps, reaching past the previous minor interval; weights with a gap and a sign
    make_design(
        "dense_odd_3",
        3,
        0,
        5,
        (8, 11),
        denominator=7,
        taps=[[0, -3, 0, 0, 0, 0, 5], [], [1, 0, -2]],
        sum_denominator=6,
        weights=[1, 0, -4, 5],
    ),
    # the other families, each as its solver makes it
    make_design("time_3p2", 3, 2, 4, (18, 22), "time-taylor"),
    make_design("uncompressed_5p0", 5, 0, 3, (20, 16), "uncompressed"),
    make_design(
        "fit_4p1",
        4,
        1,
        5,
        (16, 24),
        "least-squares",
        options={
            "denominator_bits": 16,
            "band": {
                "profile": [[20, 0.01], [80, 0.04], [350, 0.04]],
                "mount": {"natural_hz": 50.0, "damping": 0.125},
            },
        },
    ),
    make_design(
        "tuned_rate_3p0",
        3,
        0,
        6,
        (19, 12),
        "tuned",
        "rate",
        options={
            "sum": "plain",
            "filter": {"kind": "digital", "numerator": [0.25, 0.5, 0.25]},
        },
    ),
    make_design(
        "uncompressed_tuned_3p1",
        3,
        1,
        4,
        (24, 20),
        "uncompressed",
        options={"base": "tuned", "filter": {"kind": "sinc", "width_samples": 2}},
    ),
    # one tap, one sample, one minor interval: a result at every sample
    make_design("smallest", 1, 0, 1, (8, 9), denominator=2, taps=[-1]),
    # the sum is the sample before the newest alone
    make_design("late_sum_2", 2, 1, 16, (10, 8), denominator=12, taps=[0, 5, 1], weights=[0, 0, 1]),
]

DESIGNS: dict[str, Design] = {design.name: design for design in _ALL}
"""Named designs: n 1-8, p 0-n, compressed and dense, increments and rates, M 1-64, widths 8-32."""


CORES: dict[str, dict[str, Any]] = {"pipelined": {}, "compact": {"core": "compact"}}
"""[hardware] of the two cores as they come."""

TARGETS = ("ecp5", "ice40", "xilinx")
"""Targets whose multiplier or memory blocks differ from what is generic."""


def on_cores(design: Design, cores: dict[str, dict[str, Any]]) -> dict[str, Design]:
    """The design on each of the cores, by NAME-CORE."""
    return {f"{design.name}-{core}": with_hardware(design, **h) for core, h in cores.items()}


def on_targets(design: Design, core: str) -> dict[str, Design]:
    """The design on one of `CORES` for each of `TARGETS`, by NAME-TARGET."""
    return {
        f"{design.name}-{target}": with_hardware(design, target=target, **CORES[core])
        for target in TARGETS
    }


def random_counts(design: Design, samples: int, rng: np.random.Generator) -> Counts:
    """(samples, 6) counts: most negative, most positive, zero, small and uniform ones mixed.

    Runs of one kind occur too, so that accumulators are driven to their ends.
    """
    words = design.words
    lo, hi = (
        np.array([getattr(words.gyro, end)] * 3 + [getattr(words.accel, end)] * 3)
        for end in ("lo", "hi")
    )
    shape = (samples, 6)
    small = rng.integers(-3, 4, shape)
    uniform = rng.integers(lo, hi, shape, endpoint=True)
    kinds = np.stack(np.broadcast_arrays(lo, hi, np.int64(0), small, uniform))
    chance = [0.3, 0.25, 0.05, 0.1, 0.3]
    each = rng.choice(len(chance), shape, p=chance)
    runs = np.repeat(rng.choice(len(chance), (samples // 16 + 1, 6), p=chance), 16, axis=0)
    kind = np.where(rng.random((samples, 1)) < 0.3, each, runs[:samples])
    counts: Counts = np.take_along_axis(kinds, kind[np.newaxis], axis=0)[0]
    return counts


def samples_of(design: Design, samples: int, seed: int) -> Samples:
    """Random counts, full-scale ones among them, and a few faults.

    About half of the major intervals come within one of the rails and do not stand at them; half of
    the others do in one count alone.
    """
    rng = np.random.default_rng(seed)
    counts, span = random_counts(design, samples, rng), design.samples_per_major
    words = design.words
    lo, hi = (
        np.array([getattr(words.gyro, end)] * 3 + [getattr(words.accel, end)] * 3)
        for end in ("lo", "hi")
    )
    calm = np.repeat(rng.random(samples // span + 1) < 0.75, span)[:samples]
    counts[calm] = counts[calm].clip(lo + 1, hi - 1)
    for first in range(0, samples - span, span):
        if calm[first] and rng.random() < 0.33:
            column = rng.integers(6)
            counts[first + rng.integers(span), column] = rng.choice([lo[column], hi[column]])
    return counts, (rng.random(samples) < 0.01).astype(int)


@st.composite
def designs(
    draw: st.DrawFn,
    max_samples: int = 16,
    max_minors: int = 64,
    bits: tuple[int, int] = (8, 32),
) -> Design:
    """Any legal design: all families, compressed and dense tables, unequal widths."""
    n = draw(st.integers(1, max_samples))
    minors = draw(st.integers(1, max_minors))
    widths = (draw(st.integers(*bits)), draw(st.integers(*bits)))
    family = draw(st.sampled_from(["frequency-taylor", "filtered-rate", "table"]))
    if family != "table":
        least = 1 if (family, n) == ("frequency-taylor", 1) else 0
        p = draw(st.integers(least, n) | st.integers(least, 16))
        kind = "rate" if family == "filtered-rate" else "increment"
        return make_design("any", n, p, minors, widths, family, kind)
    tap = st.integers(-(1 << 20), 1 << 20) | st.integers(-3, 3)
    row = st.lists(tap, max_size=2 * n)
    flat = row.filter(any)
    dense = st.lists(row, min_size=n, max_size=n).filter(lambda rows: any(map(any, rows)))
    weight = st.lists(st.integers(-100, 100), min_size=1, max_size=n + 1)
    table: dict[str, Any] = {
        "denominator": draw(st.integers(1, 10**6)),
        "taps": draw(flat | dense),
        "sum_denominator": draw(st.integers(1, 1000)),
        "weights": draw(weight.filter(any) | st.none()),
    }
    return make_design("any", n, draw(st.integers(0, n)), minors, widths, **table)


@st.composite
def huge_designs(draw: st.DrawFn) -> Design:
    """Designs whose coefficients have hundreds of bits."""
    taps = draw(st.lists(st.integers(-(10**80), 10**80), min_size=1, max_size=6).filter(any))
    weights = draw(st.lists(st.integers(-(10**60), 10**60), min_size=1, max_size=4).filter(any))
    bits = draw(st.tuples(st.integers(8, 32), st.integers(8, 32)))
    return make_design("huge", 3, 1, 4, bits, denominator=1, taps=taps, weights=weights)
