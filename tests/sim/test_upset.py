"""After a reset the compact core is right whatever its memories held; and no X is left in any core.

In Icarus Verilog, on the text as it is handed out.
"""

import re
import subprocess
from typing import NamedTuple

import pytest

from bench_files import bench_of, modules_of, places, shell
from position_designs import HIGH_RESOLUTION
from sculler_hdl import sample_ports, timing
from sculler_hdl.plan.compact.plan import plan_compact
from sculler_sim.engines.verilator_build import emitted
from strategies import DESIGNS, make_design, with_hardware
from tiers import tiers

pytestmark = pytest.mark.usefixtures("icarus")


class Words(NamedTuple):
    """A memory that the core writes: how simulators reach it, bits of a word and words."""

    path: str
    width: int
    depth: int


def writable(text):
    """The memories of a core's Verilog; the program's is never written."""
    modules = modules_of(text)
    found = []
    for kind, path in places(next(iter(modules)), modules):
        if kind == "DP16KD":
            found.append(Words(f"{path}.memory", 18, 1024))
        declared = re.findall(r" reg \[(\d+):0\] (\w+) \[(\d+):0\];$", modules.get(kind, ""), re.M)
        found += [
            Words(f"{path}.{name}", int(top) + 1, int(last) + 1) for top, name, last in declared
        ]
    kept = [words for words in found if "program" not in words.path]
    owners = {re.sub(r"_?\d+$", "", words.path.rpartition(".")[0]) for words in kept}
    assert len(owners) == 4, owners
    assert len(found) > 4
    return kept


def spoiling(design, core, level):
    """Statements that fill every memory of an instance with a level."""
    lines = [
        f"for (i = 0; i < {words.depth}; i = i + 1) {core}.{words.path}[i] = {level};"
        for words in writable(emitted(design)[f"{design.name}.v"])
    ]
    return "\n".join(lines)


def compact(design, **hardware):
    return with_hardware(design, core="compact", **hardware)


CN1 = make_design("cn1", 1, 1, 2, (8, 8))
SHAPES = {
    f"{design.name}-{'-'.join(map(str, hardware.values()))}": compact(design, **hardware)
    for design, targets in (
        (CN1, ("generic", "ecp5", "ice40", "xilinx")),
        (DESIGNS["stim300_4x5"], ("ecp5", "ice40")),
        (DESIGNS["dense_odd_3"], ("generic",)),
        (HIGH_RESOLUTION["smallest_hr"], ("generic", "ecp5", "ice40", "xilinx")),
    )
    for target in targets
    for hardware in ({"target": target}, {"target": target, "multipliers": 0})
    if design.name != "stim300_4x5" or len(hardware) == 1  # a long run without a multiplier
} | {
    f"{CN1.name}-{target}-drop": compact(CN1, target=target, overrun="drop-result")
    for target in ("generic", "ecp5")
}
SHAPES[f"{CN1.name}-async"] = compact(CN1, reset="async")


@pytest.mark.parametrize("design", tiers(SHAPES))
def test_a_reset_undoes_an_upset_of_every_word(design, tmp_path):
    """The bench passes though every memory is filled with random bits in each of its resets.

    It holds every port to the golden model and to the timing from the first clock after reset on.
    """
    command = bench_of(design, tmp_path)["icarus"].replace(".v ", ".v upset.v -s upset ", 1)
    bench = f"{design.name}_tb"
    (tmp_path / "upset.v").write_text(
        f"""module upset;
          integer i, upsets = 0;
          always @(posedge {bench}.clk) if ({bench}.rst) begin
            #1 upsets = upsets + 1;
            {spoiling(design, f"{bench}.core", "$random")}
          end
          always @(negedge {bench}.clk)
            if ({bench}.index == {bench}.SAMPLES && {bench}.results == {bench}.RESULTS)
              $display("%0d upsets", upsets);
        endmodule"""
    )
    done = shell(command, tmp_path)
    said = sorted(done.stdout.splitlines())
    assert said[0] == "6 upsets", done.stdout + done.stderr
    assert [line[:6] for line in said[1:]] == ["PASS: "]


