"""The core between Amaranth's streams, and the Python file that has it."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from amaranth.hdl import Fragment, Value
from amaranth.lib import stream
from amaranth.sim import Simulator

from sculler.runs.hardware import write_amaranth
from sculler_hdl import StreamCore, result_layout, sample_layout
from sculler_model.design import AXES, Design
from sculler_model.errors import InputError
from sculler_model.golden import GoldenModel, to_words
from strategies import DESIGNS, samples_of, with_hardware
from tiers import few_of

CASES = {
    "parallel": DESIGNS["smallest"],
    "words": with_hardware(DESIGNS["smallest"], core="compact", target="ecp5"),
    "pipelined words": with_hardware(DESIGNS["smallest"], handover="stream"),
}


def payloads_of(design: Design, core: StreamCore, samples: int, seed: int) -> tuple[Any, Any]:
    """What comes out of the simulated core, and what the golden model says should."""
    counts, faults = samples_of(design, samples, seed)
    rng = np.random.default_rng(seed)
    results = list(
        GoldenModel(design).run(
            (tuple(row[:3]), tuple(row[3:]), int(fault))
            for row, fault in zip(counts.tolist(), faults.tolist(), strict=True)
        )
    )
    if design.hardware.handover == "stream":
        words = [to_words(design, result.row()) for result in results]
        wanted = [
            {"data": word, "last": int(i == len(row) - 1)}
            for row in words
            for i, word in enumerate(row)
        ]
    else:
        wanted = [dict(zip(design.columns, result.row(), strict=True)) for result in results]
    shown: list[dict[str, int]] = []

    async def source(ctx: Any) -> None:
        for row, fault in zip(counts.tolist(), faults.tolist(), strict=True):
            while rng.random() < 0.3:
                await ctx.tick()
            payload = {"gyro": row[:3], "accel": row[3:], "fault": int(fault)}
            ctx.set(core.samples.payload, payload)
            ctx.set(core.samples.valid, 1)
            await ctx.tick().until(core.samples.ready)
            ctx.set(core.samples.valid, 0)

    async def sink(ctx: Any) -> None:
        for _ in range(10_000):
            if len(shown) == len(wanted):
                break
            ready = int(rng.random() < 0.7)
            ctx.set(core.results.ready, ready)
            if ctx.get(core.results.valid) and ready:
                shown.append(named(ctx.get(core.results.payload)))
            await ctx.tick()

    simulator = Simulator(core)
    simulator.add_clock(1e-8)
    simulator.add_testbench(source, background=True)
    simulator.add_testbench(sink)
    simulator.run()
    return shown, wanted


def named(payload: Any) -> dict[str, int]:
    """Fields by the names of the columns."""
    found: dict[str, int] = {}
    for name, _ in payload.shape():
        value = payload[name]
        if hasattr(value, "shape"):
            found |= {f"{name}_{axis}": value[i] for i, axis in enumerate(AXES)}
        else:
            found[name] = int(value)
    return found


@pytest.mark.parametrize("name", few_of(list(CASES), ["parallel", "words"]))
def test_streams_carry_the_golden_models_results(name: str) -> None:
    design = CASES[name]
    shown, wanted = payloads_of(design, StreamCore(design, primitive=False), 12, 5)
    assert len(wanted) >= 12
    assert shown == wanted


def test_payloads_are_as_wide_as_the_numbers() -> None:
    design = DESIGNS["stim300_4x5"]
    core = StreamCore(design)
    assert core.signature.is_compliant(core)
    taken = core.signature.members["samples"].signature.flip()
    assert taken == stream.Signature(sample_layout(design))
    assert sample_layout(design).size == 3 * 24 + 3 * 24 + 1
    vectors = (getattr(design.words, name).bits for name in design.vectors)
    assert result_layout(design).size == 64 + 4 + 3 * sum(vectors)
    assert Value.cast(core.results.payload.alpha[0]).shape().signed
    Fragment.get(core, None)


def test_the_file_is_the_design_and_its_core(tmp_path: Path) -> None:
    for design in (*CASES.values(), with_hardware(DESIGNS["stim300_4x5"], core="compact")):
        written = write_amaranth(design, tmp_path)
        assert written.file.name == f"{design.name}.py"
        made = runpy.run_path(str(written.file))
        assert made["DESIGN"] == design
        assert made["DESIGN"].digest == design.digest
        core = made["Core"](primitive=False)
        assert isinstance(core, StreamCore)
        assert core.design == design
        assert design.digest in made["__doc__"]
        assert all(name in made["Core"].__doc__ for name in result_layout(design).members)
        Fragment.get(core, None)  # it can be built


def test_a_design_that_cannot_be_built_is_not_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"hardware\.multipliers"):
        write_amaranth(with_hardware(DESIGNS["stim300_4x5"], multipliers=1), tmp_path)
    assert not list(tmp_path.iterdir())
