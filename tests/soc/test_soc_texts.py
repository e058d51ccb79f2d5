"""What a chip is made of, and what is refused."""

from __future__ import annotations

import random
import struct
import subprocess
import zlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler.library import motions
from sculler.main import main
from sculler.runs.chip import short_results
from sculler.soc import (
    SocPlan,
    check_soc,
    chip_alignment,
    compile_firmware,
    firmware_texts,
    follow,
    makefile,
    read_chip,
    soc_texts,
)
from sculler_hdl.export.register_files import c_header
from sculler_hdl.plan.registers import RegisterMap
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel, VectorBlock
from sculler_model.host import major_increments
from sculler_model.navigation import NavHistory, Navigator, NavState, SensorNoise, coasted
from soc.conftest import START, design_of, needs_compiler


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"front": None}, r"add a \[hardware.front\]"),
        ({"bus": None}, r'result = "wishbone"'),
        ({"bus": {"result": "axi-lite"}}, r'result = "wishbone"'),
        ({"bus": {"result": "wishbone", "time_stamps": False}}, "time_stamps = true"),
        ({"front": {"sensor": "stim300", "clock_hz": 15.2e6}}, "faster clock"),
    ],
)
def test_a_design_that_is_none_for_a_chip(changes: dict[str, Any], said: str) -> None:
    data: dict[str, Any] = {"core": "compact", "bus": {"result": "wishbone"}}
    data["front"] = {"sensor": "stim300", "clock_hz": 40e6}
    data = {key: value for key, value in {**data, **changes}.items() if value is not None}
    with pytest.raises(InputError, match=said):
        check_soc(Design.parse({"preset": "stim300", "name": "chip", "hardware": data}))


@pytest.mark.parametrize("memory", [0, 16, 48, 2048])
def test_memory_is_a_power_of_two(memory: int) -> None:
    with pytest.raises(InputError, match="power of two"):
        SocPlan(design_of(), START, memory_kib=memory)


def test_the_initial_state_is_written_to_the_last_bit() -> None:
    text = firmware_texts(SocPlan(design_of(), START, position_every=5))["chip_start.h"]
    for number in (*START.q, *START.v, START.lat, START.lon, START.h):
        assert number.hex() in text
    assert "#define CHIP_POSITION_EVERY 5u" in text


def test_results_of_short_history_are_told() -> None:
    """None where no tap reaches back; else of the first interval, which lacks what was before."""
    assert short_results(design_of()) == 0
    reaching = {"preset": "stim300", "name": "chip", "algorithm": {"history": 2}}
    hardware = design_of().model_dump(exclude_none=True)["hardware"]
    assert short_results(Design.parse({**reaching, "hardware": hardware})) == 1


