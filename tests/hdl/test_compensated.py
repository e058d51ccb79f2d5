"""Compensation before both cores in Amaranth's simulator: every port on every clock."""

from __future__ import annotations

import random
from itertools import pairwise
from typing import Any

import pytest
from amaranth import ClockDomain, Module

import amaranth_runs
from sculler_hdl import build_core, counter_ports, generate, timing
from sculler_hdl.plan.compensation import Kind, plan_compensation
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.golden import (
    CycleModel,
    Ports,
    clocks_per_major,
    clocks_per_minor,
    result_ports,
)
from tiers import few_of

ERRORS: dict[str, Any] = {
    "gyro": {
        "bias": [2000.0, -4000.0, 1000.0],
        "scale_factor": [500.0, -300.0, 200.0],
        "misalignment": [1.0, -0.5, 0.3, 0.8, -0.2, 0.4],
        "g_sensitivity": 100.0,
    },
    "accel": {"bias": [20.0, -10.0, 30.0]},
}


ARMS: dict[str, Any] = {
    "arms_m": [[0.1, 0.02, -0.03], [0.05, -0.2, 0.01], [0.0, 0.03, 0.15]],
    "accel_denominator": 1 << 24,
}
WIDE_ARMS = ERRORS | ARMS | {"accel_denominator": 1 << 32}


def design(
    core: str,
    bits: tuple[int, int] = (16, 16),
    samples: int = 2,
    minors: int = 2,
    family: str = "frequency-taylor",
    hardware: dict[str, Any] | None = None,
    algorithm: dict[str, Any] | None = None,
    **compensation: Any,
) -> Design:
    sensor = {"kind": "increment", "sample_rate_hz": 1000.0}
    return Design.parse(
        {
            "name": "d",
            "sensor": sensor
            | {"gyro": {"bits": bits[0], "lsb": 1e-8}, "accel": {"bits": bits[1], "lsb": 1e-7}},
            "algorithm": {
                "family": family,
                "samples": samples,
                "history": int(samples == 1),
                "minors": minors,
            }
            | (algorithm or {}),
            "hardware": {"core": core} | (hardware or {}),
            "compensation": compensation,
        }
    )


def watch(one: Design, clocks: int, seed: int, often: float, resets: tuple[int, ...] = ()) -> int:
    """Run among random stalls, withdrawn offers and resets; results, or words of them, taken."""
    model, rng = CycleModel(one, timing(one)), random.Random(seed)
    top = Module()
    top.domains.sync = domain = ClockDomain("sync")
    top.submodules.core = core = build_core(one, primitive=False)
    ranges = [one.words.gyro] * 3 + [one.words.accel] * 3
    taken = 0

    async def drive(ctx: Any) -> None:
        nonlocal taken
        ports = [getattr(core, f"sample_{s}_{axis}") for s in ("gyro", "accel") for axis in "xyz"]
        counters = [getattr(core, port.name) for port in counter_ports(one)]
        results = [getattr(core, f"result_{port}") for port in result_ports(one)]
        for clock in range(clocks):
            at_rail = rng.random() < 0.05
            counts = [
                rng.choice([w.lo, w.hi]) if at_rail else rng.randint(w.lo, w.hi) for w in ranges
            ]
            fault, offered = int(rng.random() < 0.05), rng.random() < often
            ready, rst = rng.random() < 0.5, clock in resets
            for port, count in zip(ports, counts, strict=True):
                ctx.set(port, count)
            ctx.set(core.sample_fault, fault)
            ctx.set(core.sample_valid, offered)
            ctx.set(core.result_ready, ready)
            ctx.set(domain.rst, rst)
            shown = ctx.tick().sample(core.sample_ready, core.result_valid, *counters, *results)
            _, _, takes, valid, *others = await shown
            counted, result = others[: len(counters)], others[len(counters) :]
            got = Ports(takes, valid, tuple(result) if valid else (0,) * len(result), *counted)
            sample = (tuple(counts[:3]), tuple(counts[3:]), fault)
            assert got == model.clock(sample if offered else None, ready, rst), clock
            taken += valid and ready and not rst

    amaranth_runs.drive(top, drive)
    return taken


