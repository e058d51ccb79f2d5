"""Memories that are meant for block memory say so in the words of each vendor's tools."""

from __future__ import annotations

import re

import pytest

from sculler_hdl import generate
from sculler_model.design import Design

# by hand, from the makers' manuals
RAM = '(* ram_style = "block", ramstyle = "M10K", syn_ramstyle = "block_ram" *)'
ROM = '(* rom_style = "block", romstyle = "M10K", syn_romstyle = "EBR" *)'


def attributes(text: str) -> dict[tuple[str, int, int], str]:
    """What stands before each memory: by module, words and bits."""
    found = {}
    for module in re.finditer(r"^module (\w+) \(.*?^endmodule", text, re.M | re.S):
        memories = (
            r"^(?:  (\(\* .*\*\))\n)?  \(\* no_rw_check \*\) reg \[(\d+):0\] \w+ \[(\d+):0\];"
        )
        for before, high, last in re.findall(memories, module[0], re.M):
            found[module[1], int(last) + 1, int(high) + 1] = before
    return found


def test_what_fills_a_block_is_marked() -> None:
    """The microprogram, a result's two banks: 4096 bits or more; operands have fewer."""
    design = Design.parse({"preset": "stim300", "name": "unit", "hardware": {"core": "compact"}})
    found = attributes(generate(design).verilog)
    assert found["unit_engine_program", 347, 35] == ROM
    assert found["unit_results", 256, 16] == RAM
    assert found["unit_engine_left", 98, 18] == ""
    for (_, words, bits), before in found.items():
        assert bool(before) == (words * bits >= 4096)


@pytest.mark.deep
def test_so_is_the_queue_of_a_unit() -> None:
    hardware = {
        "core": "compact",
        "bus": {"result": "axi-lite"},
        "front": {"sensor": "stim300", "clock_hz": 50e6},
    }
    made = generate(Design.parse({"preset": "stim300", "name": "unit", "hardware": hardware}))
    found = attributes(made.further["unit_bus.v"] + made.further["unit_front.v"])
    assert found["unit_bus_store", 256, 32] == RAM
    assert found["unit_front_frames", 128, 8] == ""
