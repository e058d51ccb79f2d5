"""A core beside what is claimed of it, as one netlist for a model checker.

Verilog, properties ─▶ Yosys: flattened, multipliers cut ─▶ AIGER, one file a property
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from sculler_hdl import Port, generate, module_ports, properties
from sculler_model.design import Design
from sculler_sim.place.tools import YOSYS, ToolError

TOP = "sculler_proof"

TO_GATES = """\
async2sync
chformal -lower
setattr -unset keep
delete -output
opt -full
formalff -clk2ff -ff2anyinit
simplemap
techmap
dffunmap
opt -fast
setundef -undriven -anyseq"""
"""Passes from a flat module to gates and flip-flops that may begin as anything."""

FLAT = """
read_verilog {sources}
read_verilog -sv -formal -D SCULLER_NO_BIND properties.sv
read_verilog -sv -formal top.v
hierarchy -check -top {top}
proc
flatten
delete t:$print
{cut}
memory_map -formal
{to_gates}
write_rtlil flat.il
"""

_ONE = """
read_rtlil flat.il
delete t:$assert c:checks.{label} %d
opt_clean
aigmap
write_aiger -zinit {label}.aig
design -reset
"""


def write_problems(
    design: Design,
    folder: Path,
    labels: Sequence[str] | None = None,
    verilog: str | None = None,
    *,
    cut: bool = True,
) -> list[str]:
    """Write LABEL.aig for each property of a design's core: its one output is high where it fails.

    Args:
        design: the design.
        folder: where, a folder that is there.
        labels: of properties (`sculler_hdl.PROPERTIES`); None for all that the core has.
        verilog: in place of the core's text.
        cut: products are anything at all, so that no property may depend on their values.

    Returns:
        The labels.

    Raises:
        InputError: Yosys is not installed.
        ToolError: Yosys failed.
    """
    sources = write_core(design, folder, verilog)
    (folder / "properties.sv").write_text(properties(design), encoding="utf-8")
    (folder / "top.v").write_text(top_module(design.name, module_ports(design)), encoding="utf-8")
    found = labels_of(design)
    chosen = found if labels is None else [label for label in labels if label in found]
    script = FLAT.format(
        to_gates=TO_GATES, sources=sources, top=TOP, cut="cutpoint t:$mul" if cut else ""
    )
    run_yosys(folder, script + "design -reset\n" + "".join(map(_one, chosen)))
    return chosen


def labels_of(design: Design) -> list[str]:
    """The properties that a design's core has, by their labels."""
    return re.findall(r"^ +(\w+): assert \(", properties(design), re.M)


def _one(label: str) -> str:
    return _ONE.format(label=label)


def run_yosys(folder: Path, script: str) -> None:
    """Run a script in a folder.

    Raises:
        InputError: Yosys is not installed.
        ToolError: it failed.
    """
    (folder / "script.ys").write_text(script, encoding="utf-8")
    status, said = YOSYS.run(folder, "-q", "script.ys")
    if status:
        raise ToolError(YOSYS, said)


def write_core(design: Design, folder: Path, verilog: str | None = None) -> str:
    """Write a core's text and those of its blocks.

    Args:
        design: the design.
        folder: where, a folder that is there.
        verilog: in place of the core's text.

    Returns:
        The names of the files, for Yosys.
    """
    generated = generate(design)
    texts = {"core.v": verilog or generated.verilog}
    for cell, text in generated.cells.items():
        texts[f"{cell}.v"] = text.replace("$finish;", "")  # which Yosys wants in `initial` only
    for name, content in texts.items():
        (folder / name).write_text(content, encoding="utf-8")
    return " ".join(texts)


def top_module(
    name: str, ports: Sequence[Port], more: Sequence[str] = (), *, properties: bool = True
) -> str:
    """The core and its properties side by side; all inputs are free.

    Args:
        name: of the core.
        ports: of the core.
        more: lines of the module.
        properties: whether these stand beside it.
    """
    declared = [_declared(port, "input ") for port in ports if not port.output]
    wires = [f"  {_declared(port, 'wire ')};" for port in ports if port.output]
    connections = ", ".join(f".{port.name}({port.name})" for port in ports)
    return "\n".join(
        [
            f"module {TOP} ({', '.join(declared)});",
            *wires,
            f"  {name} core ({connections});",
            *([f"  {name}_properties checks ({connections});"] if properties else []),
            *more,
            "endmodule\n",
        ]
    )


def _declared(port: Port, kind: str) -> str:
    return f"{kind}[{port.bits - 1}:0] {port.name}"
