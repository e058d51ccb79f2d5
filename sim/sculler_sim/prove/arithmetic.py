"""Whether a core of a few bits hands over the page's integers, whatever its first samples are.

The page's lines are written as Verilog with plain integers, from the tables of coefficients alone,
and stand beside the core.  Counts have so few bits that a solver can compare sums of products;
the core's own words are as short as its worst case lets them be, so a word that is a bit too short
shows.  Samples come as fast as the core takes them and results are taken at once: that numbers do
not depend on stalls is what the properties of the ports, and simulation, are for.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

from sculler_hdl import Port, module_ports, timing
from sculler_model.algorithms import TapTable
from sculler_model.design import AXES, Design
from sculler_model.golden import WORD_BITS, words_per_column, words_per_result
from sculler_sim.prove.engine import Outcome, prove_unrolled
from sculler_sim.prove.problem import TO_GATES, TOP, run_yosys, top_module, write_core

LABEL = "arithmetic"

_WRITE = """
read_verilog {sources}
read_verilog -sv -formal top.v
hierarchy -check -top {top}
proc
flatten
delete t:$print
memory_map -formal
{to_gates}
opt_clean
aigmap
write_aiger -zinit {label}.aig
"""


def narrowed(design: Design, bits: int) -> Design:
    """The same design with counts of so few bits as no sensor has.

    Args:
        design: the design.
        bits: of a count, 2 or more.
    """
    sensor = design.sensor
    counts = {
        name: getattr(sensor, name).model_copy(update={"bits": bits}) for name in ("gyro", "accel")
    }
    fields = {name: getattr(design, name) for name in type(design).model_fields}
    # not a copy, which would keep what has been computed of the wider design
    return type(design).model_construct(**fields | {"sensor": sensor.model_copy(update=counts)})


def write_arithmetic_problem(
    design: Design, folder: Path, results: int = 2, verilog: str | None = None
) -> int:
    """Write arithmetic.aig: an output is high where a component of a result is not the page's.

    There is an output for each component of each of the first results, and one that is high where
    so many did not come.

    Args:
        design: the design, without high-resolution position.
        folder: where, a folder that is there.
        results: how many, from power-up on.
        verilog: in place of the core's text.

    Returns:
        Clocks until the last result has been taken.

    Raises:
        InputError: Yosys is not installed.
        ToolError: Yosys failed.
        ValueError: the design has high-resolution position.
    """
    if design.high_resolution:
        raise ValueError("high-resolution position is not among the page's lines here")
    sources, clocks = write_core(design, folder, verilog), clocks_for(design, results)
    lines = checker(design, results, clocks)
    top = top_module(design.name, module_ports(design), lines, properties=False)
    # a core that drops results would drop some of these: the next interval's samples wait
    offered = "made == taken" if design.drops_results else "1'd1"
    (folder / "top.v").write_text(at_full_pace(top, offered), encoding="utf-8")
    run_yosys(folder, _WRITE.format(sources=sources, top=TOP, to_gates=TO_GATES, label=LABEL))
    return clocks


def settle_arithmetic(
    design: Design, folder: Path, results: int = 2, verilog: str | None = None
) -> Outcome:
    """Compare the first results of a design of few bits (`narrowed`).

    Args:
        design: the design, without high-resolution position.
        folder: to work in, a folder that is there.
        results: how many, from power-up on.
        verilog: in place of the core's text.

    Raises:
        InputError: Yosys is not installed.
        ToolError: it failed.
    """
    begun = time.monotonic()
    clocks = write_arithmetic_problem(design, folder, results, verilog)
    verdict = prove_unrolled(folder, LABEL, clocks)
    return Outcome(verdict, clocks, time.monotonic() - begun)


def at_full_pace(top: str, offered: str = "1'd1") -> str:
    """The top with the handshakes' inputs tied; samples are offered where `offered` is high."""
    for name, value in (("rst", "1'd0"), ("sample_valid", offered), ("result_ready", "1'd1")):
        top = top.replace(f"input [0:0] {name}", f"input [0:0] free_{name}")
        top = top.replace(");\n", f");\n  wire {name};\n", 1)
        top = top.replace("endmodule", f"  assign {name} = {value};\nendmodule", 1)
    return top


