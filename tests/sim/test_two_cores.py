"""Generated folders of two cores in one project, as one list of files."""

import shlex
import shutil
from itertools import permutations

import pytest

from bench_files import bench_of, shell
from sculler_hdl import cell_models
from strategies import make_design, with_hardware
from tiers import few_of


def core(name, **hardware):
    return with_hardware(make_design(name, 1, 1, 2, (18, 20)), **hardware)


CORES = [
    core("first", core="compact", target="ecp5"),
    core("second", core="pipelined", target="ecp5"),
    core("third", core="compact", target="ice40"),
    core("fourth", core="pipelined", target="generic"),
]
PAIRS = [(CORES[0], CORES[1]), (CORES[0], CORES[2]), (CORES[2], CORES[3])]
NAMED = {"-".join(design.name for design in pair): pair for pair in PAIRS}
EACH_PAIR = pytest.mark.parametrize("pair", few_of(NAMED, ["first-second"]))


def project(pair, folder):
    """Both folders as `generate` leaves them; all their Verilog files."""
    for design in pair:
        (folder / design.name).mkdir()
        bench_of(design, folder / design.name)
    return sorted(str(path.relative_to(folder)) for path in folder.glob("*/*.v"))


@pytest.mark.usefixtures("icarus")
@EACH_PAIR
def test_both_benches_pass_in_icarus(pair, tmp_path):
    files = shlex.join(project(pair, tmp_path))
    for design in pair:
        top = f"{design.name}_tb"
        done = shell(
            f"iverilog -g2005 -Wall -s {top} -o {top}.vvp {files}"
            f" && vvp -n {top}.vvp +vectors={design.name}",
            tmp_path,
        )
        assert done.stderr == ""
        assert done.stdout.startswith("PASS: ")


@pytest.mark.deep
def test_both_are_read_and_one_runs_in_verilator(verilator, tmp_path):
    """Two cores with models of the same blocks."""
    first, second = PAIRS[0]
    files = project(PAIRS[0], tmp_path)
    shared = {name for name in cell_models() if sum(f.endswith(f"/{name}.v") for f in files) == 2}
    assert shared == {"MULT18X18D"}
    for design in (first, second):
        top = f"{design.name}_tb"
        lint = [*verilator.verilator, *"--lint-only --timing -Wall --top-module".split(), top]
        done = shell(shlex.join([*lint, *files]), tmp_path)
        assert (done.returncode, done.stderr) == (0, "")
    if shutil.which("make") is None:
        pytest.skip("make is not installed")
    build = f"--binary --timing -CFLAGS -std=c++20 --top-module {first.name}_tb -o bench".split()
    quick = {"VERILATOR_ROOT": str(verilator.root), "MAKEFLAGS": "-j2 OPT_FAST=-O0 OPT_GLOBAL=-O0"}
    built = shell(shlex.join([*verilator.verilator, *build, *files]), tmp_path, **quick)
    assert built.returncode == 0, built.stderr
    passed = shell(f"obj_dir/bench +vectors={first.name}", tmp_path)
    assert passed.stdout.startswith("PASS: ")


def test_no_name_but_a_models_is_declared_twice(tmp_path):
    """Modules, and macros, which have no scope."""
    for pair in permutations(CORES, 2):
        folder = tmp_path / "-".join(design.name for design in pair)
        folder.mkdir()
        declared = [
            word
            for file in project(pair, folder)
            for line in (folder / file).read_text().splitlines()
            for keyword, word in [(*line.split(), "", "")[:2]]
            if keyword in ("module", "`define")
        ]
        twice = {word for word in declared if declared.count(word) > 1}
        guards = {f"SCULLER_MODEL_{name}" for name in cell_models()}
        assert twice <= cell_models().keys() | guards
        assert len(declared) >= 4


@pytest.mark.parametrize("name", cell_models())
def test_a_model_is_guarded_by_its_own_name(name):
    lines = [line for line in cell_models()[name].splitlines() if not line.startswith("//")]
    assert lines[:2] == [f"`ifndef SCULLER_MODEL_{name}", f"`define SCULLER_MODEL_{name}"]
    assert lines[2].startswith(f"module {name} ")
    assert lines[-2:] == ["endmodule", "`endif"]
