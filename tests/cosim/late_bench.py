"""cocotb's side of `test_bus_rtl`: a sensor that cannot wait, and a host that is late."""

from __future__ import annotations

import random
from typing import Any

import cocotb
from bus_bench import AT, begin, take
from bus_watch import COUNTS, JOB, check_times
from cocotb.triggers import ClockCycles, RisingEdge

from sculler_model.design import STATUS_LOST, Design
from sculler_model.golden import GoldenModel


async def offer(dut: Any, samples: list[list[int]]) -> None:
    """Each sample for one clock, taken or not."""
    for sample in samples:
        for name, value in zip([*COUNTS, "sample_fault"], sample, strict=True):
            getattr(dut, name).value = value
        dut.sample_valid.value = 1
        await RisingEdge(dut.clk)
        dut.sample_valid.value = 0
        await ClockCycles(dut.clk, JOB["period"])


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def late(dut: Any) -> None:
    """What is read is right, what is missing is counted, what waits is kept."""
    host, watch = await begin(dut)
    await ClockCycles(dut.clk, 60)
    offered = cocotb.start_soon(offer(dut, JOB["samples"]))
    while not await host.read(AT["status"]) & 2:  # full
        pass
    first = await host.read(JOB["window"][0][1][0])
    await ClockCycles(dut.clk, JOB["idle"])
    assert await host.read(JOB["window"][0][1][0]) == first == 0
    results = []
    dice = random.Random(JOB["seed"])
    quiet = 0
    while quiet < 3000 or not offered.done():
        if await host.read(AT["status"]) & 1:
            results.append(await take(host, dice))
            quiet = 0
        quiet += 10
        await ClockCycles(dut.clk, 10)

    # what the golden model makes of the samples that the core took
    design = Design.parse(JOB["design"])
    rows = [
        row.row() for row in GoldenModel(design).run((s[:3], s[3:6], s[6]) for s in watch.samples)
    ]
    lost = 0
    for position, result in enumerate(results):
        row = list(rows[result["major"]])
        lost += bool(result["status"] & STATUS_LOST)
        row[1] |= result["status"] & STATUS_LOST
        assert [result[name] for name in JOB["columns"]] == row, f"result {position}"
        check_times(result, position, watch)
    majors = [result["major"] for result in results]
    assert majors == sorted(set(majors))
    missing = JOB["offered"] - len(watch.taken)
    assert await host.read(AT["samples_lost"]) == missing
    assert await host.read(AT["samples"]) == len(watch.taken)
    if design.drops_results:
        assert await host.read(AT["results_dropped"]) == len(rows) - len(results) > 0
        assert majors[-1] == len(rows) - 1
    else:
        assert majors == list(range(len(rows)))
        assert missing > 0
        assert lost > 0
