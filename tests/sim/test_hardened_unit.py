"""A hardened core behind a bus: an upset is told by status bit 4, `faults` and the port `upset`."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from bench_files import unit_sources
from sculler_model.design import STATUS_UPSET, Design
from sculler_model.golden import GoldenModel
from strategies import make_design, samples_of
from tiers import few_of

needs_icarus = pytest.mark.skipif(
    shutil.which("iverilog") is None, reason="Icarus Verilog is not installed"
)
pytestmark = needs_icarus

# where the newest sample stands in a copy's memory
FLIP = "unit.core.copy1.engine.newest[0] = ~unit.core.copy1.engine.newest[0];"
RESULTS = 10


def hard(hardening: str, result: str, **bus: object) -> Design:
    hardware = {
        "core": "compact",
        "hardening": hardening,
        "bus": {"result": result, "time_stamps": False, **bus},
    }
    return make_design("narrow", 2, 1, 2, (8, 8), hardware=hardware)


BENCH = """
module bench;
  reg clk = 0, rst = 1;
  always #5 clk = !clk;
  reg [47:0] samples [0:{samples} - 1];
  initial $readmemh("samples.hex", samples);
  integer taken = 0, result, word;
  wire [47:0] sample = samples[taken % {samples}];
  wire ready, upset;
  always @(posedge clk) if (!rst && ready) taken <= taken + 1;
{host}
  initial begin
    repeat (4) @(negedge clk);
    rst = 0;
    for (result = 0; result < {results}; result = result + 1) begin
      if (result == 2) {flip}
      $write("result");
      for (word = 0; word < {words}; word = word + 1) take;
      $display(" upset %0d", upset);
    end
    finish;
  end
  initial begin
    #20_000_000 $display("late");
    $finish;
  end
