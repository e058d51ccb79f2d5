"""The component for VHDL projects has the Verilog module's ports, and GHDL takes it."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from front_designs import design_of
from sculler_hdl import generate
from sculler_model.design import Design
from strategies import DESIGNS, with_hardware

CORES = {
    "pipelined": DESIGNS["smallest"],
    "compact": with_hardware(DESIGNS["smallest"], core="compact"),
    "drops": with_hardware(DESIGNS["smallest"], overrun="drop-result"),
    "clocked": with_hardware(DESIGNS["smallest"], reset_active="low", clock_enable=True),
}


def stand_in(verilog: str) -> str:
    """An entity with the ports that the Verilog text declares, and nothing in it."""
    name, ports = re.findall(r"^module (\w+) \((.*?)\);", verilog, re.M | re.S)[0]
    lines = []
    declared = re.findall(r"(input|output) (?:reg )?(?:\[(\d+):0\] )?(\w+)", ports)
    for direction, top, port in declared:
        kind = f"std_logic_vector({top} downto 0)" if top else "std_logic"
        lines.append(f"{port} : {'in' if direction == 'input' else 'out'} {kind}")
    return (
        "library ieee; use ieee.std_logic_1164.all;\n"
        f"entity {name} is port ({'; '.join(lines)}); end entity;\n"
        f"architecture empty of {name} is begin end architecture;\n"
    )


@pytest.mark.parametrize("design", CORES.values(), ids=CORES)
@pytest.mark.parametrize("standard", ["93", "08"])
def test_ghdl_binds_it_to_the_modules_ports(design: Design, standard: str, tmp_path: Path) -> None:
    made = generate(design)
    bind(design.name, made.verilog, made.vhdl, standard, tmp_path)


UNITS: dict[str, dict[str, str]] = {
    "stim300": {"result": "axi-lite", "clock": "separate"},
    "adis16470": {"result": "axi-stream"},
}


@pytest.mark.deep
@pytest.mark.parametrize("sensor", UNITS)
def test_ghdl_binds_unit_and_front_end_too(sensor: str, tmp_path: Path) -> None:
    data = design_of(sensor).as_json()
    data["hardware"]["bus"] = UNITS[sensor]
    design = Design.parse(data)
    made = generate(design).further
    for part in ("unit", "front"):
        name = f"{design.name}_{part}"
        folder = tmp_path / part
        folder.mkdir()
        bind(name, made[f"{name}.v"], made[f"{name}.vhd"], "93", folder)


def bind(name: str, verilog: str, vhdl: str, standard: str, tmp_path: Path) -> None:
    """A port that is missing, too many, of another width or direction would be refused."""
    if shutil.which("ghdl") is None:
        pytest.skip("GHDL is not installed")
    (tmp_path / "module.vhd").write_text(stand_in(verilog))
    (tmp_path / f"{name}.vhd").write_text(vhdl)
    for words in (
        ["-a", "module.vhd", f"{name}.vhd"],
        # a component is bound to the module of its name, as synthesis does it in every standard
        ["--elab-run", "--syn-binding", f"{name}_vhdl", "--stop-time=1ns"],
    ):
        command = ["ghdl", words[0], f"--std={standard}", "-Wbinding", "-Werror", *words[1:]]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_types_follow_the_manifest() -> None:
    made = generate(CORES["pipelined"])
    component, _, wrapper = made.vhdl.partition("end package;")
    assert len(re.findall(r"^      \w+ : (?:in|out) std_logic", component, re.M)) == len(
        made.manifest.ports
    )
    for port in made.manifest.ports:
        kind = "signed" if port.declared_signed else "unsigned"
        type_ = "std_logic" if port.bits == 1 else rf"{kind}\({port.bits - 1} downto 0\)"
        assert re.search(rf"^    {port.name} : (in|out) {type_};?$", wrapper, re.M), port
    assert made.vhdl.isascii()
