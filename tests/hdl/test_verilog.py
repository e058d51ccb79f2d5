"""The emitted Verilog: clean in two linters, the same bytes every time, told by its manifest."""

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
from dataclasses import FrozenInstanceError

import pytest

import sculler_hdl
from sculler_hdl import describe_ports, generate
from sculler_model.design import COLUMNS, Design
from sculler_sim.engines.verilator_build import emitted
from strategies import DESIGNS, with_hardware
from tiers import few_of, tiers


@pytest.fixture(params=tiers(DESIGNS, also=["stim300_4x5"]))
def design(request):
    return request.param


@pytest.fixture
def verilog(design):
    return emitted(design)[f"{design.name}.v"]


@pytest.fixture
def verilog_file(design, verilog, tmp_path):
    path = tmp_path / f"{design.name}.v"
    path.write_text(verilog)
    return path


def test_verilator_full_lint_has_nothing_to_say(design, verilog_file, verilator):
    run = verilator("--lint-only", "-Wall", "--top-module", design.name, verilog_file)
    assert (run.returncode, run.stderr) == (0, "")  # stdout has a line on the time it took


@pytest.mark.skipif(not shutil.which("iverilog"), reason="Icarus Verilog is not installed")
def test_icarus_has_nothing_to_say(verilog_file, tmp_path):
    run = subprocess.run(
        ["iverilog", "-g2005", "-Wall", "-o", tmp_path / "out", verilog_file],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (run.returncode, run.stdout + run.stderr) == (0, "")


VARIANTS = {
    f"{name}-{'-'.join(map(str, hardware.values()))}": with_hardware(DESIGNS[name], **hardware)
    for name in ("dense_odd_3",)
    for hardware in (
        {"core": "compact"},
        {"core": "compact", "multipliers": 0},
        {"core": "compact", "target": "ecp5"},
        {"core": "compact", "target": "ice40"},
        {"core": "pipelined", "target": "ecp5"},
        {"core": "pipelined", "target": "ice40"},
        {"core": "pipelined", "target": "xilinx"},
        {"core": "pipelined", "handover": "stream"},
    )
}


@pytest.mark.parametrize("variant", tiers(VARIANTS))
def test_both_linters_are_silent_on_every_core_and_target(variant, tmp_path, verilator):
    """With the models of the vendor's blocks, which are files of their own."""
    made = generate(variant)
    files = []
    for name, text in {variant.name: made.verilog, **made.cells}.items():
        files.append(tmp_path / f"{name}.v")
        files[-1].write_text(text)
    assert bool(made.cells) == (variant.hardware.target in ("ecp5", "ice40"))
    run = verilator("--lint-only", "-Wall", "--top-module", variant.name, *files)
    assert (run.returncode, run.stderr) == (0, "")
    if shutil.which("iverilog"):
        run = subprocess.run(
            ["iverilog", "-g2005", "-Wall", "-s", variant.name, "-o", tmp_path / "out", *files],
            capture_output=True,
            text=True,
            check=False,
        )
        assert (run.returncode, run.stdout + run.stderr) == (0, "")


def test_the_only_waiver_is_that_of_modules_in_one_file(verilog):
    waivers = re.findall(r".*(?:lint_off|translate_off|synthesis|verilator).*", verilog)
    assert [waiver.split("*/")[0] for waiver in waivers] == [
        "/* verilator lint_off DECLFILENAME ",
        "/* verilator lint_on DECLFILENAME ",
    ]


def test_ports_are_what_the_manifest_says(design, verilog):
    told = describe_ports(design)
    header = re.search(r"^module (\w+) \(\n(.*?)\n\);", verilog, re.M | re.S)
    assert header[1] == design.name
    port = re.compile(r"  (input|output) (?:reg )?(?:\[(\d+):0\] )?(\w+)")
    declared = [port.fullmatch(line).groups() for line in header[2].split(",\n")]
    ports = [(name, direction, int(top or 0) + 1) for direction, top, name in declared]
    assert ports == [(p["name"], p["direction"], p["width"]) for p in told]
    order = [name for name, *_ in ports]
    results = [name.removeprefix("result_") for name in order if name.startswith("result_")]
    assert [r for r in results if r not in ("valid", "ready")] == list(COLUMNS)


def test_manifest_of_the_default_design():
    made = generate(Design.preset("stim300"))
    manifest = json.loads(json.dumps(made.manifest.as_json()))
    assert manifest["verilog_sha256"] == hashlib.sha256(made.verilog.encode()).hexdigest()
    assert manifest["ports"] == describe_ports(Design.preset("stim300"))
    assert manifest["table"]["taps"][3] == [214, 92, 54]
    assert manifest["scales"]["gyro"] == pytest.approx(3.14159265358979 / 180 / 2**21, rel=1e-14)
    assert manifest["samples_per_major"] == 20
    by_name = {port["name"]: port for port in manifest["ports"]}
    # 20 counts of -2^23 need 23 + log2(20) bits and a sign
    assert by_name["result_alpha_x"]["width"] == 29
    assert by_name["result_alpha_x"]["signed"]
    assert not by_name["result_major"]["signed"]
    assert all(port["meaning"] for port in manifest["ports"])
    assert Design.parse(manifest["design"]) == Design.preset("stim300")


@pytest.mark.parametrize("name", few_of(["dense_time_3", "dense_odd_3", "smallest"], ["smallest"]))
def test_same_design_same_bytes_in_another_process(name, tmp_path):
    design = DESIGNS[name]
    script = (
        "import json, sys; from sculler_hdl import generate;"
        "from sculler_model.design import Design;"
        "made = generate(Design.parse(json.load(sys.stdin)));"
        "sys.stdout.write(made.verilog + json.dumps(made.manifest.as_json()))"
    )
    made = generate(design)
    for seed in ("0", "4242"):
        run = subprocess.run(
            [sys.executable, "-c", script],
            input=json.dumps(design.as_json()),
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        )
        assert run.stdout == made.verilog + json.dumps(made.manifest.as_json())


def test_what_is_done_to_a_manifest_leaves_the_next_one_alone():
    """`generate` is cached."""
    manifest = generate(DESIGNS["smallest"]).manifest
    text = json.dumps(manifest.as_json())
    shown = manifest.as_json()
    shown["ports"][0]["name"] = "spoilt"
    shown["resources"]["blocks"][0].clear()
    shown["design"].clear()
    with pytest.raises(TypeError):
        manifest.resources["multipliers"] = 0
    with pytest.raises(FrozenInstanceError):
        manifest.latency_clocks = 0
    assert json.dumps(generate(DESIGNS["smallest"]).manifest.as_json()) == text


def test_every_name_of_the_face_is_there():
    for name in sculler_hdl.__all__:
        assert getattr(sculler_hdl, name) is not None
    assert set(sculler_hdl.__all__) <= set(dir(sculler_hdl))
    with pytest.raises(AttributeError, match="no attribute 'core_of'"):
        sculler_hdl.core_of  # noqa: B018


def test_a_plan_needs_no_amaranth():
    script = (
        "import sys; sys.modules['amaranth'] = None; from sculler_hdl import timing;"
        "from sculler_model.design import Design;"
        "print(timing(Design.preset('stim300')).latency)"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout == "17\n"
