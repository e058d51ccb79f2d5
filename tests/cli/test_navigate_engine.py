"""`navigate --engine c` and `generate --host c`: the same files, or one clear line."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from math import radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sculler
from fine_sensor import fine_design_file
from sculler.formats.log import LogWriter
from sculler_model.design import Design
from sculler_model.motion import turn_motion
from sculler_model.samples import Quantiser

Run = Callable[..., Any]
Refused = Callable[..., str]

PLACE = ("--lat", 48, "--lon", 11, "--height", 500)
needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("engine")


@pytest.fixture
def turning(run: Run, folder: Path) -> tuple[Path, Path]:
    """Design and vectors of 40 s of a turn, in which three samples are lost."""
    toml, out = fine_design_file(folder, 2, 5, rate=200.0), folder / "vectors.csv"
    if out.exists():
        return toml, out
    motion = turn_motion(radians(48), radians(11), 500.0)
    values = np.concatenate(list(motion.chunks("increment", 8000, 1 / 200)))
    times = 4000.5 + np.arange(1, 8001) / 200
    there = np.ones(8000, np.bool_)
    there[4001:4004] = False
    with LogWriter(folder / "log.csv", times=True) as writer:
        writer.write(Quantiser(Design.load(toml))(values)[there], times=times[there])
    log = folder / "log.csv"
    assert run("model", toml, log, "-o", out, "--breaks", "split").status == 0
    return toml, out


@needs_gcc
@pytest.mark.parametrize(
    "options",
    [
        ("--third-order", "--axes", "y,-x,z"),
        ("--position-every", 4, "--height-damping", 30, "--gravity", "constant:9.8"),
        ("--gravity", "FILE", "--stop", 4030),
    ],
    ids=["third order", "settings", "gravity table"],
)
def test_files_are_those_of_the_host_in_python(
    run: Run, tmp_path: Path, turning: tuple[Path, Path], options: tuple[object, ...]
) -> None:
    """To the byte, over a break, whatever is asked for."""
    table = tmp_path / "gravity.csv"
    table.write_text("lat_deg,height_m,gravity\n40,0,9.8\n60,0,9.82\n")
    asked = [table if option == "FILE" else option for option in options]
    toml, vectors = turning
    found = {}
    for engine in ("python", "c"):
        out, frames = tmp_path / f"{engine}.csv", tmp_path / f"{engine}.frames"
        outcome = run(
            *("navigate", toml, vectors, "-o", out, *PLACE, "--ve", 30, "--no-plots", "--json"),
            *("--breaks", "split", "--engine", engine, *asked),
            *("--telemetry", frames),
        )
        assert outcome.status == 0, outcome.err
        said = json.loads(outcome.out)
        assert said.pop("engine") == engine
        del said["output"], said["telemetry"]
        found[engine] = (out.read_bytes(), frames.read_bytes(), said)
    assert len(found["c"][0].splitlines()) > 400
    assert found["c"] == found["python"]


@needs_gcc
def test_the_library_takes_either_engine() -> None:
    """Whole runs, and a live host that takes results one by one."""
    design = sculler.Design.preset("hg4930")
    log = sculler.record(design, sculler.motion("turn"), 1.0)
    vectors, begin = sculler.FastModel(design).feed(log.counts), {"lat": 48, "lon": 11, "height": 5}
    whole = sculler.navigate(design, vectors, ve=30, **begin)
    found = sculler.navigate(design, vectors, ve=30, engine="c", **begin)
    assert np.array_equal(found.history.to_numpy(), whole.history.to_numpy())
    live = sculler.LiveNavigator(design, ve=30, engine="c", **begin)
    parts = [live.feed_vectors(vectors[row : row + 1]) for row in range(len(vectors))]
    states = np.concatenate([part.to_numpy() for part in parts])
    assert np.array_equal(states[:, 1:], whole.history.to_numpy()[:, 1:])
    with pytest.raises(sculler.Error, match="engine: 'ada' is not allowed"):
        sculler.navigate(design, vectors, engine="ada", **begin)
    with pytest.raises(sculler.Error, match="compiled is for the engine python"):
        sculler.LiveNavigator(design, engine="c", compiled=True, **begin)


@needs_gcc
def test_a_run_says_by_what_it_was_computed(
    run: Run, tmp_path: Path, turning: tuple[Path, Path]
) -> None:
    toml, vectors = turning
    words = ("navigate", toml, vectors, "-o", tmp_path / "n.csv", *PLACE, "--no-plots")
    said = run(*words, "--breaks", "split", "--engine", "c").out
    assert "the host in C, compiled" in said


@needs_gcc
def test_alignments_agree_to_rounding(run: Run, tmp_path: Path) -> None:
    log, vectors = tmp_path / "log.csv", tmp_path / "vectors.csv"
    made = ("motion", "rest", "--design", "lasergyro", "-o", log, "--heading", 50)
    outcome = run(*made, "--truth", tmp_path / "truth.csv", "--duration", 24)
    assert outcome.status == 0, outcome.err
    assert run("model", "lasergyro", log, "-o", vectors).status == 0
    told = []
    for engine in ("python", "c"):
        words = ("navigate", "lasergyro", vectors, "-o", tmp_path / "n.csv", *PLACE, "--no-plots")
        outcome = run(*words, "--align", 20, "--fine", "--engine", engine, "--json")
        assert outcome.status == 0, outcome.err
        told.append(json.loads(outcome.out))
    one, other = told
    for axis, angle in one["start_attitude_deg"].items():
        assert other["start_attitude_deg"][axis] == pytest.approx(angle, abs=1e-6)
    sigma, found = one["alignment"].pop("sigma_deg"), other["alignment"].pop("sigma_deg")
    assert found == pytest.approx(sigma, rel=1e-4)
    assert other["alignment"]["warnings"] == one["alignment"]["warnings"]


def test_what_the_host_in_c_cannot_do_is_refused(
    refused: Refused,
    tmp_path: Path,
    turning: tuple[Path, Path],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    toml, vectors = turning
    words = ("navigate", toml, vectors, "-o", tmp_path / "n.csv", *PLACE, "--engine", "c")
    said = refused(*words, "--mechanisation", "geographic")
    assert "--engine c has the wander azimuth only, leave out --mechanisation" in said
    for other in ("--azimuth free", "--attitude cosines", "--level-every 2"):
        said = refused(*words, *other.split())
        assert "--azimuth, --attitude and --level-every and --rotation are for the engine" in said
    assert "leave them out" in refused(*words, "--rotation", "first-order")

    monkeypatch.setenv("CC", "no-such-compiler")
    assert "the engine c needs a C compiler (no-such-compiler), not found" in refused(*words)
    monkeypatch.setenv("CC", "'")
    assert "is no command" in refused(*words)
    monkeypatch.setenv("SCULLER_CACHE", str(tmp_path.parent / f"{tmp_path.name}-cache"))
    monkeypatch.setenv("CC", "false")
    said = refused(*words)
    assert "false failed (status 1) while compiling the host, see" in said
    assert "false -O2" in Path(said.rpartition("see ")[2]).read_text()


def test_generate_writes_the_host_beside_the_core(run: Run, tmp_path: Path) -> None:
    outcome = run("generate", "hg4930", "-o", tmp_path / "with", "--host", "c", "--json")
    assert outcome.status == 0, outcome.err
    said = json.loads(outcome.out)
    files = {Path(file).name for file in said["files"]}
    assert files == {path.name for path in (tmp_path / "with").iterdir()}
    more = {"hg4930_4x1_host.h", "hg4930_4x1_host.c", "sculler_nav.h", "sculler_nav.c"}
    assert more <= files
    own = {name for name in files if name.startswith(("sculler_", "hg4930_4x1_host."))}
    assert not any("host" in name or "sculler" in name for name in files - own)
