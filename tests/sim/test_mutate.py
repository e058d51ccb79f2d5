"""Mutants of the Verilog against the generated test bench: what comes of them, and the page."""

from __future__ import annotations

import re
import shutil
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from sculler_sim.engines.verilator_build import emitted
from sculler_sim.prove.shapes import SHAPES as PROVED
from studies.mutate import equivalence, verdicts
from studies.mutate import mutants as module
from studies.mutate.command import RESULTS
from studies.mutate.equivalence import compare
from studies.mutate.microprogram import NotFollowedError
from studies.mutate.miter import Circuit, read, write_miter
from studies.mutate.page import results
from studies.mutate.pairs import Pairs, TooManyError
from studies.mutate.shapes import SHAPES
from studies.mutate.verdicts import Judged, judge

PASS, FAIL = "PASS: all", "FAIL: clock 9"
BIT = "microprogram word 3 bit 1"


def judged(killed: int, *proofs: str, change: str = "mutate") -> list[Judged]:
    dead = [Judged(change, FAIL, FAIL)] * killed
    return dead + [Judged(change, PASS, proof=proof) for proof in proofs]


def test_the_share_leaves_out_what_is_equivalent_and_counts_what_is_open() -> None:
    found = {
        "one": judged(199, "equivalent", "equivalent", "open, equal for 9 clocks"),
        "two": judged(97, "differs after 8 clocks", "equivalent")
        + judged(10, "unused", "unused", "", change=BIT),
    }
    lines = list(results(found))
    assert "| `one` | 202 | 199 | 2 | 0 | 1 | 99.5 % |" in lines
    assert "| `two` | 99 | 97 | 1 | 1 | 0 | 99.0 % |" in lines
    assert "| **all** | 301 | 296 | 3 | 1 | 1 | 99.3 % |" in lines
    assert lines.count("| `two` | 13 | 10 | 0 | 2 | 0 | 1 | 90.9 % |") == 1


def test_what_passes_in_either_simulator_lives() -> None:
    assert Judged("a", FAIL, FAIL).killed
    assert not Judged("a", PASS).killed
    assert not Judged("a", FAIL, PASS).killed


def test_those_killed_are_kept_by_number_and_the_others_whole(tmp_path) -> None:
    live = [Judged("mutate -mode inv", PASS, "", "open", 60), Judged(BIT, PASS, proof="unused")]
    killed = [Judged("mutate -mode const0", FAIL, FAIL), *judged(2, change=BIT)]
    path = tmp_path / "one.json"
    verdicts._Kept("core", "bench", [killed[0], *live, *killed[1:]], {}).write(path)
    found = verdicts._Kept.read(path, "core", "bench")
    assert [each for each in found.mutants if not each.killed] == live
    assert sorted(m.change for m in found.mutants if m.killed) == ["microprogram"] * 2 + ["mutate"]
    assert list(results({"one": found.mutants})) == list(results({"one": [*live, *killed]}))
    assert verdicts._Kept.read(path, "core", "other").mutants == []
    assert verdicts._Kept.read(path, "core", "other").proofs == {"mutate -mode inv": ("open", 60)}
    assert verdicts._Kept.read(path, "other", "bench").proofs == {}


CORE = """\
module one (clk, mutant);
  reg [3:0] words_2 [0:1];
  initial begin
    words_2[0] = 4'h0;
  end
endmodule
module one_engine_program (clk, data);
  reg [3:0] words_2 [0:3];
  initial begin
    words_2[2] = 4'h5;
    words_2[3] = 4'hc;
  end
endmodule
"""


def test_bits_of_the_microprogram_become_unknown() -> None:
    text = module.with_unknown(CORE, [BIT, "microprogram word 2 bit 0"])
    ends = "    words_2[3] = 4'hc;\n"
    unknown = "    words_2[3][1] = 1'bx;\n    words_2[2][0] = 1'bx;\n"
    assert text == CORE.replace(ends, ends + unknown)


def test_bits_without_effect_are_found_by_halves(monkeypatch, tmp_path) -> None:
    """Of eight the third and the last show."""
    changes = [f"microprogram word {word} bit 0" for word in range(8)]
    asked = []

    def says(design, unknown, texts, folder):
        asked.append(unknown)
        return FAIL if {changes[2], changes[7]} & set(unknown) else PASS

    monkeypatch.setattr(verdicts, "with_unknown", lambda core, changes: changes)
    monkeypatch.setattr(verdicts, "icarus_says", says)
    shape = SHAPES["compact_one"]
    texts = {"compact_one.v": ""}
    good = verdicts._without_effect(shape, texts, changes, tmp_path)
    assert sorted(good) == changes[:2] + changes[3:7]
    assert len(asked) < 14


