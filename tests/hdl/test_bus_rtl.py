"""The emitted unit, driven by other people's bus masters in Icarus and in Verilator."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest

from bench_files import unit_sources
from cosim_runs import Simulator, require_cosim, run_cosim
from register_facts import from_rdl
from sculler_hdl import generate
from sculler_model.design import Design
from sculler_model.golden import GoldenModel
from strategies import make_design, samples_of
from tiers import few_of


def bus_design(
    result: str,
    core: str = "compact",
    overrun: str = "drop-sample",
    initial: bool = True,
    clocking: Mapping[str, Any] = MappingProxyType({}),
    **bus: Any,
) -> Design:
    hardware = {
        "core": core,
        "overrun": overrun,
        "initial": initial,
        "bus": {"result": result, **bus},
        **clocking,
    }
    return make_design("narrow", 2, 1, 2, (8, 8), hardware=hardware)


def job_of(design: Design, seed: int, majors: int) -> dict[str, Any]:
    """What the bench must know; addresses are written here by hand, as the page has them."""
    bus = design.hardware.bus
    assert bus is not None
    per = design.samples_per_major
    counts, faults = samples_of(design, majors * per, seed)
    samples = [(*map(int, row), int(fault)) for row, fault in zip(counts, faults, strict=True)]
    rows = GoldenModel(design).run((s[:3], s[3:6], bool(s[6])) for s in samples)
    widest = max(getattr(design.words, name).bits for name in design.vectors)
    words = -(-widest // 32)
    window = [
        [name, [0x800 + 4 * words * number, words], number > 1]
        for number, name in enumerate(design.columns)
    ]
    end = 0x800 + 4 * words * len(design.columns)
    if bus.time_stamps:
        window += [
            ["sample_time", [end, 2], False],
            ["result_time", [end + 8, 2], False],
            ["pulse_time", [end + 16, 2], False],
            ["pulses", [end + 24, 1], False],
        ]
    return {
        "kind": bus.result,
        "sample": bus.sample,
        "clock": bus.clock,
        "low": design.hardware.reset_active == "low",
        "at_once": design.hardware.resets_at_once,
        "enable": design.hardware.clock_enable is True,
        "bus_period_ps": 7_300 if seed % 2 else 23_700,
        "seed": seed,
        "samples": samples,
        "results": [list(row.row()) for row in rows],
        "columns": list(design.columns),
        "per_interval": per,
        "time_stamps": bus.time_stamps,
        "window": window,
        "nowhere": 0x7FC,
        "constants": {"identity": 0x5343_554C, "version": 0x0001_0000},
        "addresses": {
            "identity": 0x000,
            "version": 0x004,
            "control": 0x014,
            "status": 0x018,
            "faults": 0x01C,
            "interrupt_enable": 0x020,
            "pop": 0x028,
            "samples": 0x030,
            "results": 0x034,
            "samples_lost": 0x038,
            "results_dropped": 0x03C,
            "time_low": 0x060,
            "time_high": 0x064,
            **{
                f"inject_{sensor}_{axis}": 0x080 + 12 * (sensor == "accel") + 4 * "xyz".index(axis)
                for sensor in ("gyro", "accel")
                for axis in "xyz"
            },
            "inject_push": 0x098,
        },
    }


def run_bench(
    design: Design,
    folder: Path,
    module: str,
    job: dict[str, Any],
    tests: int,
    simulator: Simulator = "icarus",
) -> None:
    """Compile the unit and run the tests of a module of `cosim`."""
    require_cosim(simulator)
    sources = unit_sources(design, folder)
    run_cosim(sources, f"{design.name}_unit", module, job, folder, tests, simulator)


CLOCKED = {"reset": "async", "reset_active": "low", "clock_enable": True}

REGISTERS: dict[str, dict[str, Any]] = {
    "axi-lite": {"result": "axi-lite"},
    "axi-lite-separate": {"result": "axi-lite", "clock": "separate"},
    "axi-lite-clocked": {
        "result": "axi-lite",
        "clock": "separate",
        "initial": False,
        "clocking": CLOCKED,
    },
    "axi-lite-fast-core": {"result": "axi-lite", "core": "pipelined", "depth": 2},
    "axi-lite-no-stamps": {"result": "axi-lite", "time_stamps": False},
    "apb": {"result": "apb"},
    "apb-separate": {"result": "apb", "clock": "separate", "depth": 16},
    "apb-no-initial-values": {"result": "apb", "clock": "separate", "initial": False},
    "wishbone": {"result": "wishbone"},
    "wishbone-separate": {"result": "wishbone", "clock": "separate"},
    "wishbone-low": {"result": "wishbone", "clocking": {"reset_active": "low"}},
    "wishbone-pipelined-clocked": {"result": "wishbone-pipelined", "clocking": CLOCKED},
    "wishbone-pipelined": {"result": "wishbone-pipelined"},
    "wishbone-pipelined-separate": {"result": "wishbone-pipelined", "clock": "separate"},
}

PACKETS: dict[str, dict[str, Any]] = {
    "axi-stream": {"result": "axi-stream"},
    "axi-stream-separate": {"result": "axi-stream", "sample": "axi-stream", "clock": "separate"},
    "axi-stream-clocked": {
        "result": "axi-stream",
        "sample": "axi-stream",
        "core": "pipelined",
        "clocking": CLOCKED,
    },
    "axi-stream-samples": {"result": "axi-stream", "sample": "axi-stream", "time_stamps": False},
    "axi-stream-fast-core": {"result": "axi-stream", "core": "pipelined"},
    "stream": {"result": "stream", "depth": 2},
    "stream-separate": {"result": "stream", "clock": "separate"},
}


def masters(result: str) -> str:
    """The package that has the bus's master."""
    kind = result.partition("-")[0]
    return {"axi": "cocotbext.axi", "stream": "cocotbext.axi"}.get(kind, f"cocotbext.{kind}")


