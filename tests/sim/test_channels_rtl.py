"""The Verilog of a core with many channels: each as a core of its own, bit for bit."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bench_files import bench_of, shell
from hdl_channels import drawn, many
from sculler.main import main
from sculler_hdl import generate
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import FastChannels, VectorBlock
from sculler_sim.engine import simulate, trace
from sculler_sim.engines.verilator_build import Tools
from sculler_sim.run import RESET
from sculler_sim.stimulus import Stimulus
from strategies import DESIGNS, with_hardware

deep = pytest.mark.deep
CASES: list[Any] = [
    pytest.param("taylor_3p3", {"channels": 5}, 900, id="history"),
    *(
        pytest.param(name, hardware, samples, marks=deep, id=name)
        for name, hardware, samples in (
            ("smallest", {"channels": 3, "reset_active": "low"}, 4000),
            ("dense_odd_3", {"channels": 4, "target": "ice40"}, 6000),
            ("early_taps_2", {"channels": 3}, 4000),
            ("both_taps_2", {"channels": 3, "target": "ice40"}, 4000),
            ("late_sum_2", {"channels": 2, "initial": False}, 6000),
            ("rate_1p0", {"channels": 6, "multipliers": 0, "target": "ice40"}, 1500),
            ("stim300_4x5", {"channels": 17, "target": "ecp5"}, 6000),
            ("taylor_3p1", {"channels": 4, "target": "ecp5"}, 4000),
            ("wide_5p0", {"channels": 2, "target": "nexus"}, 3000),
            ("taylor_8p8", {"channels": 3, "target": "gowin"}, 3000),
            ("dense_uncompressed_4", {"channels": 256}, 12000),
        )
    ),
    *(
        pytest.param(
            name,
            {"core": "pipelined", **hardware},
            samples,
            marks=deep,
            id=f"fast_{name}_{hardware['channels']}",
        )
        for name, hardware, samples in (
            ("taylor_3p3", {"channels": 5}, 3000),
            ("smallest", {"channels": 3, "reset_active": "low"}, 2000),
            ("dense_odd_3", {"channels": 4, "target": "ice40"}, 4000),
            ("early_taps_2", {"channels": 2}, 3000),
            ("both_taps_2", {"channels": 3, "target": "xilinx"}, 3000),
            ("late_sum_2", {"channels": 2, "initial": False}, 4000),
            ("rate_1p0", {"channels": 6, "target": "ice40"}, 1500),
            ("stim300_4x5", {"channels": 64, "target": "ecp5"}, 9000),
            ("taylor_3p1", {"channels": 20, "target": "ecp5", "multipliers": 40}, 6000),
            ("taylor_2p0", {"channels": 17, "target": "ecp5"}, 6000),
            ("taylor_2p0", {"channels": 16, "target": "ecp5"}, 6000),  # the most without blocks
            ("early_taps_2", {"channels": 1024, "target": "ecp5"}, 8000),
            ("wide_5p0", {"channels": 2, "target": "nexus"}, 3000),
            ("taylor_8p8", {"channels": 3, "target": "gowin", "multipliers": 60}, 3000),
            ("dense_uncompressed_4", {"channels": 256}, 15000),
        )
    ),
]


def alone(design: Design, channel: int, samples: tuple[np.ndarray, ...]) -> list[tuple[int, ...]]:
    """Rows of a core of one channel, in Verilator, that takes this channel's samples alone."""
    counts, channels, faults, restarts = samples
    mine = np.flatnonzero(channels == channel)
    chunks: list[Any] = []
    for number, part in enumerate(np.split(mine, np.flatnonzero(restarts[mine]))):
        chunks += [RESET] * (number > 0) + [(counts[part], faults[part])]
    hardware = design.as_json()["hardware"]
    single = with_hardware(design, **{**hardware, "channels": 1})
    return [row for block in simulate(single, chunks) for row in block.rows()]


