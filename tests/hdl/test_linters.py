"""What two more readers of Verilog say of the emitted text: slang and Verible's linter."""

from __future__ import annotations

import shutil
import subprocess
import sysconfig
from pathlib import Path

import pytest

from sculler_hdl import generate
from strategies import DESIGNS, with_hardware
from tiers import tiers

VARIANTS = {
    f"{name}-{'-'.join(map(str, hardware.values()))}": with_hardware(DESIGNS[name], **hardware)
    for name, hardware in (
        ("stim300_4x5", {"core": "pipelined"}),
        ("rate_4p1", {"core": "pipelined", "target": "ecp5"}),
        ("smallest", {"core": "pipelined", "target": "ice40", "handover": "stream"}),
        ("dense_odd_3", {"core": "compact"}),
        ("dense_odd_3", {"core": "compact", "target": "ecp5"}),
        ("dense_odd_3", {"core": "compact", "initial": False}),
        ("smallest", {"reset": "async", "reset_active": "low", "clock_enable": True}),
    )
}

NOT_IN_VERILOG = "-unpacked-dimensions-range-ordering"
"""A rule that asks for `[N]`, which is SystemVerilog."""


@pytest.fixture(params=tiers(VARIANTS))
def files(request: pytest.FixtureRequest, tmp_path: Path) -> list[Path]:
    """The core's text, then the models of blocks that it needs."""
    made = generate(request.param)
    paths = []
    for name, text in {request.param.name: made.verilog, **made.cells}.items():
        paths.append(tmp_path / f"{name}.v")
        paths[-1].write_text(text)
    return paths


def test_slang_has_nothing_to_say(files: list[Path]) -> None:
    """As Verilog-2005 and as SystemVerilog."""
    pytest.importorskip("pyslang")
    from pyslang import driver

    for language in ("1364-2005", "1800-2017"):
        slang = driver.Driver()
        slang.addStandardArgs()
        words = ["slang", "--std", language, "--top", files[0].stem, "-Wextra", *map(str, files)]
        assert slang.parseCommandLine(" ".join(words))
        assert slang.processOptions()
        assert slang.parseAllSources()
        slang.reportCompilation(slang.createCompilation(), quiet=True)
        assert slang.textDiagClient.getString() == ""


def test_veribles_linter_has_nothing_to_say(files: list[Path]) -> None:
    """Of the core; parameters of the blocks' models have no type, as the vendors' have none."""
    lint = Path(sysconfig.get_path("scripts")) / "verible-verilog-lint"
    found = str(lint) if lint.exists() else shutil.which(lint.name)
    if found is None:
        pytest.skip("Verible is not installed")
    done = subprocess.run(
        [found, f"--rules={NOT_IN_VERILOG}", files[0]], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
