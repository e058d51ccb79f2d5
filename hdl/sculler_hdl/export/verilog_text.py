"""The Verilog that Yosys writes, put as a person would: ports in the head, registers before wires.

Registers start by `initial` statements, not by initialisers in their declarations.  Memories are
marked as never depending on a word read as it is written, which saves iCE40 synthesis the logic to
make sure of it.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from types import MappingProxyType

from sculler_hdl.targets import BLOCK_ATTRIBUTES

_MODULE = re.compile(
    r"^module (?P<name>\w+)\((?P<ports>.*?)\);\n(?P<body>.*?)^endmodule$", re.M | re.S
)
_DECLARED = re.compile(
    r"  (?P<kind>input|output|wire|reg) (?P<range>\[\d+:0\] )?(?P<name>\w+)"
    r"(?P<words> \[\d+:0\])?(?: = (?P<init>[^;]+))?;$"
)


_SYNCHRONISER = dict.fromkeys(("unsettled", "data_out"), '(* ASYNC_REG = "TRUE" *) ')
"""Registers of `lib.crossing.Synchroniser`, which tools are to leave as they are, side by side."""

_APART = '(* keep = "true", dont_touch = "true", dont_merge, syn_preserve = 1 *)\n  '
"""Of registers that are copies on purpose, for Vivado, Quartus and Synplify; see `_keeping`."""

WIDEST = 100
"""Characters of a line."""

_REGISTER = re.compile(r"  always @\(posedge clk\)\n(?:    if .*\n)? +(?P<name>\w+) <= ")
_OF_A_DOMAIN = re.compile(r"\w+_(clk|rst)")

_WIDE_CONSTANT = re.compile(r"\b(?P<bits>\d+)'h(?P<digits>[0-9a-f]{81,})\b")
_PIECE_DIGITS = 16


def wrapped(text: str) -> str:
    """The text with no line longer than `WIDEST`, as far as it can be broken."""
    return "".join(f"{part}\n" for line in text.splitlines() for part in _parts(line))


def _parts(line: str) -> Iterator[str]:
    if len(line) <= WIDEST:
        yield line
        return
    margin = re.match(r"(?:// ?)? *", line)
    indent = (margin[0] if margin else "") + "    "
    line = _WIDE_CONSTANT.sub(_pieces, line)
    while len(line) > WIDEST:
        end = max(line.rfind(mark, len(indent), WIDEST) + 1 for mark in (" ", "("))
        if end <= len(indent):
            break
        yield line[:end].rstrip()
        line = indent + line[end:]
    yield line


def _pieces(constant: re.Match[str]) -> str:
    """A constant too long for a line as the pieces that it is joined of, the highest first."""
    bits, digits = int(constant["bits"]), constant["digits"]
    count = -(-len(digits) // _PIECE_DIGITS)
    padded = digits.zfill(count * _PIECE_DIGITS)
    cut = [padded[i : i + _PIECE_DIGITS] for i in range(0, len(padded), _PIECE_DIGITS)]
    highest = bits - 4 * _PIECE_DIGITS * (count - 1)
    cut[0] = cut[0][-((highest + 3) // 4) :] if highest < 4 * _PIECE_DIGITS else cut[0]
    widths = [highest, *[4 * _PIECE_DIGITS] * (count - 1)]
    return "{ " + ", ".join(f"{w}'h{d}" for w, d in zip(widths, cut, strict=True)) + " }"


def read_verilog(text: str) -> dict[str, str]:
    """Yosys' text of the modules of a design, by name: from `module` to `endmodule`."""
    return {found["name"]: found[0] for found in _MODULE.finditer(text)}


_COPIED = '(* keep_hierarchy = "yes", syn_hier = "hard" *)'
"""Of a module whose instances are alike and have to stay: Yosys and Vivado, Synplify."""


