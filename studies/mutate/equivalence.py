"""A changed core against the core, by the model checker."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from sculler_hdl import module_ports
from sculler_model.design import Design
from sculler_sim.place.tools import ToolError
from sculler_sim.prove.engine import Verdict, prove
from sculler_sim.prove.problem import TO_GATES, run_yosys
from studies.mutate.miter import read, write_miter
from studies.mutate.mutants import changed

EQUIVALENT = "equivalent"

_GATES = """\
read_verilog changed.v {cells}
read_verilog top.v
hierarchy -check -top asked
proc
flatten
delete t:$print
memory_map -formal
{to_gates}
aigmap
write_aiger -zinit -symbols core.aig
"""


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
        try:
            to_gates = TO_GATES.replace("delete -output\n", "")  # these are compared
            run_yosys(folder, _GATES.format(cells=" ".join(cells), to_gates=to_gates))
            write_miter(read(folder / "core.aig"), "choice", folder / "both.aig")
            outcome = prove(folder, "both", seconds, bounded=False)
        except ToolError as error:
            return "open: " + " ".join(str(error).split())[-120:]
    if outcome.verdict is Verdict.PROVED:
        return EQUIVALENT
    if outcome.verdict is Verdict.REFUTED:
        return f"differs after {outcome.clocks} clocks"
    return f"open, equal for {outcome.clocks} clocks"


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