def test_missing_place_is_refused(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "chip.toml").write_text(
        'preset = "stim300"\n[hardware.bus]\nresult = "wishbone"\n[hardware.front]\n'
        'sensor = "stim300"\nclock_hz = 40e6\n'
    )
    assert main(["soc", str(tmp_path / "chip.toml"), "-o", str(tmp_path / "out")]) == 2
    assert "--lat" in capfd.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_compiler_that_is_absent_is_one_line(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pythondata_cpu_vexriscv")
    (tmp_path / "chip.toml").write_text(
        'preset = "stim300"\nname = "chip"\n[hardware]\ncore = "compact"\n[hardware.bus]\n'
        'result = "wishbone"\n[hardware.front]\nsensor = "stim300"\nclock_hz = 40e6\n'
    )
    monkeypatch.setenv("PATH", "/nowhere")
    place = ["--lat", "48", "--lon", "11", "--height", "500"]
    assert main(["soc", str(tmp_path / "chip.toml"), "-o", str(tmp_path / "out"), *place]) == 2
    said = capfd.readouterr().err
    assert "apt-get install gcc-riscv64-unknown-elf" in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def _frame(kind: int, status: int, payload: bytes) -> bytes:
    """By hand, from docs/reference/telemetry.md."""
    body = b"SN\x01" + bytes([kind]) + struct.pack("<HH", len(payload), status) + payload
    return body + struct.pack("<I", zlib.crc32(body))


def _result(number: int, rows: list[int]) -> bytes:
    """Columns in 2 registers each, seven of stamps, five counters, three times."""
    window = b"".join(struct.pack("<q", value) for value in rows)
    stamps = struct.pack("<QQQI", 1000 + number, 2**33 + number, 0, 0)
    counters = struct.pack("<5I", 20 * number, 1, 2, 3, 4)
    return _frame(
        2,
        rows[1],
        struct.pack("<Q", number) + window + stamps + counters + struct.pack("<3Q", 3, 5, 2**40),
    )


def test_telemetry_is_decoded_through_damage() -> None:
    design = design_of()
    rows = [[major, major % 2, *(-(2**40) - 17 * major - k for k in range(18))] for major in (0, 1)]
    state = NavState(0.25, (1.0, 0.0, 0.0, 0.0), (1.0, 2.0, 3.0), 0.5, -0.25, 100.0)
    history = NavHistory.from_states([state])
    q = [*state.q[1:], state.q[0]]
    told = _frame(
        1,
        2,
        struct.pack("<Q", 1)
        + struct.pack("<12d", state.time, *q, *state.v, state.lat, state.lon, state.h, 0.0),
    )
    damaged = bytearray(_result(5, rows[0]))
    damaged[40] ^= 1
    data = b"SN\x01" + _result(0, rows[0]) + b"\x00" + bytes(damaged) + _result(1, rows[1]) + told
    found = read_chip(design, data + told[:60])
    assert list(map(list, found.results.rows())) == rows
    assert found.numbers.tolist() == [0, 1]
    assert found.sample_clock.tolist() == [1000, 1001]
    assert found.result_clock.tolist() == [2**33, 2**33 + 1]
    assert found.counters.tolist() == [[0, 1, 2, 3, 4], [20, 1, 2, 3, 4]]
    assert (found.free[0], found.begun[0], found.ended[0]) == (3, 5, 2**40)
    assert found.passed_over == 4 + len(damaged) + 60
    assert found.states["place"].tolist() == [[state.lat, state.lon, state.h]]
    assert found.states["status"].tolist() == [2]
    assert np.array_equal(found.states["v"], history.v)


def test_an_alignment_is_decoded() -> None:
    """Kind 3, 25 numbers by their places; and damage anywhere loses one frame, nothing else."""
    numbers = [60.0, *(0.1 * k for k in range(24))]
    told = _frame(3, 0, struct.pack("<QII25d", 7, 0, 1, *numbers))
    assert len(told) == 228
    found = read_chip(design_of(), b"S" + told).alignments
    assert (found["number"].tolist(), found["error"].tolist(), found["fine"].tolist()) == (
        [7],
        [0],
        [1],
    )
    assert found["seconds"].tolist() == [60.0]
    assert found["q"].tolist() == [numbers[1:5]]
    assert found["covariance"].ravel().tolist() == numbers[5:14]
    assert found["gravity"].tolist() == [numbers[17]]
    assert found["surprise"].tolist() == [numbers[24]]
    rng = random.Random(1)
    rows = [[major, 0, *range(18)] for major in range(3)]
    stream = b"".join((*(_result(k, row) for k, row in enumerate(rows)), told))
    for _ in range(200):
        hurt = bytearray(stream)
        at = rng.randrange(len(hurt))
        hurt[at : at + rng.randrange(1, 9)] = rng.randbytes(rng.randrange(9))
        record = read_chip(design_of(), bytes(hurt))
        assert len(record.results) + len(record.alignments) >= 2
        assert {row[0] for row in record.results.rows()} <= {0, 1, 2}


NOISE = SensorNoise(1e-5, 1e-3)


@pytest.mark.parametrize(
    ("seconds", "noise", "lat", "said"),
    [
        (9.0, NOISE, 0.8, "900 results are too short, give 10 or more"),
        (60.0, SensorNoise(1e-5), 0.8, "give --gyro-noise and --accel-noise"),
        (60.0, NOISE, 1.57, "too near a pole"),
    ],
)
def test_alignments_that_are_none(
    seconds: float, noise: SensorNoise, lat: float, said: str
) -> None:
    with pytest.raises(InputError, match=said):
        chip_alignment(design_of(), seconds, False, noise, lat)


def test_an_alignment_is_written_into_the_firmware() -> None:
    design = design_of()
    for fine, steps in ((False, 1), (True, 60)):
        plan = SocPlan(design, START, align=chip_alignment(design, 60.0, fine, NOISE, START.lat))
        assert (plan.memory, plan.steps) == (128, steps)
        texts = firmware_texts(plan)
        assert "#define CHIP_ALIGN_RESULTS 6000u" in texts["chip_start.h"]
        assert f"#define CHIP_ALIGN_FINE {int(fine)}u" in texts["chip_start.h"]
        assert "    1e-05, /* rad/sqrt(s) */" in texts["chip_start.h"]
        sources = makefile(plan).split("FIRMWARE := ")[1].splitlines()[0].split()
        assert {"chip_align.c", "sculler_align.c", "sculler_fine.c"} < set(sources)
        assert "sculler_noise.c" not in sources
    plain = SocPlan(design, START)
    assert plain.memory == 64
    assert "chip_align.c" not in firmware_texts(plain)
    assert "sculler_align.c" not in makefile(plain)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--fine",), "--fine refines --align"),
        (("--gyro-noise", "1"), "--gyro-noise is for --align"),
        (("--align", "60", "--heading", "3"), "--heading and --align contradict"),
        (("--align", "60"), "give --gyro-noise and --accel-noise"),
    ],
)
def test_options_of_an_alignment(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], words: tuple[str, ...], said: str
) -> None:
    (tmp_path / "chip.toml").write_text(
        'preset = "stim300"\nname = "chip"\n[hardware]\ncore = "compact"\n[hardware.bus]\n'
        'result = "wishbone"\n[hardware.front]\nsensor = "stim300"\nclock_hz = 40e6\n'
    )
    place = ["--lat", "48", "--lon", "11", "--height", "500"]
    assert (
        main(["soc", str(tmp_path / "chip.toml"), "-o", str(tmp_path / "out"), *place, *words]) == 2
    )
    assert said in capfd.readouterr().err
    assert not (tmp_path / "out").exists()


