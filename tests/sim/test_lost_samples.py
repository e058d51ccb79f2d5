"""A sensor that cannot wait: what it offers and the core does not take is counted and told.

In Verilog by hand, with neither the cycle model nor the generated bench; and the counters' end.
"""

from __future__ import annotations

import re

import pytest

from amaranth_runs import drive
from bench_files import shell
from sculler_hdl.lib import losses
from sculler_hdl.lib.losses import Losses
from sculler_sim.engines.verilator_build import emitted
from strategies import make_design, with_hardware

OVERRUN = """
// One strobe every 150 clocks; the host sleeps for 2000 clocks once.
module overrun;
  reg clk = 0, rst = 1, sv = 0, rr = 1;
  always #5 clk = !clk;
  integer i, offered = 0, taken = 0, untold = 0, results = 0, part = 0;
  wire r, v;
  wire [15:0] lost;
  %(wires)s
  %(name)s core(.clk(clk), .rst(rst), .sample_valid(sv), .sample_ready(r), .sample_gyro_x(8'd3),
    .sample_gyro_y(8'd5), .sample_gyro_z(8'd7), .sample_accel_x(8'd1), .sample_accel_y(8'd2),
    .sample_accel_z(8'd9), .sample_fault(1'b0), .result_valid(v), .result_ready(rr),
    .samples_lost(lost), %(ports)s);
  initial begin
    repeat (4) @(negedge clk);
    rst = 0;
    repeat (300) @(negedge clk);
    for (i = 0; i < 15000; i = i + 1) begin
      sv = i %% 150 == 0;
      rr = !(i > 3000 && i < 5000);
      #1;
      if (sv) begin
        offered = offered + 1;
        if (r) begin
          taken = taken + 1;
          if (taken %% 2 == 0) begin
            $display("interval %%0d untold %%0d", taken / 2 - 1, untold);
            untold = 0;
          end
        end else untold = untold + 1;
      end
      if (v && rr) begin
        if (%(at_status)s) $display("result %%0d status %%0d", results, %(status)s);
        if (%(last)s) begin results = results + 1; part = 0; end else part = part + 1;
      end
      @(negedge clk);
    end
    $display("offered %%0d taken %%0d lost %%0d", offered, taken, lost);
    $finish;
  end
endmodule
"""
STREAM = {
    "wires": "wire [15:0] data; wire last;",
    "ports": ".result_data(data), .result_last(last)",
    "at_status": "part == 2",
    "status": "data",
    "last": "last",
}
PARALLEL = {
    "wires": "wire [3:0] status;",
    "ports": ".result_status(status)",
    "at_status": "1",
    "status": "status",
    "last": "1",
}


@pytest.mark.parametrize(
    ("hardware", "wiring"),
    [
        ({"core": "compact"}, STREAM),
        ({"core": "compact", "target": "ice40"}, STREAM),
        ({"core": "pipelined"}, PARALLEL),
        ({"core": "pipelined", "handover": "stream"}, STREAM),
    ],
    ids=["compact", "compact-ice40", "pipelined", "streaming"],
)
def test_a_host_that_sleeps(icarus, tmp_path, hardware, wiring):
    design = make_design("sleepy", 1, 1, 2, (8, 8))
    design = with_hardware(design, **hardware)
    files = emitted(design)
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "overrun.v").write_text(OVERRUN % {"name": design.name, **wiring})
    sources = " ".join(["overrun.v", *files])
    done = shell(f"iverilog -g2005 -s overrun -o run.vvp {sources} && vvp -n run.vvp", tmp_path)
    offered, taken, lost = map(int, re.findall(r"\d+", done.stdout.splitlines()[-1]))
    assert offered == 100
    assert lost == offered - taken
    # asleep for 2000 clocks, 13 strobes: one result waits, a second sample ends the next interval
    assert 9 <= lost <= 13
    untold = [int(count) for count in re.findall(r"interval \d+ untold (\d+)", done.stdout)]
    status = [int(bits) for bits in re.findall(r"result \d+ status (\d+)", done.stdout)]
    assert len(status) >= 40
    assert [bits & 8 for bits in status] == [8 * (count > 0) for count in untold[: len(status)]]
    assert sum(count > 0 for count in untold[: len(status)]) == 1
    assert sum(bits & 7 for bits in status) == 1  # the first interval's short history


def test_the_counter_stays_at_its_highest(monkeypatch):
    monkeypatch.setattr(losses, "COUNTER_BITS", 3)
    part, seen = Losses(), []

    async def bench(ctx):
        for clock in range(40):
            ctx.set(part.sample_valid, clock % 2)
            _, _, count = await ctx.tick().sample(part.count)
            seen.append(count)

    drive(part, bench)
    # offered in clock 1, withdrawn in 2, counted from 4 on, and so every second clock
    assert seen == [min(max(clock - 2, 0) // 2, 7) for clock in range(40)]
