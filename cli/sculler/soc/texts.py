"""The texts of a chip: Verilog, firmware, and the processor from its package."""

from __future__ import annotations

from importlib import import_module, metadata, resources
from pathlib import Path
from string import Template

from sculler.host_c import host_texts, library_texts
from sculler.soc.plan import BAUD, COUNTERS, SocPlan
from sculler_hdl import pin_ports, unit_ports
from sculler_model.errors import InputError
from sculler_model.navigation import SensorNoise

_PACKAGE, _CORE = "pythondata-cpu-vexriscv", "VexRiscv.v"
_SOURCES = ("soc_start.S", "soc.ld")


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
        memory_kib=plan.memory,
        baud=BAUD,
        clock_mhz=f"{plan.clock_mhz:g}",
        word_bits=(plan.memory * 256 - 1).bit_length(),
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
    words = {
        "name": design.name,
        "guard": guard,
        "counter_count": len(COUNTERS),
        "counters": ", ".join(f"{guard}_{name}" for name in COUNTERS),
    }
    aligning = {}
    if plan.align:
        aligning = {
            "chip_align.c": Template(_source("chip_align.c.in")).substitute(words),
            "chip_align.h": _source("chip_align.h"),
        }
    return {
        f"{design.name}_flight.c": Template(_source("flight.c.in")).substitute(words),
        f"{design.name}_start.h": _start(plan),
        **aligning,
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
    include = "sculler_align.h" if plan.align else "sculler_nav.h"
    return f"""/* Where {plan.design.name}_soc begins to navigate.  Made by `sculler soc`. */
#ifndef {guard}_START_H
#define {guard}_START_H

#include "{include}"

#define {guard}_POSITION_EVERY {plan.position_every}u
#define {guard}_RING {plan.ring}u /* a power of two */

/* results of a window at rest, 0 for none; whether a fine stage follows, and its steps */
#define {guard}_ALIGN_RESULTS {plan.align.results if plan.align else 0}u
#define {guard}_ALIGN_FINE {int(plan.align is not None and plan.align.fine)}u
#define {guard}_ALIGN_STEPS {plan.steps}u
{_noise(plan)}
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


def _noise(plan: SocPlan) -> str:
    """The sensors' noise, where an alignment asks."""
    if plan.align is None:
        return ""
    noise: SensorNoise = plan.align.noise
    told = (
        (noise.angle_random_walk, "rad/sqrt(s)"),
        (noise.velocity_random_walk, "m/s/sqrt(s)"),
        (noise.velocity_noise, "m/s, of the velocity at one instant"),
        (noise.gyro_bias, "rad/s; negative where nothing is known, as the next"),
        (noise.accel_bias, "m/s^2"),
    )
    rows = "".join(
        f"    {-1.0 if value is None else float(value)!r}, /* {unit} */\n" for value, unit in told
    )
    return f"""
/* one standard deviation, each axis */
static const sculler_noise {plan.design.name}_noise = {{
{rows}}};
"""


def _source(name: str) -> str:
    room = resources.files("sculler").joinpath("soc", "src")
    return room.joinpath(name).read_text(encoding="utf-8")