@pytest.mark.parametrize(("name", "hardware", "count"), CASES)
def test_channels_are_cores_of_their_own(name: str, hardware: dict[str, Any], count: int):
    """Random interleaving, restarts and stalls; three channels at most are run as single cores."""
    design = many(name, **hardware)
    samples = drawn(design, count, seed=count)
    counts, channels, faults, restarts = samples
    half = count // 2
    chunks: list[Any] = [
        (counts[part], channels[part], faults[part], restarts[part])
        for part in (slice(half), slice(half, None))
    ]
    run = simulate(design, chunks, stimulus=Stimulus.stalls(count))
    found = VectorBlock.concatenate(list(run))
    assert found.channels is not None
    expected = FastChannels(design).feed(counts, channels, faults, restarts)
    assert found.first_difference(expected) is None
    assert len(found) == len(expected) > 20
    assert found.channels.tolist() == expected.channels.tolist()
    for channel in range(min(3, design.channels)):
        mine = found[found.channels == channel]
        assert list(mine.rows()) == alone(design, channel, samples)


@pytest.mark.parametrize(("name", "hardware", "count"), CASES)
def test_every_port_on_every_clock(name: str, hardware: dict[str, Any], count: int):
    design = many(name, **hardware)
    counts, channels, faults, restarts = drawn(design, count, seed=1)
    clocks = 20 * count
    stimulus = Stimulus.stalls(5).with_resets(clocks // 3, clocks // 3 + 700).giving_up()
    verilog, model = (
        trace(design, counts, faults, stimulus, clocks, engine, channels, restarts)
        for engine in ("verilator", "model")
    )
    assert verilog.first_difference(model) is None
    assert model.sample_ready.any()


@deep
@pytest.mark.parametrize(
    ("hardware", "spacing", "apart"),
    [
        ({"target": "ecp5"}, 1, 4),
        ({"target": "ice40"}, 1, 3),
        ({"target": "ecp5", "multipliers": 40}, 3, 4),
    ],
)
def test_a_channel_may_come_back_after_any_number_of_others(
    hardware: dict[str, Any], spacing: int, apart: int
):
    """One channel alone, two by turns, three by turns, ...: a sample offered in every clock.

    No major interval ends before all of that is through, so that no result keeps samples back: a
    turn takes `spacing` clocks for each sample, or `apart` if its channel comes back before.
    """
    design = many("taylor_3p1", core="pipelined", channels=8, **hardware)
    said = design.as_json()
    design = Design.parse({**said, "algorithm": {**said["algorithm"], "minors": 64}})
    turns, rounds = range(1, 9), 23
    whose = [np.tile(np.arange(turn), rounds) for turn in turns]
    missing = 3 * 64 - np.bincount(np.concatenate(whose))
    rest = np.random.default_rng(7).permutation(np.repeat(np.arange(8), missing))
    order = np.concatenate([*whose, rest])
    counts, _, faults, _ = drawn(design, len(order), seed=7)
    seen, model = (
        trace(design, counts, faults, Stimulus(), 9000, engine, order)
        for engine in ("verilator", "model")
    )
    assert seen.first_difference(model) is None
    taken = np.flatnonzero(seen.sample_ready)
    for turn, end in zip(turns, np.cumsum([len(part) for part in whose]), strict=True):
        assert taken[end - turn] - taken[end - 3 * turn] == 2 * max(apart, turn * spacing)
    none = np.zeros(len(order), np.int64)
    chunk: Any = (counts, order, faults, none)
    found = VectorBlock.concatenate(list(simulate(design, [chunk])))
    expected = FastChannels(design).feed(counts, order, faults, none)
    assert found.first_difference(expected) is None
    assert sorted(found.channels.tolist()) == list(range(8))


def test_what_does_not_fit_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    design = many("smallest", channels=3)
    rows = np.zeros((4, 6), int)
    for chunk, told in (
        ((rows, None), "samples from 0 on: no channels, but hardware.channels = 3"),
        ((rows, np.full(4, 3), None, None), "sample 0: channel 3 is not there, give 0 to 2"),
        ((rows, np.zeros(3, int), None, None), "samples from 0 on: give 4 channels and restarts"),
    ):
        with pytest.raises(InputError) as raised:
            list(simulate(design, [chunk], engine="model"))
        assert str(raised.value) == told
    run = simulate(DESIGNS["smallest"], [(rows, np.zeros(4, int), None, None)], engine="model")
    with pytest.raises(InputError, match=r"channels, but hardware\.channels = 1"):
        list(run)


@pytest.mark.parametrize("core", ["compact", pytest.param("pipelined", marks=deep)])
def test_the_verbs_take_a_log_through_the_core(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, core: str
):
    monkeypatch.chdir(tmp_path)
    Path("two.toml").write_text(
        'name = "two"\npreset = "stim300"\n[algorithm]\nsamples = 2\nminors = 1\n'
        f'[hardware]\ncore = "{core}"\nchannels = 2\n'
    )
    rng = np.random.default_rng(4)
    rows = np.column_stack([rng.integers(0, 2, 24), rng.integers(-(2**23), 2**23, (24, 6))])
    header = "channel,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\n"
    text = "".join(",".join(map(str, row)) + "\n" for row in rows.tolist())
    Path("log.csv").write_text(header + text)
    assert main("model two.toml log.csv -o m.csv".split()) == 0
    assert main("simulate two.toml log.csv -o s.csv --engine amaranth --stall 2".split()) == 0
    assert Path("m.csv").read_bytes() == Path("s.csv").read_bytes()
    for option in ("--package", "--data-sheet"):
        assert main(["generate", "two.toml", "-o", "g", option]) == 2


def test_the_manifest_tells_of_channels():
    manifest = generate(many("smallest", channels=3)).manifest.as_json()
    ports = {port["name"]: port["width"] for port in manifest["ports"]}
    assert (ports["sample_channel"], ports["sample_restart"], ports["result_channel"]) == (2, 1, 2)
    assert manifest["timing"]["results"] == 2
    assert manifest["resources"]["sample_words"] == 3 * 4 * 6


BENCHES: list[Any] = [
    pytest.param("early_taps_2", {"channels": 2, "target": "ice40"}, id="two"),
    *(
        pytest.param(name, hardware, marks=deep, id=f"{hardware.get('core', 'compact')}_{name}")
        for name, hardware in (
            ("smallest", {"channels": 3, "target": "ice40", "initial": False}),
            ("taylor_3p3", {"channels": 5, "target": "ecp5"}),
            ("stim300_4x5", {"channels": 100}),  # memories without initial values
            ("smallest", {"core": "pipelined", "channels": 5, "initial": False}),
            ("taylor_3p3", {"core": "pipelined", "channels": 40, "target": "ecp5"}),
            ("taylor_3p1", {"core": "pipelined", "channels": 2, "multipliers": 40}),
        )
    ),
]


@pytest.mark.parametrize(("name", "hardware"), BENCHES)
def test_the_bench_passes_in_icarus_without_a_warning(
    icarus: None, tmp_path: Path, name: str, hardware: dict[str, Any]
):
    design = many(name, **hardware)
    done = shell(bench_of(design, tmp_path)["icarus"], tmp_path)
    assert done.stderr == ""
    assert done.stdout.startswith("PASS: ")
    assert done.returncode == 0


@deep
@pytest.mark.parametrize("column", ["result_channel", "result_data", "sample_ready"])
def test_the_bench_sees_a_core_that_is_wrong(icarus: None, tmp_path: Path, column: str):
    """A bit between core and bench is turned over."""
    design = many("early_taps_2", channels=2)
    command = bench_of(design, tmp_path)["icarus"]
    bench = tmp_path / f"{design.name}_tb.v"
    text = bench.read_text()
    wrong = re.sub(
        rf"^  wire (\[\d+:0\] )?{column};$",
        rf"  wire \1turned; wire \1{column} = turned ^ 1'b1;",
        text.replace(f".{column}({column})", f".{column}(turned)"),
        flags=re.M,
    )
    assert wrong.count("turned") == 3
    bench.write_text(wrong)
    done = shell(command, tmp_path)
    assert f"{column}: " in done.stdout
    assert done.stdout.startswith("FAIL")


@pytest.mark.parametrize(("name", "hardware"), BENCHES)
def test_verilators_full_lint_has_nothing_to_say(
    verilator: Tools, tmp_path: Path, name: str, hardware: dict[str, Any]
):
    design = many(name, **hardware)
    bench_of(design, tmp_path)
    files = sorted(path.name for path in tmp_path.glob("*.v"))
    lint = [*verilator.verilator, "--lint-only", "-Wall", "--timing"]
    done = subprocess.run(
        [*lint, "--top-module", f"{design.name}_tb", *files],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        env=verilator.environment,
    )
    assert (done.returncode, done.stderr) == (0, "")
