"""From a motion to vectors over the sensor's wire: the unit's results are the golden model's.

`sculler motion` gives counts, an independent maker their datagrams, a line at the real baud rate
carries them, some damaged, to NAME_unit in Icarus: front end, core and bus.
"""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import raw_datagrams
from front_bench import needs_icarus
from front_runs import COUNTERS, edges
from sculler.formats.log import read_log
from sculler.main import main
from sculler_hdl import generate
from sculler_model.design import Design
from sculler_model.golden import GoldenModel

_BENCH = """
module bench;
  reg clk = 0, rst = 1, rx = 1;
  integer file, found, clock, level, now = 0;
  wire packet_valid, packet_last;
  wire [31:0] packet_data;
  {name}_unit unit (.clk(clk), .rst(rst), .rx(rx), .pulse(1'b0), .packet_ready(1'b1),
    .packet_valid(packet_valid), .packet_data(packet_data), .packet_last(packet_last),
    .packet_status(), .samples_lost(), .sample_latency());
  always #5 clk = !clk;
  initial begin
    file = $fopen("edges.txt", "r");
    found = $fscanf(file, "%d %d\\n", clock, level);
    repeat (4) @(negedge clk);
    rst = 0;
    while (now < {clocks}) begin
      if (found == 2 && clock == now) begin
        rx = level;
        found = $fscanf(file, "%d %d\\n", clock, level);
      end
      @(posedge clk);
      if (packet_valid) $display("%0d %0d", packet_last, packet_data);
      @(negedge clk);
      now = now + 1;
    end
    $display("counters {formats}", {counters});
    $finish;
  end
endmodule
"""


def run_unit(design: Design, folder: Path, line: list[tuple[int, int]], clocks: int) -> Any:
    """Packets, each a list of words; and the counters at the end."""
    made = generate(design)
    files = {f"{design.name}.v": made.verilog, **made.further}
    files = {name: text for name, text in files.items() if name.endswith(".v")}
    files |= {f"{cell}.v": text for cell, text in made.cells.items()}
    files["bench.v"] = _BENCH.format(
        name=design.name,
        clocks=clocks,
        formats=" ".join(["%0d"] * len(COUNTERS)),
        counters=", ".join(f"unit.{name}" for name in COUNTERS),
    )
    for name, text in files.items():
        (folder / name).write_text(text)
    (folder / "edges.txt").write_text("".join(f"{at} {level}\n" for at, level in line))
    build = ["iverilog", "-g2005", "-o", "bench", *files]
    subprocess.run(build, cwd=folder, check=True)
    done = subprocess.run(
        ["vvp", "-n", "bench"], cwd=folder, check=True, capture_output=True, text=True
    )
    packets: list[list[int]] = [[]]
    *words, last = [each.split() for each in done.stdout.splitlines()]
    for ends, word in words:
        packets[-1].append(int(word))
        if ends == "1":
            packets.append([])
    return packets[:-1], dict(zip(COUNTERS, map(int, last[1:]), strict=True))


def rows_of(design: Design, packets: list[list[int]]) -> list[list[int]]:
    """The columns of each packet."""
    widest = max(getattr(design.words, name).bits for name in design.vectors)
    count = -(-widest // 32)
    rows = []
    for packet in packets:
        row = []
        for number in range(len(design.columns)):
            words = packet[count * number : count * number + count]
            value = sum(word << 32 * place for place, word in enumerate(words))
            top = 1 << (32 * count - 1)
            row.append(value - 2 * top if number > 1 and value & top else value)
        rows.append(row)
    return rows


SMALL = {"algorithm": {"samples": 2, "minors": 2}, "clock": 16 * 921600.0, "samples": 18}
WHOLE = {"algorithm": {"samples": 4, "minors": 5}, "clock": 50e6, "samples": 65}


@needs_icarus
@pytest.mark.parametrize(
    "job", [SMALL, pytest.param(WHOLE, marks=pytest.mark.deep)], ids=["small", "whole"]
)
def test_vectors_of_the_wire_are_those_of_the_model(job: dict[str, Any], tmp_path: Path) -> None:
    text = "\n".join(
        [
            'preset = "stim300"\nname = "wired"\n[algorithm]',
            *(f"{key} = {value}" for key, value in job["algorithm"].items()),
            '[hardware]\ncore = "compact"\n[hardware.bus]\nresult = "stream"\n[hardware.front]',
            f'sensor = "stim300"\nclock_hz = {job["clock"]}',
        ]
    )
    (tmp_path / "wired.toml").write_text(text)
    design = Design.load(tmp_path / "wired.toml")
    assert design.front is not None
    log, truth = tmp_path / "imu.csv", tmp_path / "truth.csv"
    count = job["samples"]
    words = ["--design", tmp_path / "wired.toml", "-o", log, "--truth", truth]
    assert main(["motion", "demo", *map(str, words), "--duration", str(count / 2000 + 0.02)]) == 0
    counts = np.concatenate([chunk.counts for chunk in read_log(log, design)])[:count].tolist()

    stream: list[tuple[int, int]] = []
    expected: list[Any] = []
    damaged, lost, marked = {5}, {9, 10}, {12}
    for number, row in enumerate(counts):
        status = 0x40 if number in marked else 0
        frame = bytearray(raw_datagrams.stim300(row[:3], row[3:], number, status=status))
        if number in damaged:
            frame[14] ^= 0x10
        at = 300 + number * design.front.interval
        per_byte = 10 * job["clock"] / 921600
        if number not in lost:
            stream += [(round(at + place * per_byte), b) for place, b in enumerate(frame)]
        held = number in damaged | lost
        kept = expected[-1][:2] if held else (tuple(row[:3]), tuple(row[3:]))
        expected.append((*kept, held or number in marked))
    end = 300 + (count + 1) * design.front.interval
    packets, counters = run_unit(design, tmp_path, edges(design, stream), end)
    model = [list(result.row()) for result in GoldenModel(design).run(expected)]
    assert len(model) == count // design.samples_per_major
    assert rows_of(design, packets) == model
    assert counters == {
        "frames_taken": count - 3,
        "frames_bad": 1,
        "frames_missed": 3,
        "frames_late": 0,
        "sensor_faults": 1,
    }