def clocks_for(design: Design, results: int) -> int:
    """Clocks in which the first results come, samples and results without stalls, and some more."""
    clocks = timing(design)
    work = clocks.work or (0,) * design.algorithm.samples
    minor = sum(max(clocks.spacing, one) for one in work)
    parts = words_per_result(design) if design.hardware.handover == "stream" else 1
    hand_over = clocks.latency + parts * clocks.handover_spacing + 4
    return clocks.startup + results * (design.algorithm.minors * minor + hand_over)


def checker(design: Design, results: int, clocks: int) -> list[str]:
    """Lines that work out the first results and compare what the core hands over."""
    table, n = design.table, design.algorithm.samples
    numbers, bits = list(design.components), _number_bits(design)
    lines = [
        f"  reg [7:0] phase = 0, minor = 0, made = 0, part = 0, taken = 0;  // {results} results",
        *(f"  reg signed [{bits - 1}:0] {name} = 0;" for name in numbers),
        *_registers(design, bits),
        "  always @(posedge clk) if (sample_valid && sample_ready) begin",
        *_every_sample(table),
        f"    if (phase == {n - 1}) begin",
        *_minor_end(table),
        f"      if (minor == {design.algorithm.minors - 1}) begin",
        *(f"        if (made == {i}) begin {_kept(i, numbers)} end" for i in range(results)),
        f"        if (made != {results}) made = made + 1;",
        "        " + " ".join(f"{name} = 0;" for name in numbers),
        "        minor = 0;",
        "      end else minor = minor + 1;",
        "      phase = 0;",
        "    end else phase = phase + 1;",
        *_history(table),
        "  end",
        *(f"  reg signed [{bits - 1}:0] {n}_{i} = 0;" for i in range(results) for n in numbers),
    ]
    stream = design.hardware.handover == "stream"
    compare = _stream_checks if stream else _port_checks
    arrived = [
        "  reg [15:0] clock = 0;",
        "  always @(posedge clk) begin",
        "    clock = clock + 1;",
        f"    if (clock == {clocks}) {LABEL}_all: assert (taken == {results});",
        "  end",
    ]
    return [*_ordered(lines), *compare(design, results, numbers), *arrived]


def _ordered(lines: list[str]) -> list[str]:
    """Declarations first."""
    return sorted(lines, key=lambda line: not line.startswith("  reg"))


def _kept(i: int, numbers: list[str]) -> str:
    return " ".join(f"{name}_{i} = {name};" for name in numbers)


def _registers(design: Design, bits: int) -> Iterator[str]:
    """The history s[t-d], r[t-d]; the sums; names are those of the page."""
    for axis in AXES:
        for sensor, name in (("gyro", "s"), ("accel", "r")):
            top = getattr(design.sensor, sensor).bits - 1
            for d in range(1, _reach(design.table) + 1):
                yield f"  reg signed [{top}:0] {name}{d}_{axis} = 0;"
            yield f"  wire signed [{top}:0] {name}0_{axis} = sample_{sensor}_{axis};"
        for name in ("A", "B", "theta", "v"):
            yield f"  reg signed [{bits - 1}:0] {name}_{axis} = 0;"


def _reach(table: TapTable) -> int:
    """The furthest distance."""
    return max(len(table.weights) - 1, *map(len, table.taps))


def _number_bits(design: Design) -> int:
    """Of the page's integers: no sum can be larger than with all terms at their largest."""
    table, minors = design.table, design.algorithm.minors
    count = 1 << max(design.sensor.gyro.bits, design.sensor.accel.bits) - 1
    within = sum(abs(tap) for row in table.taps for tap in row) * minors
    between = sum(map(abs, table.weights)) ** 2 * minors**2
    return (4 * max(within, between) * count**2).bit_length() + 1