def test_what_should_come_over_gaps() -> None:
    """Results 0 to 19 without 5 to 7 and 13: three pieces, coasted between."""
    design = design_of()
    T = design.major_interval
    counts = motions.record(design, motions.motion("turn"), 20 * T).counts
    model = FastModel(design).feed(counts)
    majors = [major for major in range(20) if major not in (5, 6, 7, 13)]
    rows = [list(row) for row in model.rows() if row[0] in majors]
    none = read_chip(design, b"")
    block = VectorBlock.from_rows(rows, design)
    record = replace(none, results=block, numbers=np.arange(16))
    found = follow(SocPlan(design, START, position_every=2), record)
    assert found.rows.tolist() == list(range(16))
    assert found.coasted == pytest.approx(4 * T)
    whole, state = major_increments(design, model), START
    states = []
    for first, stop, missing in ((0, 5, 0.0), (8, 13, 3 * T), (14, 20, T)):
        state = coasted(state, missing) if missing else state
        part = Navigator(state, T, position_every=2).run(whole[first:stop])
        state = part.state(len(part) - 1)
        states.append(part)
    expected = NavHistory.concatenate(states)
    assert np.abs(found.states.to_numpy() - expected.to_numpy()).max() < 1e-12
    assert found.states.time[-1] == pytest.approx(20 * T)


def registers_of(design: Design) -> str:
    return c_header(RegisterMap(design))


@needs_compiler
def test_the_firmware_fits() -> None:
    """With room for the stack that an update takes (host-in-c-targets.md: 2.3 KiB)."""
    design = design_of()
    firmware = compile_firmware(SocPlan(design, START), registers_of(design))
    assert 4 * len(firmware.hex.split()) == firmware.code
    assert firmware.code + firmware.variables < (64 - 6) * 1024
    with pytest.raises(InputError, match="larger --memory"):
        compile_firmware(SocPlan(design, START, memory_kib=32), registers_of(design))


@needs_compiler
@pytest.mark.deep
def test_larger_firmware_fits() -> None:
    """A fine alignment of five minutes, and order 4."""
    design = design_of()
    align = chip_alignment(design, 300.0, True, NOISE, START.lat)
    assert compile_firmware(SocPlan(design, START, align=align), registers_of(design)).code < 90_000
    data = design.as_json()
    data["algorithm"]["order"] = 4
    four = Design.parse(data)
    assert compile_firmware(SocPlan(four, START), registers_of(four)).code > 56_000


@needs_compiler
@pytest.mark.deep
def test_the_makefile_compiles_the_same(tmp_path: Path) -> None:
    design = design_of()
    plan = SocPlan(design, START)
    texts = {**firmware_texts(plan), "chip_regs.h": registers_of(design)}
    for name, text in {**texts, "chip_soc.mk": makefile(plan)}.items():
        (tmp_path / name).write_text(text)
    command = ["make", "-f", "chip_soc.mk", "chip_firmware.hex"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    words = (tmp_path / "chip_firmware.hex").read_text().split()
    assert words[0] == "@00000000"
    expected = compile_firmware(plan, registers_of(design)).hex.split()
    assert [word.lower() for word in words[1:]] == expected


def test_the_top_level_and_the_processor() -> None:
    pytest.importorskip("pythondata_cpu_vexriscv")
    texts = soc_texts(SocPlan(design_of(), START))
    assert "MIT License" in texts["VexRiscv_LICENSE.txt"]
    assert "module VexRiscv (" in texts["VexRiscv.v"]
    assert 'initial $readmemh("chip_firmware.hex", memory);' in texts["chip_soc.v"]
