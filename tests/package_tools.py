"""Tools that read a package's files: a Tcl that records, FuseSoC with the programs it calls."""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

import pytest

from sculler_sim.engines.verilator_build import Tools


def tcl_commands(script: Path) -> list[tuple[str, ...]]:
    """What a script tells a tool, by a real Tcl, word by word."""
    tkinter = pytest.importorskip("tkinter")
    tcl, said = tkinter.Tcl(), []

    def told(*words: str) -> str:
        said.append(words)
        return f"<{' '.join(words)}>"  # what a later command gets for it

    tcl.createcommand("unknown", told)
    tcl.eval("rename package {}")
    tcl.call("source", str(script))
    return said


def programs(folder: Path, **made: str) -> dict[str, str]:
    """Surroundings in which the tools of the Python environment have the names FuseSoC calls."""
    folder.mkdir()
    for name, text in made.items():
        path = folder / name.replace("_", "-")
        path.write_text(text)
        path.chmod(0o755)
    scripts = sysconfig.get_path("scripts")
    return {**os.environ, "PATH": os.pathsep.join([str(folder), scripts, os.environ["PATH"]])}


def fusesoc(cores: Path, work: Path, target: str, name: str, **made: str) -> Any:
    pytest.importorskip("fusesoc")
    work.mkdir()
    code = "import sys; from fusesoc.main import main; sys.exit(main())"
    words = ["-c", code, "--cores-root", cores, "run", "--target", target, f"sculler:core:{name}"]
    return subprocess.run(
        [sys.executable, *map(str, words)],
        cwd=work,
        env=programs(work / "bin", **made),
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def verilator_program() -> str:
    """A program of that name: the wheel's own command would find this one again."""
    root = Tools.find().root
    return f'#!/bin/sh\nVERILATOR_ROOT="{root}" exec perl "{root}/bin/verilator" "$@"\n'
