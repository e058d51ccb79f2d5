"""Memories of more words than fill a block of the ECP5: banks with the blocks' own registers."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest

from bench_files import shell
from sculler_hdl.export.component import component_verilog
from sculler_hdl.lib.memory import BlockMemory, bank_shares
from sculler_hdl.plan.ports import Port
from sculler_hdl.targets import TARGETS, cell_models

DEPTH = {18: 1024, 9: 2048, 4: 4096, 2: 8192, 1: 16384}


@pytest.mark.parametrize(
    "words", [1, 1024, 1025, 2049, 4096, 5000, 8192, 8320, 16384, 16385, 65600]
)
def test_banks_hold_the_words_and_begin_at_multiples_of_their_depths(words: int) -> None:
    depths = [DEPTH[share] for share in bank_shares(words, 18)]
    assert sum(depths) >= words > sum(depths[:-1])
    assert all(sum(depths[:bank]) % depth == 0 for bank, depth in enumerate(depths))


@pytest.mark.parametrize(
    ("words", "blocks"),
    [
        (2049, 2 + 1),  # 2048 words of 9 bits twice, 1024 of 18
        (8192, 9),  # of 2 bits
        (8320, 9 + 1),
        (16384, 18),  # of 1 bit
        (32768 + 128, 2 * 18 + 1),
    ],
)
def test_how_many_blocks(words: int, blocks: int) -> None:
    text = emitted(words)
    assert len(re.findall(r"^  DP16KD #", text, re.M)) == blocks


def emitted(words: int) -> str:
    part = BlockMemory(TARGETS["ecp5"], 18, [0] * words)
    bits = (words - 1).bit_length()
    inputs = {"clk": 1, "step": 1, "address": bits}
    inputs |= {"write": 1, "write_address": bits, "write_data": 18}
    ports = [Port(name, width, told=name) for name, width in inputs.items()]
    ports.append(Port("data", 18, output=True, told="data"))
    return component_verilog(part, "memory", ports, ["a memory"])


@pytest.mark.usefixtures("icarus")
@pytest.mark.parametrize("words", [8320, pytest.param(40_000, marks=pytest.mark.deep)])
def test_words_come_two_steps_later_from_whichever_bank(words: int, tmp_path: Path) -> None:
    """Beside words and two registers, near the banks' ends and anywhere."""
    rng = random.Random(words)
    near = sorted({0, 1, 1023, 2047, 4095, 8191, 8192, 16383, 16384, 32767, 32768, words - 1})
    near = [address for address in near if address < words]
    steps = []
    for _ in range(3000):
        read, write = (rng.choice((rng.choice(near), rng.randrange(words))) for _ in "rw")
        stores = read != write and rng.random() < 0.6
        steps.append((rng.random() < 0.8, read, stores, write, rng.randrange(1 << 18)))
    rows = "\n".join(f"{s:b}{r:016b}{w:b}{a:016b}{d:018b}" for s, r, w, a, d in steps)
    (tmp_path / "steps").write_text(rows)
    (tmp_path / "memory.v").write_text(emitted(words))
    (tmp_path / "DP16KD.v").write_text(cell_models()["DP16KD"])
    bits = (words - 1).bit_length()
    (tmp_path / "bench.v").write_text(
        f"""module bench;
          reg clk = 0; reg [51:0] steps [0:{len(steps) - 1}], now; reg [17:0] words [0:{words - 1}];
          reg [17:0] first, second; wire [17:0] data;
          integer i, compared = 0, wrong = 0;
          memory m (.clk(clk), .step(now[51]), .address(now[{34 + bits}:35]), .write(now[34]),
                    .write_address(now[{17 + bits}:18]), .write_data(now[17:0]), .data(data));
          initial begin
            $readmemb("steps", steps);
            for (i = 0; i < {words}; i = i + 1) words[i] = 0;
            first = 18'bx; second = 18'bx;
            for (i = 0; i < {len(steps)}; i = i + 1) begin
              now = steps[i];
              #5;
              if (now[51]) begin second = first; first = words[now[50:35]]; end
              if (now[34]) words[now[33:18]] = now[17:0];
              clk = 1; #5 clk = 0;
              if (^second !== 1'bx) begin
                compared = compared + (second != 0);
                wrong = wrong + (data !== second);
              end
            end
            $display("%0d wrong, %0s", wrong, compared > 500 ? "many words" : "too few words");
          end
        endmodule"""
    )
    done = shell("iverilog -g2005 -o b bench.v memory.v DP16KD.v && vvp -n b", tmp_path)
    assert done.stdout == "0 wrong, many words\n", done.stdout + done.stderr