def tidy(
    module: str,
    ports: Sequence[str] = (),
    note: Sequence[str] = (),
    *,
    apart: Collection[str] = (),
    blocks: Mapping[str, str] = MappingProxyType({}),
    initial: bool = True,
    blank: bool = False,
    copied: bool = False,
) -> str:
    """A module with its ports in its head.

    Args:
        module: as `read_verilog` gives it.
        ports: order of the ports; those not told follow as they stand, clock and reset first.
        note: lines of a comment above it.
        apart: registers that synthesis is not to make one with equal ones.
        blocks: which of `BLOCK_ATTRIBUTES` memories are that are meant for block memory, by name.
        initial: whether registers and memories get their initial values.
        blank: whether those of large memories are left out where all are 0.
        copied: whether synthesis is to leave its instances as they are, though they are alike.
    """
    found = _MODULE.fullmatch(module)
    assert found is not None, "no module"
    crossing = re.search(r"^  reg .*\bunsettled\b", found["body"], re.M) is not None
    heads: dict[str, str] = {}
    registers: list[str] = []
    starts: list[str] = []
    wires: list[str] = []
    rest: list[str] = []
    for line in found["body"].splitlines():
        declared = _DECLARED.match(line)
        if declared is None:
            rest.append(line)
            continue
        kind, width, name = declared["kind"], declared["range"] or "", declared["name"]
        mark = _SYNCHRONISER.get(name, "") if crossing else _APART * (name in apart)
        if kind in ("input", "output"):
            heads[name] = f"{mark}{kind} {width}{name}"
        elif name in heads:
            if kind == "reg":
                heads[name] = heads[name].replace("output ", "output reg ")
        elif declared["words"]:
            registers += [f"  {BLOCK_ATTRIBUTES[blocks[name]]}"] if name in blocks else []
            registers.append(f"  (* no_rw_check *) reg {width}{name}{declared['words']};")
        else:
            (registers if kind == "reg" else wires).append(f"  {mark}{kind} {width}{name};")
        if declared["init"] and initial:
            starts.append(f"  initial {name} = {declared['init']};")
    body = re.sub(r"^  function (?=\[)", "  function automatic ", "\n".join(rest), flags=re.M)
    body = _keeping(body, apart)
    if not initial:
        body = _STARTS.sub("", body)
    elif blank:
        body = _STARTS.sub(lambda found: "" if _is_blank(found[0]) else found[0], body)
    own = re.findall(r"\w+", found["ports"])
    listed = ",\n".join(f"  {heads[port]}" for port in _ordered(own, ports))
    lines = [
        *(f"// {line}".rstrip() for line in note),
        *[_COPIED] * copied,
        f"module {found['name']} (",
        listed,
        ");",
    ]
    text = "\n".join([*lines, *registers, *wires, *starts, body, "endmodule", ""])
    return re.sub(r"\b(\d+)'h0{20,}\b", r"{\1{1'h0}}", text)


def _ordered(own: Sequence[str], ports: Sequence[str]) -> list[str]:
    """A module's own ports: those told first, the clock's and reset's next."""
    # Amaranth has those of the clock domains in no order of its own
    clocks = sorted(set(own) & {"clk", "rst"}) + sorted(filter(_OF_A_DOMAIN.fullmatch, own))
    first = [*ports, *(port for port in clocks if port not in ports)]
    return [*first, *(port for port in own if port not in first)]


def _keeping(body: str, apart: Collection[str]) -> str:
    """Marks the statements that make the registers `apart`, for there Yosys looks for it."""

    def marked(found: re.Match[str]) -> str:
        return f"  (* keep *) {found[0].lstrip()}" if found["name"] in apart else found[0]

    return _REGISTER.sub(marked, body) if apart else body


_STARTS = re.compile(r"^  initial begin\n.*?^  end\n", re.M | re.S)
"""What a memory holds at first, a line a word."""

_LARGE = 1024  # words, whose zeros synthesis takes minutes to read


def _is_blank(block: str) -> bool:
    """Whether it is the zeros of a large memory."""
    return block.count("\n") > _LARGE and not re.search(r"'h0*[1-9a-f]", block)