CASES: dict[str, tuple[dict[str, Any], int]] = {
    "pipelined": (
        {"core": "pipelined", "samples": 1, "delay_samples": 0.5, "taps": 2, **ERRORS},
        700,
    ),
    "compact": ({"core": "compact", "delay_samples": 0.4, "taps": 4}, 1800),
    "wide compact": (  # three digits for the gyros, two for the accelerometers
        {"core": "compact", "bits": (24, 12), "samples": 1, "minors": 1, **ERRORS},
        1500,
    ),
    "dropping": (
        {"core": "compact", "samples": 1, "minors": 1, "hardware": {"overrun": "drop-result"}},
        1500,
    ),
    "arms": ({"core": "compact", "samples": 1, "minors": 1, **ERRORS, **ARMS}, 1800),
    "arms, as wide as it gets": (
        {"core": "pipelined", "bits": (24, 24), "samples": 1, "delay_samples": -0.5, **WIDE_ARMS},
        1500,
    ),
    "arms, slow memory": (
        {"core": "compact", "bits": (16, 24), "hardware": {"target": "ice40"}, **ARMS},
        4000,
    ),
    "third order": (
        {"core": "compact", "bits": (24, 16), "algorithm": {"order": 3}, "delay_samples": 0.4},
        15000,
    ),
    "third order, pipelined": (
        {"core": "pipelined", "bits": (12, 12), "algorithm": {"order": 3}, **ERRORS},
        1500,
    ),
    "position": (
        {"core": "compact", "bits": (24, 16), "algorithm": {"position": "high-resolution"}}
        | ERRORS,
        9000,
    ),
    "position, pipelined": (
        {"core": "pipelined", "bits": (12, 12), "algorithm": {"position": "high-resolution"}},
        1500,
    ),
    "widest": (
        {"core": "compact", "bits": (32, 8), "delay_samples": -7.5, "taps": 12, **ERRORS},
        6000,
    ),
    "narrow": (  # offsets far beyond the counts' words
        {"core": "pipelined", "bits": (8, 8), "delay_samples": 3.0, "accel": {"bias": 9000.0}},
        1500,
    ),
    "dense": ({"core": "pipelined", "samples": 3, "family": "time-taylor", **ERRORS}, 3000),
    "ice40": ({"core": "compact", "hardware": {"target": "ice40"}, **ERRORS}, 4000),
    "ecp5": (
        {"core": "pipelined", "bits": (24, 24), "hardware": {"target": "ecp5"}, **ERRORS},
        3000,
    ),
    "words": (
        {"core": "pipelined", "hardware": {"handover": "stream", "overrun": "drop-result"}},
        3000,
    ),
}


@pytest.mark.parametrize("case", few_of(CASES, ["pipelined", "compact", "wide compact", "arms"]))
def test_every_port_on_every_clock(case: tuple[dict[str, Any], int]) -> None:
    made, clocks = case
    resets = (clocks // 3, clocks // 3 + 1, clocks // 2)
    assert watch(design(**made), clocks, 5, 0.6, resets) > 2


def test_a_step_is_a_product_a_clock() -> None:
    """Products are counted, not trusted; an offset is made of powers of two and factors."""
    one = design("pipelined", bits=(24, 24), delay_samples=0.5, **ERRORS)
    stage, plan = plan_compensation(one), one.compensation_plan
    assert plan is not None
    outputs: list[list[Any]] = [[]]
    for step in stage.steps:
        assert step.factor in stage.right
        outputs[-1].append(step)
        if step.last:
            outputs.append([])
    assert outputs.pop() == []
    for steps, terms, offset in zip(outputs, plan.outputs, plan.offsets, strict=True):
        counts = [(s.source, s.lag, s.factor) for s in steps if s.kind == Kind.COUNT]
        assert counts == [tuple(term) for term in terms]
        constants = [s for s in steps if s.kind == Kind.CONSTANT]
        assert sum(s.factor << s.power for s in constants) == offset
        assert all(1 << s.power in one.words.gyro for s in constants)
    # counts are written, products, the way to the last, and the clock that offers
    assert timing(one).compensation == 6 + len(stage.steps) - 1 + stage.summed + 1


def test_how_fast_it_is() -> None:
    """The next sample is taken in the clock after the core has taken the compensated one."""
    one = design("pipelined", delay_samples=0.5, taps=2)
    clocks = timing(one)
    assert clocks.compensation is not None
    assert clocks_per_minor(one, clocks) == 2 * (clocks.compensation + 1)
    assert clocks_per_major(one, clocks) == 4 * (clocks.compensation + 1)
    model, taken = CycleModel(one, clocks), []
    for clock in range(20 * clocks.compensation):
        if model.clock(((0, 0, 0), (0, 0, 0), 0), 1).sample_ready:
            taken.append(clock)
    assert {b - a for a, b in pairwise(taken)} == {clocks.compensation + 1}


def test_manifest_and_text_tell_of_it() -> None:
    one = design("compact", delay_samples=0.5, taps=2, **ERRORS)
    made = generate(one)
    found = made.manifest.as_json()
    assert one.compensation_plan is not None
    assert found["compensation"] == one.compensation_plan.as_json()
    assert found["timing"]["compensation"] == timing(one).compensation
    assert found["latency_clocks"] == timing(one).latency + timing(one).before
    assert found["scales"]["gyro"] == 1e-8 / 65536
    assert found["resources"]["compensation_multipliers"] == 1
    assert "known errors are taken out of each sample first" in made.verilog
    assert "  d_compensation compensation (" in made.verilog
    assert not any("properties" in name for name in made.further)
    plain = generate(Design.preset("stim300")).manifest.as_json()
    assert "compensation" not in plain["timing"]
    assert "compensation" not in plain


def test_what_needs_multiplier_blocks_says_so() -> None:
    with pytest.raises(InputError, match="compensation: is not built without multiplier blocks"):
        design("compact", hardware={"multipliers": 0})
