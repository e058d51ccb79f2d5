"""Example top levels: a sensor's line in, results out by the board's serial port.

A design for a board has a sensor front end on a UART, and a bus of packets or of registers:

    [hardware.front]                [hardware.bus]
    clock_hz = the board's          result = "axi-stream" or "axi-lite"

Registers are read by a small master in the top level, which makes the same packets of them.

Pins: ULX3S from its constraint file (emard/ulx3s, doc/constraints/ulx3s_v20.lpf); iCEBreaker from
Project IceStorm (examples/icebreaker/icebreaker.pcf).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from sculler_hdl import Generated, unit_ports
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.front import Uart
from sculler_sim.package.master import (
    Text,
    master_instance,
    master_module,
    master_nets,
    result_words,
)

BAUD = 921_600
"""Of the serial port to the host."""

_BITS_A_WORD = 4 * 10


_NETS = {
    "clk": "clk",
    "rst": "rst",
    "pulse": "pulse",
    "rx": "sensor_rx",
    "m_axis_tvalid": "valid",
    "m_axis_tready": "ready",
    "m_axis_tdata": "data",
    "m_axis_tlast": "last",
}
"""Net of each port of the unit; of others, outputs stay open and inputs are 0."""


@dataclass(frozen=True)
class Board:
    """A board.

    Attributes:
        name: as it is given on the command line.
        title: as its maker writes it.
        family: of its device; the design file's hardware.target.
        clock_mhz: of its oscillator.
        pressed: level of the button while it is pressed.
        pins: place of each port of the top level.
        options: what tells nextpnr the device.
    """

    name: str
    title: str
    family: Literal["ecp5", "ice40"]
    clock_mhz: float
    pressed: int
    pins: Mapping[str, str]
    options: str

    def sources(self, design: str) -> list[str]:
        """The files to synthesise for a design of this name."""
        parts = (f"_{self.name}", "_unit", "_front", "", "_bus")
        return [f"{design}{part}.v" for part in parts]

    def pin_file(self, design: str) -> str:
        """The file of the pins."""
        return f"{design}_{self.name}.{'lpf' if self.family == 'ecp5' else 'pcf'}"


_ALL = (
    Board(
        "ulx3s",
        "ULX3S with an LFE5U-85F",
        "ecp5",
        25.0,
        1,
        {
            "clk": "G2",
            "button": "R1",
            "sensor_rx": "B11",
            "pulse": "A10",
            "host_tx": "L4",
            "led": "B2",
        },
        "--85k --package CABGA381",
    ),
    Board(
        "icebreaker",
        "iCEBreaker with an iCE40UP5K",
        "ice40",
        12.0,
        0,
        {
            "clk": "35",
            "button": "10",
            "sensor_rx": "4",
            "pulse": "2",
            "host_tx": "9",
            "led": "37",
        },
        "--up5k --package sg48",
    ),
)

BOARDS = {board.name: board for board in _ALL}


def find_board(name: str) -> Board:
    """The board of a name.

    Raises:
        InputError: there is none.
    """
    if name not in BOARDS:
        raise InputError(f"--board {name}: no such board, give one of {', '.join(BOARDS)}")
    return BOARDS[name]


def board_texts(generated: Generated, name: str) -> dict[str, str]:
    """Top level, pins and Makefile for a board: texts by the name of their file.

    Raises:
        InputError: there is no such board, or the design is not one for it.
    """
    board, design = find_board(name), generated.manifest.design
    _check(board, design)
    top = f"{design.name}_{name}"
    sources = board.sources(design.name)
    pins = {"ecp5": _lpf, "ice40": _pcf}[board.family](board, top)
    return {
        f"{top}.v": _top(board, design, top),
        board.pin_file(design.name): pins,
        f"{top}.mk": _makefile(board, top, sources),
    }


def _check(board: Board, design: Design) -> None:
    hardware, link = design.hardware, design.front
    where = f"--board {board.name}"
    if link is None or not isinstance(link.wire, Uart):
        raise InputError(
            f"{where}: the design has no sensor on a UART, add a [hardware.front] that has one"
        )
    bus = hardware.bus
    if bus is None or bus.result not in ("axi-stream", "axi-lite") or bus.clock != "same":
        raise InputError(
            f'{where}: results go out as packets, add [hardware.bus] with result = "axi-stream"'
            ' or "axi-lite", and clock = "same"'
        )
    if hardware.target not in (board.family, "generic"):
        raise InputError(
            f'{where}: the design is for {hardware.target}, give hardware.target = "{board.family}"'
        )
    if not hardware.clocked_plainly:
        raise InputError(
            f"{where}: its top level has a synchronous reset, active high, and no clock enable,"
            " leave out hardware.reset, reset_active and clock_enable"
        )
    front = hardware.front
    if front is None or front.clock_hz != board.clock_mhz * 1e6:
        raise InputError(
            f"{where}: its clock is {board.clock_mhz:g} MHz, give hardware.front.clock_hz ="
            f" {board.clock_mhz:g}e6"
        )
    rate = (
        (1 + result_words(design))
        * _BITS_A_WORD
        * design.sensor.sample_rate_hz
        / design.samples_per_major
    )
    if rate > 0.95 * BAUD:
        raise InputError(
            f"{where}: results take {rate:,.0f} bits a second, more than {BAUD} baud, give more"
            " algorithm.minors"
        )


def _top(board: Board, design: Design, top: str) -> str:
    bus = design.hardware.bus
    assert bus is not None
    ports, master, modules = unit_ports(design), "", ""
    nets = {port.name: "" if port.output else f"{port.bits}'d0" for port in ports} | _NETS
    if bus.has_registers:
        nets |= master_nets(design)
        modules, master = master_module(top, design), master_instance(top, design)
    return Text.of("board.v.in").substitute(
        top=top,
        name=design.name,
        title=board.title,
        baud=BAUD,
        divisor=round(board.clock_mhz * 1e6 / BAUD),
        pressed=board.pressed,
        connections=",\n".join(f"    .{port.name}({nets[port.name]})" for port in ports),
        master=master,
        modules=modules,
        unused="" if bus.time_stamps else "  wire unused = &{1'b0, pulse};\n",
    )


def _lpf(board: Board, top: str) -> str:
    lines = [
        f"# {top}: pins of the {board.title}",
        f'FREQUENCY PORT "clk" {board.clock_mhz:.6f} MHZ ;',
    ]
    pulls = {"button": "DOWN", "sensor_rx": "UP", "pulse": "DOWN"}
    for port, site in board.pins.items():
        pull = pulls.get(port, "NONE")
        lines.append(f'LOCATE COMP "{port}" SITE "{site}" ;')
        lines.append(f'IOBUF PORT "{port}" PULLMODE={pull} IO_TYPE=LVCMOS33 ;')
    return "\n".join(lines) + "\n"


def _pcf(board: Board, top: str) -> str:
    lines = [f"# {top}: pins of the {board.title}", f"set_frequency clk {board.clock_mhz:g}"]
    for port, pin in board.pins.items():
        pull = "-pullup yes " if port in ("button", "sensor_rx") else ""
        lines.append(f"set_io {pull}{port} {pin}")
    return "\n".join(lines) + "\n"


def _makefile(board: Board, top: str, sources: list[str]) -> str:
    """With the names of PyPI's tools; `make -f FILE PREFIX=` takes those without yowasp-."""
    if board.family == "ecp5":
        pack, routed, bits = "ecppack --compress", "config", "bit"
        place = f"nextpnr-ecp5 {board.options} --lpf {top}.lpf --textcfg $@"
    else:
        pack, routed, bits = "icepack", "asc", "bin"
        place = f"nextpnr-ice40 {board.options} --pcf {top}.pcf --asc $@"
    pins = f"{top}.{'lpf' if board.family == 'ecp5' else 'pcf'}"
    return f"""# {top}.{bits}, the bitstream for the {board.title}:
#   make -f {top}.mk              with the tools of PyPI: pip install 'sculler[place]'
#   make -f {top}.mk PREFIX=      with yosys and nextpnr on PATH
PREFIX ?= yowasp-

{top}.{bits}: {top}.{routed}
\t$(PREFIX){pack} $< $@

{top}.{routed}: {top}_netlist.json {pins}
\t$(PREFIX){place} --json $< --report {top}_report.json

{top}_netlist.json: {" ".join(sources)}
\t$(PREFIX)yosys -q -p "read_verilog $^; synth_{board.family} -top {top} -json $@"
"""
