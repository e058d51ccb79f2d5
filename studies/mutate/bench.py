"""The bench that is handed out, compiled for two simulators."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from sculler_hdl import timing
from sculler_model.design import Design
from sculler_model.errors import InputError, ToolError
from sculler_model.outputs import replacing
from sculler_sim import processes
from sculler_sim.bench_runs import LEAST, Least
from sculler_sim.engines import cache
from sculler_sim.engines.verilator_build import Tools
from sculler_sim.testbench import write_testbench

HANG = 120
"""Seconds after which a simulation is ended: the bench has a time-out of its own, far below."""

LONG = Least((4, 5_000), (8, 40_000), 160, 5_000, 4_000_000)
"""A hundred times what is handed out, a reset in each clock of the latency: what fails differs."""

_VERILATOR = (
    "--binary --timing --output-split 0 -Wno-fatal -Wno-lint -Wno-style"
    " -CFLAGS -std=c++20 -MAKEFLAGS OPT_FAST=-O1 -MAKEFLAGS OPT_SLOW=-O0 -MAKEFLAGS OPT_GLOBAL=-O1"
).split()

_RUNTIME = ("verilated", "verilated_threads", "verilated_timing")
"""Parts of Verilator's runtime, compiled once for all shapes."""


@dataclass(frozen=True)
class Bench:
    """A compiled bench with a core that changes itself.

    Attributes:
        folder: where it lies.
        commands: by name of a simulator, what runs it.
    """

    folder: Path
    commands: dict[str, list[str]]

    def run(self, simulator: str, mutant: int) -> str:
        """The bench's line, with a change of the core; 0 for none."""
        return _line(self.folder, [*self.commands[simulator], f"+mutant={mutant}"])


def write_bench(
    design: Design, texts: Mapping[str, str], folder: Path, least: Least = LEAST
) -> list[Path]:
    """Write the bench and its vectors, as they are handed out.

    Args:
        design: the design.
        texts: core and models of blocks, by name of file; the core is NAME.v.
        folder: where.
        least: how long it is, if it is not as handed out.

    Returns:
        The files.
    """
    cells = _cells(design, texts)
    for cell in cells:
        (folder / cell).write_text(texts[cell], encoding="utf-8")
    names = [cell.removesuffix(".v") for cell in cells]
    return write_testbench(design, folder, timing(design), names, least)


def build(design: Design, core: str, texts: Mapping[str, str], folder: Path) -> Bench:
    """Compile a bench with a core that changes itself.

    Args:
        design: the design.
        core: its text.
        texts: core and models of blocks, by name of file; the core is NAME.v.
        folder: where the bench lies.

    Raises:
        InputError: Icarus Verilog, Verilator, perl, make or a compiler is not installed.
        ToolError: one of them failed.
    """
    for program in ("iverilog", "make"):
        if shutil.which(program) is None:
            raise InputError(f"{program} is not installed, on Debian: apt-get install {program}")
    icarus = _icarus(design, core, texts, folder)
    tools, top = Tools.find(), f"{design.name}_tb"
    command = [*tools.verilator, *_VERILATOR, "--top-module", top, "--Mdir", "verilator"]
    command += [f"{top}.v", "mutants.v", *_cells(design, texts)]
    (folder / "verilator").mkdir()
    made_with = [tools.verilator_version, tools.compiler_version, *_VERILATOR]
    runtime = {
        folder / "verilator" / f"{part}.o": cache.entry(f"bench-{part}", ".o", *made_with)
        for part in _RUNTIME
    }
    for part, entry in runtime.items():
        if entry.exists():
            shutil.copy(entry, part)
    _compile(command, folder, tools.environment)
    for part, entry in runtime.items():
        with replacing(entry) as temporary:
            shutil.copy(part, temporary)
    return Bench(folder, {"icarus": icarus, "verilator": [f"verilator/V{top}"]})


def icarus_says(design: Design, core: str, texts: Mapping[str, str], folder: Path) -> str:
    """The bench's line in Icarus Verilog.

    Args:
        design: the design.
        core: its text.
        texts: core and models of blocks, by name of file; the core is NAME.v.
        folder: where the bench lies.
    """
    return _line(folder, _icarus(design, core, texts, folder))


def _icarus(design: Design, core: str, texts: Mapping[str, str], folder: Path) -> list[str]:
    (folder / "mutants.v").write_text(core, encoding="utf-8")
    top = f"{design.name}_tb"
    command = ["iverilog", "-g2005", "-s", top, "-o", "icarus", f"{top}.v", "mutants.v"]
    _compile([*command, *_cells(design, texts)], folder, None)
    return ["vvp", "-n", "icarus"]


def _cells(design: Design, texts: Mapping[str, str]) -> list[str]:
    return [file for file in texts if file != f"{design.name}.v"]


def _line(folder: Path, command: list[str]) -> str:
    (ended,) = processes.run(["timeout", f"{HANG}", *command], folder=folder)
    lines = ended.said.splitlines()
    return next((each[:100] for each in lines if each.startswith(("PASS", "FAIL"))), "no end")


def _compile(command: list[str], folder: Path, environment: Mapping[str, str] | None) -> None:
    (ended,) = processes.run(command, folder=folder, environment=environment)
    if ended.status:
        raise ToolError(f"{Path(command[0]).name}: " + " | ".join(ended.said.splitlines()[-3:]))
