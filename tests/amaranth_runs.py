"""A part or a core in Amaranth's simulator, with what drives it."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from typing import Any

from amaranth.sim import Simulator


def drive(top: Any, process: Callable[[Any], Coroutine[Any, Any, None]]) -> None:
    """Run until a process ends, which sets inputs and samples outputs at clock edges.

    A process and not a test bench: what it sets between two edges takes effect together, in one
    step of the simulator.
    """

    async def to_its_end(ctx: Any) -> None:
        with ctx.critical():
            await process(ctx)

    simulator = Simulator(top)
    simulator.add_clock(1e-6)
    simulator.add_process(to_its_end)
    simulator.run()
