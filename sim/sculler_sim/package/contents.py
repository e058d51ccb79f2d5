"""What an IP package holds: its modules, files, ports, clocks and standard interfaces."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

from sculler_hdl import Generated, Manifest, Port, RegisterMap
from sculler_model.design import Design
from sculler_model.errors import InputError

VENDOR, LIBRARY = "sculler", "core"
"""The first two parts of every name of vendor, library, name and version."""

CLOCK_MHZ = 50.0
"""Clock rate of the constraints where none is given."""

Kind = Literal["axi-stream", "axi-lite", "apb"]


class Clock(NamedTuple):
    """A clock input: its port, and its rate in MHz."""

    port: str
    mhz: float

    @property
    def period_ns(self) -> float:
        """Of one clock."""
        return 1e3 / self.mhz


class Reset(NamedTuple):
    """A reset input: its port, and how it acts.

    `at_once` is a reset that is asserted without the clock; the core's own registers end it with
    the clock.
    """

    port: str
    active_high: bool
    at_once: bool

    @property
    def active(self) -> str:
        """Its active level, in a word."""
        return "high" if self.active_high else "low"


class Interface(NamedTuple):
    """Ports that together are a standard interface.

    Attributes:
        name: of the interface.
        kind: which standard.
        clock, reset: ports that it belongs to.
        ports: port of the module by the standard's name of the signal.
        gives: whether the module begins the transfers (master, initiator).
    """

    name: str
    kind: Kind
    clock: str
    reset: str
    ports: Mapping[str, str]
    gives: bool = True


@dataclass(frozen=True)
class Contents:
    """An IP core as it is handed out.

    Attributes:
        design: the design.
        version: of the package.
        top: the module that a user instantiates.
        ports: its ports, in order.
        clocks: its clocks, the core's first.
        reset: its reset, that of the first clock.
        interfaces: standard interfaces among the ports.
        verilog: names of the files to synthesise.
        models: names of the models of vendor blocks, for simulators and linters only.
        vhdl: name of the file for VHDL projects.
        bench: names of the self-checking test bench, and of its vectors.
        other_resets: those of further clocks, in their order.
        anytime: inputs that come at any time, which the module synchronises.
        crossings: places in the module of the queues between its clocks.
        registers: what stands behind the interface that has addresses; None where none has.
        interrupt: the port of that interface's interrupt, high while something waits; "" where
            there is none.
    """

    design: Design
    version: str
    top: str
    ports: tuple[Port, ...]
    clocks: tuple[Clock, ...]
    reset: Reset
    interfaces: tuple[Interface, ...]
    verilog: tuple[str, ...]
    models: tuple[str, ...]
    vhdl: str
    bench: tuple[str, ...]
    other_resets: tuple[Reset, ...] = ()
    anytime: tuple[str, ...] = ()
    crossings: tuple[str, ...] = ()
    registers: RegisterMap | None = None
    interrupt: str = ""

    @property
    def name(self) -> str:
        """Of the top module, with which all files begin."""
        return self.top

    @property
    def resets(self) -> tuple[Reset, ...]:
        """All resets."""
        return (self.reset, *self.other_resets)

    @property
    def summary(self) -> str:
        """What it is, in one line of plain ASCII."""
        algorithm, hardware = self.design.algorithm, self.design.hardware
        part = "core" if self.top == self.design.name else "unit"
        return (
            f"Exact coning and sculling {part}: {algorithm.family}, {algorithm.samples} samples a"
            f" minor interval, {algorithm.minors} minor intervals a result;"
            f" {hardware.core}, target {hardware.target}"
        )

    @property
    def bare_ports(self) -> tuple[Port, ...]:
        """The ports that are neither clock nor reset nor interrupt nor of a standard interface."""
        taken = {
            self.interrupt,
            *(reset.port for reset in self.resets),
            *(clock.port for clock in self.clocks),
        }
        taken |= {port for interface in self.interfaces for port in interface.ports.values()}
        return tuple(port for port in self.ports if port.name not in taken)


def checked_mhz(clock_mhz: float, where: str = "clock rate") -> float:
    """The rate of a clock.

    Raises:
        InputError: it is none.
    """
    if not 1e-3 <= clock_mhz <= 1e4:
        raise InputError(
            f"{where}: {clock_mhz:g} MHz is not allowed, give a number from 0.001 to 10000"
        )
    return clock_mhz


def contents(generated: Generated, clock_mhz: float = CLOCK_MHZ) -> Contents:
    """The package of a generated core.

    Args:
        generated: the core.
        clock_mhz: rate of its clock, for the constraints.

    Raises:
        InputError: the clock rate is none.
    """
    checked_mhz(clock_mhz)
    manifest = generated.manifest
    design, name = manifest.design, manifest.name
    reset = _reset(manifest.ports, design)
    bench = (f"{name}_tb.v", f"{name}_samples.hex", f"{name}_expected.hex")
    return Contents(
        design=design,
        version=version_of(manifest),
        top=name,
        ports=manifest.ports,
        clocks=(Clock("clk", clock_mhz),),
        reset=reset,
        interfaces=_interfaces(design, reset.port),
        verilog=(f"{name}.v",),
        models=tuple(f"{cell}.v" for cell in generated.cells),
        vhdl=f"{name}.vhd",
        bench=bench,
    )


def _reset(ports: tuple[Port, ...], design: Design) -> Reset:
    port = next(port.name for port in ports if port.name in ("rst", "rst_n"))
    return Reset(port, port == "rst", design.hardware.resets_at_once)


def _interfaces(design: Design, reset: str) -> tuple[Interface, ...]:
    """The word stream of results is an AXI4-Stream but for the names of its ports."""
    if design.hardware.handover != "stream":
        return ()
    names = {"TVALID": "valid", "TREADY": "ready", "TDATA": "data", "TLAST": "last"}
    ports = {logical: f"result_{name}" for logical, name in names.items()}
    return (Interface("result", "axi-stream", "clk", reset, ports),)


def version_of(manifest: Manifest) -> str:
    """Sculler's version in three numbers, as every tool takes them."""
    numbers = re.findall(r"\d+", manifest.as_json()["tools"]["sculler"])[:3]
    return ".".join([*numbers, "0", "0"][:3])
