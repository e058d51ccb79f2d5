"""Compiles an emitted core so that each bit of its state can be turned over while it runs."""

from __future__ import annotations

import ctypes
import json
from collections.abc import Iterable
from importlib import resources
from pathlib import Path

from sculler_hdl import Port, result_ports, sample_ports
from sculler_model.design import Design
from sculler_model.errors import ToolError
from sculler_model.golden import words_per_column, words_per_result
from sculler_sim import processes
from sculler_sim.engines import cache
from sculler_sim.engines.verilator_build import Tools, emitted
from studies.upsets.state import states

_VERILATOR = (
    "--cc -O3 --x-assign 0 --x-initial 0 --no-assert --no-timing --make json --vpi"
    " --prefix Vcore --Mdir model -Wno-lint -Wno-style -Wno-fatal"
).split()
_COMPILER = "-std=c++17 -fPIC -fvisibility=hidden -pthread".split()


def library(design: Design) -> ctypes.CDLL:
    """The core with the harness, compiled or from the cache.

    Raises:
        InputError: Verilator, perl or a compiler is missing.
        ToolError: one of them fails.
    """
    tools = Tools.find()
    text = "\n".join(emitted(design).values())
    harness = _harness(design)
    made_of = [tools.verilator_version, tools.compiler_version, *_VERILATOR, *_COMPILER]
    path = cache.entry(f"{design.name}-upsets", ".so", *made_of, harness, text)
    if not path.exists():
        _compile(design, tools, text, harness, path)
    return ctypes.CDLL(str(path))


def _compile(design: Design, tools: Tools, text: str, harness: str, path: Path) -> None:
    with cache.workshop() as work:
        (work / "core.v").write_text(text, encoding="utf-8")
        (work / "state.vlt").write_text(_written_from_outside(text, design.name), encoding="utf-8")
        files = ["--top-module", design.name, "state.vlt", "core.v"]
        _run([*tools.verilator, *_VERILATOR, *files], work, tools)
        sources = json.loads((work / "model/Vcore.json").read_text(encoding="utf-8"))["sources"]
        model = {
            kind: [each for each in those if each.endswith(".cpp")]
            for kind, those in sources.items()
        }
        often = [each for kind in ("classes_fast", "support_fast") for each in model.get(kind, [])]
        others = {each for those in model.values() for each in those} - set(often)
        texts = {"often": _includes(["Vcore.h", *often]) + harness}
        texts["others"] = _includes(["Vcore.h", *sorted(others)])
        folders = ["-Imodel", f"-I{tools.root}/include", f"-I{tools.root}/include/vltstd"]
        compiler = [*tools.compiler, *_COMPILER, *folders, "-DVM_TRACE=0", "-DVM_COVERAGE=0"]
        for (name, unit), effort in zip(texts.items(), ("-O1", "-O0"), strict=True):
            (work / f"{name}.cpp").write_text(unit, encoding="utf-8")
            _run([*compiler, effort, "-c", f"{name}.cpp"], work, tools)
        _run([*compiler, "-shared", "often.o", "others.o", "-o", "unit.so"], work, tools)
        (work / "unit.so").replace(path)


def _written_from_outside(text: str, top: str) -> str:
    """What tells Verilator that registers and memories may change between two clocks."""
    places = dict.fromkeys((state.module, state.name) for state in states(text, top))
    lines = [f'public_flat_rw -module "{module}" -var "{name}"' for module, name in places]
    return "\n".join(["`verilator_config", *lines, ""])


def _includes(paths: Iterable[str]) -> str:
    return "".join(f'#include "{path}"\n' for path in paths)


def _run(command: list[str], work: Path, tools: Tools) -> None:
    (done,) = processes.run(command, folder=work, environment=tools.environment)
    if done.status:
        raise ToolError(f"{command[0]} failed: {done.said.strip()[-2000:]}")


def _harness(design: Design) -> str:
    """The harness, with this design's ports before it."""
    *counts, _ = sample_ports(design)
    shown = [port for port in result_ports(design) if port.name != "result_last"]
    stream = design.hardware.handover == "stream"
    lines = [
        f"#define SCULLER_SAMPLES(X) {_each(counts)}",
        f"#define SCULLER_OUTPUTS(X) {_each(shown)}",
        # a 64-bit port takes one word; `major` stands before the status
        f"#define SCULLER_STATUS {words_per_column(design) if stream else 1}",
    ]
    if stream:
        lines.append(f"#define SCULLER_WORDS {words_per_result(design)}")
    if getattr(design.hardware, "hardening", None) is not None:
        lines.append("#define SCULLER_UPSET")
    code = resources.files("studies.upsets").joinpath("harness.cpp").read_text(encoding="utf-8")
    return "\n".join([*lines, code])


def _each(ports: list[Port]) -> str:
    return " ".join(f"X({port.name}, {port.bits})" for port in ports)
