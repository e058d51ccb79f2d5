"""What the simulation tests share: tools or a reason to skip, stub cores."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from sculler_model.design import AXES, COMPONENTS, VECTORS, Design
from sculler_model.errors import InputError
from sculler_sim.engines import cache, verilator_build
from strategies import DESIGNS


@pytest.fixture(scope="session")
def verilator() -> verilator_build.Tools:
    """The tools of the Verilator engine."""
    try:
        return verilator_build.Tools.find()
    except InputError as error:
        pytest.skip(str(error))


@pytest.fixture
def icarus() -> None:
    """Icarus Verilog is there."""
    if shutil.which("iverilog") is None:
        pytest.skip("Icarus Verilog (iverilog) is not installed")


@pytest.fixture
def own_cache(
    verilator: verilator_build.Tools, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Path:
    """A cache folder for one test, holding Verilog and Verilator's runtime but no simulator."""
    verilator_build.build(DESIGNS["smallest"])
    folder = tmp_path / "cache"
    folder.mkdir()
    for path in cache.folder().iterdir():
        if path.suffix in (".o", ".json"):
            shutil.copy(path, folder)
    monkeypatch.setenv("SCULLER_CACHE", str(folder))
    return folder


@pytest.fixture
def use_verilog(
    verilator: verilator_build.Tools, monkeypatch: pytest.MonkeyPatch
) -> Callable[[Design, str], None]:
    """Put a body of Verilog, with the design's ports, in the place of the generated core."""

    def use(design: Design, body: str) -> None:
        text = stub_core(design, body)
        monkeypatch.setattr(verilator_build, "emitted", lambda _: {"core.v": text})

    return use


def stub_core(design: Design, body: str) -> str:
    """A module with the ports of the design's core (contract of `sculler_model.golden`)."""
    words = design.words
    inputs = [(name, 1) for name in ("clk", "rst", "sample_valid", "sample_fault", "result_ready")]
    for sensor in ("gyro", "accel"):
        inputs += [(f"sample_{sensor}_{axis}", getattr(words, sensor).bits) for axis in AXES]
    outputs = [("sample_ready", 1), ("result_valid", 1)]
    if design.hardware.handover == "stream":
        outputs += [("result_data", 16), ("result_last", 1)]
    else:
        outputs += [("result_major", 64), ("result_status", 4)]
        widths = [getattr(words, vector).bits for vector in VECTORS for _ in AXES]
        outputs += [(f"result_{name}", bits) for name, bits in zip(COMPONENTS, widths, strict=True)]
    outputs.append(("samples_lost", 16))
    ports = [f"input [{bits - 1}:0] {name}" for name, bits in inputs]
    ports += [f"output [{bits - 1}:0] {name}" for name, bits in outputs]
    return f"module {design.name} (\n  {', '.join(ports)});\n{body}\nendmodule\n"
