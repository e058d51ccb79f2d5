"""The generated test bench, as its README says to run it."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

from sculler_hdl import generate, timing
from sculler_model.design import Design
from sculler_sim.engines.verilator_build import emitted
from sculler_sim.testbench import LEAST, Least, write_testbench

PLAIN = Least((1, 200), (2, 400), 0, 0)
"""The two long runs of what is handed out, without the others and their goals."""


def bench_of(design: Design, folder: Path, least: Least = PLAIN) -> dict[str, str]:
    """Leave a folder as `generate` does; the commands of its README by simulator."""
    files = emitted(design)
    cells = [Path(name).stem for name in files if name != f"{design.name}.v"]
    write_testbench(design, folder, timing(design), cells, least)
    for name, text in files.items():
        (folder / name).write_text(text)
    readme = (folder / "README.md").read_text()
    (icarus,) = re.findall(r"^    (iverilog .*)$", readme, re.M)
    (verilator,) = re.findall(r"`(verilator --binary .*?)`", readme)
    return {"icarus": icarus, "verilator": verilator}


def shell(command: str, folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """What a command says and how it ends."""
    return subprocess.run(
        command,
        shell=True,
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, **environment},
    )


def run_bench(design: Design, folder: Path, least: Least = PLAIN) -> tuple[int, int, int]:
    """The bench passes in Icarus without a warning; results, samples and stalled clocks."""
    done = shell(bench_of(design, folder, least)["icarus"], folder)
    assert done.stderr == ""
    counts = re.fullmatch(
        r"PASS: (\d+) results of (\d+) samples in \d+ clocks, samples stalled in (\d+),"
        r" (\d+) lost, (\d+) results dropped\n",
        done.stdout,
    )
    assert counts, done.stdout
    assert done.returncode == 0
    results, samples, stalled, lost, dropped = map(int, counts.groups())
    assert results >= 3
    can_stall = not design.drops_results or timing(design).spacing > 1
    assert (stalled > 0) == can_stall
    if least in (PLAIN, LEAST):  # a shorter bench may lose no sample
        assert (lost > 0) == can_stall
    assert (dropped > 0) == design.drops_results
    return results, samples, stalled


def unit_sources(design: Design, folder: Path) -> list[Path]:
    """All Verilog that `generate` makes of a design, in a folder; the core, its bus and so on."""
    made = generate(design)
    texts = {f"{design.name}.v": made.verilog, **made.further}
    texts |= {f"{cell}.v": text for cell, text in made.cells.items()}
    sources = [folder / name for name in texts if name.endswith(".v")]
    for path in sources:
        path.write_text(texts[path.name])
    return sources


def modules_of(verilog):
    """The bodies of a text's modules by name."""
    return dict(re.findall(r"^module (\w+) \((.*?)^endmodule", verilog, re.M | re.S))


def places(top, modules):
    """Every instance below a module: its kind, and the path of instances to it."""
    pattern = r"^  (\w+) (?:#\(.*?\) )?(\w+) \($"
    for kind, name in re.findall(pattern, modules[top], re.M | re.S):
        yield kind, name
        if kind in modules:
            yield from ((below, f"{name}.{path}") for below, path in places(kind, modules))
