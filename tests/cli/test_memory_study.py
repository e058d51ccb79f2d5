"""`python -m studies.memories`."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from sculler_sim.place.tools import YOSYS
from studies import documents
from studies.memories.command import PAGE, command, table
from studies.memories.measure import FAMILIES, Memory, memories, places

TEXT = """
module unit_bus_store (input clk, input [7:0] a, b, input [31:0] d, input w, output reg [31:0] q);
  (* no_rw_check *) reg [31:0] words [255:0];
  always @(posedge clk) begin
    if (w) words[a] <= d;
    q <= words[b];
  end
endmodule
module unit_other (input clk, output reg q);
  always @(posedge clk) q <= !q;
endmodule
"""


def test_memories_are_found_and_told() -> None:
    held = memories(TEXT)
    assert held == [Memory("unit_bus_store", 256, 32)]
    rows = table(held, {"One": ["DP16KD"], "Two": ["TRELLIS_DPR16X4"], "Three": [""]})
    assert rows[0] == "| family | queue 256 × 32 |"
    assert rows[2:] == [
        "| One | **`DP16KD`** |",
        "| Two | `TRELLIS_DPR16X4` |",
        "| Three | logic |",
    ]


def test_the_page_has_every_family() -> None:
    page = (Path(__file__).parents[2] / documents.PAGES / PAGE).read_text()
    for name in FAMILIES:
        assert f"\n| {name} | " in page


def test_an_unknown_family_is_refused() -> None:
    done = CliRunner().invoke(command, ["--only", "none"])
    assert done.exit_code
    assert "--only none: no such family" in str(done.exception)


@pytest.mark.deep
@pytest.mark.parametrize(
    ("family", "cell"),
    # by hand: 256 words of 32 bits are 8 Kbit, less than any of these holds
    [("Lattice ECP5", "16KD"), ("Lattice iCE40", "ICE40_RAM"), ("Microchip SmartFusion2", "")],
)
def test_a_queue_goes_to_block_memory(family: str, cell: str) -> None:
    pytest.importorskip(YOSYS.module, reason="Yosys is not installed")
    (found,) = places(TEXT, family)
    assert cell in found
    assert bool(found) == bool(cell)
