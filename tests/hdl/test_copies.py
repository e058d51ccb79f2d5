"""Registers that are copies on purpose are still apart when Yosys has made a netlist of them."""

from __future__ import annotations

import json
import re
from itertools import combinations
from pathlib import Path
from typing import Any

import pytest

from sculler_hdl import generate
from sculler_model.design import Design
from sculler_sim.place.tools import YOSYS
from strategies import DESIGNS, make_design, with_hardware

MERGING = "hierarchy -top {top}; proc; flatten; opt"
"""What all of Yosys' flows do first, and where equal registers become one."""

FLOWS = {
    "generic": MERGING,
    "ecp5": "synth_ecp5 -noiopad -top {top}",
    "ice40": "synth_ice40 -top {top}",
    "xilinx": "synth_xilinx -family xc7 -flatten -noiopad -noclkbuf -top {top}",
    "nexus": "synth_nexus -noiopad -top {top}",
    "gowin": "synth_gowin -noiopads -family gw2a -top {top}",
}


def nets(text: str, script: str, top: str, folder: Path) -> dict[str, set[Any]]:
    """The wires of each net of the design's own, by its name in the text."""
    pytest.importorskip(YOSYS.module, reason="Yosys is not installed")
    (folder / "core.v").write_text(text)
    commands = f"read_verilog core.v; {script.format(top=top)}; write_json netlist.json"
    status, said = YOSYS.run(folder, "-q", "-p", commands)
    assert status == 0, said
    module = json.loads((folder / "netlist.json").read_text())["modules"][top]
    return {name: set(net["bits"]) for name, net in module["netnames"].items()}


def copies(found: dict[str, set[Any]], design: Design) -> list[tuple[str, str]]:
    """Registers that hold the same: each count a clock late, and operands of a long array."""
    pairs = []
    for sensor in ("gyro", "accel"):
        for axis in "xyz":
            late = [name for name in found if re.match(rf"{sensor}_taps\.later_{axis}\b", name)]
            pairs += [(f"{sensor}_{axis}", name) for name in late]
    held: dict[str, list[str]] = {}
    for name in found:
        if part := re.fullmatch(r"(\w+\.)+held\d+_(\w+)", name):
            held.setdefault(part[1] + part[2], []).append(name)
    return pairs + [pair for names in held.values() for pair in combinations(names, 2)]


def merged(found: dict[str, set[Any]], design: Design) -> list[tuple[str, str]]:
    """Those of them that share a register."""
    return [(one, other) for one, other in copies(found, design) if found[one] & found[other]]


@pytest.mark.parametrize("initial", [pytest.param(True, marks=pytest.mark.deep), False])
def test_copies_stay_apart(initial: bool, tmp_path: Path) -> None:
    design = make_design("narrow", 2, 1, 2, (8, 8))
    design = with_hardware(design, core="pipelined", target="ecp5", initial=initial)
    text = generate(design).verilog
    found = nets(text, MERGING, design.name, tmp_path)
    assert len(copies(found, design)) >= 6
    assert merged(found, design) == []
    bare = nets(re.sub(r"\(\* keep \*\) ", "", text), MERGING, design.name, tmp_path)
    assert len(merged(bare, design)) >= 6  # but for the attribute they would be one


@pytest.mark.deep
@pytest.mark.parametrize("initial", [True, False])
@pytest.mark.parametrize("target", FLOWS)
def test_copies_stay_apart_in_every_flow(target: str, initial: bool, tmp_path: Path) -> None:
    design = with_hardware(DESIGNS["stim300_4x5"], core="pipelined", target=target, initial=initial)
    found = nets(generate(design).verilog, FLOWS[target], design.name, tmp_path)
    held = [pair for pair in copies(found, design) if "held" in pair[0]]
    assert held or target in ("xilinx", "generic")
    assert merged(found, design) == []


@pytest.mark.deep
def test_copies_of_every_array_stay_apart(tmp_path: Path) -> None:
    """The third array too, which position at high resolution has."""
    hardware = {"core": "pipelined", "target": "ecp5", "initial": False}
    algorithm = {"position": "high-resolution"}
    design = Design.parse(
        {"preset": "stim300", "name": "higher", "algorithm": algorithm, "hardware": hardware}
    )
    found = nets(generate(design).verilog, MERGING, design.name, tmp_path)
    held = {one.partition(".held")[0] for one, _ in copies(found, design) if ".held" in one}
    assert len(held) >= 2
    assert merged(found, design) == []
