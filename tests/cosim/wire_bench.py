"""cocotb's side of `test_front_wire`: the emitted front end, and a sensor on its UART or SPI.

The environment names a file with the job: when frames begin, their bytes, disturbances of a line,
and what is to come out.
"""

from __future__ import annotations

import json
import os
import struct
from pathlib import Path
from typing import Any

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, First, RisingEdge, Timer
from cocotb.types import Logic
from cocotb.utils import get_sim_time

JOB: dict[str, Any] = json.loads(Path(os.environ["SCULLER_BENCH"]).read_text())
COUNTS = [f"sample_{sensor}_{axis}" for sensor in ("gyro", "accel") for axis in "xyz"]
COUNTERS = ("frames_taken", "frames_bad", "frames_missed", "frames_late", "sensor_faults")


async def watch(dut: Any, samples: list[list[int]]) -> None:
    """Every sample that is offered; the core is always ready."""
    while True:
        await RisingEdge(dut.sample_valid)
        await Timer(1, "ps")
        counts = [getattr(dut, name).value.to_signed() for name in COUNTS]
        samples.append([*counts, int(dut.sample_fault.value)])


async def begin(dut: Any) -> list[list[int]]:
    """Clock and reset."""
    cocotb.start_soon(Clock(dut.clk, JOB["period_ps"], "ps").start())
    reset = dut.rst_n if JOB["low"] else dut.rst
    reset.value = not JOB["low"]
    dut.sample_ready.value = 1
    if JOB["enable"]:
        cocotb.start_soon(enables(dut))
    await ClockCycles(dut.clk, 3)
    reset.value = JOB["low"]
    samples: list[list[int]] = []
    cocotb.start_soon(watch(dut, samples))
    return samples


async def enables(dut: Any) -> None:
    """A core that moves in every third clock."""
    while True:
        dut.clk_en.value = 0
        await ClockCycles(dut.clk, 2)
        dut.clk_en.value = 1
        await RisingEdge(dut.clk)


async def check(dut: Any, samples: list[list[int]]) -> None:
    """Samples and counters are as they should be."""
    await ClockCycles(dut.clk, 5)
    assert samples == JOB["samples"]
    assert {name: int(getattr(dut, name).value) for name in COUNTERS} == JOB["counters"]


async def at(ns: int) -> None:
    """Wait until a time since the start."""
    await Timer(max(1, ns - round(get_sim_time("ns"))), "ns")


@cocotb.test(skip=JOB["wire"] != "uart")
async def line(dut: Any) -> None:
    """cocotbext-uart sends; short pulses disturb the idle line."""
    from cocotbext.uart import UartSource

    dut.rx.value = 1
    samples = await begin(dut)
    source = UartSource(dut.rx, baud=JOB["baud"], bits=8)
    for time, content in JOB["frames"]:
        await at(time)
        await source.write(bytes.fromhex(content))
        await source.wait()
        for _ in range(JOB["pulses"]):
            await Timer(10, "us")
            dut.rx.value = 0
            await Timer(JOB["pulse_ns"], "ns")
            dut.rx.value = 1
    await at(JOB["end"])
    await check(dut, samples)


def spi_sensor(dut: Any) -> Any:
    """A sensor's SPI port in mode 3, by cocotbext-spi: takes 16 bits, then shows what is at hand.

    cocotbext-spi 0.5 was written for cocotb 1, of which it misses two names; they are given to it.
    """
    cocotb.clock.BaseClock = Clock  # type: ignore[attr-defined]
    Logic.integer = property(int)  # type: ignore[attr-defined]
    from cocotbext.spi import SpiBus, SpiConfig, SpiSlaveBase

    class Sensor(SpiSlaveBase):  # type: ignore[misc]
        _config = SpiConfig(
            word_width=16,
            cpol=True,
            cpha=True,
            data_output_idle=0,
            frame_spacing_ns=JOB["pause_ns"] or 1,  # less is an error
        )

        def __init__(self, bus: Any) -> None:
            self.words: list[int] = []
            self.requests: list[list[int]] = []
            super().__init__(bus)

        def offer(self, content: bytes) -> None:
            """What it shows from now on, after a word of zeros."""
            self.words = [0, *struct.unpack(f">{len(content) // 2}H", content)]
            self.requests.append([])

        async def _transaction(self, frame_start: Any, frame_end: Any) -> None:
            await frame_start
            self.idle.clear()
            assert self._sclk.value == 1, "mode 3 begins high"
            while self.words:
                word = self.words.pop(0)
                self.requests[-1].append(await self._shift(16, tx_word=word))
                if JOB["pause_ns"]:  # a word at a time
                    break
            assert await First(FallingEdge(self._sclk), frame_end) is frame_end
            assert self._sclk.value == 1

    return Sensor(SpiBus.from_entity(dut, sclk_name="sck", cs_name="cs_n"))


@cocotb.test(skip=JOB["wire"] != "spi")
async def burst(dut: Any) -> None:
    """A sensor over SPI."""
    dut.miso.value = 0
    dut.data_ready.value = 0
    samples = await begin(dut)
    sensor = spi_sensor(dut)
    for time, content in JOB["frames"]:
        await at(time)
        sensor.offer(bytes.fromhex(content))
        dut.data_ready.value = 1
        await Timer(20, "us")
        dut.data_ready.value = 0
    await at(JOB["end"])
    words = 1 + len(JOB["frames"][0][1]) // 4
    asked = JOB["requests"] + [0] * (words - len(JOB["requests"]))
    assert sensor.requests == [asked] * len(JOB["frames"])
    await check(dut, samples)
