"""What the shipped bench says of each mutant, and whether a survivor can be told from the core."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from sculler_hdl import generate, module_ports, timing
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_sim.place.tools import ToolError
from sculler_sim.prove.engine import Verdict, prove
from sculler_sim.prove.problem import TO_GATES, run_yosys
from sculler_sim.testbench import LEAST, write_testbench
from studies.mutate.mutants import Mutant, mutants

HANG = 120
"""Seconds after which a simulation is ended: the bench has a time-out of its own, far below."""


@dataclass(frozen=True)
class Judged:
    """A mutant and what came of it.

    Attributes:
        change: what was changed.
        killed: whether the bench failed.
        said: its line.
        proof: of a survivor: "equivalent", "differs after N clocks" or "open".
        seconds: that simulation and proof took.
    """

    change: str
    killed: bool
    said: str
    proof: str
    seconds: float


def judge(
    design: Design, count: int, seconds: int, done: Callable[[], None] = lambda: None
) -> list[Judged]:
    """Every mutant of a core.

    Args:
        design: the design.
        count: of mutants of the gates.
        seconds: for the proof of a survivor.
        done: called after each mutant.

    Raises:
        InputError: Icarus Verilog or Yosys is not installed.
        ToolError: Yosys failed, or the core itself does not pass.
    """
    if shutil.which("iverilog") is None:
        raise InputError("Icarus Verilog is not installed, on Debian: apt-get install iverilog")
    with tempfile.TemporaryDirectory(prefix="sculler-mutate-") as work:
        folder = Path(work)
        generated = generate(design)
        write_testbench(design, folder, timing(design), generated.cells, LEAST)
        for cell, text in generated.cells.items():
            (folder / f"{cell}.v").write_text(text, encoding="utf-8")
        (folder / "yosys").mkdir()
        found = mutants(design, folder / "yosys", count)

        def one(numbered: tuple[int, Mutant]) -> Judged:
            number, mutant = numbered
            begun = time.monotonic()
            said = simulate(design, folder, f"m{number}", mutant.verilog)
            killed = not said.startswith("PASS")
            proof = ""
            if not killed and number:
                proof = compare(design, mutant.verilog, seconds)
            done()
            return Judged(mutant.change, killed, said, proof, round(time.monotonic() - begun, 2))

        with ThreadPoolExecutor(2) as pool:
            judged = list(pool.map(one, enumerate(found)))
    if judged[0].killed:
        raise InputError(f"{design.name}: the core itself does not pass: {judged[0].said}")
    return judged[1:]


def simulate(design: Design, folder: Path, name: str, verilog: str) -> str:
    """The bench's line, in Icarus Verilog."""
    core, program = folder / f"{name}.v", folder / f"{name}.vvp"
    core.write_text(verilog, encoding="utf-8")
    cells = [f"{cell}.v" for cell in generate(design).cells]
    top = f"{design.name}_tb"
    try:
        built = subprocess.run(
            ["iverilog", "-g2005", "-s", top, "-o", program.name, f"{top}.v", core.name, *cells],
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
        )
        if built.returncode:
            return f"not compiled: {built.stderr[:200]}"
        done = subprocess.run(
            ["vvp", "-n", program.name],
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
            timeout=HANG,
        )
    except subprocess.TimeoutExpired:
        return "no end"
    finally:
        core.unlink()
        program.unlink(missing_ok=True)
    return next((line for line in done.stdout.splitlines() if line), "nothing said")[:120]


_BOTH = """\
read_verilog gold.v {cells}
prep -flatten -top {name}
memory_map -formal
rename {name} gold
design -stash gold
read_verilog gate.v {cells}
prep -flatten -top {name}
memory_map -formal
rename {name} gate
design -stash gate
design -copy-from gold gold
design -copy-from gate gate
read_verilog -sv -formal top.v
hierarchy -check -top both
proc
flatten
delete t:$print
{to_gates}
aigmap
write_aiger -zinit both.aig
"""


def compare(design: Design, verilog: str, seconds: int) -> str:
    """Whether any samples and resets from power-up tell a changed core from the core at its ports.

    Result ports count while `result_valid` is high.
    """
    generated = generate(design)
    with tempfile.TemporaryDirectory(prefix="sculler-mutate-") as work:
        folder = Path(work)
        for name, text in generated.cells.items():
            (folder / f"{name}.v").write_text(text.replace("$finish;", ""), encoding="utf-8")
        (folder / "gold.v").write_text(generated.verilog, encoding="utf-8")
        (folder / "gate.v").write_text(verilog, encoding="utf-8")
        (folder / "top.v").write_text(_both(design), encoding="utf-8")
        cells = " ".join(f"{cell}.v" for cell in generated.cells)
        try:
            run_yosys(folder, _BOTH.format(name=design.name, cells=cells, to_gates=TO_GATES))
            outcome = prove(folder, "both", seconds)
        except ToolError as error:
            return "open: " + " ".join(str(error).split())[-120:]
    if outcome.verdict is Verdict.PROVED:
        return "equivalent"
    if outcome.verdict is Verdict.REFUTED:
        return f"differs after {outcome.clocks} clocks"
    return f"open, equal for {outcome.clocks} clocks"


def _both(design: Design) -> str:
    """Core and changed core, with the same inputs."""
    ports = module_ports(design)
    inputs = ", ".join(f"input [{p.bits - 1}:0] {p.name}" for p in ports if not p.output)
    lines = [f"module both ({inputs});"]
    differ = []
    for port in (p for p in ports if p.output):
        lines.append(f"  wire [{port.bits - 1}:0] {port.name}, gate_{port.name};")
        differs = f"{port.name} != gate_{port.name}"
        looked = port.name.startswith("result_") and port.name != "result_valid"
        differ.append(f"(result_valid && {differs})" if looked else f"({differs})")
    for core, prefix in (("gold", ""), ("gate", "gate_")):
        wired = ", ".join(f".{p.name}({prefix if p.output else ''}{p.name})" for p in ports)
        lines.append(f"  {core} {core} ({wired});")
    lines += [
        "  always @(posedge clk) alike: assert (!(" + " || ".join(differ) + "));",
        "endmodule\n",
    ]
    return "\n".join(lines)
