"""A read of a unit's registers in a real run: the bus's part in Amaranth's simulator.

The host reads the register `identity`, for the timing diagram of the data sheet.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from amaranth.sim import Simulator

from sculler_hdl import RegisterMap, ResultBus
from sculler_model.design import Design
from sculler_model.errors import ToolError

BEGINS = 2
"""Clock in which the access begins."""

_MOST = 40
_PERIOD = 1e-8  # seconds


@dataclass(frozen=True)
class Access:
    """How a read goes on a bus.

    Attributes:
        levels: inputs that are 1, and from which clock on, counted from the beginning.
        ends: outputs of which one high ends each of them, by input; others stay.
        done: the output that shows the answer, and that with its data.
        shown: ports of the diagram, in order.
    """

    levels: Mapping[str, int]
    ends: Mapping[str, str]
    done: tuple[str, str]
    shown: tuple[str, ...]


_AXI = (
    *("s_axi_arvalid", "s_axi_arready", "s_axi_araddr"),
    *("s_axi_rvalid", "s_axi_rready", "s_axi_rdata", "s_axi_rresp"),
)
_APB = (
    *("s_apb_psel", "s_apb_penable", "s_apb_pwrite", "s_apb_paddr"),
    *("s_apb_pready", "s_apb_prdata", "s_apb_pslverr"),
)
_WISHBONE = ("wb_cyc", "wb_stb", "wb_we", "wb_adr", "wb_ack", "wb_err", "wb_dat_r")

ACCESSES: Mapping[str, Access] = {
    "axi-lite": Access(
        {"s_axi_arvalid": 0, "s_axi_rready": 0},
        {"s_axi_arvalid": "s_axi_arready"},
        ("s_axi_rvalid", "s_axi_rdata"),
        _AXI,
    ),
    "apb": Access(
        {"s_apb_psel": 0, "s_apb_penable": 1},
        {"s_apb_psel": "s_apb_pready", "s_apb_penable": "s_apb_pready"},
        ("s_apb_pready", "s_apb_prdata"),
        _APB,
    ),
    "wishbone": Access(
        {"wb_cyc": 0, "wb_stb": 0},
        {"wb_cyc": "wb_ack", "wb_stb": "wb_ack"},
        ("wb_ack", "wb_dat_r"),
        _WISHBONE,
    ),
}
"""By the bus; pipelined Wishbone is not among them."""


def watched_read(design: Design) -> list[dict[str, int]]:
    """The ports of a bus in each clock of a read, and two clocks before and after it.

    Args:
        design: whose bus is one of `ACCESSES`.

    Raises:
        ToolError: there is no answer, or another than the register has.
    """
    bus = design.hardware.bus
    assert bus is not None
    access, seen = ACCESSES[bus.result], list[dict[str, int]]()
    part = ResultBus(design)
    domain = "bus" if bus.clock == "separate" else "sync"

    async def host(ctx: Any) -> None:
        given = dict.fromkeys(access.levels, 0)
        over: set[str] = set()
        answered = _MOST
        for clock in range(_MOST):
            for name, begins in access.levels.items():
                given[name] = int(clock >= BEGINS + begins and name not in over)
                ctx.set(getattr(part, name), given[name])
            now = {name: ctx.get(getattr(part, name)) for name in access.shown}
            seen.append(now)
            over |= {name for name, end in access.ends.items() if given[name] and now[end]}
            if now[access.done[0]] and answered == _MOST:
                answered = clock
            if clock >= answered + 2:
                break
            await ctx.tick(domain)

    simulator = Simulator(part)
    for each in {"sync", domain}:
        simulator.add_clock(_PERIOD, domain=each)
    simulator.add_testbench(host)
    simulator.run()
    done, data = access.done
    found = next((now[data] for now in seen if now[done]), None)
    wanted = RegisterMap(design)["identity"].fields[0].reset
    if found != wanted:
        raise ToolError(f"a read of identity answers {found}, not {wanted}")
    return seen