def test_bits_are_followed_on_symbols_first_and_unknown_only_where_that_says_nothing(
    monkeypatch, tmp_path
) -> None:
    """The first is the same, the second differs, the third is of no step; the last is killed."""
    changes = [f"microprogram word {word} bit 0" for word in range(4)]
    said = iter([True, False, NotFollowedError()])

    def same(plan, word, bit):
        if isinstance(answer := next(said), Exception):
            raise answer
        return answer

    asked = []
    monkeypatch.setattr(verdicts, "same_results", same)
    monkeypatch.setattr(verdicts, "with_unknown", lambda core, changes: asked.append(changes))
    monkeypatch.setattr(verdicts, "icarus_says", lambda *_: PASS)
    shape = SHAPES["compact_one"]
    found = [Judged(each, PASS) for each in changes[:3]] + [Judged(changes[3], FAIL, FAIL)]
    found = verdicts._followed(shape, found)
    assert [each.proof for each in found] == ["equivalent", "", "", ""]
    found = verdicts._unused(shape, {"compact_one.v": ""}, found, tmp_path)
    assert [each.proof for each in found] == ["equivalent", "unused", "unused", ""]
    assert asked == [changes[1:3]]


def gates(folder: Path, core: str, top: str) -> Circuit:
    """What the model checker is given of a changed core, below a module of that text."""
    for name, text in (("changed", core), ("top", top), ("free", equivalence._FREE)):
        (folder / f"{name}.v").write_text(text)
    equivalence._write_gates(folder, [])
    return read(folder / "core.aig")


@pytest.mark.deep
def test_products_are_free_only_where_no_factor_depends_on_the_change(tmp_path) -> None:
    """A fault's mark meets no product, so none is left; that a sample is there meets them all."""
    shape = SHAPES["one_minor"]
    sizes = []
    for port in ("sample_fault", "sample_valid"):
        folder = tmp_path / port
        folder.mkdir()
        change = f"mutate -mode inv -module one_minor -cell sequencer -port {port} -portbit 0"
        text = module.changed(shape.name, emitted(shape), folder, [change])
        sizes.append(len(gates(folder, text, equivalence._asked(shape)).ands))
    assert 2 * sizes[0] < sizes[1]


@pytest.mark.deep
@pytest.mark.skipif(shutil.which("iverilog") is None, reason="Icarus Verilog is missing")
def test_what_the_bench_kills_can_be_told_from_the_core(tmp_path) -> None:
    """And what can not is not killed: bench and model checker agree; what is kept is not run."""
    shape, path = SHAPES["one_minor"], tmp_path / "kept.json"
    found = judge(shape, 8, 120, path)
    assert len(found) == 8
    assert not any(mutant.proof.startswith("differs") for mutant in found)
    runs: list[int] = []
    again = judge(shape, 8, 120, path, lambda: runs.append(1))
    assert [each for each in again if not each.killed] == [m for m in found if not m.killed]
    assert len(again) == len(found)
    assert not runs


@pytest.mark.deep
def test_the_model_checker_tells_a_changed_core() -> None:
    shape = SHAPES["one_minor"]
    inverted = "mutate -mode inv -module one_minor -cell sequencer -port sample_fault -portbit 0"
    assert compare(shape, emitted(shape), [inverted], 120).startswith("differs after ")


NAMES = {"i0": "a", "i1": "choice[0]", "o0": "result_valid", "o1": "result_a"}


def circuit(shown: int) -> Circuit:
    """A latch takes `a and not choice`, another takes `a`; what is shown is the first, or so."""
    first, second = 2 * 3, 2 * 4
    return Circuit(2, [2 * 5, 2], [(2, 4 ^ 1), (first, second)], [second, shown], NAMES)


def values(made: Circuit, state: list[int], given: list[int]) -> tuple[list[int], list[int]]:
    """Outputs and next state, worked out AND by AND."""
    nodes = [0, *given, *state]
    for a, b in made.ands:
        nodes.append((nodes[a >> 1] ^ a & 1) & (nodes[b >> 1] ^ b & 1))
    return [[nodes[lit >> 1] ^ lit & 1 for lit in lits] for lits in (made.outputs, made.latches)]