def test_the_bench_sees_a_word_that_no_reset_mends(tmp_path):
    """One that is spoiled after start-up: the test above can fail."""
    design = SHAPES["cn1-generic"]
    command = bench_of(design, tmp_path)["icarus"].replace(".v ", ".v upset.v -s upset ", 1)
    (left,) = [w for w in writable(emitted(design)["cn1.v"]) if "left" in w.path]
    (tmp_path / "upset.v").write_text(
        f"module upset; initial #{10 * timing(design).startup + 50}"
        f" cn1_tb.core.{left.path}[47] = 3; endmodule"
    )
    done = shell(command, tmp_path)
    told = re.fullmatch(
        r"FAIL: result 0, word 2, result_data: (\d+), expected (\d+)\n.*", done.stdout, re.S
    )
    assert told, done.stdout
    assert int(told[1]) ^ int(told[2]) == 2  # the constant is 3 where it should be 1


def run(text, folder, sources):
    (folder / "bench.v").write_text(text)
    for name, source in sources.items():
        (folder / name).write_text(source)
    command = f"iverilog -g2005 -s bench -o bench.vvp bench.v {' '.join(sources)}"
    built = shell(command, folder)
    assert (built.returncode, built.stderr) == (0, "")
    return subprocess.run(
        ["vvp", "-n", "bench.vvp"], cwd=folder, capture_output=True, text=True, check=True
    ).stdout


def counts_from(bits):
    """Connections of the sample ports to a register of random bits."""
    low, connections = 0, []
    for port in sample_ports(bits):
        connections.append(f".{port.name}(s[{low + port.bits - 1}:{low}])")
        low += port.bits
    return ", ".join(connections), low


@pytest.mark.deep
def test_each_word_by_itself(tmp_path):
    """Two cores reset together, each word of one turned over before: they never differ again."""
    design = compact(CN1)
    text = emitted(design)["cn1.v"]
    connections, bits = counts_from(design)
    clocks = timing(design).startup + 3 * 2 * timing(design).work[0]
    both = "\n".join(
        f"cn1 {core} (.clk(clk), .rst(rst), .sample_valid(1'b1), .sample_ready(ready_{core}),"
        f" {connections}, .result_valid(valid_{core}), .result_ready(1'b1),"
        f" .result_data(data_{core}), .result_last(last_{core}));"
        for core in "ab"
    )
    words = writable(text)
    flips = "\n".join(
        f"for (i = 0; i < {depth}; i = i + 1) begin"
        f" b.{path}[i] = ~b.{path}[i]; run; total = total + 1; end"
        for path, _, depth in words
    )
    said = run(
        f"""module bench;
          reg clk = 0, rst = 1;
          reg [{bits - 1}:0] s = 0;
          wire ready_a, ready_b, valid_a, valid_b, last_a, last_b;
          wire [15:0] data_a, data_b;
          integer i, clock, seed = 1, total = 0, results = 0, wrong = 0;
          {both}
          task run; begin
            rst = 1; #5 clk = 1; #5 clk = 0; rst = 0;
            for (clock = 0; clock < {clocks}; clock = clock + 1) begin
              s = {{$random(seed), $random(seed)}};
              #5;
              if (ready_a !== ready_b || valid_a !== valid_b
                  || (valid_a && {{data_a, last_a}} !== {{data_b, last_b}})) wrong = wrong + 1;
              if (valid_a && last_a) results = results + 1;
              clk = 1; #5 clk = 0;
            end
          end endtask
          initial begin
            run;
            {flips}
            $display("%0d words, %0d results, %0d clocks differ", total, results, wrong);
          end
        endmodule""",
        tmp_path,
        {"cn1.v": text},
    )
    total = sum(words.depth for words in words)
    made = plan_compact(design).resources
    parts = ("left_words", "right_words", "sample_words", "result_words")
    assert total >= sum(made[part] for part in parts)  # a few more: depths are powers of two
    told = re.fullmatch(r"(\d+) words, (\d+) results, (\d+) clocks differ\n", said)
    assert int(told[1]) == total
    assert int(told[2]) >= 2 * total
    assert int(told[3]) == 0


