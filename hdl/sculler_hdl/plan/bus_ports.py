"""The ports of NAME_bus, by name, with what they mean."""

from __future__ import annotations

from sculler_hdl.plan.front import front_counter_ports
from sculler_hdl.plan.ports import (
    Port,
    core_ports,
    counter_ports,
    part_clock_ports,
    reset_name,
    reset_told,
    sample_ports,
)
from sculler_hdl.plan.registers import ADDRESS_BITS
from sculler_model.design import STATUS_BITS, Bus, Design

CORE = "core_"
"""What the names of ports begin with that go to the core's port of the rest of the name."""

BUS_PREFIXES = {
    "axi-lite": "s_axi_",
    "wishbone": "wb_",
    "wishbone-pipelined": "wb_",
    "apb": "s_apb_",
    "axi-stream": "m_axis_t",
    "stream": "packet_",
}
"""What the names of a bus's ports begin with."""

SAMPLE_PREFIXES = {"axi-stream": "s_axis_t", "stream": "sample_packet_"}
"""What the names of ports begin with by which packets of samples come."""


def the_bus(design: Design) -> Bus:
    """The design's [hardware.bus], which is there."""
    bus = design.hardware.bus
    assert bus is not None, "no [hardware.bus]"
    return bus


def bus_ports(design: Design) -> tuple[Port, ...]:
    """Every port of the Verilog module, in order."""
    bus = the_bus(design)
    bus_clock = [
        Port("bus_clk", 1, told="clock of the bus, rising edge"),
        Port(
            reset_name(design, "bus_rst"),
            1,
            told=f"its {reset_told(design)}, together with {reset_name(design)}",
        ),
    ]
    return (
        *part_clock_ports(design),
        *(bus_clock if bus.clock == "separate" else []),
        *_sample_side(design),
        *_core_side(design),
        *_times(design),
        *_host_side(design),
    )


def front_ports(design: Design) -> list[Port]:
    """Those that a sensor front end drives beside the sample."""
    counters = [port._replace(output=False) for port in front_counter_ports()]
    instant = Port("sample_instant", 1, told="the moment that the next sample's time stamp tells")
    return [
        instant,
        *counters,
        Port(reset_name(design, "front_rst"), 1, output=True, told="resets the sensor front end"),
    ]


def has_front(design: Design) -> bool:
    """Whether samples come from a sensor front end."""
    return design.front is not None


def takes_packets(design: Design) -> bool:
    """Whether samples come as packets."""
    return the_bus(design).takes_packets


def packet_sample_ports(kind: str) -> dict[str, Port]:
    """The ports by which packets of samples come, by the names that AXI4-Stream has for them."""
    names = {name: name for name in ("valid", "ready", "data", "last", "user")}
    if kind == "stream":
        names["user"] = "fault"
    told = {
        "valid": "a word of a sample is offered",
        "ready": "it is taken in this clock",
        "data": "a count, extended by its sign; gyro x, y, z, accel x, y, z",
        "last": "this word is the sample's last",
        "user": "with the last word: the sensor marks the sample",
    }
    return {
        name: Port(
            f"{SAMPLE_PREFIXES[kind]}{own}",
            32 if name == "data" else 1,
            output=name == "ready",
            told=told[name],
        )
        for name, own in names.items()
    }


def _sample_side(design: Design) -> list[Port]:
    if takes_packets(design):
        return [
            *packet_sample_ports(the_bus(design).sample or "").values(),
            Port(
                "packets_bad",
                16,
                output=True,
                told="packets that were no sample since reset, in the core's clock",
            ),
        ]
    return [
        Port("sample_valid", 1),
        Port("sample_ready", 1, output=True, told="the offered sample is taken in this clock"),
        *sample_ports(design),
        *(front_ports(design) if has_front(design) else []),
    ]


def _core_side(design: Design) -> list[Port]:
    """The core's ports seen from outside it."""
    counters = counter_ports(design) if the_bus(design).has_registers else []
    names = {port.name for port in counter_ports(design)} - {port.name for port in counters}
    names.add("upset")  # of a hardened core: it is a port of the unit
    core = [port for port in core_ports(design) if port.name not in names]
    return [
        Port(
            f"{CORE}{port.name}", port.bits, port.signed, not port.output, f"the core's {port.name}"
        )
        for port in [Port(reset_name(design), 1), *core]
    ]


