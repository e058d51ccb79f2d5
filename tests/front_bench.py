"""The emitted front end in Icarus Verilog, its pins driven from a file of edges."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterable
from pathlib import Path

import pytest

from front_runs import COUNTERS, PORTS, Run
from sculler_hdl import front_ports
from sculler_model.design import Design

needs_icarus = pytest.mark.skipif(
    not shutil.which("iverilog"), reason="Icarus Verilog is not installed"
)

_BENCH = """
module bench;
  reg clk = 0, rst = 1;
  reg rx = 1;
  reg sample_ready = 1;
  integer file, found, clock, level, now = 0, last, busy = {busy};
{wires}
  {name} front (.clk(clk), .rst(rst), .rx(rx), .sample_ready(sample_ready){ports});
  always #5 clk = !clk;
  initial begin
    file = $fopen("edges.txt", "r");
    found = $fscanf(file, "%d %d\\n", clock, level);
    @(negedge clk);
    @(negedge clk);
    rst = 0;
    while (now < {clocks}) begin
      if (found == 2 && clock == now) begin
        rx = level;
        found = $fscanf(file, "%d %d\\n", clock, level);
      end
      sample_ready = busy == 0 || now % busy == 0;
      @(posedge clk);
      if (sample_valid && sample_ready) $display("sample %0d {samples}", now, {sample_ports});
      if (sample_instant) $display("instant %0d", now);
      @(negedge clk);
      now = now + 1;
    end
    $display("counters {counters}", {counter_ports});
    $finish;
  end
endmodule
"""


def run_verilog(
    design: Design,
    verilog: str,
    edges: Iterable[tuple[int, int]],
    clocks: int,
    folder: Path,
    busy: int = 0,
) -> Run:
    """As `front_runs.run_line`; with `busy` the core takes a sample in every so manieth clock."""
    outputs = [port for port in front_ports(design) if port.output]
    shown = [*PORTS, "sample_fault"]
    text = _BENCH.format(
        name=f"{design.name}_front",
        busy=busy,
        clocks=clocks,
        wires="\n".join(
            f"  wire {'signed ' if port.signed else ''}[{port.bits - 1}:0] {port.name};"
            for port in outputs
        ),
        ports="".join(f", .{port.name}({port.name})" for port in outputs),
        samples=" ".join(["%0d"] * len(shown)),
        sample_ports=", ".join(shown),
        counters=" ".join(["%0d"] * len(COUNTERS)),
        counter_ports=", ".join(COUNTERS),
    )
    (folder / "bench.v").write_text(text)
    (folder / "front.v").write_text(verilog)
    (folder / "edges.txt").write_text("".join(f"{at} {level}\n" for at, level in edges))
    build = ["iverilog", "-g2005", "-o", "bench", "bench.v", "front.v"]
    subprocess.run(build, cwd=folder, check=True)
    done = subprocess.run(
        ["vvp", "-n", "bench"], cwd=folder, check=True, capture_output=True, text=True
    )
    lines = [line.split() for line in done.stdout.splitlines()]
    samples = [list(map(int, line[1:])) for line in lines if line[0] == "sample"]
    return Run(
        [(tuple(sample[1:7]), sample[7]) for sample in samples],
        [sample[0] for sample in samples],
        [int(line[1]) for line in lines if line[0] == "instant"],
        dict(zip(COUNTERS, map(int, lines[-1][1:]), strict=True)),
    )
