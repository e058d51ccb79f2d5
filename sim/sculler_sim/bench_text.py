"""Verilog and vectors of test benches, as text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from importlib import resources
from itertools import accumulate
from string import Template

from sculler_hdl import Port
from sculler_model.design import Design
from sculler_sim.bench_goals import slices


class _Template(Template):
    delimiter = "%%"  # neither Verilog nor Markdown has it


def clocking_connections(design: Design, clk_en: str = "clk_en") -> list[str]:
    """Connections of the reset, to `rst`, and of the clock enable, if there is one."""
    low = design.hardware.reset_active == "low"
    enables = [f".clk_en({clk_en})"] if design.hardware.clock_enable else []
    return [".rst_n(!rst)" if low else ".rst(rst)", *enables]


def fill(template: str, values: Mapping[str, object]) -> str:
    """A template of this package with what stands in it."""
    text = resources.files("sculler_sim").joinpath(template).read_text(encoding="ascii")
    return _Template(text).substitute(values)


def packed_hex(rows: Iterable[Iterable[int]], ports: Sequence[Port]) -> str:
    """One packed word a line for $readmemh, the first port in the lowest bits."""
    lows = [0, *accumulate(port.bits for port in ports)]
    digits = -(-lows.pop() // 4)
    fields = [((1 << port.bits) - 1, low) for port, low in zip(ports, lows, strict=True)]
    words = (
        sum([(value & mask) << low for value, (mask, low) in zip(row, fields, strict=True)])
        for row in rows
    )
    return "".join([f"{word:0{digits}x}\n" for word in words])


def declarations(ports: list[Port]) -> Iterator[str]:
    """Wires of the result ports, and of what they should show."""
    for port, place in slices(ports):
        kind = "signed " if port.signed else ""
        wanted = port.name.replace("result_", "want_")
        yield f"  wire {kind}[{port.bits - 1}:0] {port.name};"
        yield f"  wire {kind}[{port.bits - 1}:0] {wanted} = want{place};"


def connections(inputs: list[Port], outputs: list[Port]) -> Iterator[str]:
    """Of the sample and result ports."""
    for port, place in slices(inputs):
        yield f"    .{port.name}(sample{place})"
    for port in outputs:
        yield f"    .{port.name}({port.name})"


def checks(ports: list[Port]) -> Iterator[str]:
    """Of the result ports, where a result is due."""
    for name in (port.name for port in ports):
        wanted = name.replace("result_", "want_")
        yield f"    end else if (want_valid && {name} !== {wanted}) begin"
        yield f'      $display("FAIL: result %0d, word %0d, {name}: %0d, expected %0d",'
        yield f"               results, part, {name}, {wanted});"
        yield "      fail;"
