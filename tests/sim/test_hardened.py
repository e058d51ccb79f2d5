"""Hardened cores: undisturbed they are the plain core; upsets are told, or do no harm."""

from __future__ import annotations

import json
import re
import subprocess

import numpy as np
import pytest
from amaranth.hdl import Fragment

from sculler_hdl import StreamCore, result_layout, result_ports, sample_ports
from sculler_model.design import STATUS_UPSET
from sculler_model.golden import words_per_column, words_per_result
from sculler_sim.engine import trace
from sculler_sim.engines.verilator_build import emitted
from sculler_sim.place.tools import YOSYS
from sculler_sim.stimulus import Stimulus
from strategies import make_design, samples_of, with_hardware
from studies.upsets import campaign
from studies.upsets.shapes import shapes
from studies.upsets.state import State, states

CN1 = make_design("cn1", 1, 1, 2, (8, 8))


def compact(**hardware):
    return with_hardware(CN1, **({"core": "compact"} | hardware))


@pytest.mark.parametrize(
    ("hardening", "hardware"),
    [
        ("recover", {}),
        pytest.param("detect", {"core": "pipelined"}, marks=pytest.mark.deep),
        pytest.param("recover", {"core": "pipelined"}, marks=pytest.mark.deep),
        pytest.param("detect", {"overrun": "drop-result"}, marks=pytest.mark.deep),
        pytest.param("detect", {"target": "ice40", "reset": "async"}, marks=pytest.mark.deep),
        pytest.param("recover", {"clock_enable": True}, marks=pytest.mark.deep),
    ],
)
def test_undisturbed_every_port_is_as_the_cycle_model_says(hardening, hardware):
    """Among random stalls, resets and samples that are given up; the plain core's timing holds."""
    design = compact(hardening=hardening, **hardware)
    counts, faults = samples_of(design, 200, 3)
    stimulus = Stimulus(3, longest=60, resets=frozenset({700}), gives_up=True)
    runs = [trace(design, counts, faults, stimulus, 1100, e) for e in ("model", "amaranth")]
    assert runs[0].first_difference(runs[1]) is None


def test_streams_carry_the_bit_and_the_port():
    for hardening, bits in ((None, 4), ("detect", 5)):
        design = compact(core="pipelined", hardening=hardening)
        assert result_layout(design)["status"].shape.width == bits
        core = StreamCore(design)
        assert ("upset" in core.signature.members) == (hardening is not None)
        Fragment.get(core, None)  # Amaranth warns of what is never used


BENCH = """module bench;
  reg clk = 0, rst = 1;
  reg [{bits}:0] s = 0;
  wire ready_a, ready_b, valid_a, valid_b, last_a, last_b, upset;
  wire [15:0] data_a, data_b;
  reg [15:0] words_a [0:65535], words_b [0:65535];
  integer i, clock, a = 0, b = 0, seed = 1, sa = 0, sb = 0;
  reg [{bits}:0] samples [0:4095];
  plain a0 (.clk(clk), .rst(rst), .sample_valid(1'b1), .sample_ready(ready_a), {from_a},
    .result_valid(valid_a), .result_ready(1'b1), .result_data(data_a), .result_last(last_a));
  hard b0 (.clk(clk), .rst(rst), .sample_valid(1'b1), .sample_ready(ready_b), {from_b},
    .result_valid(valid_b), .result_ready(1'b1), .result_data(data_b), .result_last(last_b),
    .upset(upset));
  wire [{bits}:0] now_a = samples[sa], now_b = samples[sb];
  initial begin
    for (i = 0; i < 4096; i = i + 1) samples[i] = {{$random(seed), $random(seed)}};
    #5 clk = 1; #5 clk = 0; rst = 0;
    for (clock = 0; clock < {clocks}; clock = clock + 1) begin
      #5;
      if (ready_a) sa = sa + 1;
      if (ready_b) sb = sb + 1;
      if (valid_a) begin words_a[a] = data_a; a = a + 1; end
      if (valid_b) begin words_b[b] = data_b; b = b + 1; end
      clk = 1; #2;
      {flips}
      #3 clk = 0;
    end
    for (i = 0; i < a && i < b; i = i + 1) $display("%0d %0d", words_a[i], words_b[i]);
    $finish;
  end
endmodule
"""


def beside_the_plain_core(hardening, flips, clocks, folder):
    """The words of a plain core and of a hardened one, of which bits turn over at these clocks."""
    plain, hard = compact(), compact(hardening=hardening)
    texts = []
    for name, design in (("plain", plain), ("hard", hard)):
        text = emitted(design)["cn1.v"]
        texts.append(re.sub(r"\bcn1(?=\b|_)", name, text))
    connections, low = [], 0
    for port in sample_ports(plain):
        connections.append((port.name, f"[{low + port.bits - 1}:{low}]"))
        low += port.bits
    ports = {
        f"from_{side}": ", ".join(f".{name}(now_{side}{bits})" for name, bits in connections)
        for side in "ab"
    }
    lines = [
        f"if (clock == {clock}) b0.{place} = b0.{place} ^ {mask};" for clock, place, mask in flips
    ]
    bench = BENCH.format(bits=low - 1, clocks=clocks, flips="\n".join(lines), **ports)
    (folder / "all.v").write_text("\n".join([bench, *texts]))
    command = ["iverilog", "-g2005", "-s", "bench", "-o", "bench.vvp", "all.v"]
    subprocess.run(command, cwd=folder, check=True)
    run = ["vvp", "-n", "bench.vvp"]
    said = subprocess.run(run, cwd=folder, capture_output=True, text=True, check=True).stdout
    pairs = np.array([line.split() for line in said.splitlines()], dtype=int)
    per = words_per_result(plain)
    whole = len(pairs) // per * per
    return pairs[:whole].reshape(-1, per, 2), words_per_column(plain)


