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
    "xilinx": "synth_xilinx -family xc7 -flatten -noiopad -noclkbuf",
}

_SCRIPT = """
read_verilog core.v
{synthesis} -top {core}
delete t:$scopeinfo
write_verilog -noattr netlist.v
write_json core.json
"""

_HARNESS_SCRIPT = """
design -stash synthesised
read_verilog harness.v
{synthesis} -top {top}
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


def synthesise(generated: Generated, family: Family) -> Synthesis:
    """Synthesise a core; for a family of which nextpnr places no core alone, also in its harness.

    The core is synthesised by itself and put into the harness afterwards, so that the netlist is
    the same with and without it.

    Raises:
        InputError: Yosys is not installed.
        ToolError: Yosys fails, or makes something else of the design.
    """
    name = generated.manifest.name
    harnessed = family == "ice40"
    script = _SCRIPT + (_HARNESS_SCRIPT if harnessed else "")
    with cache.workshop() as work:
        (work / "core.v").write_text(generated.verilog, encoding="utf-8")
        (work / "harness.v").write_text(harness(name, generated.manifest.ports), encoding="utf-8")
        text = script.format(synthesis=_SYNTHESIS[family], core=name, top=TOP)
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
            return Synthesis(name, netlist, core, TOP, placed, log)
        return Synthesis(name, netlist, core, name, core, log)


class Names:
    """Cells and nets of the placed netlist (`Synthesis.top`, `.placed`) in the words of the design.

    Yosys names what it makes after what it made it from; a register's own name is that of its
    output.
    """

    _MADE = re.compile(
        r"_(TRELLIS_FF|LUT4|CCU2C|PFUMX|L6MUX21|MULT18X18D|DP16KD|TRELLIS_DPR16X4"
        r"|SB_LUT4|SB_CARRY|SB_DFF\w*|SB_MAC16|SB_RAM40_4K)_"
    )
    _REGISTERS = re.compile(r"TRELLIS_FF|SB_DFF")

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
        name = re.sub(r"_(DFF)?LC$|_RAM$|_DSP$", "", cell)
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
