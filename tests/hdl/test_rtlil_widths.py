"""Passes over the emitted text: operand widths written out, long constants joined of pieces."""

import re

import pytest

from sculler_hdl.export.rtlil_text import read_modules
from sculler_hdl.export.rtlil_widths import equal_widths, top_bit
from sculler_hdl.export.verilog_text import WIDEST, wrapped

WIDTHS = {"\\a": 4, "\\b": 9, "\\v[0]": 5, "$1": 7}


@pytest.mark.parametrize(
    ("expression", "bit"),
    [
        ("\\b", "\\b [8]"),
        ("\\b [5:2]", "\\b [5]"),
        ("\\b [3]", "\\b [3]"),
        ("\\v[0]", "\\v[0] [4]"),
        ("\\v[0] [2:1]", "\\v[0] [2]"),
        ("{ \\a 3'000 }", "\\a [3]"),
        ("{ 2'10 \\a }", "1'1"),
        ("{ $1 [6] $1 }", "$1 [6]"),
    ],
)
def test_top_bit(expression, bit):
    assert top_bit(expression, WIDTHS) == bit


MODULE = r"""module \m
  wire width 4 input 1 \a
  wire width 9 input 2 \b
  wire width 10 $1
  wire $2
  wire width 8 output 3 \y
  cell $add $c
    parameter \A_SIGNED 1
    parameter \A_WIDTH 4
    parameter \B_SIGNED 1
    parameter \B_WIDTH 9
    parameter \Y_WIDTH 10
    connect \A \a
    connect \B \b
    connect \Y $1
  end
  cell $logic_not $n
    parameter \A_SIGNED 0
    parameter \A_WIDTH 4
    parameter \Y_WIDTH 1
    connect \A \a
    connect \Y $2
  end
  connect \y $1 [8:1]
end
"""


def widened(text):
    (module,) = read_modules(text).values()
    equal_widths(module)
    return module.text()


def test_sum_is_cut_to_what_is_read_and_operands_fill_it():
    out = widened(MODULE)
    assert "  wire width 9 $1\n" in out
    assert "    connect \\A { \\a [3] \\a [3] \\a [3] \\a [3] \\a [3] \\a }\n" in out
    assert "    connect \\B \\b\n" in out
    assert "    parameter \\Y_WIDTH 9\n" in out


def test_sum_read_whole_keeps_its_width():
    out = widened(MODULE.replace("$1 [8:1]", "{ $1 [9:8] $1 [5:0] }"))
    assert "  wire width 10 $1\n" in out
    assert "    connect \\B { \\b [8] \\b }\n" in out


def test_unsigned_operands_are_filled_with_zeros():
    out = widened(MODULE.replace("\\A_SIGNED 1", "\\A_SIGNED 0"))
    assert "    connect \\A { 1'0 1'0 1'0 1'0 1'0 \\a }\n" in out


def test_logic_not_becomes_a_comparison_with_zero():
    out = widened(MODULE)
    assert "  cell $eq $n\n" in out
    assert "    connect \\B 4'0000\n" in out
    assert "$logic_not" not in out


def test_a_constant_too_long_for_a_line_is_joined_of_pieces():
    value = int("1" + "0123456789abcdef" * 12, 16)
    text = wrapped(f"  assign x = pick(a, 773'h{value:x}, b);")
    assert max(map(len, text.splitlines())) <= WIDEST
    pieces = re.findall(r"(\d+)'h([0-9a-f]+)", text)
    whole = bits = 0
    for width, digits in pieces:
        assert len(digits) <= -(-int(width) // 4)
        whole, bits = (whole << int(width)) | int(digits, 16), bits + int(width)
    assert (whole, bits) == (value, 773)
