"""A core's Verilog to the cells of a device, by Yosys."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sculler_hdl import Generated
from sculler_sim.engines import cache
from sculler_sim.place.devices import Family
from sculler_sim.place.harness import CORE, TOP, harness
from sculler_sim.place.tools import YOSYS, ToolError

# synth_ice40 -dsp would move registers into SB_MAC16 and lose their initial values, whereupon it
# ties the product to a constant (Yosys 0.70); a design with hardware.target = "ice40" brings its
# own SB_MAC16.
_SYNTHESIS: dict[Family, str] = {
    "ecp5": "synth_ecp5 -noiopad",
    "ice40": "synth_ice40",
    "nexus": "synth_nexus -noiopad",
    "gowin": "synth_gowin -noiopads -family {part}",
    "gatemate": "synth_gatemate -luttree -nomx8 -noiopad -noclkbuf",
    "xilinx": "synth_xilinx -family {part} -flatten -noiopad -noclkbuf",
    "intel": "synth_intel_alm -noiopad -noclkbuf",
}

_PARTS = {"gowin": "gw2a", "xilinx": "xc7"}
"""Where none is given."""

_WITHOUT_PADS = re.compile(r" -no(iopads?|clkbuf)\b")

_HARNESSED = frozenset({"ice40", "nexus", "gowin", "gatemate"})
"""Families of which nextpnr places no core alone."""

_SCRIPT = """
read_verilog core.v
{synthesis} -top {core}
{whole}
delete t:$scopeinfo
write_verilog -noattr netlist.v
write_json core.json
"""

_WHOLE = """
setattr -mod -unset keep_hierarchy *
flatten
opt_clean
"""
"""The copies of a hardened core, which synthesis has left apart, in one module for nextpnr."""

_HARNESS_SCRIPT = """
design -stash synthesised
read_verilog harness.v
{padded} -top {top}
delete ={core}
design -copy-from synthesised {core}
hierarchy -check -top {top}
flatten
delete t:$scopeinfo
write_json placed.json
"""

_WRONG = re.compile(r"^Warning: (Driver-driver conflict .*|.* is used but has no driver.*)$", re.M)
"""What Yosys only warns of, though the netlist is not the design's any more."""


@dataclass(frozen=True)
class Cell:
    """A cell of the netlist.

    Attributes:
        type: its type.
        parameters: by name; text as it stands, or bits.
        connections: port to the numbers of its nets, or "0", "1", "x".
    """

    type: str
    parameters: Mapping[str, str]
    connections: Mapping[str, tuple[int | str, ...]]


@dataclass(frozen=True)
class Synthesis:
    """What Yosys made of a core.

    Attributes:
        name: of the core's module.
        netlist: the core as Verilog of the device's cells.
        core: the same for nextpnr (JSON).
        top, placed: module and netlist (JSON) that nextpnr places: the core, or the core in the
            harness, flattened.
        log: what Yosys said.
    """

    name: str
    netlist: str
    core: str
    top: str
    placed: str
    log: str

    def cells(self) -> dict[str, Cell]:
        """The core's cells by name."""
        return cells_of(json.loads(self.core), self.name)

    def counts(self) -> dict[str, int]:
        """How many cells the core has, by type."""
        counts: dict[str, int] = {}
        for cell in self.cells().values():
            counts[cell.type] = counts.get(cell.type, 0) + 1
        return dict(sorted(counts.items()))


def cells_of(netlist: Mapping[str, Any], module: str) -> dict[str, Cell]:
    """The cells of a module of a netlist as Yosys writes it in JSON."""
    return {
        name: Cell(
            cell["type"],
            cell["parameters"],
            {port: tuple(bits) for port, bits in cell["connections"].items()},
        )
        for name, cell in netlist["modules"][module]["cells"].items()
    }


