"""Benches of `cosim`, run by cocotb in Icarus Verilog."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

COSIM = Path(__file__).parent / "cosim"


def require_cosim() -> Any:
    """cocotb's runner; skips where a tool is missing."""
    if shutil.which("iverilog") is None:
        pytest.skip("Icarus Verilog is not installed")
    return pytest.importorskip("cocotb_tools.runner", reason="cocotb is not installed")


def run_cosim(
    sources: list[Path], top: str, module: str, job: dict[str, Any], folder: Path, tests: int
) -> None:
    """Compile sources, run the tests of a module of `cosim` on a job, and see that all pass."""
    runner = require_cosim()
    (folder / "job.json").write_text(json.dumps(job))
    simulator = runner.get_runner("icarus")
    simulator.build(
        sources=sources,
        hdl_toplevel=top,
        build_dir=folder,
        build_args=["-g2005", "-Wall"],
        timescale=("1ps", "1ps"),
        log_file=folder / "build.log",
    )
    results = folder / "results.xml"
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(COSIM))  # the simulator's Python gets this path
        patch.setenv("SCULLER_BENCH", str(folder / "job.json"))
        patch.setenv("COCOTB_LOG_LEVEL", "WARNING")
        try:
            simulator.test(
                test_module=module,
                hdl_toplevel=top,
                build_dir=folder,
                test_dir=folder,
                log_file=folder / "run.log",
                results_xml=str(results),
            )
        except SystemExit:
            pytest.fail((folder / "run.log").read_text()[-4000:])
    assert runner.get_results(results) == (tests, 0)
