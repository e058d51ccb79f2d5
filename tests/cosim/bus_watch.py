"""What the benches of the unit share: the job, clocks and reset, samples, pulses, time stamps.

The environment names a file with the job: kind, samples, results and numbers to expect.
"""

from __future__ import annotations

import json
import os
import random
from pathlib import Path
from typing import Any

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge, Timer

JOB: dict[str, Any] = json.loads(Path(os.environ["SCULLER_BENCH"]).read_text())
AT: dict[str, int] = JOB["addresses"]
RELEASE = 2 * JOB["at_once"]
"""Clocks after an asynchronous reset's end in which it goes on."""
COUNTS = [f"sample_{sensor}_{axis}" for sensor in ("gyro", "accel") for axis in "xyz"]


class Reset:
    """A reset, whatever its level: `active` is set and looked at; None leaves it at none."""

    def __init__(self, dut: Any, name: str) -> None:
        self.low = JOB["low"]
        self.signal = getattr(dut, f"{name}_n" if self.low else name)

    @property
    def active(self) -> bool:
        return int(self.signal.value) != self.low

    @active.setter
    def active(self, value: bool) -> None:
        self.signal.value = int(value != self.low)


class Watch:
    """Clocks since reset at which things happened, seen at the ports."""

    def __init__(self, dut: Any) -> None:
        self.dut = dut
        self.taken: list[int] = []
        self.samples: list[list[int]] = []
        self.results: list[int] = []
        self.pulses: list[int] = []

    def sample(self) -> list[int]:
        """The sample that stands at the core's port."""
        counts = [getattr(self.dut, f"core_{name}").value.to_signed() for name in COUNTS]
        return [*counts, int(self.dut.core_sample_fault.value)]

    async def run(self) -> None:
        now, pulse = -RELEASE, [0, 0, 0]
        reset = Reset(self.dut, "rst")
        while True:
            await RisingEdge(self.dut.clk)
            if reset.active:
                now, pulse = -RELEASE, [0, 0, 0]
                continue
            if now < 0:
                now += 1
                continue
            enabled = not JOB["enable"] or self.dut.clk_en.value == 1
            offered, ready = self.dut.core_sample_valid.value, self.dut.core_sample_ready.value
            if enabled and offered == 1 and ready == 1:
                self.taken.append(now)
                self.samples.append(self.sample())
            valid, ready = self.dut.core_result_valid.value, self.dut.core_result_ready.value
            if enabled and valid == 1 and ready == 1 and self.dut.core_result_last.value == 1:
                self.results.append(now)
            pulse = [int(self.dut.pulse.value), *pulse[:2]] if JOB["time_stamps"] else pulse
            if pulse[1:] == [1, 0]:
                self.pulses.append(now + 1)
            now += 1


async def start(dut: Any, inputs: tuple[str, ...]) -> tuple[Any, Reset, Watch]:
    """Clocks and reset, with these inputs at 0 as the others are; the bus's clock and reset.

    Reset ends after ten clocks more; the master is to be made at once.
    """
    cocotb.start_soon(Clock(dut.clk, 10_000, "ps").start())
    separate = JOB["clock"] == "separate"
    if separate:
        cocotb.start_soon(Clock(dut.bus_clk, JOB["bus_period_ps"], "ps").start())
    clock = dut.bus_clk if separate else dut.clk
    reset, core_reset = Reset(dut, "bus_rst" if separate else "rst"), Reset(dut, "rst")
    reset.active = core_reset.active = True
    if JOB["enable"]:
        dut.clk_en.value = 0
        cocotb.start_soon(enables(dut))
    own = [name for name in ("sample_valid", *COUNTS, "sample_fault") if hasattr(dut, name)]
    pulse = ["pulse"] if JOB["time_stamps"] else []
    for name in (*own, *pulse, *inputs):
        getattr(dut, name).value = 0
    await ClockCycles(clock, 1)
    watch = Watch(dut)
    cocotb.start_soon(watch.run())
    cocotb.start_soon(end_reset(dut, clock, reset, core_reset))
    return clock, reset, watch


async def enables(dut: Any) -> None:
    """A clock enable that is high in some clocks."""
    dice = random.Random(JOB["seed"] + 5)
    while True:
        await RisingEdge(dut.clk)
        dut.clk_en.value = int(dice.random() < 0.6)


async def end_reset(dut: Any, clock: Any, reset: Reset, core_reset: Reset) -> None:
    """Both resets end, each at its own clock."""
    await ClockCycles(dut.clk, 10)
    await ClockCycles(clock, 10)
    await FallingEdge(dut.clk)
    core_reset.active = False
    await FallingEdge(clock)
    reset.active = False


async def feed(dut: Any, samples: list[list[int]]) -> None:
    """Samples of a source that can wait, with pauses."""
    dice = random.Random(JOB["seed"])
    for sample in samples:
        for name, value in zip([*COUNTS, "sample_fault"], sample, strict=True):
            getattr(dut, name).value = value
        dut.sample_valid.value = 1
        await RisingEdge(dut.clk)
        while dut.sample_ready.value != 1:
            await RisingEdge(dut.clk)
        dut.sample_valid.value = 0
        if dice.random() < 0.3:
            await ClockCycles(dut.clk, dice.randint(1, 60))


async def pulses(dut: Any) -> None:
    """Pulses that have nothing to do with the clock."""
    dice = random.Random(JOB["seed"] + 1)
    while True:
        await ClockCycles(dut.clk, dice.randint(50, 900))
        await Timer(dice.randint(1, 9_999), "ps")
        dut.pulse.value = 1
        await ClockCycles(dut.clk, dice.randint(4, 20))
        dut.pulse.value = 0


def check_times(result: dict[str, int], number: int, watch: Watch) -> None:
    """The stamps of the result that came as this one are the clocks in which things happened."""
    last = JOB["per_interval"] * (result["major"] + 1) - 1
    assert result["sample_time"] == watch.taken[last]
    assert result["result_time"] == watch.results[number]
    before = [pulse for pulse in watch.pulses if pulse < watch.results[number]]
    assert result["pulses"] == len(before)
    assert result["pulse_time"] == (before[-1] if before else 0)