def synthesise(generated: Generated, family: Family, part: str = "") -> Synthesis:
    """Synthesise a core; for a family of which nextpnr places no core alone, also in its harness.

    The core is synthesised by itself and put into the harness afterwards, so that the netlist is
    the same with and without it.

    Raises:
        InputError: Yosys is not installed.
        ToolError: Yosys fails, or makes something else of the design.
    """
    name = generated.manifest.name
    harnessed = family in _HARNESSED
    synthesis = _SYNTHESIS[family].format(part=part or _PARTS.get(family, ""))
    around = harness(name, generated.manifest.ports, oscillator=family == "nexus")
    script = _SCRIPT + (_HARNESS_SCRIPT if harnessed else "")
    with cache.workshop() as work:
        (work / "core.v").write_text(generated.verilog, encoding="utf-8")
        (work / "harness.v").write_text(around, encoding="utf-8")
        padded = _WITHOUT_PADS.sub("", synthesis)
        hardened = generated.manifest.design.hardware.hardening is not None
        text = script.format(
            synthesis=synthesis,
            padded=padded,
            core=name,
            top=TOP,
            whole=_WHOLE if hardened else "",
        )
        (work / "script.ys").write_text(text, encoding="utf-8")
        status, log = YOSYS.run(work, "script.ys")
        wrong = _WRONG.search(log)
        if status or wrong:
            raise ToolError(YOSYS, log if status or wrong is None else wrong[1])
        netlist, core = (
            (work / file).read_text(encoding="utf-8") for file in ("netlist.v", "core.json")
        )
        if harnessed:
            placed = (work / "placed.json").read_text(encoding="utf-8")
            if family == "nexus":
                placed = without_constant_carries(placed)
            return Synthesis(name, netlist, core, TOP, placed, log)
        return Synthesis(name, netlist, core, name, core, log)


def without_constant_carries(netlist: str) -> str:
    """A netlist without carry inputs that Yosys ties to 0, which nextpnr-nexus refuses.

    The first cell of a chain makes its carry out of its other inputs (Yosys issue 4081).
    """
    cells = json.loads(netlist)
    for module in cells["modules"].values():
        low = {
            bit
            for cell in module["cells"].values()
            if cell["type"] == "VLO"
            for bit in cell["connections"]["Z"]
        }
        for cell in module["cells"].values():
            if cell["type"] == "CCU2" and low.issuperset(cell["connections"].get("CIN", ())):
                cell["connections"].pop("CIN", None)
    return json.dumps(cells)


class Names:
    """Cells and nets of the placed netlist (`Synthesis.top`, `.placed`) in the words of the design.

    Yosys names what it makes after what it made it from; a register's own name is that of its
    output.
    """

    _MADE = re.compile(
        r"_(TRELLIS_FF|LUT4|CCU2C|PFUMX|L6MUX21|MULT18X18D|DP16KD|TRELLIS_DPR16X4"
        r"|SB_LUT4|SB_CARRY|SB_DFF\w*|SB_MAC16|SB_RAM40_4K"
        r"|FD1P3\w\w|CCU2|WIDEFN9|DPR16X4|MULTPREADD18X18|PDPSC16K|VLO|VHI"
        r"|DFF\w*|LUT[123]|ALU|MUX2_LUT\d|RAM16SDP4|SDPX9B|CC_\w+?)_"
    )
    _REGISTERS = re.compile(r"TRELLIS_FF|SB_DFF|FD1P3|DFF|CC_DFF")

    def __init__(self, top: str, placed: str) -> None:
        module = json.loads(placed)["modules"][top]
        self._cells = cells_of({"modules": {top: module}}, top)
        self._core = f"{CORE}." if top == TOP else ""
        self._nets: dict[int | str, str] = {}
        for name, net in module["netnames"].items():
            for index, bit in enumerate(net["bits"]):
                shown = f"{name}[{index}]" if len(net["bits"]) > 1 else name
                self._nets[bit] = min(self._nets.get(bit, shown), shown, key=self._plainness)
        self._readers: dict[int | str, list[str]] = {}
        for name, cell in self._cells.items():
            for port in ("D", "DI"):
                for bit in cell.connections.get(port, ()):
                    self._readers.setdefault(bit, []).append(name)

    def _plainness(self, name: str) -> tuple[bool, bool, bool, int, str]:
        """Names of the design first, the core's before the harness's, then short ones."""
        return (
            "$" in name,
            bool(self._MADE.search(name)),
            not name.startswith(self._core),
            len(name),
            name,
        )

    def register(self, cell: str) -> str:
        """The register that a cell of nextpnr's is or holds, or a block, by its output.

        Args:
            cell: name as nextpnr reports it.
        """
        name = re.sub(r"_(DFF)?LC$|_RAM$|_DSP$|/.*$|\$lt$", "", cell)
        found = self._cells.get(name)
        if found is None:
            return self._own(name)
        if found.type == "SB_LUT4":  # iCE40: a look-up table with a register behind it
            followers = [
                reader
                for reader in self._readers.get(found.connections["O"][0], [])
                if self._REGISTERS.match(self._cells[reader].type)
            ]
            found = self._cells[followers[0]] if followers else found
        for port in ("Q", "O"):
            bits = found.connections.get(port, ())
            if len(bits) == 1:
                return self._own(self._nets.get(bits[0], name))
        return f"{self._own(name)} ({found.type})"

    def _own(self, name: str) -> str:
        if name.startswith(self._core):
            return name.removeprefix(self._core)
        return f"harness.{name}"
