"""The RTL in Verilator against bare evaluation of the same verilated model.

Bare: a program that does nothing but drive the samples, toggle the clock and evaluate, as often as
our harness does.  It checks nothing, copies no result, and is compiled with the flags that suit
the model best of those tried.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler_hdl import timing
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.golden import clocks_per_major
from sculler_sim.engine import simulate
from sculler_sim.engines import verilator_build
from studies.bench.contest import Contest, Run

_BEST_FLAGS = ["-std=c++17", "-pthread", "-O2", "-march=native", "-fno-tree-vectorize"]
_BARE = Path(__file__).parent / "plain" / "bare_model.cpp"


def contests(folder: Path) -> list[Contest]:
    """Both cores of the default design, and an unfavourable one: wide and high-resolution."""
    default = Design.preset("stim300").as_json()
    wide = {
        **default,
        "name": "wide_8x4",
        "sensor": {
            **default["sensor"],
            **{name: {**default["sensor"][name], "bits": 32} for name in ("gyro", "accel")},
        },
        "algorithm": {
            "family": "frequency-taylor",
            "samples": 8,
            "history": 4,
            "minors": 5,
            "position": "high-resolution",
        },
    }
    found = []
    for title, json, samples in (
        ("default design", default, {"pipelined": 400_000, "compact": 40_000}),
        ("32 bits, n = 8, p = 4, high-resolution", wide, {"pipelined": 50_000, "compact": 40_000}),
    ):
        for core, count in samples.items():
            design = Design.parse({**json, "hardware": {"core": core}})
            found.append(_contest(folder, f"{core} core, {title}", design, count))
    return found


def _contest(folder: Path, name: str, design: Design, samples: int) -> Contest:
    rng = np.random.default_rng(1)
    words = design.words
    counts = np.hstack(
        [rng.integers(w.lo, w.hi + 1, (samples, 3)) for w in (words.gyro, words.accel)]
    )
    intervals = samples // design.samples_per_major
    clocks = intervals * clocks_per_major(design, timing(design))
    bare, missing = _bare(folder / f"{design.name}_{design.hardware.core}", design, counts)
    return Contest(
        f"RTL in Verilator: {name}",
        "bare evaluation of the same model",
        clocks,
        "clocks",
        lambda: sum(map(len, simulate(design, [(counts, None)]))),
        bare,
        goal=0.9,
        missing=missing,
    )


def _bare(folder: Path, design: Design, counts: NDArray[np.int64]) -> tuple[Run | None, str | None]:
    """The other side, built; or what is missing."""
    try:
        tools = verilator_build.Tools.find()
    except InputError as error:
        return None, str(error)
    folder.mkdir()
    counts.astype(np.int32).tofile(folder / "counts")
    verilog = "\n".join(verilator_build.emitted(design).values())
    (folder / "core.v").write_text(verilog, encoding="utf-8")
    top = ["--top-module", design.name]
    environment = tools.environment
    subprocess.run(
        [*tools.verilator, *verilator_build.VERILATOR_FLAGS, *top, "core.v"],
        cwd=folder,
        env=environment,
        check=True,
        capture_output=True,
    )
    sources = [str(path) for path in sorted((folder / "model").glob("*.cpp"))]
    runtime = [str(tools.root / "include" / f"verilated{kind}.cpp") for kind in ("", "_threads")]
    include = [f"-I{path}" for path in ("model", tools.root / "include")]
    text = "".join(f'#include "{path}"\n' for path in [*sources, *runtime, _BARE])
    (folder / "bare.cpp").write_text(text, encoding="utf-8")
    words = design.words
    widths = [f"-DGYRO_BITS={words.gyro.bits}", f"-DACCEL_BITS={words.accel.bits}"]
    command = [*tools.compiler, *_BEST_FLAGS, *widths, *include, "bare.cpp", "-o", "bare"]
    subprocess.run(command, cwd=folder, env=environment, check=True, capture_output=True)
    run = [str(folder / "bare"), str(folder / "counts")]
    return lambda: subprocess.run(run, check=True), None
