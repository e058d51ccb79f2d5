"""cocotb's side of `test_bus_rtl`: the emitted unit, its sample port, and somebody's bus master."""

from __future__ import annotations

import random
from typing import Any

import cocotb
from bus_masters import HOSTS
from bus_watch import COUNTS, JOB, Watch, check_times, feed, pulses, start
from cocotb.triggers import ClockCycles, with_timeout

AT: dict[str, int] = JOB["addresses"]


async def begin(dut: Any) -> tuple[Any, Watch]:
    """Reset, and the master, which waits for its end."""
    kind = HOSTS[JOB["kind"]]
    clock, reset, watch = await start(dut, kind.INPUTS)
    host = kind(dut, clock, reset, JOB["seed"])
    while reset.active:
        await ClockCycles(clock, 1)
    await ClockCycles(clock, 3)
    return host, watch


async def number(host: Any, place: list[int], signed: bool) -> int:
    """The number of some words of the window, read in any order."""
    address, count = place
    order = list(range(count))
    random.shuffle(order)
    words = {index: await host.read(address + 4 * index) for index in order}
    value = sum(word << 32 * index for index, word in words.items())
    return value - (1 << 32 * count) if signed and value >> 32 * count - 1 else value


async def take(host: Any, dice: random.Random) -> dict[str, int]:
    """The oldest result, when there is one; a word is read twice, and the result freed."""
    while not await host.read(AT["status"]) & 1:
        pass
    await ClockCycles(cocotb.top.clk, dice.choice([0, 1, 50, 700]) + 1)
    found = {}
    for name, place, signed in JOB["window"]:
        found[name] = await number(host, place, signed)
    name, place, signed = dice.choice(JOB["window"])
    assert await number(host, place, signed) == found[name], "the result changed under the reader"
    await host.write(AT["pop"], 1)
    return found


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def registers(dut: Any) -> None:
    """Results through the window are the golden model's; every register does what it says."""
    host, watch = await begin(dut)
    for name, value in JOB["constants"].items():
        assert await host.read(AT[name]) == value, name
    assert await host.read(AT["faults"]) == 0
    await host.read(JOB["window"][0][1][0], error=True)
    await host.write(AT["pop"], 1)  # nothing waits
    await host.write(AT["interrupt_enable"], 1)

    if JOB["time_stamps"]:
        cocotb.start_soon(pulses(dut))
    fed = cocotb.start_soon(feed(dut, JOB["samples"]))
    dice = random.Random(JOB["seed"] + 2)
    for position, expected in enumerate(JOB["results"]):
        result = await with_timeout(take(host, dice), 5, "ms")
        columns = [result[name] for name in JOB["columns"]]
        assert columns == expected, f"result {position}"
        if JOB["time_stamps"]:
            check_times(result, position, watch)
    await fed
    assert await host.read(AT["samples"]) == len(JOB["samples"])
    assert await host.read(AT["results"]) == len(JOB["results"])
    assert await host.read(AT["samples_lost"]) == 0
    seen = 0
    for row in JOB["results"]:
        seen |= row[1]
    assert await host.read(AT["faults"]) == seen
    await host.write(AT["faults"], 1)
    assert await host.read(AT["faults"]) == seen & ~1
    assert await host.read(AT["status"]) == 0

    await host.read(JOB["nowhere"], error=True)
    await host.write(JOB["nowhere"], 1, error=True)
    await host.write(AT["identity"], 1, error=True)
    await host.write(AT["inject_gyro_x"], 0x7F)
    await host.write(AT["inject_gyro_x"], 0x1234_5601, 1)
    assert await host.read(AT["inject_gyro_x"]) == 1
    await host.write(AT["control"], 1 << 10)  # clears, and disables
    assert await host.read(AT["samples"]) == 0
    assert await host.read(AT["results"]) == 0
    if JOB["time_stamps"]:
        low, high = await host.read(AT["time_low"]), await host.read(AT["time_high"])
        assert watch.taken[-1] < low < (1 << 32)
        assert high == 0


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def injection(dut: Any) -> None:
    """Pushed samples give the golden model's results; the interrupt tells of them."""
    host, _ = await begin(dut)
    enable, inject, reset_core = 1, 2, 1 << 8
    await host.write(AT["interrupt_enable"], 1)
    await host.write(AT["control"], enable | inject)
    for _ in range(2):  # twice: a reset of the core begins anew
        assert dut.irq.value == 0
        for sample in JOB["samples"][: JOB["per_interval"]]:
            for name, value in zip(COUNTS, sample, strict=False):
                await host.write(AT[name.replace("sample", "inject")], value & 0xFFFF_FFFF)
            await host.write(AT["inject_push"], 1 | sample[-1] << 1)
            while await host.read(AT["status"]) & 4:
                pass
        result = await with_timeout(take(host, random.Random(1)), 5, "ms")
        assert [result[name] for name in JOB["columns"]] == JOB["results"][0]
        await host.write(AT["control"], enable | inject | reset_core)
        await ClockCycles(dut.clk, 200)
    assert await host.read(AT["faults"]) & 0x100 == 0
