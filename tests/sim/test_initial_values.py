"""Cores without initial values: right after one clock of reset, whatever their registers held."""

from __future__ import annotations

import re

import numpy as np
import pytest

from bench_files import bench_of, shell
from sculler_hdl import generate
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel
from sculler_sim.engine import simulate
from sculler_sim.place.tools import YOSYS
from strategies import DESIGNS, with_hardware
from tiers import few_of, tiers

CORES = {
    f"{name}-{'-'.join(map(str, hardware.values()))}": with_hardware(
        DESIGNS[name], initial=False, **hardware
    )
    for name, hardware in (
        ("smallest", {"core": "pipelined"}),
        ("smallest", {"core": "compact"}),
        ("dense_odd_3", {"core": "pipelined", "handover": "stream"}),
        ("dense_odd_3", {"core": "compact", "multipliers": 0}),
        ("stim300_4x5", {"core": "compact", "target": "ecp5"}),
        ("stim300_4x5", {"core": "pipelined", "target": "ice40"}),
    )
}
FEW = few_of(list(CORES), ["smallest-pipelined", "smallest-compact"])


def test_the_usual_is_left_unsaid() -> None:
    """A design with initial values is the same design whether it says so or not."""
    usual = DESIGNS["smallest"]
    assert with_hardware(usual, initial=True) == usual
    assert with_hardware(usual, initial=True).digest == usual.digest
    without = with_hardware(usual, initial=False)
    assert without.digest != usual.digest
    assert Design.parse(without.as_json()) == without


@pytest.mark.parametrize("design", tiers(CORES))
def test_the_text_has_none(design: Design) -> None:
    text = generate(design).verilog
    assert "no initial values: reset it before use" in text
    assert not re.search(r"\binitial\b", re.sub(r"//.*", "", text))
    assert not re.search(r"INITVAL_\w+\(320'h0*[1-9a-f]", text)


@pytest.mark.usefixtures("icarus")
@pytest.mark.parametrize("name", FEW)
def test_the_bench_passes_though_all_is_unknown_at_first(name, tmp_path) -> None:
    """In Icarus a register without an initial value is X."""
    done = shell(bench_of(CORES[name], tmp_path)["icarus"], tmp_path)
    assert done.stdout.startswith("PASS: "), done.stdout + done.stderr


@pytest.mark.usefixtures("verilator")
@pytest.mark.parametrize("name", FEW)
def test_results_are_exact_though_all_is_random_at_first(name) -> None:
    """Verilator fills such registers and memories with random bits."""
    design = CORES[name]
    words, rng = design.words, np.random.default_rng(1)
    sensors = (words.gyro, words.accel)
    counts = np.hstack([rng.integers(w.lo, w.hi + 1, (60, 3)) for w in sensors])
    blocks = simulate(design, [(counts, None)], engine="verilator")
    found = [row for block in blocks for row in block.rows()]
    assert len(found) == 60 // design.samples_per_major
    assert found == list(FastModel(design).feed(counts).rows())


@pytest.mark.parametrize(
    ("name", "script"),
    [
        pytest.param(name, script, marks=[] if quick else pytest.mark.deep)
        for name in ("smallest-compact", "smallest-pipelined")
        for script in ("synth_gatemate", "synth_sf2")
        for quick in (name == "smallest-compact" and script == "synth_gatemate",)
    ],
)
def test_synthesis_for_devices_without_initial_values_takes_it(name, script, tmp_path) -> None:
    """Of the text that has them, `synth_sf2` says that it cannot be."""
    try:
        YOSYS.version()
    except InputError as error:
        pytest.skip(str(error))
    design = CORES[name]
    (tmp_path / "script.ys").write_text(f"read_verilog core.v\n{script} -top {design.name}\n")
    (tmp_path / "core.v").write_text(generate(design).verilog)
    status, log = YOSYS.run(tmp_path, "script.ys")
    assert status == 0, log[-2000:]
    if script == "synth_sf2":
        (tmp_path / "core.v").write_text(generate(with_hardware(design, initial=True)).verilog)
        status, log = YOSYS.run(tmp_path, "script.ys")
        assert status != 0
        assert "init" in log[-2000:]
