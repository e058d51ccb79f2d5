"""Synthesises memories of a unit for families that Yosys knows."""

from __future__ import annotations

import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

from sculler_hdl import generate
from sculler_model.design import Design
from sculler_sim.place.tools import YOSYS, ToolError

_RAMS = "map_ram; memory_libmap -lib +/nanoxplore/rf_rams_{}.txt -lib +/nanoxplore/brams.txt"
"""The flow's own next command; what comes after it in the flow takes many minutes."""

FAMILIES: dict[str, tuple[str, str]] = {
    "Lattice ECP5": ("synth_ecp5", "map_ffram"),
    "Lattice iCE40": ("synth_ice40", "map_ffram"),
    "Lattice Nexus": ("synth_nexus", "map_ffram"),
    "Lattice MachXO2": ("synth_lattice -family xo2", "map_ffram"),
    "AMD 7 series": ("synth_xilinx -family xc7", "map_ffram"),
    "AMD UltraScale+": ("synth_xilinx -family xcup", "map_ffram"),
    "Intel Cyclone V": ("synth_intel_alm -family cyclonev", "map_ffram"),
    "Gowin": ("synth_gowin", "map_ffram"),
    "Microchip SmartFusion2": ("synth_sf2", "map_ffs"),
    "Microchip PolarFire": ("synth_microchip -family polarfire", "map_ffram"),
    "NanoXplore NG-MEDIUM": (
        "synth_nanoxplore -family medium",
        _RAMS.format("m"),
    ),
    "NanoXplore NG-ULTRA": (
        "synth_nanoxplore -family ultra",
        _RAMS.format("u"),
    ),
    "Cologne Chip GateMate": ("synth_gatemate", "map_ffram"),
    "Efinix": ("synth_efinix", "map_ffram"),
    "QuickLogic QLF K6N10F": ("synth_quicklogic -family qlf_k6n10f", "map_ffram"),
    "Anlogic": ("synth_anlogic", "map_ffram"),
    "Analog Devices": ("synth_analogdevices", "map_ffram"),
}
"""Command, and the step before which it is stopped: memories have their places by then."""

SHOWN = ("engine_program", "results", "bus_store")
"""The memories that are synthesised: the microprogram, a result's two banks, the queue."""

SMALL = ("LUTRAM", "DPR16X4", "DRAM16", "MLAB", "RFB", "LRAM_S")
"""In the name of a cell: memory made of look-up tables, or a register file."""

_MAPPED = re.compile(r"(?:mapping memory \S+ via|Mapping to bram type) (\S+)")


@dataclass(frozen=True)
class Memory:
    """A memory of the unit.

    Attributes:
        module: it stands in, which is its own.
        words, bits: how many, and of each.
    """

    module: str
    words: int
    bits: int


def unit() -> Design:
    """The preset stim300 in the compact core, with front end and registers."""
    hardware = {
        "core": "compact",
        "bus": {"result": "axi-lite"},
        "front": {"sensor": "stim300", "clock_hz": 50e6},
    }
    return Design.parse({"preset": "stim300", "name": "unit", "hardware": hardware})


def unit_text(design: Design) -> str:
    """Verilog of all its parts."""
    made = generate(design)
    parts = (made.further[f"{design.name}_{part}.v"] for part in ("bus", "front"))
    return "\n".join([made.verilog, *parts])


def memories(text: str) -> list[Memory]:
    """The memories in a text that are shown, each of which stands in a module of its own."""
    found = []
    for module in re.finditer(r"^module (\w+) \(.*?^endmodule", text, re.M | re.S):
        for high, last in re.findall(r"\*\) reg \[(\d+):0\] \w+ \[(\d+):0\];", module[0]):
            if module[1].endswith(SHOWN):
                found.append(Memory(module[1], int(last) + 1, int(high) + 1))
    return found


def alone(text: str, module: str) -> str:
    """A module, and those that it is made of."""
    modules = {
        m[1]: m[0] for m in re.finditer(r"^module (\w+) \(.*?^endmodule\n", text, re.M | re.S)
    }
    kinds = re.findall(r"^  (\w+) \w+ \($", modules[module], re.M)
    parts = (alone(text, kind) for kind in dict.fromkeys(kinds) if kind in modules)
    return "".join([modules[module], *parts])


def places(text: str, family: str) -> list[str]:
    """What each memory becomes: the name that Yosys says, or "" where it becomes logic.

    Raises:
        InputError: Yosys is not installed.
        ToolError: it failed.
    """
    command, end = FAMILIES[family]
    held = memories(text)
    lines = []
    for memory in held:
        lines += [
            "design -reset",
            f"read_verilog {memory.module}.v",
            f"log MEMORY {memory.module}",
            f"{command} -top {memory.module} -run begin:{end}",
        ]
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        for memory in held:
            (folder / f"{memory.module}.v").write_text(alone(text, memory.module), "utf-8")
        status, said = YOSYS.run(folder, "-p", "\n".join(lines))
    if status:
        raise ToolError(YOSYS, said)
    found = []
    for told in said.split("\nMEMORY ")[1:]:
        names = _MAPPED.findall(told)
        found.append(names[-1].strip("$_.:") if names else "")
    return found