@pytest.mark.parametrize("seed", [3, pytest.param(4, marks=pytest.mark.deep)])
@pytest.mark.parametrize("keys", few_of(REGISTERS, ["axi-lite-clocked", "apb"]))
def test_registers(keys: dict[str, Any], seed: int, tmp_path: Path) -> None:
    """Somebody's master reads the golden model's results, under stalls of every channel."""
    pytest.importorskip(masters(keys["result"]), reason="the bus's master is not installed")
    design = bus_design(**keys)
    majors = 4 if seed == 3 else 30
    run_bench(design, tmp_path, "bus_bench", job_of(design, seed, majors), 2)


IN_VERILATOR = {
    name: REGISTERS[name]
    for name in (
        "axi-lite",
        "axi-lite-clocked",
        "apb-no-initial-values",
        "wishbone",
        "wishbone-pipelined-separate",
    )
} | {name: PACKETS[name] for name in ("axi-stream-clocked", "axi-stream-separate", "stream")}


@pytest.mark.deep
@pytest.mark.parametrize("name", IN_VERILATOR)
def test_in_verilator(name: str, tmp_path: Path) -> None:
    """The same masters, in a simulator that knows no X: what has no value begins at random."""
    keys = IN_VERILATOR[name]
    pytest.importorskip(masters(keys["result"]), reason="the bus's master is not installed")
    design = bus_design(**keys)
    module, tests = ("packet_bench", 1) if name in PACKETS else ("bus_bench", 2)
    run_bench(design, tmp_path, module, job_of(design, 5, 10), tests, "verilator")


@pytest.mark.parametrize("seed", [3, pytest.param(4, marks=pytest.mark.deep)])
@pytest.mark.parametrize("keys", few_of(PACKETS, ["axi-stream-separate"]))
def test_packets(keys: dict[str, Any], seed: int, tmp_path: Path) -> None:
    """Packets are the golden model's results, whatever stalls."""
    pytest.importorskip("cocotbext.axi", reason="the bus's master is not installed")
    design = bus_design(**keys)
    majors = 4 if seed == 3 else 30
    run_bench(design, tmp_path, "packet_bench", job_of(design, seed, majors), 1)


LATE: dict[str, tuple[dict[str, Any], int]] = {
    "small-drops-samples": ({"core": "compact"}, 400),
    "small-drops-results": ({"core": "compact", "overrun": "drop-result"}, 400),
    "fast-drops-samples": ({"core": "pipelined"}, 30),
    "fast-drops-results": ({"core": "pipelined", "overrun": "drop-result"}, 3),
    "fast-drops-results-separate": (
        {"core": "pipelined", "overrun": "drop-result", "clock": "separate"},
        1,
    ),
    "fast-drops-results-clocked": (
        {"core": "pipelined", "overrun": "drop-result", "clocking": {"reset": "async"}},
        3,
    ),
}


@pytest.mark.parametrize("case", few_of(LATE, ["fast-drops-results"]))
def test_a_late_host(case: tuple[dict[str, Any], int], tmp_path: Path) -> None:
    """What the design's overrun says gives way, and nothing else."""
    pytest.importorskip("cocotbext.apb", reason="the bus's master is not installed")
    keys, period = case
    design = bus_design("apb", depth=2, **keys)
    job = job_of(design, 7, 40)
    job |= {
        "period": period,
        "idle": 24 * design.samples_per_major * (period + 1),
        "offered": len(job["samples"]),
        "design": design.as_json(),
    }
    run_bench(design, tmp_path, "late_bench", job, 1)


@pytest.mark.parametrize("result", few_of(["wishbone", "axi-lite"], ["wishbone"]))
def test_registers_are_what_the_description_says(result: str, tmp_path: Path) -> None:
    """All addresses of 4 KiB, by what systemrdl-compiler reads in NAME.rdl."""
    pytest.importorskip(masters(result), reason="the bus's master is not installed")
    design = bus_design(result, clock="separate" if result == "axi-lite" else "same")
    facts, resets = from_rdl(generate(design).further["narrow.rdl"], tmp_path)
    registers: dict[int, list[tuple[int, int]]] = {}
    for name, (address, mask) in facts.items():
        if address >= 0x800:
            continue  # no result waits, so the window is an error
        fields = registers.setdefault(address, [])
        if name in resets:
            fields.append((mask, resets[name] << (mask & -mask).bit_length() - 1))
    plain = [fact for name, fact in facts.items() if name.startswith(("inject_g", "inject_a"))]
    job = job_of(design, 3, 1)
    job |= {"registers": registers, "writable": plain, "whole": result == "axi-lite"}
    run_bench(design, tmp_path, "walk_bench", job, 1)
