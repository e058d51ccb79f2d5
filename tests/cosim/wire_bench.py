"""cocotb's side of `test_front_wire`: the emitted front end, and a sensor on its UART or SPI.

The environment names a file with the job: when frames begin, their bytes, disturbances of a line,
and what is to come out.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge, Timer
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


class Sensor:
    """A sensor's SPI port in mode 3: takes 16 bits, then shows what is at hand.

    (cocotbext-spi 0.5 does not run with cocotb 2.)  What it shows changes 25 ns after
    the falling edge of the clock.
    """

    def __init__(self, dut: Any) -> None:
        self.dut = dut
        self.content = b""
        self.requests: list[list[int]] = []
        cocotb.start_soon(self.run())

    async def run(self) -> None:
        while True:
            await FallingEdge(self.dut.cs_n)
            assert self.dut.sck.value == 1, "mode 3 begins high"
            bits = [0] * 16 + [byte >> 7 - bit & 1 for byte in self.content for bit in range(8)]
            words: list[int] = []
            for number, bit in enumerate(bits):
                if JOB["pause_ns"] and number and number % 16 == 0:  # a word at a time
                    await RisingEdge(self.dut.cs_n)
                    risen = get_sim_time("ns")
                    await FallingEdge(self.dut.cs_n)
                    assert get_sim_time("ns") - risen >= JOB["pause_ns"]
                await FallingEdge(self.dut.sck)
                assert self.dut.cs_n.value == 0
                await Timer(25, "ns")
                self.dut.miso.value = bit
                await RisingEdge(self.dut.sck)
                if number % 16 == 0:
                    words.append(0)
                words[-1] = words[-1] << 1 | int(self.dut.mosi.value)
            self.requests.append(words)
            await RisingEdge(self.dut.cs_n)
            assert self.dut.sck.value == 1


@cocotb.test(skip=JOB["wire"] != "spi")
async def burst(dut: Any) -> None:
    """A sensor over SPI."""
    dut.miso.value = 0
    dut.data_ready.value = 0
    samples = await begin(dut)
    sensor = Sensor(dut)
    for time, content in JOB["frames"]:
        await at(time)
        sensor.content = bytes.fromhex(content)
        dut.data_ready.value = 1
        await Timer(20, "us")
        dut.data_ready.value = 0
    await at(JOB["end"])
    asked = JOB["requests"] + [0] * (1 + len(sensor.content) // 2 - len(JOB["requests"]))
    assert sensor.requests == [asked] * len(JOB["frames"])
    await check(dut, samples)