def _sum(name: str, coefficients: dict[int, int], axis: str) -> str:
    terms = (f"{c} * {name}{d}_{axis}" for d, c in coefficients.items() if c)
    return " + ".join(f"({term})" for term in terms) or "0"


def _cross(left: str, right: str, i: int) -> str:
    """A component of left x right."""
    y, z = AXES[(i + 1) % 3], AXES[(i + 2) % 3]
    return f"{left}_{y} * {right}_{z} - {left}_{z} * {right}_{y}"


def _every_sample(table: TapTable) -> Iterator[str]:
    yield "    case (phase)"
    for k, row in enumerate(table.taps):
        taps = dict(enumerate(row, start=1))
        sums = (
            f"{name}_{axis} = {_sum(samples, taps, axis)};"
            for name, samples in (("A", "s"), ("B", "r"))
            for axis in AXES
        )
        yield f"      {k}: begin {' '.join(sums)} end"
    yield "    endcase"
    for i, axis in enumerate(AXES):
        coning = _cross("A", "s0", i)
        sculling = f"{_cross('A', 'r0', i)} + {_cross('B', 's0', i)}"
        yield f"    coning_within_{axis} = coning_within_{axis} + {coning};"
        yield f"    sculling_within_{axis} = sculling_within_{axis} + {sculling};"


def _minor_end(table: TapTable) -> Iterator[str]:
    weights = dict(enumerate(table.weights))
    for axis in AXES:
        yield f"      theta_{axis} = {_sum('s', weights, axis)};"
        yield f"      v_{axis} = {_sum('r', weights, axis)};"
    for i, axis in enumerate(AXES):
        coning = _cross("alpha", "theta", i)
        sculling = f"{_cross('alpha', 'v', i)} + {_cross('nu', 'theta', i)}"
        yield f"      coning_between_{axis} = coning_between_{axis} + {coning};"
        yield f"      sculling_between_{axis} = sculling_between_{axis} + {sculling};"
    for axis in AXES:
        yield f"      alpha_{axis} = alpha_{axis} + theta_{axis};"
        yield f"      nu_{axis} = nu_{axis} + v_{axis};"


def _history(table: TapTable) -> Iterator[str]:
    for d in range(_reach(table), 0, -1):
        for axis in AXES:
            yield f"    s{d}_{axis} = s{d - 1}_{axis}; r{d}_{axis} = r{d - 1}_{axis};"


def _port_checks(design: Design, results: int, numbers: list[str]) -> Iterator[str]:
    ports: dict[str, Port] = {port.name: port for port in module_ports(design)}
    yield "  always @(posedge clk) if (result_valid && result_ready) begin"
    for i in range(results):
        for name in numbers:
            signed = "$signed" if ports[f"result_{name}"].signed else ""
            same = f"{signed}(result_{name}) == {name}_{i}"
            yield f"    if (taken == {i}) {LABEL}_{name}_{i}: assert ({same});"
    yield f"    if (taken != {results}) taken = taken + 1;"
    yield "  end"


def _stream_checks(design: Design, results: int, numbers: list[str]) -> Iterator[str]:
    """Word after word; the first two columns are number and status."""
    count = words_per_column(design)
    wide = count * WORD_BITS
    yield f"  reg signed [{wide - 1}:0] column;"
    yield "  always @(posedge clk) if (result_valid && result_ready) begin"
    for i in range(results):
        for place, name in enumerate(numbers, start=2):
            here = f"taken == {i} && part / {count} == {place}"
            word = f"column[part % {count} * {WORD_BITS} +: {WORD_BITS}]"
            yield f"    column = {name}_{i};"
            yield f"    if ({here}) {LABEL}_{name}_{i}: assert (result_data == {word});"
    yield f"    if (part == {words_per_result(design) - 1}) begin"
    yield f"      part = 0; if (taken != {results}) taken = taken + 1;"
    yield "    end else part = part + 1;"
    yield "  end"
