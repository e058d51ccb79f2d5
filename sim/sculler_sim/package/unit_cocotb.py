"""test_NAME_unit.py: a bench of the whole unit for cocotb and pytest.

It reads the vectors of the unit's plain bench.  Samples come by somebody else's UART or SPI port,
or stream, and results leave by somebody else's master of the bus.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, NamedTuple

from sculler_hdl import packet_sample_ports, sample_ports
from sculler_model.front import Link, Spi, Uart
from sculler_sim.package.contents import Contents
from sculler_sim.package.master import Text, column_words, result_words
from sculler_sim.package.unit_bench import RESULTS, unit_source


class _Part(NamedTuple):
    """A part of the bench.

    Attributes:
        files: of `cocotb_parts`, in turn.
        package: that it needs from PyPI, beside cocotb.
        imports: lines.
        triggers: of cocotb's, beside those of every bench.
        told: what it is; nothing where the unit's plain bench tells it.
        filled: places of its text.
    """

    files: tuple[str, ...]
    package: str = ""
    imports: tuple[str, ...] = ()
    triggers: tuple[str, ...] = ()
    told: str = ""
    filled: Mapping[str, Any] = {}


_AXI_LITE = "from cocotbext.axi import AxiLiteBus, AxiLiteMaster"
_HOSTS: Mapping[str, _Part] = {
    "axi-lite": _Part(("axi_lite", "registers"), "cocotbext-axi", (_AXI_LITE,), ("RisingEdge",)),
    "apb": _Part(
        ("apb", "registers"),
        *("cocotbext-apb", ("from cocotbext.apb import ApbBus, ApbMaster",), ("RisingEdge",)),
    ),
    **dict.fromkeys(
        ("wishbone", "wishbone-pipelined"),
        _Part(
            ("wishbone", "registers"),
            "cocotbext-wishbone",
            ("from cocotbext.wishbone.driver import WBOp, WishboneMaster",),
            ("RisingEdge",),
        ),
    ),
    "axi-stream": _Part(
        ("axi_stream",), "cocotbext-axi", ("from cocotbext.axi import AxiStreamBus, AxiStreamSink",)
    ),
    "stream": _Part(("plain",), triggers=("RisingEdge",)),
}


def unit_cocotb(contents: Contents) -> str:
    """The text of test_NAME_unit.py.

    Args:
        contents: of a unit.
    """
    design = contents.design
    bus = design.hardware.bus
    assert bus is not None
    given = unit_source(contents)
    parts = (_source(contents, len(given.lines)), _host(contents))
    lines = sorted({line for part in parts for line in part.imports})
    triggers = {"ClockCycles", "FallingEdge", "Timer", "with_timeout"}
    triggers |= {name for part in parts for name in part.triggers}
    clocks = {clock.port: 2 * round(5e5 / clock.mhz) for clock in contents.clocks}
    resets = {reset.port: int(reset.active_high) for reset in contents.resets}
    inputs = [port.name for port in contents.ports if not port.output]
    idle = {name: 0 for name in inputs if name not in clocks | resets}
    idle |= {name: 1 for name in ("rx", "clk_en") if name in idle}
    return Text.of("unit_cocotb.py.in").substitute(
        name=contents.name,
        packages=" ".join(sorted({part.package for part in parts} - {""})),
        source=given.told,
        host=parts[1].told,
        imports="".join(f"{line}\n" for line in lines),
        triggers=", ".join(sorted(triggers)),
        sources=" ".join((*contents.verilog, *contents.models)),
        clocks=json.dumps(clocks),
        resets=json.dumps(resets),
        idle=json.dumps(idle),
        words=result_words(design),
        compared=column_words(design) * len(design.columns),
        longest=given.longest,
        source_part=_text(parts[0]),
        host_part=_text(parts[1]),
    )


def _text(part: _Part) -> str:
    texts = (Text.of(f"cocotb_parts/{file}.py.in") for file in part.files)
    return "\n\n".join(text.substitute(part.filled) for text in texts).rstrip()


def _host(contents: Contents) -> _Part:
    bus = contents.design.hardware.bus
    assert bus is not None
    part = _HOSTS[bus.result]
    table = contents.registers
    if table is None:
        return part._replace(told="Results come as packets.")
    addresses = [table[name].address for name in ("status", "pop", "interrupt_enable")]
    addresses.append(table.window_address)
    told = (
        "A master of the bus reads each result from the registers when the interrupt tells of it."
    )
    return part._replace(told=told, filled={"addresses": ", ".join(map(hex, addresses))})


def _source(contents: Contents, lines: int) -> _Part:
    """What gives the samples.

    Args:
        contents: of the unit.
        lines: of the vectors; with a front end a byte each.
    """
    design = contents.design
    bus, link = design.hardware.bus, design.front
    assert bus is not None
    if link is not None:
        return _sensor(link, lines // (RESULTS * design.samples_per_major))
    if not bus.takes_packets:
        bits = {port.name: port.bits for port in sample_ports(design)}
        del bits["sample_fault"]
        return _Part(("ports",), triggers=("RisingEdge",), filled={"ports": json.dumps(bits)})
    if bus.sample == "axi-stream":
        names = ("AxiStreamBus", "AxiStreamFrame", "AxiStreamSource")
        line = f"from cocotbext.axi import {', '.join(names)}"
        return _Part(("packets",), "cocotbext-axi", (line,))
    ports = packet_sample_ports(bus.sample or "")
    stream = tuple(ports[name].name for name in ("valid", "ready", "data", "last"))
    return _Part(("stream",), triggers=("RisingEdge",), filled={"stream": stream})


def _sensor(link: Link, length: int) -> _Part:
    filled: dict[str, Any] = {"bytes": length, "interval": round(1e12 / link.sample_rate_hz)}
    if isinstance(link.wire, Uart):
        parity = {"none": None, "even": 0, "odd": 1}[link.wire.parity]
        filled |= {"baud": round(link.wire.baud), "parity": parity}
        imports = ("from cocotb.utils import get_sim_time", "from cocotbext.uart import UartSource")
        return _Part(("uart",), "cocotbext-uart", imports, filled=filled)
    assert isinstance(link.wire, Spi)
    filled |= {"requests": [*link.wire.requests], "pause_ns": round(1e9 * link.wire.pause_s)}
    return _Part(("spi",), "cocotbext-spi", ("from cocotb.types import Logic",), filled=filled)
