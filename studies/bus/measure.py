"""Places and routes the module between core and host, alone."""

from __future__ import annotations

import json
import tempfile
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

from sculler.words import Advance, silent
from sculler_hdl import generate
from sculler_model.design import Design
from sculler_sim.place.tools import NEXTPNR, YOSYS, ToolError

SEEDS = (1, 2, 3)
DEVICE = ("--25k", "--speed", "6", "--package", "CABGA381")
GOAL_MHZ = 150

BUSES: dict[str, dict[str, Any]] = {
    "axi-lite": {"result": "axi-lite"},
    "axi-lite, no time stamps": {"result": "axi-lite", "time_stamps": False},
    "axi-lite, a clock of its own": {"result": "axi-lite", "clock": "separate"},
    "apb": {"result": "apb"},
    "wishbone": {"result": "wishbone"},
    "wishbone-pipelined": {"result": "wishbone-pipelined"},
    "axi-stream": {"result": "axi-stream"},
    "axi-stream, a clock of its own": {"result": "axi-stream", "clock": "separate"},
}
"""The keys of [hardware.bus], by what the page calls them."""


@dataclass(frozen=True)
class Measured:
    """What a bus takes.

    Attributes:
        name: as in `BUSES`.
        luts: look-up tables of 4 inputs, carry steps among them.
        registers: flip-flops.
        blocks: block memories, DP16KD.
        mhz: clock rate of the core's side, the median of the seeds.
    """

    name: str
    luts: int
    registers: int
    blocks: int
    mhz: float


def design_of(name: str) -> Design:
    """The preset stim300 in the compact core, with a bus of `BUSES`."""
    hardware = {"core": "compact", "target": "ecp5", "bus": BUSES[name]}
    return Design.parse({"preset": "stim300", "hardware": hardware})


def measure(name: str, advance: Advance = silent) -> Measured:
    """Synthesise, place and route a bus.

    Raises:
        InputError: Yosys or nextpnr is not installed.
        ToolError: one of them failed.
    """
    design = design_of(name)
    top = f"{design.name}_bus"
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        (folder / "bus.v").write_text(generate(design).further[f"{top}.v"], encoding="utf-8")
        script = f"read_verilog bus.v; synth_ecp5 -top {top} -json bus.json"
        status, said = YOSYS.run(folder, "-q", "-p", script)
        if status:
            raise ToolError(YOSYS, said)
        advance(1)
        reports = []
        for seed in SEEDS:
            reports.append(_routed(folder, seed))
            advance(1)
    used = {kind: use["used"] for kind, use in reports[0]["utilization"].items()}
    rates = [report["fmax"]["clk"]["achieved"] for report in reports]
    return Measured(
        name, used["TRELLIS_COMB"], used["TRELLIS_FF"], used.get("DP16KD", 0), median(rates)
    )


def _routed(folder: Path, seed: int) -> dict[str, Any]:
    options = ("--json", "bus.json", "--report", "report.json", "--out-of-context", "--quiet")
    goal = ("--freq", str(GOAL_MHZ), "--timing-allow-fail", "--seed", str(seed))
    tool = NEXTPNR["ecp5"]
    status, said = tool.run(folder, *DEVICE, *options, *goal)
    if status:
        raise ToolError(tool, said)
    found: dict[str, Any] = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    return found