FLIPS = [
    (400, "copy1.engine.low", 1),  # the accumulator
    (900, "copy0.control.minor", 1),  # where in the major interval it is
    (1500, "copy2.engine.address", 4),  # the program counter
    (2200, "copy0.reader.word", 2),  # the word that is handed over
    (2700, "copy1.sample_ready", 1),
]


def test_a_core_that_recovers_hands_over_what_the_plain_core_does(icarus, tmp_path):
    """One bit in each of some intervals; status bit 4 tells of some."""
    words, status = beside_the_plain_core("recover", FLIPS, 3600, tmp_path)
    assert len(words) > 10
    differ = words[:, :, 0] ^ words[:, :, 1]
    assert set(np.unique(differ[:, status])) == {0, STATUS_UPSET}
    differ[:, status] = 0
    assert not differ.any()


def test_a_core_that_detects_tells_of_a_wrong_result_and_is_right_after_it(icarus, tmp_path):
    """A bit of the accumulator spoils one result of the copy that is shown."""
    words, status = beside_the_plain_core("detect", [(565, "copy0.engine.low", 4)], 2000, tmp_path)
    assert len(words) > 5
    told = (words[:, status, 0] ^ words[:, status, 1]) == STATUS_UPSET
    differ = words[:, :, 0] ^ words[:, :, 1]
    differ[:, status] = 0
    assert np.flatnonzero(differ.any(axis=1)).tolist() == [2]
    assert np.flatnonzero(told).tolist() == [2, 3]  # and the one that may have been under way


MANY = """module bench;
  reg clk = 0, rst = 1;
  reg [{bits}:0] samples [0:1023];
  wire ready_a, ready_b, valid_a, valid_b, upset;
  wire [{shown}:0] shown_a, shown_b;
  reg [{shown}:0] all_a [0:65535], all_b [0:65535];
  integer i, clock, a = 0, b = 0, seed = 1, sa = 0, sb = 0;
  wire [{bits}:0] now_a = samples[sa % 1024], now_b = samples[sb % 1024];
  plain a0 (.clk(clk), .rst(rst), .sample_valid(1'b1), .sample_ready(ready_a), {from_a},
    .result_valid(valid_a), .result_ready(1'b1), {to_a});
  hard b0 (.clk(clk), .rst(rst), .sample_valid(1'b1), .sample_ready(ready_b), {from_b},
    .result_valid(valid_b), .result_ready(1'b1), {to_b}, .upset(upset));
  initial begin
    for (i = 0; i < 1024; i = i + 1) samples[i] = {{$random(seed), $random(seed)}};
    #5 clk = 1; #5 clk = 0; rst = 0;
    for (clock = 0; clock < {clocks}; clock = clock + 1) begin
      #5;
      if (ready_a) sa = sa + 1;
      if (ready_b) sb = sb + 1;
      if (valid_a) begin all_a[a] = shown_a; a = a + 1; end
      if (valid_b) begin all_b[b] = shown_b; b = b + 1; end
      clk = 1; #2;
      case (clock)
      {flips}
      endcase
      #3 clk = 0;
    end
    for (i = 0; i < a && i < b; i = i + 1) $display("%h %h", all_a[i], all_b[i]);
    $finish;
  end
endmodule
"""


