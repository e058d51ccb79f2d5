"""A small master of AXI4-Lite in Verilog: it reads each result from the registers, and frees it.

The words of a result come out one by one, by `valid`, `ready`, `data` and `last`, as they stand in
a packet.  Boards and the unit's test bench have it.
"""

from __future__ import annotations

from importlib import resources
from string import Template

from sculler_hdl import own_bus_ports
from sculler_model.design import Design
from sculler_model.golden import words_per_column

STAMP_WORDS = 7
"""Words of a result's time stamps."""

MASTER_PORTS = (
    *("arvalid", "arready", "araddr", "rvalid", "rready", "rdata", "rresp", "awvalid", "awready"),
    *("awaddr", "wvalid", "wready", "wdata", "wstrb", "bvalid", "bready"),
)
"""What it drives and reads of the bus; it does not look at `bresp`."""


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


def master_module(top: str, design: Design) -> str:
    """The module TOP_master."""
    return Text.of("board_master.v.in").substitute(top=top, words=result_words(design))


def master_instance(top: str, clock: str = "clk") -> str:
    """The wires between unit and master, by the names of the standard, and the master."""
    bits = {port.name: port.bits for port in own_bus_ports("axi-lite")}
    wires = "".join(
        f"  wire {f'[{bits[name] - 1}:0] ' if bits[name] > 1 else ''}{name};\n"
        for name in MASTER_PORTS
    )
    names = {"clk": clock, "rst": "rst"}
    names |= {name: name for name in (*MASTER_PORTS, "valid", "ready", "data", "last")}
    connections = ",\n".join(f"    .{port}({net})" for port, net in names.items())
    return f"{wires}  {top}_master master (\n{connections}\n  );\n"


def master_nets() -> dict[str, str]:
    """Net of each port of the unit that the master is wired to."""
    return {f"s_axi_{name}": name for name in MASTER_PORTS}
