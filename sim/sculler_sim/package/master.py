"""A small master of a bus in Verilog: it reads each result from the registers, and frees it.

The words of a result come out one by one, by `valid`, `ready`, `data` and `last`, as they stand in
a packet.  Boards and the unit's test bench have it.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import resources
from string import Template

from sculler_hdl import BUS_PREFIXES, own_bus_ports
from sculler_model.design import Design
from sculler_model.golden import words_per_column

STAMP_WORDS = 7
"""Words of a result's time stamps."""

_AXI_LITE = {
    "title": "AXI4-Lite",
    "ports": "arvalid* arready araddr* rvalid rready rdata rresp awvalid* awready awaddr wvalid*"
    " wready wdata wstrb bvalid bready",
    "always": """
  assign rready = 1'b1;
  assign bready = 1'b1;
  assign awaddr = POP;
  assign wdata = 32'd1;
  assign wstrb = 4'b1111;
""",
    "taken": """
    if (arready) arvalid <= 1'b0;
    if (awready) awvalid <= 1'b0;
    if (wready) wvalid <= 1'b0;
""",
    "idle": """
      arvalid <= 1'b0;
      awvalid <= 1'b0;
      wvalid <= 1'b0;
""",
    "read": """
      arvalid <= 1'b1;
""",
    "address": "araddr",
    "free": """
      awvalid <= 1'b1;
      wvalid <= 1'b1;
""",
    "is_read": "rvalid",
    "data": "rdata",
    "okay": "rresp == 2'b00",
    "is_written": "bvalid",
}

_APB = {
    "title": "APB",
    "ports": "psel* penable* pwrite* paddr* pwdata pstrb pready prdata pslverr",
    "always": """
  assign pwdata = 32'd1;
  assign pstrb = pwrite ? 4'b1111 : 4'b0000;
""",
    "taken": """
    penable <= psel && !(penable && pready);
    if (penable && pready) psel <= 1'b0;
""",
    "idle": """
      psel <= 1'b0;
      penable <= 1'b0;
""",
    "read": """
      psel <= 1'b1;
      pwrite <= 1'b0;
""",
    "address": "paddr",
    "free": """
      psel <= 1'b1;
      pwrite <= 1'b1;
      paddr <= POP;
""",
    "is_read": "penable && pready && !pwrite",
    "data": "prdata",
    "okay": "!pslverr",
    "is_written": "penable && pready",
}

_WISHBONE = {
    "title": "Wishbone",
    "ports": "cyc* stb we* adr* dat_w sel ack err dat_r",
    "always": """
  assign stb = cyc;
  assign dat_w = 32'd1;
  assign sel = 4'b1111;
""",
    "taken": """
    if (ack || err) cyc <= 1'b0;
""",
    "idle": """
      cyc <= 1'b0;
""",
    "read": """
      cyc <= 1'b1;
      we <= 1'b0;
""",
    "address": "adr",
    "free": """
      cyc <= 1'b1;
      we <= 1'b1;
      adr <= POP;
""",
    "is_read": "(ack || err) && !we",
    "data": "dat_r",
    "okay": "!err",
    "is_written": "ack || err",
}

_PIPELINED = {
    **_WISHBONE,
    "title": "Wishbone, pipelined",
    "ports": "cyc* stb* we* adr* dat_w sel ack err dat_r stall",
    "always": """
  assign dat_w = 32'd1;
  assign sel = 4'b1111;
""",
    "taken": """
    if (!stall) stb <= 1'b0;
    if (ack || err) cyc <= 1'b0;
""",
    "idle": """
      cyc <= 1'b0;
      stb <= 1'b0;
""",
    "read": """
      cyc <= 1'b1;
      stb <= 1'b1;
      we <= 1'b0;
""",
    "free": """
      cyc <= 1'b1;
      stb <= 1'b1;
      we <= 1'b1;
      adr <= POP;
""",
}

_PIECES: Mapping[str, Mapping[str, str]] = {
    "axi-lite": _AXI_LITE,
    "apb": _APB,
    "wishbone": _WISHBONE,
    "wishbone-pipelined": _PIPELINED,
}
"""Of each bus with registers: what of the master's text is its own.

`ports` are those that it drives and reads, by the names of the standard; those with a star are
registers.  AXI4-Lite's `bresp` is not looked at.
"""


class Text(Template):
    """A text of Verilog whose places to fill begin with two percent signs."""

    delimiter = "%%"

    @classmethod
    def of(cls, name: str) -> Text:
        """The text of a file of this package."""
        file = resources.files("sculler_sim.package").joinpath(name)
        return cls(file.read_text(encoding="ascii"))


def column_words(design: Design) -> int:
    """Words of 32 bits that a column of a result takes."""
    return -(-words_per_column(design) // 2)


def result_words(design: Design) -> int:
    """Words of a packet, which are those of the window of the registers."""
    bus = design.hardware.bus
    assert bus is not None
    return len(design.columns) * column_words(design) + STAMP_WORDS * bus.time_stamps


def master_title(design: Design) -> str:
    """What the design's bus, which has registers, is called."""
    return _PIECES[_kind(design)]["title"]


def master_module(top: str, design: Design) -> str:
    """The module TOP_master, for the design's bus, which has registers."""
    pieces = _PIECES[_kind(design)]
    texts = {name: text.removeprefix("\n") for name, text in pieces.items()}
    slave = {port.name: port for port in own_bus_ports(_kind(design))}
    registers = {name[:-1] for name in pieces["ports"].split() if name.endswith("*")}
    texts["ports"] = "".join(
        f"  {'input' if slave[name].output else 'output'}{' reg' * (name in registers)}"
        f" {_range(slave[name].bits)}{name},\n"
        for name in _ports(design)
    )
    return Text.of("master.v.in").substitute(top=top, words=result_words(design), **texts)


def master_instance(top: str, design: Design, clock: str = "clk") -> str:
    """The wires between unit and master, by the names of the standard, and the master."""
    bits = {port.name: port.bits for port in own_bus_ports(_kind(design))}
    wires = "".join(f"  wire {_range(bits[name])}{name};\n" for name in _ports(design))
    names = {"clk": clock, "rst": "rst"}
    names |= {name: name for name in (*_ports(design), "valid", "ready", "data", "last")}
    connections = ",\n".join(f"    .{port}({net})" for port, net in names.items())
    return f"{wires}  {top}_master master (\n{connections}\n  );\n"


def master_nets(design: Design) -> dict[str, str]:
    """Net of each port of the unit that the master is wired to."""
    return {f"{BUS_PREFIXES[_kind(design)]}{name}": name for name in _ports(design)}


def _kind(design: Design) -> str:
    bus = design.hardware.bus
    assert bus is not None
    return bus.result


def _ports(design: Design) -> list[str]:
    return [name.removesuffix("*") for name in _PIECES[_kind(design)]["ports"].split()]


def _range(bits: int) -> str:
    return f"[{bits - 1}:0] " if bits > 1 else ""
