"""Compensation before both cores: the emitted Verilog in Verilator.

Amaranth's simulator has every port on every clock in `hdl/test_compensated.py`.
"""

from __future__ import annotations

import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from rtl import anywhere_in_four_majors, check_files, check_resets, check_trace
from sculler_hdl import generate, properties, timing
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_sim.testbench import Least, write_testbench
from strategies import with_hardware

pytestmark = pytest.mark.usefixtures("verilator")

ERRORS: dict[str, Any] = {
    "delay_samples": 0.4,
    "gyro": {"bias": [20.0, -40.0, 10.0], "scale_factor": 500.0, "misalignment": [1.0] * 6},
    "accel": {"bias": [2.0, -1.0, 3.0], "misalignment": [-1.0, 0.5, 0.3, -0.8, 0.2, -0.4]},
}


def stim300(samples: int, minors: int, **more: Any) -> Design:
    algorithm = {"samples": samples, "minors": minors, **more}
    name = f"compensated_{samples}x{minors}"
    data = {"preset": "stim300", "name": name, "algorithm": algorithm}
    return Design.parse({**data, "compensation": ERRORS})


FORMS = {
    "pipelined": stim300(4, 5),
    "pipelined-ecp5": with_hardware(stim300(2, 2, history=1), target="ecp5"),
    "pipelined-drop": with_hardware(stim300(1, 1, history=1), overrun="drop-result"),
    "pipelined-clocking": with_hardware(
        stim300(2, 2), reset="async", reset_active="low", clock_enable=True
    ),
    "compact": with_hardware(stim300(4, 5), core="compact"),
    "compact-ecp5": with_hardware(stim300(2, 2), core="compact", target="ecp5"),
    "compact-ice40": with_hardware(stim300(2, 1), core="compact", target="ice40"),
    "compact-drop": with_hardware(
        stim300(1, 1, history=1), core="compact", overrun="drop-result", initial=False
    ),
}
ARMED = {
    "arms_m": [[0.05, 0.02, -0.03], [0.01, -0.05, 0.02], [-0.02, 0.03, 0.05]],
    "accel_denominator": 1 << 34,
}
for name in ("pipelined-ecp5", "compact-ice40"):
    data = FORMS[name].as_json()
    FORMS[f"{name}-arms"] = Design.parse(
        {**data, "name": "armed", "compensation": data["compensation"] | ARMED}
    )
EACH = pytest.mark.parametrize("design", FORMS.values(), ids=FORMS)


@pytest.mark.deep
@EACH
def test_results_and_ports(design: Design, tmp_path: Path) -> None:
    """The golden model's vectors, the cycle model's clocks, and both after resets."""
    if design.drops_results:
        check_trace(design, "verilator", 6000, range(4))
        return
    check_files(design, tmp_path, ["model", "verilator"], 200)
    check_trace(design, "verilator", 6000, range(4))
    check_resets(design, tmp_path, 10 * design.samples_per_major, anywhere_in_four_majors(design))


@pytest.mark.deep
@EACH
def test_bench_in_icarus(design: Design, tmp_path: Path) -> None:
    """The bench that is handed out passes, and fails where it is told of a slower compensation."""
    made = generate(design)
    for name, text in {f"{design.name}.v": made.verilog, **cell_texts(made.cells)}.items():
        (tmp_path / name).write_text(text)
    clocks = timing(design)
    assert clocks.compensation is not None
    least = Least((1, 24), (2, 48), 4, 0)
    for more, said in ((0, "PASS"), (500, "FAIL")):  # a slow engine hides a few clocks
        told = replace(clocks, compensation=clocks.compensation + more)
        write_testbench(design, tmp_path, told, made.cells, least)
        assert in_icarus(tmp_path, design.name, made.cells).splitlines()[-1].startswith(said)


def cell_texts(cells: dict[str, str]) -> dict[str, str]:
    return {f"{name}.v": text for name, text in cells.items()}


def in_icarus(folder: Path, name: str, cells: dict[str, str]) -> str:
    """What the bench prints."""
    if shutil.which("iverilog") is None:
        pytest.skip("no iverilog")
    sources = [f"{each}.v" for each in (f"{name}_tb", name, *cells)]
    compiled = ["iverilog", "-g2001", "-o", "bench", *sources]
    subprocess.run(compiled, cwd=folder, check=True, capture_output=True)
    run = subprocess.run(
        ["vvp", "-n", "bench"], cwd=folder, capture_output=True, text=True, check=False
    )
    return run.stdout.strip()


def test_properties_are_those_of_a_core_without() -> None:
    with pytest.raises(InputError, match="compensation: the properties are those of a core"):
        properties(FORMS["compact"])