@pytest.mark.deep
@pytest.mark.parametrize(("core", "apart"), [("pipelined", 120), ("compact", 1000)])
def test_a_core_recovers_from_one_upset_after_another(core, apart, icarus, tmp_path):
    """60 bits of what runs the core, now in this copy and now in that, all results right.

    Had a copy not healed when the next one is hurt, there would be no majority.
    """
    designs = {"plain": compact(core=core), "hard": compact(core=core, hardening="recover")}
    texts = {
        name: re.sub(r"\bcn1(?=\b|_)", name, emitted(design)["cn1.v"])
        for name, design in designs.items()
    }
    rng = np.random.default_rng(5)
    parts = re.compile(r"hard\.copy(\d)(\.(sequencer|handover|control|reader|loader|engine))?$")
    found = [s for s in states(texts["hard"], "hard") if parts.match(s.scope) and s.words is None]
    lines = []
    for number in range(60):
        mine = [s for s in found if parts.match(s.scope)[1] == str(number % 3)]
        state = mine[rng.integers(len(mine))]
        place = f"b0{state.scope.removeprefix('hard')}.{state.name}"
        mask = 1 << int(rng.integers(state.bits))
        clock = apart * (number + 2) + int(rng.integers(apart // 4))
        lines.append(f"{clock}: {place} = {place} ^ {state.bits}'h{mask:x};")
    plain = designs["plain"]
    ports, low = {}, 0
    places = []
    for port in sample_ports(plain):
        places.append((port.name, f"[{low + port.bits - 1}:{low}]"))
        low += port.bits
    shown = [port for port in result_ports(plain) if port.name != "result_status"]
    top = 0
    outputs = []
    for port in shown:
        outputs.append((port.name, f"[{top + port.bits - 1}:{top}]"))
        top += port.bits
    for side in "ab":
        ports[f"from_{side}"] = ", ".join(f".{n}(now_{side}{bits})" for n, bits in places)
        ports[f"to_{side}"] = ", ".join(f".{n}(shown_{side}{bits})" for n, bits in outputs)
    clocks = apart * 64
    bench = MANY.format(bits=low - 1, shown=top - 1, clocks=clocks, flips="\n".join(lines), **ports)
    (tmp_path / "all.v").write_text("\n".join([bench, *texts.values()]))
    command = ["iverilog", "-g2005", "-s", "bench", "-o", "bench.vvp", "all.v"]
    subprocess.run(command, cwd=tmp_path, check=True)
    run = ["vvp", "-n", "bench.vvp"]
    said = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    pairs = [line.split() for line in said.splitlines()]
    assert len(pairs) > 200
    place = words_per_column(plain) if core == "compact" else -1
    per = words_per_result(plain) if core == "compact" else 1
    for number, (one, other) in enumerate(pairs):
        if number % per != place:  # the status, which tells
            assert one == other, number


def test_the_state_of_a_text_is_found():
    text = """
    module inner (\n  input clk,\n  output reg [3:0] q\n);
      (* no_rw_check *) reg [7:0] words [15:0];
      reg signed [15:0] a, b; // reg c;
      function [0:0] f;
        reg x;
      endfunction
    endmodule
    (* keep_hierarchy *)
    module top (\n  input clk\n);
      reg flag;
  inner one (
      .clk(clk)
  );
    endmodule""".replace("\n    module", "\nmodule").replace("\n    endmodule", "\nendmodule")
    found = states(text, "top")
    assert found == [
        State("top", "top", "flag", 1, None),
        State("inner", "top.one", "q", 4, None),
        State("inner", "top.one", "words", 8, 16),
        State("inner", "top.one", "a", 16, None),
        State("inner", "top.one", "b", 16, None),
    ]
    assert sum(state.size for state in found) == 1 + 4 + 128 + 32


@pytest.mark.deep
@pytest.mark.parametrize("hardening", ["detect", "recover"])
def test_synthesis_leaves_the_copies_apart(hardening, tmp_path):
    """As many flip-flops as copies times those of the plain core, and the agreement's own."""
    found = {}
    for mode in (None, hardening):
        design = compact(target="ecp5", hardening=mode)
        (tmp_path / "core.v").write_text(emitted(design)["cn1.v"])
        script = "read_verilog core.v; synth_ecp5 -noiopad -top cn1; flatten; write_json core.json"
        (tmp_path / "script.ys").write_text(script.replace("; ", "\n"))
        status, log = YOSYS.run(tmp_path, "script.ys")
        assert status == 0, log
        modules = json.loads((tmp_path / "core.json").read_text())["modules"]
        kinds = {
            name: [cell["type"] for cell in module["cells"].values()]
            for name, module in modules.items()
        }
        found[mode] = sum(
            kinds["cn1"].count("TRELLIS_FF") if name == "cn1" else kinds[name].count("TRELLIS_FF")
            for name in kinds
            if name.startswith("cn1")
        )
    copies = {"detect": 2, "recover": 3}[hardening]
    assert copies * found[None] <= found[hardening] <= copies * found[None] + 150


@pytest.mark.deep
@pytest.mark.parametrize("what", shapes("off"))
@pytest.mark.parametrize("mode", ["detect", "recover"])
def test_no_flip_of_a_hardened_core_is_silent(mode, what, verilator):
    """Each flip-flop once, each word of a memory once."""
    core = campaign.prepare(shapes(mode)[what])
    kinds = {}
    for _, outcome in campaign.run(core, campaign.plan(core, 1, seed=7)):
        kinds[outcome.kind] = kinds.get(outcome.kind, 0) + 1
        if mode == "recover":
            assert outcome.right_within_two
    assert set(kinds) <= {"masked", "seen", "flagged", "late", "stops"}
    if mode == "recover":
        assert set(kinds) == {"masked", "seen"}


@pytest.mark.deep
def test_the_campaign_sees_what_a_plain_core_does_not_tell(verilator):
    core = campaign.prepare(shapes("off")["8 bits, history, `generic`"])
    kinds = [outcome.kind for _, outcome in campaign.run(core, campaign.plan(core, 1, seed=7))]
    assert kinds.count("silent") > 200
    assert kinds.count("hang") > 5
    assert not {"flagged", "late", "seen"} & set(kinds)
