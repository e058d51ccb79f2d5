"""cocotb's side of `test_bus_rtl` for packets: cocotbext-axi takes results and gives samples."""

from __future__ import annotations

import random
from typing import Any

import cocotb
from bus_masters import stalls
from bus_watch import JOB, Reset, check_times, feed, pulses, start
from cocotb.triggers import ClockCycles, RisingEdge, with_timeout
from cocotbext.axi import AxiStreamBus, AxiStreamFrame, AxiStreamSink, AxiStreamSource


def columns_of(words: list[int]) -> dict[str, int]:
    """The numbers of a packet by name."""
    found = {}
    for name, (address, count), signed in JOB["window"]:
        first = (address - JOB["window"][0][1][0]) // 4
        value = sum(word << 32 * i for i, word in enumerate(words[first : first + count]))
        negative = signed and value >> 32 * count - 1
        found[name] = value - (1 << 32 * count) if negative else value
    return found


class AxiSink:
    """cocotbext-axi."""

    def __init__(self, dut: Any, clock: Any, reset: Reset) -> None:
        self.sink = AxiStreamSink(
            AxiStreamBus.from_prefix(dut, "m_axis"), clock, reset.signal, not reset.low
        )
        self.sink.set_pause_generator(stalls(JOB["seed"]))

    async def packet(self) -> tuple[list[int], set[int]]:
        """The next packet's words, and what stood beside them."""
        frame = await self.sink.recv(compact=False)
        data = bytes(frame.tdata)
        assert all(frame.tkeep)
        words = [int.from_bytes(data[at : at + 4], "little") for at in range(0, len(data), 4)]
        return words, set(frame.tuser if isinstance(frame.tuser, list) else [frame.tuser])


class PlainSink:
    """Valid and ready with random stalls; what is shown must stay until it is taken."""

    def __init__(self, dut: Any, clock: Any, reset: Reset) -> None:
        self.dut, self.clock = dut, clock
        self.dice = random.Random(JOB["seed"])

    async def packet(self) -> tuple[list[int], set[int]]:
        """The next packet's words, and what stood beside them."""
        words: list[int] = []
        beside: set[int] = set()
        shown = None
        while True:
            self.dut.packet_ready.value = ready = int(self.dice.random() < 0.5)
            await RisingEdge(self.clock)
            if self.dut.packet_valid.value != 1:
                assert shown is None, "withdrawn"
                continue
            now = tuple(
                int(getattr(self.dut, f"packet_{name}").value)
                for name in ("data", "last", "status")
            )
            assert shown in (None, now), "changed"
            shown = None if ready else now
            if ready:
                words.append(now[0])
                beside.add(now[2])
                if now[1]:
                    self.dut.packet_ready.value = 0
                    return words, beside


async def give(dut: Any, clock: Any, reset: Reset, wrong_ones: list[int]) -> None:
    """Samples as packets, among them some that are none, which are noted."""
    source = AxiStreamSource(
        AxiStreamBus.from_prefix(dut, "s_axis"), clock, reset.signal, not reset.low
    )
    source.set_pause_generator(stalls(JOB["seed"] + 9))
    dice = random.Random(JOB["seed"])
    for sample in JOB["samples"]:
        data = b"".join(value.to_bytes(4, "little", signed=True) for value in sample[:6])
        if dice.random() < 0.3:
            wrong = dice.choice([data * 2, data[:20], data[:-1] + b"\x35"])
            wrong_ones.append(len(wrong))
            await source.send(AxiStreamFrame(wrong, tuser=0))
        await source.send(AxiStreamFrame(data, tuser=sample[6]))


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def packets(dut: Any) -> None:
    """Packets are the golden model's results, and their stamps the clocks of what happened."""
    axi, from_packets = JOB["kind"] == "axi-stream", JOB["sample"] == "axi-stream"
    inputs = ("m_axis_tready",) if axi else ("packet_ready",)
    if from_packets:
        inputs += tuple(f"s_axis_t{name}" for name in "valid data last user".split())
    clock, reset, watch = await start(dut, inputs)
    sink: AxiSink | PlainSink = (AxiSink if axi else PlainSink)(dut, clock, reset)
    wrong_ones: list[int] = []
    given = give(dut, clock, reset, wrong_ones) if from_packets else None
    while reset.active:
        await ClockCycles(clock, 1)
    await ClockCycles(clock, 3)
    cocotb.start_soon(given or feed(dut, JOB["samples"]))
    if JOB["time_stamps"]:
        cocotb.start_soon(pulses(dut))
    for position, expected in enumerate(JOB["results"]):
        words, beside = await with_timeout(sink.packet(), 2, "ms")
        result = columns_of(words)
        assert [result[name] for name in JOB["columns"]] == expected, f"result {position}"
        assert beside == {expected[1]}
        last = JOB["window"][-1][1]
        assert len(words) == (last[0] - JOB["window"][0][1][0]) // 4 + last[1]
        if JOB["time_stamps"]:
            check_times(result, position, watch)
    if from_packets:
        assert int(dut.packets_bad.value) == len(wrong_ones) > 0
