"""[hardware.bus] of the design file."""

from __future__ import annotations

from typing import Any

import pytest

from sculler_model.design import Bus, Design
from sculler_model.errors import InputError


def design(bus: dict[str, Any] | None, **hardware: Any) -> Design:
    table = {**hardware} if bus is None else {**hardware, "bus": bus}
    return Design.parse({"preset": "hg4930", "hardware": table})


def test_with_a_bus_the_pipelined_core_streams() -> None:
    assert design(None).hardware.handover == "parallel"
    assert design({"result": "apb"}).hardware.handover == "stream"


def test_what_is_left_out() -> None:
    bus = design({"result": "axi-lite"}).hardware.bus
    assert bus == Bus(result="axi-lite", depth=4, time_stamps=True, clock="same")
    assert bus.sample is None
    assert design({"result": "axi-lite", "sample": "ports"}).hardware.bus == bus


def test_a_design_without_a_bus_says_nothing_of_one() -> None:
    plain = design(None)
    assert "bus" not in plain.as_json()["hardware"]
    assert design({"result": "apb"}).digest != plain.digest


def test_it_comes_back_from_json() -> None:
    told = design({"result": "wishbone", "depth": 16, "clock": "separate", "time_stamps": False})
    assert Design.parse(told.as_json()) == told


@pytest.mark.parametrize("result", ["stream", "axi-stream"])
def test_streams_have_no_registers(result: Any) -> None:
    assert not Bus(result=result).has_registers
    assert Bus(result="wishbone-pipelined").has_registers


@pytest.mark.parametrize(
    ("bus", "hardware", "said"),
    [
        ({}, {}, 'hardware.bus.result: missing, give "stream", "axi-stream"'),
        ({"result": "ahb"}, {}, "hardware.bus.result: 'ahb' is not allowed"),
        ({"result": "apb", "depth": 6}, {}, "hardware.bus.depth: 6 is not allowed, give a power"),
        ({"result": "apb", "depth": 1}, {}, "hardware.bus.depth: 1 is not allowed, give a power"),
        ({"result": "apb", "clok": "same"}, {}, "unknown key, did you mean clock"),
        ({"result": "apb", "sample": "front"}, {}, 'sample: "front" needs [hardware.front]'),
        (
            {"result": "apb", "sample": "axi-stream"},
            {"front": {"sensor": "hg4930", "clock_hz": 1e8}},
            'sample: "axi-stream" is not possible with [hardware.front]',
        ),
        ({"result": "apb"}, {"handover": "parallel"}, "not possible with [hardware.bus]"),
    ],
)
def test_faults_are_named(bus: dict[str, Any], hardware: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as raised:
        design(bus, **hardware)
    assert said in str(raised.value)
    assert "\n" not in str(raised.value)