PROGRAM = """\
module one (input clk, input [1:0] address, output [3:0] data);
  one_engine_program program_s (.clk(clk), .address(address), .data(data));
endmodule
module one_engine_program (input clk, input [1:0] address, output reg [3:0] data);
  reg [3:0] words_2 [0:3];
  initial data = 4'h0;
  initial begin
    words_2[0] = 4'h6;
    words_2[1] = 4'h9;
    words_2[2] = 4'h5;
    words_2[3] = 4'hc;
  end
  always @(posedge clk) begin
    data <= words_2[address];
  end
endmodule
"""
READS = """\
module asked (input clk, input [1:0] address, output [3:0] data, input [1:0] choice);
  one core (.clk(clk), .address(address), .data(data), .mutant({14'h0, choice}));
endmodule
"""


def test_a_bit_of_the_microprogram_is_turned_over_where_its_word_is_read(tmp_path) -> None:
    """The two changes are choices 1 and 2; the words of the unchanged program are those above."""
    changes = [BIT, "microprogram word 0 bit 3"]
    text = module.changed("one", {"one.v": PROGRAM}, tmp_path, changes)
    circuit = gates(tmp_path, text, READS)
    for choice, address in product(range(3), range(4)):
        ports = {"clk": 0, "address": address, "choice": choice}
        named = (circuit.names[f"i{i}"].rstrip("]").partition("[") for i in range(circuit.inputs))
        given = [ports[port] >> int(bit or 0) & 1 for port, _, bit in named]
        _, state = values(circuit, [0] * len(circuit.latches), given)
        data, _ = values(circuit, state, given)
        word = [6, 9, 5, 12][address] ^ {(1, 3): 2, (2, 0): 8}.get((choice, address), 0)
        assert sum(bit << i for i, bit in enumerate(data)) == word


@pytest.mark.parametrize("reaches", [False, True])
def test_a_change_reaches_a_factor_through_a_memory(reaches, tmp_path) -> None:
    """A product is free, one input more for each of its 4 bits, only where it does not."""
    written = "a ^ {1'b0, choice}" if reaches else "a"
    core = f"""\
module one (input clk, input [1:0] a, input choice, output reg [3:0] r, output reg other);
  reg [1:0] words [0:3];
  reg [1:0] back;
  initial {{words[0], words[1], words[2], words[3], back, r, other}} = 0;
  always @(posedge clk) begin
    words[a] <= {written};
    back <= words[~a];
    r <= back * a;
    other <= choice;
  end
endmodule
"""
    top = """\
module asked (input clk, input [1:0] a, input choice, output [3:0] r, output other);
  one core (.clk(clk), .a(a), .choice(choice), .r(r), .other(other));
endmodule
"""
    ports = 1 + 2 + 1
    assert gates(tmp_path, core, top).inputs == ports + (0 if reaches else 4)


@pytest.mark.parametrize(
    ("shown", "told"), [(6, [0, 1, 0, 1]), (8, [0, 0, 0, 0]), (7, [0, 1, 0, 1]), (12, [0, 1, 0, 1])]
)
def test_a_change_shows_a_clock_later_and_where_a_result_is_valid(shown, told, tmp_path) -> None:
    """Change chosen in each clock; a = 1, 0, 1, then anything: valid is a of the clock before."""
    write_miter(circuit(shown), "choice", tmp_path / "both.aig")
    made = read(tmp_path / "both.aig")
    assert len(made.latches) == 3  # that which the change cannot reach is there once
    state, found = [0] * 3, []
    for a in (1, 0, 1, 0):
        (output,), state = values(made, state, [a, 1])
        found.append(output)
    assert found == told


@pytest.mark.parametrize(
    ("second", "clocks", "latches", "told"),
    [(10, 1, 4, [0, 1, 1]), (11, 1, 4, [0, 0, 0]), (10, None, 5, [0, 0, 1]), (10, 2, 5, [0, 0, 1])],
)
def test_registers_beyond_so_many_clocks_are_there_once_and_must_not_part(
    second, clocks, latches, told, tmp_path
) -> None:
    """The changed latch, `a and not choice`, reaches the shown one where the last `a` lets it.

    Where that is its opposite, nothing reaches it.  a is always 1, and the change always chosen.
    """
    made = Circuit(2, [2 * 6, 2 * 7, 2], [(2, 4 ^ 1), (6, second)], [10, 8], NAMES)
    write_miter(made, "choice", tmp_path / "few.aig", clocks)
    made = read(tmp_path / "few.aig")
    assert len(made.latches) == latches
    state, found = [0] * latches, []
    for _ in range(3):
        (output,), state = values(made, state, [1, 1])
        found.append(output)
    assert found == told


