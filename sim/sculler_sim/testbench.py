"""The self-checking Verilog-2001 test bench of a design, with its golden vectors.

It needs no Python to run: any simulator of Verilog-2001 does.  Inside,

* samples come from a file (`bench_runs`): random counts, in some intervals all at their rails, in
  others one alone or none, and faults; an LFSR stalls both handshakes, and every other result waits
  until it holds up the samples, the first of them longer than any latency;
* offers that are not taken are sometimes withdrawn, so that samples are lost; which, the bench sees
  for itself, and holds status bit 3 and `samples_lost` to it;
* where the core drops results, some wait until others have been dropped behind them; of intervals
  that are made for something none is dropped (`bench_dropping`);
* resets, in which a sample is offered, come in mid-interval, at each clock that a result is on its
  way, while it is handed over and while it waits; the rest of the samples then starts from nothing;
* counters are set from inside, when nothing is under way, to just below where a carry runs through
  a limb of the result's number, or where those of losses stay;
* what has to have happened by the end is a list of goals, and the bench fails where one was not
  reached;
* every result port is compared with the golden model's, bit for bit, when the result (or a word
  of it) comes and for as long as it waits;
* `sample_ready` and `result_valid` are held to the core's `Timing` on every clock, and no result
  may come too many;
* where the core has a clock enable, it is low at random, and such clocks do not count;
* a line beginning with PASS or FAIL ends it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

from sculler_hdl import Port, counter_ports, result_ports, sample_ports
from sculler_model.design import STATUS_LOST, Design
from sculler_model.fast import run_fast
from sculler_model.golden import (
    COUNTER_MAX,
    RELEASE,
    ChannelTiming,
    PipelinedChannelTiming,
    Timing,
    to_words,
    words_per_column,
    words_per_result,
)
from sculler_model.outputs import make_folder, replacing
from sculler_sim.bench_compensation import compensation_texts
from sculler_sim.bench_dropping import dropping_texts
from sculler_sim.bench_goals import goals_of, inside, numbering
from sculler_sim.bench_runs import (
    LEAST,
    PATTERN,
    Kind,
    Least,
    Run,
    carries,
    number_bits,
    numbers,
    plan_runs,
    run_lengths,
    samples_of,
    stages,
)
from sculler_sim.bench_text import (
    checks,
    clocking_connections,
    connections,
    declarations,
    fill,
    packed_hex,
)
from sculler_sim.channel_bench import channel_bench

__all__ = ["LEAST", "Least", "run_lengths", "testbench", "write_testbench"]


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
    if design.compensation is not None:  # its goals and resets are those of a core without
        least = least._replace(resets=0)
    if isinstance(timing, ChannelTiming | PipelinedChannelTiming):
        files = channel_bench(design, timing, cells)
    else:
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
    runs = plan_runs(design, timing, least)
    samples = samples_of(design, runs)
    golden = [run_fast(design, rows[:, :6], rows[:, 6]) for rows in samples]  # each after a reset
    expected = [row for results in golden for row in results.rows()]

    results = len(expected)
    parts = words_per_result(design) if design.hardware.handover == "stream" else 1
    if design.hardware.handover == "stream":
        expected = [
            (word, int(i == parts))
            for row in expected
            for i, word in enumerate(to_words(design, row), start=1)
        ]
    taken = sum(run.samples for run in runs)
    clocking = _clocking(design)
    values = {
        "name": design.name,
        "sources": " ".join(f"{name}.v" for name in (design.name, *cells)),
        "samples": taken,
        "results": results,
        "parts": parts,
        "timeout": _timeout(design, timing, runs, results * parts),
        **_runs(design, timing, runs),
        **goals_of(design, timing, aimed=least.resets > 0, shown=runs[1].shown == PATTERN),
        "setters": inside(design, timing, cells) if least.resets else "",
        "numbering": numbering(design),
        **_contract(design, timing),
        **_port_texts(design),
        **clocking,
        **compensation_texts(timing, clocking),
        **dropping_texts(design, runs, clocking),
    }
    # the counters of a hardened core are several, which agree
    alone = "`define SCULLER_PORTS_ONLY\n" if design.hardware.hardening else ""
    return {
        f"{design.name}_tb.v": alone + fill("testbench.v.in", values),
        f"{design.name}_samples.hex": packed_hex(
            (row for rows in samples for row in rows.tolist()), sample_ports(design)
        ),
        f"{design.name}_expected.hex": packed_hex(expected, result_ports(design)),
        "README.md": fill("testbench.md.in", values),
    }


def _timeout(design: Design, timing: Timing, runs: Sequence[Run], words: int) -> int:
    """Clocks that the runs take at most, stalls and all."""
    slowest_sample = timing.spacing + max(timing.work, default=0) + timing.before + 16
    slowest_word = timing.latency + timing.handover_spacing + 216
    clocks = 1000 + slowest_word * words
    for run in runs:
        clocks += slowest_sample * run.samples + run.delay + timing.startup + 3 * timing.latency
    return clocks * (2 if design.hardware.clock_enable else 1)


def _runs(design: Design, timing: Timing, runs: Sequence[Run]) -> dict[str, object]:
    """The table of the runs, and that of the numbers that are set."""
    lines, samples, results = [], 0, 0
    for number, run in enumerate(runs):
        samples += run.samples
        results += run.samples // design.samples_per_major
        lines.append(
            f"      {number}: plan_of = {{32'd{samples}, 32'd{results}, 32'd{run.delay},"
            f" 4'd{run.reset}, 4'd{list(Kind).index(run.kind)}}};"
        )
    bits, found = number_bits(design), numbers(design, timing)
    return {
        "runs": len(runs),
        "resets": len(runs),  # the one at power-up too
        "stages": stages(runs),
        "plans": "\n".join(lines),
        "number_bits": bits,
        "numbers": len(found),
        "carries": carries(design, timing),
        "number_cases": "\n".join(
            f"      {i}: number_of = {bits}'h{number:x};" for i, number in enumerate(found)
        ),
    }


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
    ends = f"`{outputs[-1].name}` (top) to `{outputs[0].name}`"
    return {
        "lost_part": words_per_column(design) if stream else 0,
        "lost_bit": (STATUS_LOST.bit_length() - 1) + (0 if stream else outputs[0].bits),
        "counters": "\n".join(f"  wire [{port.bits - 1}:0] {port.name};" for port in counters),
        "counter_connections": "\n".join(f"    .{port.name}({port.name})," for port in counters),
        "counter_checks": "\n".join(_counter_checks(counters, at_once=at_once)),
        "sample_bits": sum(port.bits for port in inputs),
        "result_bits": sum(port.bits for port in outputs),
        "declarations": "\n".join(declarations(outputs)),
        "connections": ",\n".join(connections(inputs, outputs)),
        "checks": "\n".join(checks(outputs)),
        "expected": _STREAM_LINE if stream else f"one result a line: the ports from {ends}",
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


_STREAM_LINE = "one word of a result a line: `result_last` (top bit) and `result_data`"


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
