"""Places and routes the modules between sensor, core and host, each alone."""

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

CUSTOM: dict[str, Any] = {
    "sync": [0xFA, 0x05],
    "length": 31,
    "gyro": {"at": [2, 6, 10], "bytes": 4, "endian": "little"},
    "accel": {"at": [14, 18, 22], "bytes": 4, "endian": "little"},
    "counter": {"byte": 26, "modulus": 128},
    "status": [{"byte": 27, "mask": 0x7F}],
    "check": {
        **{"kind": "crc", "bits": 16, "polynomial": 0x1021},
        **{"byte": 29, "first": 1, "last": 28},
    },
}

FRONTS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "stim300, asynchronous": ({"preset": "stim300"}, {"sensor": "stim300"}),
    "hg4930, asynchronous": ({"preset": "hg4930"}, {"sensor": "hg4930"}),
    "custom of 31 bytes, CRC-16": (
        {"preset": "hg4930"},
        {"sensor": "custom", "baud": 460800.0, "frame": CUSTOM},
    ),
    "adis16505, SPI, 32-bit burst": (
        {"preset": "adis16488", "name": "adis16505"},
        {"sensor": "adis16505"},
    ),
    "adis16488, SPI, registers": ({"preset": "adis16488"}, {"sensor": "adis16488"}),
}
"""Designs, and the keys of their [hardware.front], by what the page calls them."""


@dataclass(frozen=True)
class Measured:
    """What a bus takes.

    Attributes:
        name: as in `BUSES` or `FRONTS`.
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
    """A compact core: the preset stim300 with a bus of `BUSES`; or a design with its front end."""
    hardware = {"core": "compact", "target": "ecp5"}
    if name in BUSES:
        return Design.parse({"preset": "stim300", "hardware": hardware | {"bus": BUSES[name]}})
    design, front = FRONTS[name]
    return Design.parse(design | {"hardware": hardware | {"front": {"clock_hz": 50e6} | front}})


def measure(name: str, advance: Advance = silent) -> Measured:
    """Synthesise, place and route a bus or a front end.

    Raises:
        InputError: Yosys or nextpnr is not installed.
        ToolError: one of them failed.
    """
    design = design_of(name)
    top = f"{design.name}_{'bus' if name in BUSES else 'front'}"
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        (folder / "part.v").write_text(generate(design).further[f"{top}.v"], encoding="utf-8")
        script = f"read_verilog part.v; synth_ecp5 -top {top} -json part.json"
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
    options = ("--json", "part.json", "--report", "report.json", "--out-of-context", "--quiet")
    goal = ("--freq", str(GOAL_MHZ), "--timing-allow-fail", "--seed", str(seed))
    tool = NEXTPNR["ecp5"]
    status, said = tool.run(folder, *DEVICE, *options, *goal)
    if status:
        raise ToolError(tool, said)
    found: dict[str, Any] = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    return found
