"""The cycle model's other resets and its clock enable, by hand and by what they are defined as."""

from __future__ import annotations

import numpy as np
import pytest

from sculler_model.design import Design
from sculler_model.golden import CycleModel, Ports, Timing
from strategies import make_design, samples_of

LOW = Ports(0, 0, (0,) * 20)


def design_with(**hardware: object) -> Design:
    return make_design("clocked", 1, 1, 1, (8, 8), hardware=hardware)


def counts_of(design: Design, count: int) -> list[tuple[tuple[int, ...], tuple[int, ...], int]]:
    counts, faults = samples_of(design, count, 3)
    return [
        (tuple(row[:3]), tuple(row[3:]), int(fault))
        for row, fault in zip(counts.tolist(), faults.tolist(), strict=True)
    ]


def test_an_asynchronous_reset_acts_at_once_and_two_clocks_longer() -> None:
    design = design_with(reset="async")
    model = CycleModel(design, Timing(latency=1, startup=1))
    sample = counts_of(design, 1)[0]
    ready = []
    for clock in range(10):
        ready.append(model.clock(sample, 0, rst=int(clock == 5)).sample_ready)
    # two clocks after power-up, and a start-up clock; one sample, whose result nobody takes;
    # the reset's clock, two more, and a start-up clock
    assert ready == [0, 0, 0, 1, 0, 0, 0, 0, 0, 1]


def test_what_is_offered_in_an_asynchronous_reset_counts_for_nothing() -> None:
    design = design_with(reset="async")
    model = CycleModel(design, Timing(latency=1))
    sample = counts_of(design, 1)[0]
    shown = [model.clock(sample if clock < 2 else None, 1, rst=0) for clock in range(6)]
    assert [ports.samples_lost for ports in shown] == [0] * 6
    assert shown[0] == shown[1] == LOW


def test_a_result_that_waits_is_gone_in_the_clock_of_an_asynchronous_reset() -> None:
    for style, valid in (("async", 0), ("sync", 1)):
        design = design_with(reset=style)
        model = CycleModel(design, Timing(latency=1))
        sample = counts_of(design, 1)[0]
        for clock in range(5):
            model.clock(sample if clock == 3 else None, 0)
        assert model.ports().result_valid == 1
        assert model.clock(None, 0, rst=1).result_valid == valid
        assert model.ports().result_valid == 0


@pytest.mark.parametrize("reset", ["sync", "async"])
def test_a_clock_that_is_not_enabled_might_as_well_not_be(reset: str) -> None:
    """The enabled clocks of one run are the clocks of another; the rest shows what follows."""
    design = design_with(reset=reset, clock_enable=True)
    timing = Timing(latency=3, spacing=2, startup=2)
    some, all_ = CycleModel(design, timing), CycleModel(design, timing)
    rng = np.random.default_rng(4)
    enabled = results = 0
    for sample in counts_of(design, 400):
        offered = sample if rng.random() < 0.7 else None
        ready, rst = int(rng.random() < 0.5), int(rng.random() < 0.01)
        enable = int(rng.random() < 0.5)
        shown = some.clock(offered, ready, rst, enable)
        in_reset = reset == "async" and all_._clock < all_._released
        if enable or rst or in_reset:
            assert shown == all_.clock(offered, ready, rst)
            enabled += 1
            results += shown.result_valid & ready
        else:
            assert shown == all_.ports() == some.ports()
    assert 150 < enabled < 300
    assert some.golden.t == all_.golden.t
    assert results > 10


def test_a_reset_acts_in_a_clock_that_is_not_enabled() -> None:
    design = design_with(clock_enable=True)
    model = CycleModel(design, Timing(latency=1))
    model.clock(counts_of(design, 1)[0], 0)
    assert model.ports().result_valid == 1
    model.clock(None, 0, rst=0, clk_en=0)
    assert model.ports().result_valid == 1
    model.clock(None, 0, rst=1, clk_en=0)
    assert model.ports() == Ports(1, 0, (0,) * 20)


def test_the_usual_is_left_unsaid() -> None:
    usual = design_with()
    said = design_with(reset="sync", reset_active="high", clock_enable=False)
    assert said == usual
    assert said.digest == usual.digest
    other = design_with(reset="async", reset_active="low", clock_enable=True)
    assert other.digest != usual.digest
    assert Design.parse(other.as_json()) == other


def test_parts_around_the_core_are_clocked_alike() -> None:
    keys = {"reset": "async", "reset_active": "low", "clock_enable": True}
    hardware = design_with(**keys, bus={"result": "axi-lite"}).hardware
    assert {key: getattr(hardware, key) for key in keys} == keys
