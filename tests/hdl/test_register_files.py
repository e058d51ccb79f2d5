"""The registers in SystemRDL and in C, read by others, tell the same."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

from register_facts import Facts, from_rdl
from sculler_hdl import generate
from sculler_hdl.export.register_files import c_header, systemrdl
from sculler_hdl.plan.registers import RegisterMap
from sculler_model.design import Design, scales_hash
from strategies import make_design


def designs() -> dict[str, Design]:
    plain = make_design(
        "plain", 2, 1, 2, (8, 8), hardware={"core": "compact", "bus": {"result": "apb"}}
    )
    full = Design.parse(
        {
            "preset": "stim300",
            "algorithm": {"position": "high-resolution"},
            "hardware": {
                "overrun": "drop-result",
                "core": "compact",
                "front": {"sensor": "stim300", "clock_hz": 1e8},
                "bus": {"result": "axi-lite", "clock": "separate"},
            },
        }
    )
    bare = make_design(
        "bare",
        2,
        1,
        2,
        (8, 8),
        hardware={"core": "compact", "bus": {"result": "wishbone", "time_stamps": False}},
    )
    return {design.name: design for design in (plain, full, bare)}


DESIGNS = pytest.mark.parametrize("design", designs().values(), ids=designs())


def from_c(text: str, name: str, folder: Path) -> tuple[Facts, dict[str, int]]:
    """What the C compiler's preprocessor makes of the header's names."""
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    path = folder / "registers.h"
    path.write_text(text)
    command = ["gcc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-E", "-dM", path]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    prefix = name.upper() + "_"
    found = re.findall(rf"^#define {prefix}(\w+) (0x[0-9A-F]+|\d+)u$", said, re.M)
    values = {key: int(value, 0) for key, value in found}
    facts: Facts = {}
    for key, value in values.items():
        if key.endswith("_MASK"):
            register = max(
                (k for k in values if key.startswith(k + "_") and f"{k}_SHIFT" not in values),
                key=len,
            )
            facts[key.removesuffix("_MASK").lower()] = (values[register], value)
            shift = values[key.replace("_MASK", "_SHIFT")]
            assert value >> shift & 1
            assert value & ((1 << shift) - 1) == 0
        if key.endswith("_WORDS") and key != "RESULT_WORDS":
            facts[key.removesuffix("_WORDS").lower()] = (values[key.removesuffix("_WORDS")], value)
    resets = {
        k.removesuffix("_RESET").lower(): v for k, v in values.items() if k.endswith("_RESET")
    }
    return facts, resets


@DESIGNS
def test_systemrdl_and_c_agree(design: Design, tmp_path: Path) -> None:
    rdl = from_rdl(systemrdl(RegisterMap(design)), tmp_path)
    header = from_c(c_header(RegisterMap(design)), design.name, tmp_path)
    assert rdl == header


def test_generate_writes_both() -> None:
    design = designs()["plain"]
    texts = generate(design).further
    assert texts["plain.rdl"] == systemrdl(RegisterMap(design))
    assert texts["plain_regs.h"] == c_header(RegisterMap(design))


@DESIGNS
def test_every_column_has_an_address(design: Design, tmp_path: Path) -> None:
    """By what the page says: from 800 on, each column the same number of words."""
    facts, _ = from_rdl(systemrdl(RegisterMap(design)), tmp_path)
    widest = max(getattr(design.words, name).bits for name in design.vectors)
    words = -(-widest // 32)
    for number, column in enumerate(design.columns):
        assert facts[f"result_{column}"] == (0x800 + 4 * words * number, words)
    assert ("result_sample_time" in facts) == (design.name != "bare")


@DESIGNS
def test_constants(design: Design, tmp_path: Path) -> None:
    _, resets = from_rdl(systemrdl(RegisterMap(design)), tmp_path)
    assert resets["identity_value"] == int.from_bytes(b"SCUL", "big")
    assert resets["scales_value"] == scales_hash(design)
    assert resets["design_value"] == int(design.digest, 16) >> 224
    assert resets["format_columns"] == len(design.columns)


def test_the_scales_hash_changes_with_the_scales_alone() -> None:
    base = {"preset": "hg4930", "name": "one"}
    one = Design.parse(base)
    assert scales_hash(Design.parse({**base, "name": "two"})) == scales_hash(one)
    other = one.as_json()
    other["sensor"]["gyro"]["lsb"] *= 1.5
    assert scales_hash(Design.parse(other)) != scales_hash(one)


@DESIGNS
def test_ip_xact_by_peakrdl(design: Design, tmp_path: Path) -> None:
    """Every register, and every column of the window, at its address."""
    ipxact = pytest.importorskip("peakrdl_ipxact", reason="peakrdl-ipxact is not installed")
    from systemrdl import RDLCompiler

    table = RegisterMap(design)
    (tmp_path / "registers.rdl").write_text(systemrdl(table))
    compiler = RDLCompiler()
    compiler.compile_file(str(tmp_path / "registers.rdl"))
    exporter = ipxact.IPXACTExporter()
    exporter.export(compiler.elaborate(), str(tmp_path / "registers.xml"))
    found = {}
    for register in ElementTree.parse(tmp_path / "registers.xml").iter():
        if register.tag.endswith("}register"):
            values = {child.tag.partition("}")[2]: child.text or "" for child in register}
            found[values["name"]] = int(values["addressOffset"].replace("'h", "0x"), 0)
    expected = {register.name: register.address for register in table.registers}
    for entry in table.window.entries:
        expected[f"result_{entry.name}"] = 0x800 + 4 * entry.first
    assert found == expected


_EMIT = """
import sys
from sculler_hdl import generate
from sculler_model.design import Design
hardware = {"core": "compact", "bus": {"result": "axi-lite", "clock": "separate"}}
design = Design.parse({"preset": "hg4930", "name": "b", "hardware": hardware})
sys.stdout.write(generate(design).further["b_bus.v"])
"""


@pytest.mark.deep
def test_a_bus_of_two_clocks_is_the_same_bytes_in_every_process() -> None:
    """Python orders the names of a set anew in each."""
    texts = {
        subprocess.run(
            [sys.executable, "-c", _EMIT],
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(sys.path)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("0", "1")
    }
    assert len(texts) == 1
    assert "module b_bus (" in texts.pop()
