"""The self-checking Verilog-2001 test bench of a design, with its golden vectors.

It needs no Python to run: any simulator of Verilog-2001 does.  Inside,

* samples come from a file of random counts, in some intervals full-scale ones among them, in others
  one alone or none, and a few faults; an LFSR stalls both handshakes, and every other result waits
  until it holds up the samples;
* offers that are not taken are sometimes withdrawn, so that samples are lost; which, the bench sees
  for itself, and holds status bit 3 and `samples_lost` to it;
* where the core drops results, some wait until others have been dropped behind them;
* after a part of the samples, in mid-interval, reset is held for some clocks while a sample is
  offered; the rest of the samples then starts from nothing;
* every result port is compared with the golden model's, bit for bit, when the result (or a word
  of it) comes and for as long as it waits;
* `sample_ready` and `result_valid` are held to the core's `Timing` on every clock, and no result
  may come too many;
* where the core has a clock enable, it is low at random, and such clocks do not count;
* a line beginning with PASS or FAIL ends it.
"""

from __future__ import annotations

import random
from collections.abc import Collection, Iterable, Iterator, Sequence
from importlib import resources
from pathlib import Path
from string import Template

import numpy as np
from numpy.typing import NDArray

from sculler_hdl import Port, counter_ports, result_ports, sample_ports
from sculler_model.design import STATUS_LOST, Design, Interval
from sculler_model.fast import run_fast
from sculler_model.golden import (
    COUNTER_MAX,
    RELEASE,
    Timing,
    clocks_per_major,
    to_words,
    words_per_column,
    words_per_result,
)
from sculler_model.outputs import make_folder, replacing

_SEED = 2001
_DROPPING = 5  # major intervals after which a result has been dropped
_CLOCKS = 3  # a sample; cores that take more get fewer samples than `Least` says

Least = tuple[tuple[int, int], tuple[int, int]]
"""Major intervals and samples, so many at least, before the reset and after it."""

LEAST: Least = ((1, 200), (2, 400))
"""What a test bench runs that is handed out."""


class _Template(Template):
    delimiter = "%%"  # neither Verilog nor Markdown has it


def write_testbench(
    design: Design,
    folder: str | Path,
    timing: Timing,
    cells: Collection[str] = (),
    least: Least = LEAST,
) -> list[Path]:
    """Write NAME_tb.v, its two vector files and a README.md beside the design's NAME.v.

    The same design gives the same bytes.

    Args:
        design: the design.
        folder: where NAME.v lies; made if need be.
        timing: the core's clocks (`timing` in the manifest).
        cells: names of the vendor blocks whose models lie beside NAME.v.
        least: length of the run; slow cores get fewer samples.

    Returns:
        The files written.

    Raises:
        InputError: the folder cannot be made or written to.
    """
    files = testbench(design, timing, cells, least)
    folder = make_folder(folder)
    for name, text in files.items():
        with replacing(folder / name) as temporary:
            temporary.write_text(text, encoding="ascii", newline="\n")
    return [folder / name for name in files]


def testbench(
    design: Design, timing: Timing, cells: Collection[str], least: Least
) -> dict[str, str]:
    """The test bench's files, text by name; see `write_testbench`."""
    before, after = run_lengths(design, timing, least)
    samples = _samples(design, before, after)
    first = run_fast(design, samples[:before, :6], samples[:before, 6])
    second = run_fast(design, samples[before:, :6], samples[before:, 6])  # after a reset

    parts = words_per_result(design) if design.hardware.handover == "stream" else 1
    expected: list[tuple[int, ...]] = [*first.rows(), *second.rows()]
    results = len(expected)
    if design.hardware.handover == "stream":
        expected = [
            (word, int(i == parts))
            for row in expected
            for i, word in enumerate(to_words(design, row), start=1)
        ]

    # clocks that a sample and a result take at most, stalls and all
    slowest_sample = timing.spacing + max(timing.work, default=0) + 16
    slowest_result = timing.latency + parts * (timing.handover_spacing + 16) + 200
    clocks = 1000 + 2 * timing.startup + slowest_sample * len(samples) + slowest_result * results
    timeout = clocks * (2 if design.hardware.clock_enable else 1)
    numbers = {
        "name": design.name,
        "sources": " ".join(f"{name}.v" for name in (design.name, *cells)),
        "samples": len(samples),
        "before": before,
        "results": results,
        "results_before": len(first),
        "parts": parts,
        "timeout": timeout,
        **_contract(design, timing),
        **_port_texts(design),
        **_clocking(design),
    }
    return {
        f"{design.name}_tb.v": _fill("testbench.v.in", numbers),
        f"{design.name}_samples.hex": packed_hex(samples.tolist(), sample_ports(design)),
        f"{design.name}_expected.hex": packed_hex(expected, result_ports(design)),
        "README.md": _fill("testbench.md.in", numbers),
    }