def _times(design: Design) -> list[Port]:
    if not the_bus(design).time_stamps:
        return []
    return [Port("pulse", 1, told="pulse per second, of any clock; its rising edge is stamped")]


def own_bus_ports(kind: str, status_bits: int = STATUS_BITS) -> list[Port]:
    """Those of a kind of bus, by the names that its standard has for them."""
    return [
        Port(name, status_bits if name in ("user", "status") else bits, output=output, told=told)
        for name, bits, output, told in _LISTS[kind]
    ]


def unread_ports(kind: str) -> dict[str, Port]:
    """What the standard of a bus has beside them and nothing reads, by the port that it follows.

    The unit has these ports, so that a tool finds the whole interface; `bus_ports` has them not.
    """
    if kind != "axi-lite":
        return {}
    return {
        f"a{way}addr": Port(f"a{way}prot", 3, told=f"{what} protection, which nothing reads")
        for way, what in (("w", "write"), ("r", "read"))
    }


def _host_side(design: Design) -> list[Port]:
    bus = the_bus(design)
    prefix, own = BUS_PREFIXES[bus.result], own_bus_ports(bus.result, design.status_bits)
    ports = [port._replace(name=f"{prefix}{port.name}") for port in own]
    if bus.has_registers:
        ports.append(Port("irq", 1, output=True, told="high while something waits that is enabled"))
    return ports


_Listed = list[tuple[str, int, bool, str]]

_AXI_LITE: _Listed = [
    ("awvalid", 1, False, "write address: valid"),
    ("awready", 1, True, "write address: ready"),
    ("awaddr", ADDRESS_BITS, False, "write address, of a byte"),
    ("wvalid", 1, False, "write data: valid"),
    ("wready", 1, True, "write data: ready"),
    ("wdata", 32, False, "write data"),
    ("wstrb", 4, False, "bytes of it that count"),
    ("bvalid", 1, True, "write answer: valid"),
    ("bready", 1, False, "write answer: ready"),
    ("bresp", 2, True, "write answer: 0 OKAY, 2 SLVERR"),
    ("arvalid", 1, False, "read address: valid"),
    ("arready", 1, True, "read address: ready"),
    ("araddr", ADDRESS_BITS, False, "read address, of a byte"),
    ("rvalid", 1, True, "read data: valid"),
    ("rready", 1, False, "read data: ready"),
    ("rdata", 32, True, "read data"),
    ("rresp", 2, True, "read answer: 0 OKAY, 2 SLVERR"),
]

_WISHBONE: _Listed = [
    ("cyc", 1, False, "a cycle of accesses"),
    ("stb", 1, False, "an access is asked for"),
    ("we", 1, False, "it is a write"),
    ("adr", ADDRESS_BITS, False, "address, of a byte"),
    ("dat_w", 32, False, "data from the master"),
    ("sel", 4, False, "bytes that count"),
    ("ack", 1, True, "the access is done"),
    ("err", 1, True, "the access was an error"),
    ("dat_r", 32, True, "data to the master"),
]

_APB: _Listed = [
    ("psel", 1, False, "select"),
    ("penable", 1, False, "second and later clocks of an access"),
    ("pwrite", 1, False, "it is a write"),
    ("paddr", ADDRESS_BITS, False, "address, of a byte"),
    ("pwdata", 32, False, "data from the requester"),
    ("pstrb", 4, False, "bytes of it that count"),
    ("pready", 1, True, "the access is done"),
    ("prdata", 32, True, "data to the requester"),
    ("pslverr", 1, True, "the access was an error"),
]

_AXI_STREAM: _Listed = [
    ("valid", 1, True, "a word of a result is shown"),
    ("ready", 1, False, "it is taken in this clock"),
    ("data", 32, True, "columns in order, least significant word first; then time stamps"),
    ("keep", 4, True, "bytes that count: all"),
    ("last", 1, True, "this word is the result's last"),
    ("user", STATUS_BITS, True, "status of the result, at each of its words"),
]

_STREAM: _Listed = [
    ("status" if name == "user" else name, bits, output, told)
    for name, bits, output, told in _AXI_STREAM
    if name != "keep"
]

_LISTS: dict[str, _Listed] = {
    "axi-lite": _AXI_LITE,
    "wishbone": _WISHBONE,
    "wishbone-pipelined": [
        *_WISHBONE,
        ("stall", 1, True, "the access that is asked for is not taken in this clock"),
    ],
    "apb": _APB,
    "axi-stream": _AXI_STREAM,
    "stream": _STREAM,
}
