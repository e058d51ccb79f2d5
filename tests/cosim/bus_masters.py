"""Other people's bus masters behind one face: `read(address)` and `write(address, data)`.

With `error` the slave must answer with an error, without it must not.
"""

from __future__ import annotations

import logging
import random
from itertools import repeat
from typing import Any

from cocotb.triggers import ClockCycles


def stalls(seed: int) -> Any:
    """Random pauses of a channel: an endless sequence of whether it pauses."""
    dice = random.Random(seed)
    while True:
        pause = dice.random() < 0.3
        yield from repeat(pause, dice.randint(1, 6))


class AxiLiteHost:
    """cocotbext-axi.

    `INPUTS` are to be 0 for a clock before the master is made: an immediate change at the very
    start does not go through Icarus's nets.
    """

    INPUTS: tuple[str, ...] = ()

    def __init__(self, dut: Any, clock: Any, reset: Any, seed: int) -> None:
        from cocotbext.axi import AxiLiteBus, AxiLiteMaster

        self.master = AxiLiteMaster(
            AxiLiteBus.from_prefix(dut, "s_axi"), clock, reset.signal, not reset.low
        )
        write, read = self.master.write_if, self.master.read_if
        channels = (
            write.aw_channel,
            write.w_channel,
            write.b_channel,
            read.ar_channel,
            read.r_channel,
        )
        for number, channel in enumerate(channels):
            channel.set_pause_generator(stalls(seed + number))

    async def read(self, address: int, error: bool = False) -> int:
        answer = await self.master.read(address, 4)
        assert answer.resp == 2 * error
        return int.from_bytes(answer.data, "little")

    async def write(self, address: int, data: int, lanes: int = 4, error: bool = False) -> None:
        answer = await self.master.write(address, data.to_bytes(4, "little")[:lanes])
        assert answer.resp == 2 * error


class ApbHost:
    """cocotbext-apb."""

    INPUTS = tuple(f"s_apb_p{name}" for name in "sel enable write addr wdata strb".split())

    def __init__(self, dut: Any, clock: Any, reset: Any, seed: int) -> None:
        from cocotbext.apb import ApbBus, ApbMaster

        self.clock = clock
        self.dice = random.Random(seed)
        self.master = ApbMaster(ApbBus.from_prefix(dut, "s_apb"), clock)
        self.master.log.setLevel(logging.WARNING)  # else it tells of every access

    async def read(self, address: int, error: bool = False) -> int:
        await ClockCycles(self.clock, self.dice.randint(1, 4))
        data = await self.master.read(address, error_expected=error)
        return int.from_bytes(data, "little")

    async def write(self, address: int, data: int, lanes: int = 4, error: bool = False) -> None:
        await ClockCycles(self.clock, self.dice.randint(1, 4))
        await self.master.write(address, data, (1 << lanes) - 1, error_expected=error)


class WishboneHost:
    """cocotbext-wishbone, classic or pipelined, as the slave has `stall` or not."""

    INPUTS = tuple(f"wb_{name}" for name in "cyc stb we adr dat_w sel".split())

    def __init__(self, dut: Any, clock: Any, reset: Any, seed: int) -> None:
        from cocotbext.wishbone.driver import WBOp, WishboneMaster

        names = {"datwr": "dat_w", "datrd": "dat_r"}
        names |= {name: name for name in "cyc stb we adr ack err sel".split()}
        if hasattr(dut, "wb_stall"):
            names["stall"] = "stall"
        self.operation = WBOp
        self.dice = random.Random(seed)
        self.master = WishboneMaster(dut, "wb", clock, timeout=500, signals_dict=names)

    async def _access(self, error: bool, **what: int) -> int:
        operation = self.operation(idle=self.dice.randint(0, 4), **what)
        (answer,) = await self.master.send_cycle([operation])
        assert answer.ack == 1 + error
        return int(answer.datrd)

    async def read(self, address: int, error: bool = False) -> int:
        return await self._access(error, adr=address)

    async def write(self, address: int, data: int, lanes: int = 4, error: bool = False) -> None:
        await self._access(error, adr=address, dat=data, sel=(1 << lanes) - 1)


HOSTS: dict[str, Any] = {
    "axi-lite": AxiLiteHost,
    "apb": ApbHost,
    "wishbone": WishboneHost,
    "wishbone-pipelined": WishboneHost,
}