CORES = {name: design for name, design in SHAPES.items() if design.name != "dense_odd_3"} | {
    f"pipelined-{'-'.join([name, target, *map(str, hardware.values())])}": with_hardware(
        DESIGNS[name], target=target, **hardware
    )
    for name, hardware in (
        ("smallest", {}),
        ("taylor_2p1", {"multipliers": 12}),
        ("smallest", {"handover": "stream"}),
    )
    for target in ("generic", "ecp5", "ice40", "xilinx")
}


def unknown(text):
    """Nothing has a value at first, the program apart."""
    text = re.sub(r"^  initial (?!begin)[^;]*;$", "", text, flags=re.M)

    def module(found):
        if "program" in found[1]:
            return found[0]
        return re.sub(r"^  initial begin\n.*?^  end\n", "", found[0], flags=re.M | re.S)

    return re.sub(r"^module (\w+).*?^endmodule$", module, text, flags=re.M | re.S)


@pytest.mark.parametrize("design", tiers(CORES))
def test_one_clock_of_reset_leaves_no_x(design, tmp_path):
    """Every register and memory is X at first; one clock of reset, then random samples.

    No handshake shows an X, nor any bit of a result.  And as handed out, with the initial values
    that the text has, no output is X, whether it means anything or not.
    """
    files = emitted(design)
    name = f"{design.name}.v"
    for start, text in (("reset", unknown(files[name])), ("power-up", files[name])):
        assert (text == files[name]) == (start == "power-up")
        folder = tmp_path / start
        folder.mkdir()
        said = run(x_bench(design, start == "reset"), folder, {**files, name: text})
        assert said == "3 results, 0 X\n", start


def x_bench(design, spoilt):
    """Counts results and clocks that show an X; of spoilt cores, none where no result is valid."""
    connections, bits = counts_from(design)
    ports = emitted(design)[f"{design.name}.v"].partition("\n);\n")[0]
    outputs = re.findall(r"^  output (?:reg )?(?:\[(\d+):0\] )?(result_\w+),?$", ports, re.M)
    results = [(name, int(top or 0) + 1) for top, name in outputs if name != "result_valid"]
    wires = "\n".join(f"wire [{width - 1}:0] {name};" for name, width in results)
    shown = ", ".join(name for name, _ in results)
    ports = ", ".join(f".{name}({name})" for name, _ in results)
    last = "result_last" if design.hardware.handover == "stream" else "1"
    looked = "result_valid & " if spoilt else ""
    spoil = (
        spoiling(design, "core", "18'bx") if spoilt and "compact" in design.hardware.core else ""
    )
    return f"""module bench;
      reg clk = 0, rst = 1;
      reg [{bits - 1}:0] s = 0;
      wire sample_ready, result_valid;
      {wires}
      wire shown = sample_ready ^ result_valid ^ ({looked}^{{{shown}}});
      integer i, results = 0, unknown = 0, seed = 1;
      {design.name} core (.clk(clk), .rst(rst), .sample_valid(1'b1), .sample_ready(sample_ready),
        {connections}, .result_valid(result_valid), .result_ready(1'b1), {ports});
      initial begin
        #1;
        {spoil}
        repeat ({1 if spoilt else 3}) begin #5 clk = 1; #5 clk = 0; end  // 2 until a memory shows
        rst = 0;
        while (results < 3 && $time < 10000000) begin
          s = {{16{{$random(seed)}}}};
          #5;
          if (shown === 1'bx) unknown = unknown + 1;
          if (result_valid && {last}) results = results + 1;
          clk = 1; #5 clk = 0;
        end
        $display("%0d results, %0d X", results, unknown);
      end
    endmodule"""
