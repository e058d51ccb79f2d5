"""cocotb's side of `test_bus_rtl`: every address is what the SystemRDL text says."""

from __future__ import annotations

from typing import Any

import cocotb
from bus_bench import begin
from bus_watch import JOB


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def walk(dut: Any) -> None:
    """Registers answer, with the values they have after reset; all other addresses are errors."""
    host, _ = await begin(dut)
    registers: dict[int, list[list[int]]] = {int(at): f for at, f in JOB["registers"].items()}
    for address in range(0, 0x1000, 4 if JOB["whole"] else 20):
        if address not in registers:
            await host.read(address, error=True)
            await host.write(address, 0, error=True)
            continue
        value = await host.read(address)
        for mask, reset in registers[address]:
            assert value & mask == reset, hex(address)
    if JOB["kind"] == "wishbone":  # the others' masters align addresses themselves
        await host.read(2, error=True)
    for address, mask in JOB["writable"]:
        await host.write(address, 0xFFFF_FFFF & mask)
        assert await host.read(address) & mask == mask, hex(address)
        await host.write(address, 0)
        assert await host.read(address) & mask == 0, hex(address)
