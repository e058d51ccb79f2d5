"""The texts of a chip: Verilog, firmware, and the processor from its package."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module, metadata, resources
from pathlib import Path
from string import Template

from sculler.host_c import host_texts, library_texts
from sculler_hdl import pin_ports, unit_ports
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.golden import words_per_column
from sculler_model.navigation import NavState

BAUD = 921_600
"""Of the telemetry's line."""

COUNTERS = ("FRAMES_TAKEN", "FRAMES_BAD", "FRAMES_MISSED", "FRAMES_LATE", "SAMPLES_LOST")
"""Registers of the unit that each result's telemetry tells."""

STACK_BYTES = 6144
_PACKAGE, _CORE = "pythondata-cpu-vexriscv", "VexRiscv.v"
_SOURCES = ("soc_start.S", "soc.ld")


@dataclass(frozen=True)
class SocPlan:
    """A chip to make.

    Attributes:
        design: with a sensor front end, and Wishbone as its bus.
        start: where the navigation begins, at the end of the first result of full history; its
            time is not looked at.
        position_every: major intervals from one position update to the next.
        memory_kib: of the processor, a power of two.

    Raises:
        InputError: the design is none for a chip, or a number is out of its range.
    """

    design: Design
    start: NavState
    position_every: int = 1
    memory_kib: int = 64

    def __post_init__(self) -> None:
        check_soc(self.design)
        if not 32 <= self.memory_kib <= 1024 or self.memory_kib & (self.memory_kib - 1):
            raise InputError(
                f"--memory {self.memory_kib}: give a power of two from 32 to 1024 (KiB)"
            )

    @property
    def divisor(self) -> int:
        """Clocks a bit of telemetry."""
        return clocks_a_bit(self.design)

    @property
    def clock_mhz(self) -> float:
        """Of the chip."""
        front = self.design.hardware.front
        assert front is not None
        return front.clock_hz / 1e6


def clocks_a_bit(design: Design) -> int:
    """Clocks a bit of telemetry."""
    front = design.hardware.front
    assert front is not None
    return round(front.clock_hz / BAUD)


def check_soc(design: Design) -> None:
    """See that a design is one for a chip.

    Raises:
        InputError: it has no front end, another bus than Wishbone, no time stamps, or a clock that
            is too slow for the telemetry.
    """
    hardware = design.hardware
    if hardware.front is None:
        raise InputError(
            f"{design.name}: a chip needs the sensor's wire, add a [hardware.front] to the design"
        )
    bus = hardware.bus
    if bus is None or bus.result != "wishbone" or bus.clock != "same" or not bus.time_stamps:
        raise InputError(
            f"{design.name}: the processor's bus is Wishbone, add [hardware.bus] with result ="
            ' "wishbone", clock = "same" and time_stamps = true'
        )
    error = clocks_a_bit(design) * BAUD / hardware.front.clock_hz - 1
    if abs(error) > 0.02:
        raise InputError(
            f"hardware.front.clock_hz {hardware.front.clock_hz:g}: {BAUD} baud of telemetry are off"
            f" by {100 * abs(error):.1f} %, give a faster clock"
        )
    rate = design.sensor.sample_rate_hz / design.samples_per_major
    if rate * bytes_a_result(design) * 10 > 0.95 * BAUD:
        raise InputError(
            f"{design.name}: telemetry of {rate:g} results a second is more than {BAUD} baud, give"
            " more algorithm.minors"
        )


