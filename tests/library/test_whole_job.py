"""The main job through the front door, from a design to a navigated run."""

from __future__ import annotations

import os
import subprocess
import sys
from math import degrees
from pathlib import Path

import numpy as np
import pytest

import sculler
import sculler_hdl
import sculler_model
import sculler_sim

EXAMPLES = Path(__file__).parents[2] / "examples"

SCRIPT = """
import numpy as np
import sculler

design: sculler.Design = sculler.Design.preset("stim300")
core = sculler.generate(design)
text: str = core.verilog
log: sculler.Log = sculler.read_log("imu.csv", design)
vectors: sculler.VectorBlock = sculler.FastModel(design).feed(log)
rtl: sculler.VectorBlock = sculler.simulate(design, np.zeros((40, 6), np.int16))
first: sculler.Difference | None = sculler.compare(vectors, rtl)
phi = sculler.increments(design, vectors).phi
reveal_type(phi)
run: sculler.Navigated = sculler.navigate(design, vectors, lat=48, lon=11, height=500, align=300)
table = run.history.to_numpy()
live = sculler.LiveNavigator(design, lat=48.0, lon=11.0, height=500.0)
state: sculler.NavState | None = live.state
drift: float = sculler.coning_drift(design, 0.1, 50)
version: str = sculler.__version__
try:
    sculler.read_vectors("nothing.csv")
except sculler.Error:
    pass
"""


@pytest.mark.deep
def test_a_strict_type_checker_sees_every_name(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    script = tmp_path / "user.py"
    script.write_text(SCRIPT + "\n".join(f"sculler.{name}" for name in sculler.__all__) + "\n")
    packages = (sculler, sculler_hdl, sculler_model, sculler_sim)
    folders = [str(Path(str(package.__file__)).parents[1]) for package in packages]
    paths = os.pathsep.join(folder for folder in folders if "site-packages" not in folder)

    def check() -> str:
        done = subprocess.run(
            [sys.executable, "-m", "mypy", "--strict", "--no-incremental", str(script)],
            capture_output=True,
            encoding="utf-8",
            check=False,
            cwd=tmp_path,
            stdin=subprocess.DEVNULL,
            env={**os.environ, "MYPYPATH": paths},
        )
        return done.stdout

    told = check()
    assert "user.py" not in told.replace("user.py:13: note: Revealed type", "")
    assert "float64" in told
    script.write_text(SCRIPT.replace("lat=48,", "latitude=48,"))
    assert 'Unexpected keyword argument "latitude" for "navigate"' in check()


def test_from_a_design_to_a_run(tmp_path: Path) -> None:
    design = sculler.Design.load(EXAMPLES / "stim300_4x5.toml")
    motion = sculler.motion("turn", lat=48, lon=11, height=500, speed=30.0)
    sculler.write_log(tmp_path / "imu.csv", sculler.record(design, motion, 2))
    log = sculler.read_log(tmp_path / "imu.csv")
    vectors = sculler.FastModel(design).feed(log)
    sculler.write_vectors(tmp_path / "vectors.csv", vectors)
    golden = sculler.GoldenModel(design)
    rows = [golden.step((a, b, c), (d, e, f)) for a, b, c, d, e, f in log.counts.tolist()]
    assert list(vectors.rows()) == [row.row() for row in rows if row is not None]
    begin = motion.state(np.zeros(1)).state(0)
    roll, pitch, heading = (degrees(angle) for angle in begin.euler)
    for source in (vectors, tmp_path / "vectors.csv"):
        run = sculler.navigate(
            design,
            source,
            lat=48,
            lon=11,
            height=500,
            roll=roll,
            pitch=pitch,
            heading=heading,
            vn=begin.v[0],
            ve=begin.v[1],
            vd=begin.v[2],
        )
        truth = motion.state(run.history.time)
        assert np.abs(run.history.lat - truth.lat).max() * 6.4e6 < 1e-2
        assert np.abs(run.history.euler - truth.euler).max() < 1e-5
        assert run.history.time[-1] == pytest.approx(2.0)
        assert run.warnings == []


def test_the_simulated_hardware_gives_the_same_integers_and_times() -> None:
    design = sculler.Design.preset("hg4930", samples=2)
    log = sculler.record(design, sculler.motion("coning"), 0.4)
    vectors = sculler.FastModel(design).feed(log)
    rtl = sculler.simulate(design, log, engine="amaranth", stall=3)
    assert len(rtl) == 20
    assert sculler.compare(vectors, rtl) is None
    assert rtl.times is not None
    assert rtl.times.tolist() == pytest.approx([0.02 * (k + 1) for k in range(20)])


def test_a_core_is_written_as_the_command_line_does(tmp_path: Path) -> None:
    design = sculler.Design.preset("hg4930", samples=2)
    core = sculler.generate(design)
    written = core.write(tmp_path / "core")
    assert all(file.is_file() for file in written)
    for name, text in core.files.items():
        assert (tmp_path / "core" / name).read_text(encoding="utf-8") == text
    assert core.manifest.as_json()["latency_clocks"] == core.manifest.latency_clocks


def test_compare_tells_the_end_of_the_shorter_and_times() -> None:
    design = sculler.Design.preset("hg4930")
    log = sculler.record(design, sculler.motion("rest"), 0.4)
    block = sculler.FastModel(design).feed(log)
    short = sculler.FastModel(design).feed(log.counts[:20])
    for first, second, row in ((block, short, 5), (short, block, 5)):
        found = sculler.compare(first, second)
        assert found is not None
        assert (found.row, found.major, found.column) == (row, row, "major")
    assert log.times is not None
    late = sculler.FastModel(design).feed(sculler.Log(log.counts, times=log.times + 1))
    found = sculler.compare(block, late)
    assert found is not None
    assert (found.column, found.first, found.second) == ("time_s", 0.04, 1.04)


def test_vectors_of_another_design_are_refused() -> None:
    design = sculler.Design.preset("hg4930", position="high-resolution")
    block = sculler.FastModel(sculler.Design.preset("hg4930")).feed(np.zeros((40, 6), int))
    for job in (
        lambda: sculler.increments(design, block),
        lambda: sculler.navigate(design, block, lat=1, lon=2, height=3),
        lambda: sculler.compare(block, sculler.FastModel(design).feed(np.zeros((40, 6), int))),
    ):
        with pytest.raises(sculler.InputError, match="columns"):
            job()


def test_coning_drift_is_what_two_samples_leave() -> None:
    # with 2/3 s1 x s2 an interval of two samples makes of the coning, per sin² α and λ = ΩT,
    # 2/3 (2 sin λ - sin 2λ) where the truth is λ - ½ sin 2λ
    design = sculler.Design.preset("stim300", samples=2, minors=1)
    alpha, hertz = 0.01, 100.0
    lam = 2 * np.pi * hertz * design.sample_interval
    left = 2 / 3 * (2 * np.sin(lam) - np.sin(2 * lam)) - lam + np.sin(2 * lam) / 2
    expected = np.sin(np.radians(alpha)) ** 2 * left / design.major_interval
    found = sculler.coning_drift(design, alpha, hertz)
    assert abs(found) == pytest.approx(abs(np.degrees(expected) * 3600), rel=1e-4)
    # sculling of the same product of amplitudes leaves as much
    force = np.sin(np.radians(alpha)) * 2 * np.pi * hertz
    other = sculler.sculling_drift(design, np.degrees(np.sin(np.radians(alpha))), force, hertz)
    assert other == pytest.approx(expected, rel=1e-9)
