"""The package of the unit: core, bus and front end as one IP core, NAME_unit."""

from __future__ import annotations

from collections.abc import Mapping

from sculler_hdl import (
    BUS_PREFIXES,
    Generated,
    RegisterMap,
    own_bus_ports,
    packet_sample_ports,
    pin_ports,
    unit_ports,
    unread_ports,
)
from sculler_model.design import Bus, Design
from sculler_sim.package.contents import (
    CLOCK_MHZ,
    Clock,
    Contents,
    Interface,
    Kind,
    Reset,
    checked_mhz,
    version_of,
)
from sculler_sim.package.unit_bench import bench_files

_STANDARD: Mapping[str, Kind] = {"axi-lite": "axi-lite", "apb": "apb", "axi-stream": "axi-stream"}
"""Interfaces that have a standard's definition."""

_BUS = "result_bus"
"""The instance of NAME_bus in the unit."""


def unit_contents(
    generated: Generated, clock_mhz: float = CLOCK_MHZ, bus_clock_mhz: float | None = None
) -> Contents | None:
    """The package of a design's unit; None where it has no bus.

    Args:
        generated: the design's files.
        clock_mhz: rate of `clk`, for the constraints.
        bus_clock_mhz: rate of `bus_clk`, where there is one; by default that of `clk`.

    Raises:
        InputError: a clock rate is none.
    """
    manifest = generated.manifest
    design, name = manifest.design, manifest.name
    bus = design.hardware.bus
    if bus is None:
        return None
    ports = unit_ports(design)
    clocks = [Clock("clk", checked_mhz(clock_mhz))]
    resets = [_reset(design, "rst")]
    if bus.clock == "separate":
        rate = clock_mhz if bus_clock_mhz is None else bus_clock_mhz
        clocks.append(Clock("bus_clk", checked_mhz(rate, "clock rate of the bus")))
        resets.append(_reset(design, "bus_rst"))
    parts = ["", "_bus", *(["_front"] if design.front is not None else []), "_unit"]
    names = {port.name for port in ports}
    pins = [port.name for port in pin_ports(design) if not port.output]
    return Contents(
        design=design,
        version=version_of(manifest),
        top=f"{name}_unit",
        ports=ports,
        clocks=tuple(clocks),
        reset=resets[0],
        other_resets=tuple(resets[1:]),
        interfaces=_interfaces(bus, clocks[-1].port, resets[-1].port),
        verilog=tuple(f"{name}{part}.v" for part in parts),
        models=tuple(f"{cell}.v" for cell in generated.cells),
        vhdl=f"{name}_unit.vhd",
        bench=bench_files(design),
        anytime=tuple(port for port in ("pulse", *pins) if port in names),
        crossings=_crossings(bus) if len(clocks) > 1 else (),
        registers=RegisterMap(design) if bus.has_registers else None,
        interrupt="irq" if bus.has_registers and bus.result in _STANDARD else "",
    )


def _reset(design: Design, port: str) -> Reset:
    low = design.hardware.reset_active == "low"
    return Reset(f"{port}_n" if low else port, not low, design.hardware.resets_at_once)


def _interfaces(bus: Bus, clock: str, reset: str) -> tuple[Interface, ...]:
    found = []
    if bus.result in _STANDARD:
        kind, prefix = _STANDARD[bus.result], BUS_PREFIXES[bus.result]
        letter = "T" if kind == "axi-stream" else ""
        whole = (*own_bus_ports(bus.result), *unread_ports(bus.result).values())
        ports = {f"{letter}{port.name}".upper(): f"{prefix}{port.name}" for port in whole}
        name = prefix.rstrip("_t").rstrip("_")
        found.append(Interface(name, kind, clock, reset, ports, not bus.has_registers))
    if bus.sample == "axi-stream":
        own = packet_sample_ports(bus.sample)
        ports = {f"T{name}".upper(): port.name for name, port in own.items()}
        found.append(Interface("s_axis", "axi-stream", clock, reset, ports, gives=False))
    return tuple(found)


def _crossings(bus: Bus) -> tuple[str, ...]:
    """The queues with Gray pointers, by their places."""
    names = ["request", "answer"] if bus.has_registers else ["packet"]
    names += ["sample"] if bus.takes_packets else []
    return tuple(f"{_BUS}/{name}_crossing" for name in names)