def registers_of(design: Design) -> int:
    """Registers of 32 bits of a result, with its time stamps."""
    return len(design.columns) * -(-words_per_column(design) // 2) + 7


def bytes_a_result(design: Design) -> int:
    """Of telemetry: a frame of kind 2 and one of kind 1."""
    return 8 + 8 + 4 * (registers_of(design) + len(COUNTERS)) + 24 + 4 + 116


class _Verilog(Template):
    delimiter = "%%"


def soc_texts(plan: SocPlan) -> dict[str, str]:
    """The top level NAME_soc.v, and the processor with its licence: texts by name of file.

    Raises:
        InputError: the package of the processor is not installed.
    """
    design = plan.design
    pins = [port for port in (*pin_ports(design),) if port.name not in ("clk", "rst")]
    pins += [port for port in unit_ports(design) if port.name == "pulse"]
    names = {port.name for port in pins}
    wired = {"clk", "rst", "irq"}
    inside = [
        port
        for port in unit_ports(design)
        if port.name not in wired and not port.name.startswith("wb_")
    ]
    address = next(port for port in unit_ports(design) if port.name == "wb_adr")
    top = _Verilog(_source("soc.v.in")).substitute(
        name=design.name,
        memory_kib=plan.memory_kib,
        baud=BAUD,
        clock_mhz=f"{plan.clock_mhz:g}",
        word_bits=(plan.memory_kib * 256 - 1).bit_length(),
        divisor=plan.divisor,
        unit_top=address.bits - 3,
        pins="\n".join(f"  {port.direction} {port.name},  // {port.meaning}" for port in pins),
        connections=",\n".join(
            f"    .{port.name}({port.name if port.name in names else ''})" for port in inside
        ),
    )
    return {f"{design.name}_soc.v": top, **processor_texts()}


def processor_texts() -> dict[str, str]:
    """VexRiscv and its licence, from the package that carries them.

    Raises:
        InputError: it is not installed.
    """
    try:
        room = Path(import_module(_PACKAGE.replace("-", "_")).data_location)
        licence = metadata.distribution(_PACKAGE).read_text("LICENSE")
        processor = (room / _CORE).read_text(encoding="utf-8")
        own = (room / "ext" / "VexRiscv" / "LICENSE").read_text(encoding="utf-8")
    except (ImportError, OSError, AttributeError) as error:
        raise InputError("the processor is not installed: pip install 'sculler[soc]'") from error
    version = metadata.version(_PACKAGE)
    notice = f"VexRiscv.v is taken from {_PACKAGE} {version}. VexRiscv's licence:\n\n{own}"
    if licence:
        notice += f"\nThe package's licence:\n\n{licence}"
    return {_CORE: processor, "VexRiscv_LICENSE.txt": notice}


def firmware_texts(plan: SocPlan) -> dict[str, str]:
    """The firmware's sources by name.

    NAME_flight.c, NAME_start.h, start-up code, linker script, and the host in C.
    """
    design = plan.design
    guard = design.name.upper()
    flight = Template(_source("flight.c.in")).substitute(
        name=design.name,
        guard=guard,
        counter_count=len(COUNTERS),
        counters=", ".join(f"{guard}_{name}" for name in COUNTERS),
    )
    return {
        f"{design.name}_flight.c": flight,
        f"{design.name}_start.h": _start(plan),
        **{name: _source(name) for name in _SOURCES},
        **host_texts(design),
        **library_texts(),
    }


def _start(plan: SocPlan) -> str:
    """The initial state, to the last bit."""
    state, guard = plan.start, plan.design.name.upper()
    w, x, y, z = (float(part).hex() for part in state.q)
    north, east, down = (float(part).hex() for part in state.v)
    lat, lon, height = (float(part).hex() for part in (state.lat, state.lon, state.h))
    return f"""/* Where {plan.design.name}_soc begins to navigate.  Made by `sculler soc`. */
#ifndef {guard}_START_H
#define {guard}_START_H

#include "sculler_nav.h"

#define {guard}_POSITION_EVERY {plan.position_every}u

/* time (set by the firmware), attitude w x y z, velocity north east down, latitude, longitude,
 * height, wander angle */
static const sculler_state {plan.design.name}_start = {{
    0.0,
    {{{w}, {x}, {y}, {z}}},
    {{{north}, {east}, {down}}},
    {lat}, {lon}, {height},
    0.0}};

#endif
"""


def _source(name: str) -> str:
    room = resources.files("sculler").joinpath("soc", "src")
    return room.joinpath(name).read_text(encoding="utf-8")
