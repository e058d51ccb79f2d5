"""The Amaranth design in Amaranth's own simulator: slow, and independent of the emitted Verilog."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from amaranth.hdl import ClockDomain, Module
from amaranth.sim import Simulator

from sculler_hdl import ClockedCore, build_core, counter_ports, sample_ports
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.golden import Ports, result_ports
from sculler_model.outputs import replacing
from sculler_sim.surroundings import Inputs, Surroundings, sample_levels

_PERIOD = 1e-8  # seconds; only the waveform's time axis shows it


def clocks(design: Design, surroundings: Surroundings, wave: Path | None) -> Iterator[Ports]:
    """Run the core until its surroundings are done; the output ports of every clock.

    Args:
        design: the design.
        surroundings: told of every clock; gives the inputs of the next.
        wave: waveform to write, .vcd.

    Raises:
        InputError: the wave file is not a .vcd or cannot be written.
    """
    if wave is not None and wave.suffix != ".vcd":
        raise InputError(
            f"{wave}: Amaranth's simulator writes VCD only, name it .vcd or choose the engine"
            " verilator"
        )
    with ExitStack() as stack:
        target = None if wave is None else stack.enter_context(replacing(wave))
        seen: list[Ports] = []
        simulator = _simulator(design, surroundings, seen)
        if target is not None:
            stack.enter_context(simulator.write_vcd(str(target)))
        simulator.advance()  # starts the process; the first clock edge is yet to come
        while not surroundings.done:
            simulator.advance()
            yield from seen
            seen.clear()


def _simulator(design: Design, surroundings: Surroundings, seen: list[Ports]) -> Simulator:
    """The core among its surroundings; what the ports show is appended to `seen`."""
    top = Module()
    top.submodules.core = core = ClockedCore(build_core(design, primitive=False))
    top.domains.clock = clock = ClockDomain("clock", reset_less=True)
    clock.clk = core.clk
    reset, active = (core.rst_n, 0) if design.hardware.reset_active == "low" else (core.rst, 1)
    inputs = [getattr(core, port.name) for port in sample_ports(design)]
    shown = [core.sample_ready, core.result_valid]
    results = [getattr(core, f"result_{port}") for port in result_ports(design)]
    counters = [getattr(core, port.name) for port in counter_ports(design)]

    def drive(ctx: Any, now: Inputs) -> None:
        ctx.set(core.sample_valid, now.sample_valid)
        ctx.set(core.result_ready, now.result_ready)
        ctx.set(reset, now.rst if active else 1 - now.rst)
        if design.hardware.clock_enable:
            ctx.set(core.clk_en, now.clk_en)
        if now.sample is not None:
            for port, level in zip(inputs, sample_levels(now.sample), strict=True):
                ctx.set(port, level)

    # A process, not a test bench: its settings take effect together, in one step of the design.
    async def drive_and_watch(ctx: Any) -> None:
        drive(ctx, surroundings.inputs)
        watched = ctx.tick("clock").sample(*shown, *counters, *results)
        async for _, _, ready, valid, *others in watched:
            counts, result = others[: len(counters)], others[len(counters) :]
            if not valid:
                result = [0] * len(results)  # the ports mean nothing
            ports = Ports(ready, valid, tuple(result), *counts)
            seen.append(ports)
            surroundings.clocked(ports)
            if surroundings.done:
                break
            drive(ctx, surroundings.inputs)

    simulator = Simulator(top)
    simulator.add_clock(_PERIOD, domain="clock")
    simulator.add_process(drive_and_watch)
    return simulator
