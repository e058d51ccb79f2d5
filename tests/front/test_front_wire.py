"""The emitted front end on somebody else's UART and SPI, with noise and cuts.

In Icarus, and before a release in Verilator too.
"""

from __future__ import annotations

import random
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from cosim_runs import Simulator, require_cosim, run_cosim
from front_designs import design_of, made
from front_runs import run_model
from sculler_hdl import generate
from sculler_model.design import Design
from sculler_model.front import Spi, Uart
from tiers import few_of

CLOCKED = {"reset": "async", "reset_active": "low", "clock_enable": True, "initial": False}


def clocked(design: Design) -> Design:
    """The same with another reset and a clock enable."""
    data = design.as_json()
    data["hardware"] |= CLOCKED
    return Design.parse(data)


SLOW = 16 * 921600.0
CASES = {
    "stim300": (design_of("stim300", clock_hz=SLOW), "stim300"),
    "stim300 at 100 MHz": (design_of("stim300"), "stim300"),
    "custom": (design_of("custom", clock_hz=SLOW), "custom"),
    "hg4930": (design_of("hg4930", 1000.0, clock_hz=16e6), "hg4930"),
    "adis16505": (design_of("adis16505", clock_hz=8e6), "adis16505"),
    "stim300 clocked": (clocked(design_of("stim300", clock_hz=SLOW)), "stim300"),
    "adis16505 clocked": (clocked(design_of("adis16505", clock_hz=8e6)), "adis16505"),
    "adis16470": (design_of("adis16470", clock_hz=25e6), "adis16470"),
    "adis16488": (design_of("adis16488", clock_hz=20e6), "adis16488"),
}


def counts(number: int) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
    return (number, -number, 1000 + number), (77 * number, 5, -3 * number)


def job_of(design: Design, name: str) -> dict[str, Any]:
    """Frames of which some are damaged, cut or lost; what the model makes of them."""
    link = design.front
    assert link is not None
    rng = random.Random(name)
    spi = isinstance(link.wire, Spi)
    faults = {3: "bit", 6: "lost", 8: "status"} | ({} if spi else {10: "cut", 12: "garbage"})
    faults |= dict.fromkeys(range(15, 22), "lost")
    frames: list[tuple[int, bytes]] = []
    stream: list[tuple[int, int]] = []
    interval = 1e9 / link.sample_rate_hz
    for number in range(25):
        frame = bytearray(made(name, *counts(number), number))
        fault = faults.get(number)
        if fault == "bit":
            frame[rng.randrange(2, len(frame))] ^= 0x20
        elif fault == "cut":
            del frame[len(frame) // 2 :]
        elif fault == "garbage":
            frame += rng.randbytes(2)
        if fault == "lost":
            continue
        time = round(20_000 + number * interval)
        frames.append((time, bytes(frame)))
        # a time-out comes half an interval from any frame: when bytes are whole, about, will do
        clock = round((time + (0.5 if spi else 0.4) * interval) * link.clock_hz / 1e9)
        stream += [(clock, byte) for byte in frame]
    end = round(20_000 + 25.2 * interval)
    model = run_model(design, stream, round(end * link.clock_hz / 1e9))
    return {
        "wire": "spi" if spi else "uart",
        "seed": 1,
        "low": design.hardware.reset_active == "low",
        "enable": design.hardware.clock_enable is True,
        "baud": link.wire.baud if isinstance(link.wire, Uart) else 0,
        "period_ps": round(1e12 / link.clock_hz / 2) * 2,
        "frames": [(time, frame.hex()) for time, frame in frames],
        # as the data sheets have them: SYS_E_FLAG, then X_DELTANG_LOW and so on to Z_DELTVEL_OUT
        "requests": [0x0800, *range(0x4000, 0x5700, 0x200)] if name == "adis16488" else [0x6800],
        "pause_ns": 2000 if name == "adis16488" else 0,
        "pulses": 3 if name == "stim300" else 0,
        "pulse_ns": 100,
        "samples": [[*six, fault] for six, fault in model.samples],
        "counters": model.counters,
        "end": end,
    }


@pytest.mark.parametrize("case", few_of(CASES, []))
def test_what_is_sent_is_read(case: tuple[Design, str], tmp_path: Path) -> None:
    run(*case, tmp_path, "icarus")


@pytest.mark.deep
@pytest.mark.parametrize("name", ["custom", "stim300 clocked", "adis16505 clocked"])
def test_what_is_sent_is_read_in_verilator(name: str, tmp_path: Path) -> None:
    run(*CASES[name], tmp_path, "verilator")


def run(design: Design, name: str, tmp_path: Path, simulator: Simulator) -> None:
    """Send a job's frames, and see what comes out."""
    require_cosim(simulator)
    wire = "spi" if name[:4] == "adis" else "uart"
    if find_spec("cocotbext") is None or find_spec(f"cocotbext.{wire}") is None:
        pytest.skip(f"cocotbext-{wire} is not installed")
    job = job_of(design, name)
    assert job["counters"]["frames_bad"] >= 1 or name == "adis16488"  # which has no check
    assert job["counters"]["frames_late"] >= 1
    assert len(job["samples"]) == 25  # time does not slip
    top = f"{design.name}_front"
    source = tmp_path / f"{top}.v"
    source.write_text(generate(design).further[source.name])
    run_cosim([source], top, "wire_bench", job, tmp_path, 2, simulator)
