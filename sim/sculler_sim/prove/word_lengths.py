"""Whether every accumulator of the pipelined core stays in the interval that the design declares.

The intervals of `Design.words` become assertions about the registers of the emitted Verilog.  The
registers are met where Yosys has flattened the core; those that an addition of several clocks
leaves in pieces are left out (`accumulators`).
"""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from sculler_hdl import generate, module_ports
from sculler_model.design import Design, Interval
from sculler_sim.prove.arithmetic import at_full_pace, clocks_for
from sculler_sim.prove.engine import Outcome, prove_unrolled
from sculler_sim.prove.problem import FLAT, TO_GATES, TOP, run_yosys, top_module, write_core

LABEL = "word_lengths"

_WRITE = """
opt_clean
aigmap
write_aiger -zinit {label}.aig
"""


class Accumulator(NamedTuple):
    """A register of a core and what it may hold.

    Attributes:
        path: its name in the flattened core.
        bits: its width in the Verilog.
        range: what the design declares.
    """

    path: str
    bits: int
    range: Interval


def accumulators(design: Design, verilog: str) -> list[Accumulator]:
    """The sums over a major interval that are registers of one piece, by the Verilog's names.

    Args:
        design: a design with a pipelined core.
        verilog: its text.
    """
    bodies = dict(re.findall(r"^module (\w+) \((.*?)^endmodule", verilog, re.M | re.S))
    found = []
    for path, module, name in _instances(design.name, bodies):
        register = re.search(r"^  output reg \[(\d+):0\] newest$", bodies[module], re.M)
        if register:
            bits = int(register[1]) + 1
            found.append(Accumulator(f"core.{path}.newest", bits, getattr(design.words, name)))
    return found


def _instances(top: str, bodies: dict[str, str]) -> Iterator[tuple[str, str, str]]:
    """(path, module, name in `Design.words`) of each accumulator."""
    for module, name, axis in re.findall(r"^  (\w+) (alpha|nu)_([xyz]) \($", bodies[top], re.M):
        yield f"{name}_{axis}", module, name
    for array, place in re.findall(r"^  (\w+) cross_(\w+) \($", bodies[top], re.M):
        totals = re.findall(r"^  (\w+) (coning|sculling)_([xyz])_total \($", bodies[array], re.M)
        for module, name, axis in totals:
            yield f"cross_{place}.{name}_{axis}_total", module, f"{name}_{place}"


def settle_word_lengths(
    design: Design,
    folder: Path,
    results: int = 2,
    held: list[Accumulator] | None = None,
) -> Outcome:
    """Whether every accumulator stays in its interval until the first results have been taken.

    Args:
        design: a design with a pipelined core.
        folder: to work in, a folder that is there.
        results: how many, from power-up on.
        held: in place of the accumulators and intervals that follow from the design.

    Raises:
        InputError: Yosys is not installed.
        ToolError: it failed.
        ValueError: no accumulator is one register.
    """
    begun = time.monotonic()
    held = accumulators(design, generate(design).verilog) if held is None else held
    if not held:
        raise ValueError(f"{design.name} has no accumulator of one piece")
    sources, clocks = write_core(design, folder), clocks_for(design, results)
    lines = list(_assertions(held))
    top = top_module(design.name, module_ports(design), lines, properties=False)
    (folder / "top.v").write_text(at_full_pace(top), encoding="utf-8")
    (folder / "properties.sv").write_text("", encoding="utf-8")
    connect = (f"connect -nounset -set sum{i} {one.path}" for i, one in enumerate(held))
    cut = "\n".join([f"cd {TOP}", *connect, "cd .."])
    flat = FLAT.format(sources=sources, top=TOP, cut=cut, to_gates=TO_GATES)
    run_yosys(folder, flat + _WRITE.format(label=LABEL))
    return Outcome(prove_unrolled(folder, LABEL, clocks), clocks, time.monotonic() - begun)


def _assertions(held: list[Accumulator]) -> Iterator[str]:
    for i, (_, bits, range_) in enumerate(held):
        yield f"  wire signed [{bits - 1}:0] sum{i};"
        wide = f"$signed({{sum{i}[{bits - 1}], sum{i}}})"
        yield f"  always @(posedge clk) in_range{i}: assert ("
        yield f"    {wide} >= {_number(range_.lo, bits + 1)}"
        yield f"    && {wide} <= {_number(range_.hi, bits + 1)});"


def _number(value: int, bits: int) -> str:
    return f"{'-' if value < 0 else ''}{bits}'sd{abs(value)}"
