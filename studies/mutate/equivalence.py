"""A changed core against the core, by the model checker."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from itertools import product
from pathlib import Path

from sculler_hdl import module_ports
from sculler_model.design import Design
from sculler_sim.place.tools import ToolError
from sculler_sim.prove.engine import Verdict, prove
from sculler_sim.prove.problem import TO_GATES, run_yosys
from studies.mutate.miter import Circuit, read, write_miter
from studies.mutate.mutants import changed
from studies.mutate.pairs import Pairs, TooManyError

EQUIVALENT = "equivalent"

_FEW_CLOCKS = (1, 2)
"""In which a change may reach registers: first it is tried whether no others ever differ."""

_FEW_SECONDS = 10

_ENGINE = (
    r"chosen|core\.(?:losses\.)?sample_ready|core\.loader\.(?:address_0|busy|clearing)"
    r"|core\.engine\.(?:address(?:_2)?|running|starting|settling|word|busy|counts"
    r"|launched_[12]|clock)"
)
_READER = (
    r"|core\.engine\.present(?=\[2\])|core\.reader\.(?:waiting|full|behind|filling|signal_s_3)"
)
_CONTROLS = [
    (re.compile(rf"(?:^| )!?(?:{names})(?: |\[|$)"), split)
    for names, split in (
        (_ENGINE, ["sample_valid"]),
        (_ENGINE + _READER, ["result_valid", "result_ready", "result_last", "sample_valid"]),
    )
]
"""What controls a compact core: registers that are followed one by one, and ports they depend on.

First those of the engine and of what loads samples; then whose bank is shown, and which is filled.
"""

_CASES = 50_000
"""Of those registers, after which that is given up."""

_GATES = """\
read_verilog changed.v {cells}
read_verilog top.v
hierarchy -check -top asked
proc
flatten
delete t:$print
memory_collect
{products}memory_map -formal
{to_gates}
aigmap
write_aiger -zinit -symbols core.aig
"""


_FREE = """\
(* techmap_celltype = "$mul" *)
module free (A, B, Y);
  parameter A_SIGNED = 0;
  parameter B_SIGNED = 0;
  parameter A_WIDTH = 1;
  parameter B_WIDTH = 1;
  parameter Y_WIDTH = 1;
  input [A_WIDTH-1:0] A;
  input [B_WIDTH-1:0] B;
  output [Y_WIDTH-1:0] Y;
  wire [Y_WIDTH-1:0] any;
  \\$anyseq #(.WIDTH(Y_WIDTH)) free (.Y(any));
  assign Y = A == 0 || B == 0 ? 0 : any;
endmodule
"""
"""A product that is anything, but 0 where a factor is."""

_FREED = """\
select -assert-none w:choice %co* t:$mul %i
techmap -map free.v t:$mul
"""
"""Where no factor depends on the change, products are the same in both, whatever they are."""


def compare(design: Design, texts: Mapping[str, str], changes: Sequence[str], seconds: int) -> str:
    """Whether any samples and resets from power-up tell a changed core from the core at its ports.

    Result ports count while `result_valid` is high.  Of several changes any one is made.

    Args:
        design: the design.
        texts: core and models of blocks, by name of file; the core is NAME.v.
        changes: of the core (`Mutants.changes`).
        seconds: for the proof.

    Returns:
        "equivalent", "differs after N clocks", or "open" with what is known.
    """
    cells = [file for file in texts if file != f"{design.name}.v"]
    with tempfile.TemporaryDirectory(prefix="sculler-mutate-") as work:
        folder = Path(work)
        text = changed(design.name, texts, folder, changes)
        (folder / "changed.v").write_text(text, encoding="utf-8")
        (folder / "top.v").write_text(_asked(design), encoding="utf-8")
        (folder / "free.v").write_text(_FREE, encoding="utf-8")
        try:
            _write_gates(folder, cells)
            core = read(folder / "core.aig")
            if design.hardware.core == "compact" and _same_by_control(core, len(changes), seconds):
                return EQUIVALENT
            for clocks in _FEW_CLOCKS:
                write_miter(core, "choice", folder / "few.aig", clocks)
                outcome = prove(folder, "few", min(seconds, _FEW_SECONDS), bounded=False)
                if outcome.verdict is Verdict.PROVED:
                    return EQUIVALENT
            write_miter(core, "choice", folder / "both.aig")
            outcome = prove(folder, "both", seconds, bounded=False)
        except ToolError as error:
            return "open: " + " ".join(str(error).split())[-120:]
    if outcome.verdict is Verdict.PROVED:
        return EQUIVALENT
    if outcome.verdict is Verdict.REFUTED:
        return f"differs after {outcome.clocks} clocks"
    return f"open, equal for {outcome.clocks} clocks"


def _same_by_control(core: Circuit, changes: int, seconds: int) -> bool:
    """Whether no change shows, told from what controls the core alone."""
    for number in range(1, changes + 1):
        for zero, (control, split) in product((False, True), _CONTROLS):
            with suppress(TooManyError):
                if Pairs(core, number, control, split, _CASES, seconds, zero).same():
                    break
        else:
            return False
    return True


def _write_gates(folder: Path, cells: Sequence[str]) -> None:
    """Write core.aig, with products that may be anything if that loses nothing."""
    to_gates = TO_GATES.replace("delete -output\n", "")  # these are compared
    script = _GATES.replace("{cells}", " ".join(cells)).replace("{to_gates}", to_gates)
    try:
        run_yosys(folder, script.format(products=_FREED))
    except ToolError:
        run_yosys(folder, script.format(products=""))


def _asked(design: Design) -> str:
    """The core with an input that chooses a change in the first clock, for ever."""
    ports = module_ports(design)
    declared = ", ".join(
        f"{'output' if p.output else 'input'} [{p.bits - 1}:0] {p.name}" for p in ports
    )
    wired = ", ".join(f".{p.name}({p.name})" for p in ports)
    return f"""\
module asked ({declared}, input [15:0] choice);
  reg chosen = 0;
  reg [15:0] kept = 0;
  wire [15:0] mutant = chosen ? kept : choice;
  always @(posedge clk) {{chosen, kept}} <= {{1'b1, mutant}};
  {design.name} core ({wired}, .mutant(mutant));
endmodule
"""
