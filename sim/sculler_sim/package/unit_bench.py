"""NAME_unit_tb.v: a self-checking test bench of the whole unit, for Icarus and Verilator.

Samples come by the sensor's wire where the unit has a front end, else at its sample port or as
packets; results leave as packets, or are read from the registers by a small master of the bus.
"""

from __future__ import annotations

import random

from sculler_hdl import BUS_PREFIXES, unit_ports
from sculler_model.design import Design
from sculler_model.golden import GoldenModel, Sample
from sculler_sim.package.contents import Contents
from sculler_sim.package.master import (
    Text,
    column_words,
    master_instance,
    master_module,
    master_nets,
    master_title,
    result_words,
)
from sculler_sim.package.unit_sources import Source, source

RESULTS = 2
"""That go through a bench."""

_SEED = 1601


def bench_files(design: Design) -> tuple[str, ...]:
    """Names of the bench of a design's unit, and of its vectors."""
    return tuple(f"{design.name}_unit_{part}" for part in ("tb.v", "sensor.hex", "expected.hex"))


def unit_bench_texts(contents: Contents) -> dict[str, str]:
    """The bench of a unit and its vectors: texts by the name of their file."""
    design = contents.design
    results = GoldenModel(design).run(_samples(design))
    words = [word for result in results for word in _words(design, result.row())]
    given = unit_source(contents)
    texts = (
        _bench(contents, given),
        "".join(f"{line}\n" for line in given.lines),
        "".join(f"{word:08x}\n" for word in words),
    )
    return dict(zip(bench_files(design), texts, strict=True))


def unit_source(contents: Contents) -> Source:
    """What gives the bench of a unit its samples."""
    design, period = contents.design, 2 * _halves(contents)[0]
    return source(design, _samples(design), period, contents.clocks[-1].port)


def _halves(contents: Contents) -> list[int]:
    """Half a period of each clock, in picoseconds."""
    return [round(5e5 / clock.mhz) for clock in contents.clocks]


def _samples(design: Design) -> list[Sample]:
    """Random samples of two major intervals, in the sensor's range and that of its frames."""
    rng, link = random.Random(_SEED), design.front

    def three(sensor: str) -> tuple[int, int, int]:
        allowed = getattr(design.words, sensor)
        lo, hi = allowed.lo, allowed.hi
        for number in getattr(link.layout, sensor) if link is not None else ():
            half = 1 << number.bits - 1
            lo = max(lo, -half if number.signed else 0)
            hi = min(hi, half - 1 if number.signed else 2 * half - 1)
        x, y, z = (rng.randint(lo, hi) for _ in range(3))
        return x, y, z

    count = RESULTS * design.samples_per_major
    return [(three("gyro"), three("accel"), False) for _ in range(count)]


def _words(design: Design, row: tuple[int, ...]) -> list[int]:
    """A result's words of 32 bits, the least significant of each column first."""
    each = column_words(design)
    return [value >> 32 * place & 0xFFFF_FFFF for value in row for place in range(each)]


def _bench(contents: Contents, given: Source) -> str:
    design = contents.design
    bus = design.hardware.bus
    assert bus is not None
    halves = _halves(contents)
    side, top = contents.clocks[-1].port, contents.top
    wires, modules, nets = "  wire ready = 1'b1;", "", given.nets
    if bus.has_registers:
        host = f"A master of {master_title(design)} reads the results from the registers."
        wires = f"{wires}\n{master_instance(f'{top}_tb', design, side)}"
        modules = master_module(f"{top}_tb", design)
        nets |= master_nets(design)
    else:
        host = "Results come as packets; the bench is always ready."
        prefix = BUS_PREFIXES[bus.result]
        nets |= {f"{prefix}{name}": name for name in ("valid", "ready", "data", "last")}
    for reset in contents.resets:
        nets[reset.port] = "rst" if reset.active_high else "!rst"
    nets |= {clock.port: clock.port for clock in contents.clocks} | {"clk_en": "1'b1"}
    ports = unit_ports(design)
    open_or_zero = {port.name: "" if port.output else f"{port.bits}'d0" for port in ports}
    nets = open_or_zero | nets
    separate = f"  reg bus_clk = 1'b0;\n  always #{halves[-1]} bus_clk = !bus_clk;"
    return Text.of("unit_bench.v.in").substitute(
        top=top,
        sensor=given.told,
        host=host,
        results=RESULTS,
        words=result_words(design),
        compared=column_words(design) * len(design.columns),
        half=halves[0],
        slower=2 * max(halves),
        bus_clock=separate if len(halves) > 1 else "",
        source=given.text,
        wires=wires,
        connections=",\n".join(f"    .{port.name}({nets[port.name]})" for port in ports),
        side=side,
        longest=given.longest,
        modules=modules,
    )
