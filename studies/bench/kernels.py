"""From arrays of counts to exact integers: `FastModel` against plain C, one thread each.

The C (plain/vectors.c) has the design's table as constants; both sides make the results' memory
anew in each run.  Then counts to φ and ΔV with one sample a result, against `python-ins`, ours with
the threads that it takes by itself.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import MAX_SAMPLES
from sculler_model.design import PRESETS, Design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel, component_limbs, limbs_of
from sculler_model.host import increments_of
from studies.bench.contest import Contest, compiled

SAMPLES = 1_000_000
_PLAIN = Path(__file__).parent / "plain" / "vectors.c"
_GOAL = 0.7


def contests(folder: Path, samples: int = SAMPLES) -> list[Contest]:
    """Every preset, a dense table, high-resolution position; how the cost grows; python-ins.

    Args:
        folder: for the C programs.
        samples: of a run.

    Raises:
        InputError: a C program gives other integers than the model.
    """
    goals = {name: Design.preset(name) for name in PRESETS}
    goals |= {
        "dense, n = 4": Design.preset("stim300", family="time-taylor"),
        "dense, n = 4, 32 bits": Design.preset("hg4930", family="time-taylor"),
        "high-resolution": Design.preset("stim300", position="high-resolution"),
    }
    growth = {f"n = {n}": Design.preset("stim300", samples=n) for n in (2, 8, 16)}
    growth |= {f"n = p = {n}": Design.preset("stim300", samples=n, history=n) for n in (1, 4, 8)}
    growth |= {f"M = {M}": Design.preset("stim300", minors=M) for M in (1, 64)}
    held = [_against_c(folder, name, design, samples, _GOAL) for name, design in goals.items()]
    held += [_against_c(folder, name, design, samples, None) for name, design in growth.items()]
    for name in ("stim300", "high-resolution"):
        held.append(_threads(name, goals[name], 4 * samples))
    return [*held, _against_python_ins(samples)]


def _against_c(
    folder: Path, name: str, design: Design, samples: int, goal: float | None
) -> Contest:
    counts = _counts(design, samples)
    model = FastModel(design, threads=1, compiled=True)

    def ours() -> Any:
        model.reset()
        return model.feed(counts)

    found = ours()
    theirs, missing = _plain(folder, design, counts, len(found))
    if theirs is not None and not np.array_equal(theirs(), limbs_of(found.components)):
        raise InputError(f"{design.name}: plain C gives other integers")
    bits = max(design.words.gyro.bits, design.words.accel.bits)
    what = f"{name}: {bits} bits, {64 * component_limbs(design)} a result"
    return Contest(what, "plain C, one thread", samples, "samples", ours, theirs, goal, missing)


def _counts(design: Design, samples: int) -> NDArray[np.int64]:
    """Random counts of full scale."""
    rng, words = np.random.default_rng(1), design.words
    sensors = (words.gyro, words.accel)
    return np.hstack([rng.integers(w.lo, w.hi + 1, (samples, 3)) for w in sensors])


def _plain(
    folder: Path, design: Design, counts: NDArray[np.int64], majors: int
) -> tuple[Callable[[], NDArray[np.int64]] | None, str | None]:
    """The C program's run of a design, or what is missing."""
    limbs, columns = component_limbs(design), len(design.components)
    if limbs > 2:
        return None, "C has integers of 128 bits at most"
    name = f"{design.name}_{design.digest[:8]}"
    header, library = folder / f"{name}.h", folder / f"{name}.so"
    header.write_text(_table(design))
    missing = compiled(str(_PLAIN), str(library), f'-DTABLE="{header}"')
    if missing is not None:
        return None, missing
    function = ctypes.CDLL(str(library)).vectors
    before = 2 * MAX_SAMPLES  # zeros, for what was before the first sample; none reaches further
    padded = np.concatenate([np.zeros((before, 6), np.int64), counts])

    def run() -> NDArray[np.int64]:
        out = np.empty((majors, columns, limbs), np.int64)
        start = ctypes.c_void_p(padded[before:].ctypes.data)
        function(start, ctypes.c_int64(majors), ctypes.c_void_p(out.ctypes.data))
        return out

    return run, None


def _table(design: Design) -> str:
    """The header of a design."""
    table, words = design.table, design.words
    sums = (words.gyro_taps, words.accel_taps, words.alpha, words.nu)
    lines = [
        f"#define N {table.samples}",
        f"#define M {design.algorithm.minors}",
        "#define COUNT int64_t",
        f"#define WIDE {int(component_limbs(design) > 1)}",
        f"#define WIDE_SUMS {int(max(each.bits for each in sums) > 63)}",
        f"#define POSITION {int(design.high_resolution)}",
    ]
    phases = []
    for k, row in enumerate(table.taps, start=1):
        if any(row):
            taps = " ".join(f"T({d}, {c}LL)" for d, c in enumerate(row, start=1) if c)
            lines.append(f"#define TAPS_{k}(T) {taps}")
            phases.append(f"P({k}, TAPS_{k})")
    lines.append(f"#define PHASES(P) {' '.join(phases)}")
    weights = " ".join(f"T({d}, {c}LL)" for d, c in enumerate(table.weights) if c)
    return "\n".join([*lines, f"#define WEIGHTS(T) {weights}", ""])


def _threads(name: str, design: Design, samples: int) -> Contest:
    """All threads that so many samples get against one."""
    counts = _counts(design, samples)
    models = [FastModel(design, compiled=True), FastModel(design, threads=1, compiled=True)]

    def run(model: FastModel) -> Callable[[], object]:
        def fed() -> object:
            model.reset()
            return model.feed(counts)

        return fed

    ours, theirs = map(run, models)
    return Contest(f"{name}, all threads", "one thread", samples, "samples", ours, theirs)


def _against_python_ins(samples: int) -> Contest:
    """Counts to φ and ΔV, a result each sample, with the correction of two samples."""
    design = Design.preset("stim300", samples=1, history=1, minors=1)
    counts = _counts(design, samples)
    model = FastModel(design, compiled=True)

    def ours() -> Any:
        model.reset()
        return increments_of(model, counts)

    name, against = "counts to φ and ΔV, n = p = M = 1", "python-ins, from increments in SI"
    try:
        import pandas as pd
        from pyins.strapdown import compute_increments_from_imu
        from pyins.util import ACCEL_COLS, GYRO_COLS
    except ImportError as error:
        missing = f"{error.name} is missing, install python-ins"
        return Contest(name, against, samples, "samples", ours, None, 4, missing)
    scales = [design.gyro_scale] * 3 + [design.accel_scale] * 3
    times = design.sample_interval * np.arange(1.0, samples + 1)
    imu = pd.DataFrame(counts * scales, index=times, columns=[*GYRO_COLS, *ACCEL_COLS])

    def theirs() -> Any:
        return compute_increments_from_imu(imu, "increment")

    return Contest(name, against, samples, "samples", ours, theirs, 4)