def run_lengths(design: Design, timing: Timing, least: Least) -> tuple[int, int]:
    """Samples before and after the reset, as many as `testbench` takes with these arguments.

    Whole major intervals and a part of one (where one is more than a sample).
    """
    per_major = design.samples_per_major
    slowness = max(1, clocks_per_major(design, timing) // (_CLOCKS * per_major))
    if design.drops_results:  # one waits until some are dropped
        least = least[0], (max(least[1][0], _DROPPING), least[1][1])
    before, after = (
        max(intervals, -(-fewest // slowness // per_major)) * per_major + per_major // 2
        for intervals, fewest in least
    )
    return before, after


def _contract(design: Design, timing: Timing) -> dict[str, object]:
    """What the bench holds the ports to on every clock."""
    return {
        "per_major": design.samples_per_major,
        "phases": design.algorithm.samples,
        "latency": timing.latency,
        "spacing": timing.spacing,
        "startup": timing.startup,
        "handover_spacing": timing.handover_spacing,
        "results_at_once": timing.results,
        "work": "\n".join(
            f"      {phase}: work = {clocks};" for phase, clocks in enumerate(timing.work) if clocks
        ),
        "drops": int(design.drops_results),
        "claim": timing.dropping.claim if timing.dropping else 0,
        "refill": timing.dropping.refill if timing.dropping else timing.handover_spacing,
        "counter_max": COUNTER_MAX,
    }


def _port_texts(design: Design) -> dict[str, object]:
    """The Verilog that depends on the ports, and where they lie in the packed words."""
    inputs, outputs = sample_ports(design), result_ports(design)
    counters = counter_ports(design)
    at_once = design.hardware.resets_at_once
    stream = design.hardware.handover == "stream"
    return {
        "lost_part": words_per_column(design) if stream else 0,
        "lost_bit": (STATUS_LOST.bit_length() - 1) + (0 if stream else outputs[0].bits),
        "counters": "\n".join(f"  wire [{port.bits - 1}:0] {port.name};" for port in counters),
        "counter_connections": "\n".join(f"    .{port.name}({port.name})," for port in counters),
        "counter_checks": "\n".join(_counter_checks(counters, at_once=at_once)),
        "sample_bits": sum(port.bits for port in inputs),
        "result_bits": sum(port.bits for port in outputs),
        "declarations": "\n".join(_declarations(outputs)),
        "connections": ",\n".join(_connections(inputs, outputs)),
        "checks": "\n".join(_checks(outputs)),
        "expected": _STREAM_LINE if stream else _PARALLEL_LINE,
    }


def _clocking(design: Design) -> dict[str, object]:
    """The Verilog that depends on the reset's style and the clock enable."""
    hardware = design.hardware
    lines: list[str] = []
    in_reset = "rst"
    if hardware.resets_at_once:
        in_reset = "in_reset"
        lines += [
            f"  // a reset acts at once, and {RELEASE} clocks longer than it is asked for",
            f"  reg [{RELEASE - 1}:0] release_left;",
            "  wire in_reset = rst || release_left != 0;",
            "  always @(posedge clk or posedge rst)",
            f"    if (rst) release_left <= {{{RELEASE}{{1'b1}}}};",
            "    else release_left <= release_left >> 1;",
            f"  initial release_left = {{{RELEASE}{{1'b1}}}};",
            "  wire [31:0] want_lost_now = in_reset ? 0 : lost;",
            "  wire [31:0] want_dropped_now = in_reset ? 0 : dropped;",
        ]
    if hardware.clock_enable:
        lines += [
            "  // low at random: such clocks do not count",
            "  reg clk_en;",
            "  reg [15:0] clk_en_lfsr;",
            "  always @(posedge clk) begin",
            "    clk_en_lfsr <= {1'b0, clk_en_lfsr[15:1]}"
            " ^ (clk_en_lfsr[0] ? 16'hb400 : 16'h0000);",
            "    clk_en <= clk_en_lfsr[1] || (clk_en_lfsr[4] && clk_en_lfsr[9]);",
            "  end",
            "  initial begin",
            "    clk_en = 1'b0;",
            "    clk_en_lfsr = 16'hace1;",
            "  end",
        ]
    return {
        "clocking": "".join(f"{line}\n" for line in lines),
        "clocking_connections": "\n".join(f"    {each}," for each in clocking_connections(design)),
        "in_reset": in_reset,
        "not_in_reset": "!in_reset && " if hardware.resets_at_once else "",
        "when_counted": f"if (clk_en || {in_reset}) " if hardware.clock_enable else "",
    }


def clocking_connections(design: Design, clk_en: str = "clk_en") -> list[str]:
    """Connections of the reset, to `rst`, and of the clock enable, if there is one."""
    low = design.hardware.reset_active == "low"
    enables = [f".clk_en({clk_en})"] if design.hardware.clock_enable else []
    return [".rst_n(!rst)" if low else ".rst(rst)", *enables]


_STREAM_LINE = "one word of a result a line: `result_last` (top bit) and `result_data`"
_PARALLEL_LINE = (
    "one result a line: the ports from `result_sculling_between_z` (top) to `result_major`"
)


def _samples(design: Design, before: int, after: int) -> NDArray[np.int64]:
    """(before + after, 7) counts and fault for the samples before and after the reset.

    Every third major interval has half of its counts full-scale, some in long runs; the others
    come within one of full scale, every second of them with a single count that reaches it.  Every
    fourth has a faulty sample.
    """
    rng = random.Random(_SEED)
    words, span = design.words, design.samples_per_major
    allowed = [words.gyro] * 3 + [words.accel] * 3
    parts = []
    for part, samples in enumerate((before, after)):
        rows = _wild(rng, allowed, samples)
        for interval, first in enumerate(range(0, samples, span), start=part):
            mine = rows[first : first + span]
            if interval % 3:
                mine[:] = mine.clip([word.lo + 1 for word in allowed], [w.hi - 1 for w in allowed])
            if interval % 3 == 2:
                axis = rng.randrange(6)
                ends = (allowed[axis].lo, allowed[axis].hi)
                mine[rng.randrange(len(mine)), axis] = rng.choice(ends)
        faults = np.zeros((samples, 1), np.int64)
        for interval, first in enumerate(range(0, samples, span), start=part):
            if interval % 4 == 1:
                faults[first + rng.randrange(min(span, samples - first))] = 1
        parts.append(np.hstack([rows, faults]))
    return np.concatenate(parts)


def _wild(rng: random.Random, allowed: Sequence[Interval], count: int) -> NDArray[np.int64]:
    """(count, 6) random counts: half of them full-scale, some in long runs."""
    rows: list[list[int]] = []
    while len(rows) < count:
        held = [rng.choice((word.lo, word.hi)) for word in allowed]  # drives sums to their ends
        for _ in range(rng.choice((1, 2, 3, 40))):
            rows.append(
                [
                    rng.choice((end, end, word.lo, word.hi, rng.randint(-3, 3), uniform))
                    for end, word in zip(held, allowed, strict=True)
                    for uniform in [rng.randint(word.lo, word.hi)]
                ]
            )
    return np.array(rows[:count], np.int64)


def _fill(template: str, values: dict[str, object]) -> str:
    text = resources.files("sculler_sim").joinpath(template).read_text(encoding="ascii")
    return _Template(text).substitute(values)


def packed_hex(rows: Iterable[Iterable[int]], ports: Sequence[Port]) -> str:
    """One packed word a line for $readmemh, the first port in the lowest bits."""
    digits = -(-sum(port.bits for port in ports) // 4)
    lines = []
    for row in rows:
        word = shift = 0
        for value, port in zip(row, ports, strict=True):
            word |= (value & ((1 << port.bits) - 1)) << shift
            shift += port.bits
        lines.append(f"{word:0{digits}x}\n")
    return "".join(lines)


def _slices(ports: list[Port]) -> Iterator[tuple[Port, str]]:
    """Each port, and its place in the packed word."""
    low = 0
    for port in ports:
        yield port, f"[{low + port.bits - 1}:{low}]"
        low += port.bits


def _declarations(ports: list[Port]) -> Iterator[str]:
    for port, place in _slices(ports):
        kind = "signed " if port.signed else ""
        wanted = port.name.replace("result_", "want_")
        yield f"  wire {kind}[{port.bits - 1}:0] {port.name};"
        yield f"  wire {kind}[{port.bits - 1}:0] {wanted} = want{place};"


def _connections(inputs: list[Port], outputs: list[Port]) -> Iterator[str]:
    for port, place in _slices(inputs):
        yield f"    .{port.name}(sample{place})"
    for port in outputs:
        yield f"    .{port.name}({port.name})"


def _checks(ports: list[Port]) -> Iterator[str]:
    for name in (port.name for port in ports):
        wanted = name.replace("result_", "want_")
        yield f"    end else if (want_valid && {name} !== {wanted}) begin"
        yield f'      $display("FAIL: result %0d, word %0d, {name}: %0d, expected %0d",'
        yield f"               results, part, {name}, {wanted});"
        yield "      fail;"


_COUNTED = {"samples_lost": "lost", "results_dropped": "dropped"}
"""What the bench counts of what each port does."""


def _counter_checks(ports: list[Port], *, at_once: bool) -> Iterator[str]:
    for port in ports:
        counted = _COUNTED[port.name]
        if at_once:
            counted = f"want_{counted}_now"
        yield f"    end else if ({port.name} !== {counted}[{port.bits - 1}:0]) begin"
        yield f'      $display("FAIL: clock %0d, {port.name}: %0d, expected %0d",'
        yield f"               clock, {port.name}, {counted});"
        yield "      fail;"
