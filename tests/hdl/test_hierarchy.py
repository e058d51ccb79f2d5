"""The emitted Verilog has a module for each part, in plain names; alike parts share theirs."""

from __future__ import annotations

import re

import pytest

from bench_files import modules_of, places
from higher_order_designs import HIGHER_ORDER
from sculler_hdl import generate
from sculler_hdl.export.port_names import with_signature_names
from sculler_hdl.export.rtlil_text import bits_in, of_bits, pieces, read_modules
from sculler_hdl.export.unread import without_unread
from sculler_model.design import RESERVED_WORDS
from sculler_sim.engines.verilator_build import emitted
from strategies import DESIGNS, make_design, with_hardware
from tiers import tiers

KNOWN = DESIGNS | HIGHER_ORDER
VARIANTS = {
    f"{name}-{'-'.join(map(str, hardware.values()))}": with_hardware(KNOWN[name], **hardware)
    for name, hardware in (
        ("dense_odd_3", {"core": "compact", "target": "ecp5"}),
        ("dense_odd_3", {"core": "compact", "target": "ice40", "multipliers": 0}),
        ("dense_odd_3", {"core": "pipelined", "target": "ice40"}),
        ("rate_4p1", {"core": "pipelined", "target": "ecp5"}),
        ("smallest", {"core": "pipelined", "handover": "stream"}),
        ("stim300_4x5", {"core": "pipelined"}),
        ("third_order", {"core": "pipelined"}),
        ("third_order", {"core": "compact"}),
    )
}
KEPT = {"module", "input", "output", "reg", "wire", "initial", "begin", "end", "assign", "always"}
KEPT |= {"posedge", "if", "else", "endmodule", "case", "casez", "endcase", "default", "signed"}


@pytest.fixture(params=tiers(VARIANTS, also=["stim300_4x5-pipelined", "third_order-pipelined"]))
def design(request):
    return request.param


def test_names_are_plain_in_every_language(design):
    text = emitted(design)[f"{design.name}.v"]
    assert text.isascii()
    code = re.sub(r"//.*|/\*.*?\*/|\(\* .*? \*\)|\"[^\"]*\"", "", text)
    assert "\\" not in code
    words = set(re.findall(r"(?<![\w'$.])[A-Za-z_]\w*", code))
    assert words >= {design.name, "clk", "rst"}
    assert max(map(len, words)) <= 64
    assert {word for word in words if word.lower() in RESERVED_WORDS} <= KEPT
    for body in modules_of(text).values():  # VHDL does not tell capitals from small letters
        names = set(re.findall(r"^  (?:input|output|reg|wire)\b[^;,]*?(\w+)[,;]?$", body, re.M))
        assert len({name.lower() for name in names}) == len(names)


def test_every_module_is_the_designs_own_used_and_told(design):
    text = emitted(design)[f"{design.name}.v"]
    modules = modules_of(text)
    assert next(iter(modules)) == design.name
    assert all(re.match(rf"{design.name}(_\w+)?$", name) for name in modules)
    used = {kind for kind, _ in places(design.name, modules)}
    assert used >= modules.keys() - {design.name}
    untold = re.findall(r"(?:\A|\n\n)module (\w+)", text)
    for name in untold:  # the core has the head of the file; a memory speaks for itself
        assert name == design.name or "(* no_rw_check *) reg" in modules[name], name


def test_alike_parts_share_a_module():
    """Three axes of the same sum are one module; sums whose flags are kept apart are not."""
    design = DESIGNS["stim300_4x5"]
    modules = modules_of(emitted(design)[f"{design.name}.v"])
    kinds = {path: kind for kind, path in places(design.name, modules)}
    for name in ("theta", "v", "alpha", "nu"):
        assert kinds[f"{name}_x"] == kinds[f"{name}_y"] == kinds[f"{name}_z"]
    assert kinds["theta_x"] != kinds["v_x"]
    assert len(set(modules.values())) == len(modules)


def test_a_long_name_leaves_room_for_the_parts():
    name = "a" * 50 + "_b" * 7
    text = generate(with_hardware(make_design(name, 1, 1, 2, (8, 8)), core="compact")).verilog
    modules = modules_of(text)
    assert (len(name), next(iter(modules))) == (64, name)
    assert len(modules) > 5
    assert max(map(len, modules)) <= 64
    assert len({module.lower() for module in modules}) == len(modules)