def test_a_circuit_is_read_as_it_is_written_down(tmp_path) -> None:
    """Of an AND: 8 - 5 = 3, 5 - 2 = 3."""
    text = b"aig 4 2 1 1 1\n8\n9\n\x03\x03i0 a\no0 result_valid\nc\nmade by hand\n"
    (tmp_path / "one.aig").write_bytes(text)
    names = {"i0": "a", "o0": "result_valid"}
    assert read(tmp_path / "one.aig") == Circuit(2, [8], [(5, 2)], [9], names)


def test_mutants_are_of_every_proved_shape_and_none_has_two_minor_intervals() -> None:
    """With two, when a sum between them begins and ends often makes no difference."""
    assert list(SHAPES) == list(PROVED)
    minors = {name: shape.algorithm.minors for name, shape in SHAPES.items()}
    assert {name for name in minors if minors[name] == 1} == {"one_minor", "compact_one"}
    assert min(set(minors.values()) - {1}) == 3
    assert SHAPES["two_results"] == PROVED["two_results"]


def turns(valid: int) -> Circuit:
    """A latch `t` turns over each clock; another takes `a`, where t is 0 only without a change.

    Nodes: 1 rst, 2 choice, 3 a, 4 t, 5 what is taken; 10 is t, 11 its opposite, of literals 8, 9.
    """
    names = {"i0": "rst", "i1": "choice[0]", "i2": "a", "l0": "core.t", "l1": "core.taken"}
    names |= {"o0": "result_valid", "o1": "result_a"}
    ands = [(6, 5), (8, 6), (12, 9), (15, 17)]  # a and not choice; t and a; not t and the first
    return Circuit(3, [9, 19], ands, [valid, 10], names)


@pytest.mark.parametrize(
    ("control", "valid", "same"),
    [("core.t", 9, True), ("core.t", 8, False), ("core.t", 1, False), ("none", 9, False)],
)
def test_what_a_change_spoils_may_be_looked_at_where_it_is_the_same_again(
    control, valid, same
) -> None:
    """Taken while t is 0 it is spoilt, and stands while t is 1; that t says so is to be known."""
    pairs = Pairs(turns(valid), 1, re.compile(control), [], 100, 60)
    assert pairs.same() is same
    assert Pairs(turns(1), 0, re.compile(control), [], 100, 60).same()  # there is no change 0


def test_too_many_cases_are_given_up() -> None:
    with pytest.raises(TooManyError):
        Pairs(turns(9), 1, re.compile("core.t"), [], 1, 60).same()


def test_a_set_has_each_pair_that_can_be_and_no_other_where_two_meet_in_an_and() -> None:
    """Worked out pair by pair: r = x and not y."""
    names = {"i0": "rst", "i1": "choice[0]", "o0": "result_valid", "o1": "result_a"}
    pairs = Pairs(Circuit(2, [0, 0], [(6, 9)], [1, 10], names), 1, re.compile("none"), [], 9, 9)
    every = list(product(range(1, 16), repeat=2))
    found = pairs._nodes(np.array(every, np.uint8), {})[5]
    for (x, y), said in zip(every, found, strict=True):
        bits = [(p, q) for p in range(4) if x >> p & 1 for q in range(4) if y >> q & 1]
        ands = {2 * (p >> 1 & ~(q >> 1)) + (p & ~q & 1) for p, q in bits}
        assert said == sum(1 << pair for pair in ands)


@pytest.mark.deep
@pytest.mark.parametrize("name", SHAPES)
def test_what_is_kept_is_of_the_core_and_bench_that_are_generated(name, monkeypatch) -> None:
    """Where this fails, run `make mutate`: it runs this shape again."""

    def mutants(*_: object) -> None:
        pytest.fail(f"{name} or its bench is not what was run")

    monkeypatch.setattr(verdicts, "mutants", mutants)
    paths = list((Path(__file__).parents[2] / RESULTS).glob(f"{name}-*.json"))
    assert paths
    for path in paths:
        assert judge(SHAPES[name], int(path.stem.rpartition("-")[2]), 0, path)
