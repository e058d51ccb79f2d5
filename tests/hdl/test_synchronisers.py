"""What comes from outside the clock goes through two flip-flops that tools are told of."""

from __future__ import annotations

import re
from typing import Any

import pytest

from bench_files import modules_of
from front_designs import design_of
from sculler_hdl import generate
from sculler_model.design import Design
from tiers import few_of

MARK = '(* ASYNC_REG = "TRUE" *) '


def unit(sensor: str, **bus: Any) -> Design:
    data = design_of(sensor).as_json()
    data["hardware"] |= {"bus": bus}
    return Design.parse(data)


UNITS = {  # and how many synchronisers front end and bus have
    "uart, registers in another clock": (unit("hg4930", result="apb", clock="separate"), 1, 6),
    "uart, packets in another clock": (
        unit("hg4930", result="axi-stream", clock="separate", time_stamps=False),
        1,
        2,
    ),
    "spi, one clock": (unit("adis16470", result="wishbone"), 2, 1),
}


@pytest.mark.parametrize("case", few_of(UNITS, ["uart, registers in another clock"]))
def test_both_flip_flops_are_marked(case: tuple[Design, int, int]) -> None:
    """Sensor's pins; pulse, interrupt, and two Gray pointers for each of two queues."""
    design, *counts = case
    made = generate(design).further
    for part, count in zip(("front", "bus"), counts, strict=True):
        text = made[f"{design.name}_{part}.v"]
        modules = modules_of(text)
        marked = [name for name, body in modules.items() if " unsettled;" in body]
        found = [text.count(f"\n  {name} ") for name in marked]
        assert sum(found) == count
        for name in marked:
            declared = re.findall(
                r"^  (\(\*.*?\*\) )?(?:output )?reg .*?(\w+)[;,]?$", modules[name], re.M
            )
            assert sorted(declared) == [(MARK, "data_out"), (MARK, "unsettled")]
        assert text.count("ASYNC_REG") == 2 * len(marked)
