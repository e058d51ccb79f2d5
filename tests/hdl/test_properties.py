"""NAME_properties.sv: read by Verilator and slang without a word, bound, asserted in simulation."""

from __future__ import annotations

import os
import re
import shutil
import subprocess

import pytest

from bench_files import bench_of
from sculler_hdl import generate
from strategies import DESIGNS, with_hardware
from tiers import few_of

VARIANTS = {
    "-".join([name, *map(str, hardware.values())]): with_hardware(DESIGNS[name], **hardware)
    for name, hardware in (
        ("stim300_4x5", {"target": "ecp5"}),
        ("smallest", {"overrun": "drop-result"}),
        ("smallest", {"core": "compact", "overrun": "drop-result"}),
        ("taylor_3p3", {"handover": "stream"}),
        ("dense_odd_3", {"core": "compact", "initial": False}),
    )
}
EVERY = pytest.mark.parametrize("design", few_of(VARIANTS, ["smallest-compact-drop-result"]))


def written(design, folder):
    made, name = generate(design), design.name
    texts = {f"{name}.v": made.verilog, **{f"{c}.v": text for c, text in made.cells.items()}}
    texts[f"{name}_properties.sv"] = made.further[f"{name}_properties.sv"]
    for file, text in texts.items():
        (folder / file).write_text(text)
    return [str(folder / file) for file in texts]


@EVERY
@pytest.mark.parametrize("role", ["", "SCULLER_ASSUME"])
def test_verilator_has_nothing_to_say(verilator, design, role, tmp_path):
    files = written(design, tmp_path)
    defines = [f"-D{role}"] if role else []
    done = verilator(
        "--lint-only", "--assert", "-Wall", "-quiet", *defines, "--top-module", design.name, *files
    )
    assert (done.returncode, done.stderr) == (0, "")


@EVERY
def test_slang_has_nothing_to_say(design, tmp_path):
    pytest.importorskip("pyslang")
    from pyslang import driver

    slang = driver.Driver()
    slang.addStandardArgs()
    words = ["slang", "--top", design.name, "-Wextra", *written(design, tmp_path)]
    assert slang.parseCommandLine(" ".join(words))
    assert slang.processOptions()
    assert slang.parseAllSources()
    slang.reportCompilation(slang.createCompilation(), quiet=True)
    assert slang.textDiagClient.getString() == ""


@pytest.mark.deep
@pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")
@pytest.mark.parametrize("design", VARIANTS.values(), ids=VARIANTS)
def test_the_bench_passes_with_the_properties_bound(verilator, design, tmp_path):
    """And where status bit 1 is not raised it is an assertion that says so."""
    bench_of(design, tmp_path)
    files = written(design, tmp_path)
    core, bench = (tmp_path / f"{design.name}{end}" for end in (".v", "_tb.v"))
    whole, goes_on = core.read_text(), bench.read_text().replace("      $stop;", "")
    for text, expected in ((whole, "PASS"), (without_faults(whole), "fault_as_due")):
        core.write_text(text)
        if text != whole:  # the bench sees it, too, and is not to end the run
            bench.write_text(goes_on)
        made = verilator(
            *(
                "--binary",
                "--timing",
                "--output-split",
                "0",
                "--assert",
                "-CFLAGS",
                "-std=c++20 -O0",
                "-Wno-fatal",
            ),
            *("--Mdir", str(tmp_path / "made"), "--top-module", f"{design.name}_tb"),
            *(str(bench), *files),
        )
        assert made.returncode == 0, made.stderr
        done = subprocess.run(
            [tmp_path / "made" / f"V{design.name}_tb", f"+vectors={tmp_path}"],
            env=os.environ,
            capture_output=True,
            text=True,
            check=False,
        )
        assert expected in done.stdout + done.stderr


def without_faults(verilog):
    """The mark of a faulty sample does not come in."""
    text, count = re.subn(r"\.(sample_fault|fault)\(sample_fault\)", r".\1(1'h0)", verilog)
    assert count
    return text