WIDTHS = {"\\a": 4, "\\b[0]": 3, "$1": 2}


@pytest.mark.parametrize(
    ("signal", "found"),
    [
        ("\\a", [("\\a", 0, 4)]),
        ("\\a [2]", [("\\a", 2, 1)]),
        ("\\a [2:1]", [("\\a", 1, 2)]),
        ("5'10x01", [("10x01", 0, 5)]),
        ("0", [("0" * 32, 0, 32)]),
        ("-1", [("1" * 32, 0, 32)]),
        ("{ \\b[0] 2'10 $1 [1] }", [("$1", 1, 1), ("10", 0, 2), ("\\b[0]", 0, 3)]),
    ],
)
def test_signals_are_read_lowest_bits_first_and_written_again(signal, found):
    assert pieces(signal, WIDTHS) == found
    bits = bits_in(signal, WIDTHS)
    assert len(bits) == sum(width for *_, width in found)
    assert bits_in(of_bits(bits, WIDTHS), WIDTHS) == bits


PARTS = """
module \\top
  wire width 4 input 1 \\in
  wire width 2 output 2 \\out
  wire width 3 \\from_part
  cell \\part \\part
    connect \\whole \\in
    connect \\low \\from_part [0]
    connect \\high \\from_part [2:1]
  end
  connect \\out \\from_part [2:1]
end
module \\part
  wire width 4 input 1 \\whole
  wire width 1 output 2 \\low
  wire width 2 output 3 \\high
  wire width 4 \\alias
  cell $not $1
    parameter \\A_WIDTH 2
    connect \\A \\alias [3:2]
    connect \\Y \\high
  end
  cell $not $2
    parameter \\A_WIDTH 1
    connect \\A \\whole [0]
    connect \\Y \\low
  end
  connect \\alias \\whole
end
"""


def test_what_nothing_reads_is_left_out():
    """Bit 1 of the input, and the output `low`, which no one reads, with all that makes it."""
    modules = read_modules(PARTS)
    without_unread(modules, ["\\part", "\\top"])
    part, top = modules["\\part"], modules["\\top"]
    assert {name: wire.width for name, wire in part.ports.items()} == {"\\whole": 2, "\\high": 2}
    assert [cell.connections for cell in part.cells.values()] == [
        {"\\A": "\\whole", "\\Y": "\\high"}
    ]
    (instance,) = top.cells.values()
    assert instance.connections == {"\\high": "\\from_part", "\\whole": "\\in [3:2]"}
    assert {name: wire.width for name, wire in top.ports.items()} == {"\\in": 4, "\\out": 2}


def test_ports_get_the_names_of_the_signature():
    """An output under a register's name, one in two pieces, an input with a constant above it."""
    text = """module \\core
  wire width 3 \\data
  wire width 2 \\some
  wire width 1 \\flag
  cell \\core.part \\part
    connect \\sum_reg \\data [2:0]
    connect \\port$7$0 \\flag [0]
    connect \\port$7$1 \\some [1]
    connect \\port$9$0 \\some [1:0]
  end

end
module \\core.part
  wire width 3 output 0  \\sum_reg
  wire width 1 output 1  \\port$7$0
  wire width 1 output 2  \\port$7$1
  wire width 2 input 3  \\port$9$0
  wire width 3 \\total
  wire width 2 \\flags
  wire width 3 \\operand
connect \\total \\sum_reg [2:0]
connect \\flags { \\port$7$1 [0] \\port$7$0 [0] }
connect \\operand { 1'0 \\port$9$0 [1:0] }
end
"""
    members = {"\\core.part": {"total", "flags", "operand"}}
    found = with_signature_names(text, members)
    (cell,) = re.findall(r"cell \\core.part.*?  end", found, re.S)
    assert dict(re.findall(r"connect (\S+) (.*)", cell)) == {
        "\\flags": "{ \\some [1] \\flag [0] }",
        "\\total": "\\data [2:0]",
        "\\operand_0": "\\some [1:0]",
    }
    ports = re.findall(r"wire width (\d) (input|output) \d +(\S+)", found)
    assert sorted(ports) == [
        ("2", "input", "\\operand_0"),
        ("2", "output", "\\flags"),
        ("3", "output", "\\total"),
    ]
