"""What a chip is made of, and what is refused."""

from __future__ import annotations

import struct
import subprocess
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler.main import main
from sculler.runs.soc import short_results
from sculler.soc import (
    SocPlan,
    check_soc,
    compile_firmware,
    firmware_texts,
    makefile,
    read_chip,
    soc_texts,
)
from sculler_hdl.export.register_files import c_header
from sculler_hdl.plan.registers import RegisterMap
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.navigation import NavHistory, NavState
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