endmodule
"""

PORTS = """
  narrow_unit unit (
    .clk(clk), .rst(rst), .sample_valid(!rst), .sample_ready(ready), .sample_fault(1'b0),
    .sample_gyro_x(sample[47:40]), .sample_gyro_y(sample[39:32]), .sample_gyro_z(sample[31:24]),
    .sample_accel_x(sample[23:16]), .sample_accel_y(sample[15:8]), .sample_accel_z(sample[7:0]),
    .upset(upset), {more}
  );
"""

PACKETS = (
    PORTS.format(
        more=".m_axis_tvalid(valid), .m_axis_tready(go), .m_axis_tdata(data), .m_axis_tuser(user)"
    )
    + """
  wire valid;
  reg go = 0;
  wire [31:0] data;
  wire [4:0] user;
  task take;
    begin
      while (!valid) @(negedge clk);
      $write(" %h %0d", data, user);
      go = 1;
      @(negedge clk);
      go = 0;
    end
  endtask
  task finish; $finish; endtask
"""
)

REGISTERS = (
    PORTS.format(
        more=".s_apb_psel(sel), .s_apb_penable(enable), .s_apb_pwrite(write), .s_apb_paddr(at),"
        " .s_apb_pwdata(out), .s_apb_pstrb({4{write}}), .s_apb_pready(done), .s_apb_prdata(data),"
        " .irq(irq)"
    )
    + """
  reg sel = 0, enable = 0, write = 0;
  reg [11:0] at = 0;
  reg [31:0] out = 0, got;
  wire done, irq;
  wire [31:0] data;
  task access(input [11:0] address, input writes, input [31:0] value);
    begin
      {at, write, out, sel} = {address, writes, value, 1'b1};
      @(negedge clk);
      enable = 1;
      @(posedge clk);
      while (!done) @(posedge clk);
      got = data;
      @(negedge clk);
      {sel, enable} = 0;
    end
  endtask
  task take;
    begin
      if (word == 0) begin
        got = 0;
        while (!got[0]) access('h18, 0, 0);
      end
      access('h800 + 4 * word, 0, 0);
      $write(" %h %0d", got, irq);
      if (word == WORDS - 1) access('h28, 1, 1);
    end
  endtask
  task finish;
    begin
      access('h1c, 0, 0);
      $display("faults %0d", got);
      access('h1c, 1, 'h10);
      access('h1c, 0, 0);
      $display("cleared %0d", got);
      access('h20, 1, 2);
      repeat (3) @(negedge clk);
      $display("irq %0d", irq);
      $finish;
    end
  endtask
"""
)


def run(design: Design, folder: Path, flip: str) -> list[list[str]]:
    """What the bench says, line by line, in words."""
    counts, _ = samples_of(design, RESULTS * design.samples_per_major + 40, 5)
    words = len(design.columns)
    host = PACKETS if design.hardware.bus.result == "axi-stream" else REGISTERS  # type: ignore[union-attr]
    text = BENCH.format(
        samples=len(counts), host=host, results=RESULTS, words=words, flip=flip or ";"
    )
    (folder / "bench.v").write_text(text.replace("WORDS", str(words)))
    hexes = ("".join(f"{int(count) & 0xFF:02x}" for count in row) for row in counts)
    (folder / "samples.hex").write_text("".join(f"{line}\n" for line in hexes))
    sources = [path.name for path in unit_sources(design, folder)]
    command = ["iverilog", "-g2005", "-o", "bench", "bench.v", *sources]
    subprocess.run(command, cwd=folder, check=True)
    done = subprocess.run(
        ["vvp", "-n", "bench"], cwd=folder, check=True, capture_output=True, text=True
    )
    return [line.split() for line in done.stdout.splitlines()]


def golden(design: Design) -> list[list[int]]:
    counts, _ = samples_of(design, RESULTS * design.samples_per_major + 40, 5)
    samples = ((row[:3], row[3:], False) for row in (tuple(map(int, row)) for row in counts))
    return [list(row.row()) for row in GoldenModel(design).run(samples)][:RESULTS]


CASES = {
    "detect, packets": hard("detect", "axi-stream"),
    "recover, packets": hard("recover", "axi-stream"),
    "detect, registers": hard("detect", "apb"),
    "recover, registers": hard("recover", "apb"),
}


@pytest.mark.parametrize("design", few_of(CASES, ["recover, packets"]))
def test_an_upset_is_told_to_the_host(design: Design, tmp_path: Path) -> None:
    """Two results are taken before it; the vectors are the golden model's in all of them."""
    said = run(design, tmp_path, FLIP)
    rows = [line for line in said if line[0] == "result"]
    words = [[int(word, 16) for word in row[1:-2:2]] for row in rows]
    marked = []
    for number, (row, right) in enumerate(zip(words, golden(design), strict=True)):
        marked += [number] * (row[1] == right[1] | STATUS_UPSET)
        assert row[1] & 15 == right[1]
        assert [row[0], *row[2:]] == [right[0], *(value & 0xFFFF_FFFF for value in right[2:])]
    told = [number for number, row in enumerate(rows) if row[-1] == "1"]
    assert marked[0] in (2, 3)
    assert marked == list(range(marked[0], marked[-1] + 1))
    assert marked[-1] < RESULTS - 1  # what it spoilt is over
    assert told
    if len(said) == RESULTS:  # packets: the status stands beside every word
        for row, word in zip(rows, words, strict=True):
            assert set(map(int, row[2:-2:2])) == {word[1]}
        return
    assert said[RESULTS][0] == "faults"
    assert int(said[RESULTS][1]) & STATUS_UPSET
    assert said[RESULTS + 1] == ["cleared", str(int(said[RESULTS][1]) & ~STATUS_UPSET)]


@pytest.mark.deep
@pytest.mark.parametrize("name", CASES)
def test_without_one_nothing_is_told(name: str, tmp_path: Path) -> None:
    design = CASES[name]
    said = run(design, tmp_path, "")
    assert [line[0] for line in said[:RESULTS]] == ["result"] * RESULTS
    for line, right in zip(said[:RESULTS], golden(design), strict=True):
        assert int(line[3], 16) == right[1]
        assert line[-1] == "0"
    for line in said[RESULTS:]:
        assert (line[0], int(line[1]) & STATUS_UPSET) != ("faults", STATUS_UPSET)
