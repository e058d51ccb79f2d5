"""Write out operand widths in RTLIL, so that the Verilog text has no implicit ones.

Verilog gives ``a + b`` the width of what it is assigned to and extends or cuts without a word;
linters ask that this be written.  This pass rewrites the additions, subtractions and comparisons
of a flat RTLIL module so that both operands and the result are equally wide:

* a sum whose top bits nobody reads loses them (it is exact modulo 2^width all the same),
* narrower operands are extended by their sign, or by zeros.

Products lose unread top bits too, but their operands are left alone: synthesisers size multipliers
by the operands' widths, and linters accept them.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

_SUMS = ("$add", "$sub")
_COMPARISONS = ("$eq", "$ne", "$lt", "$le", "$gt", "$ge")

_WIRE = re.compile(
    r"^  wire(?: width (?P<width>\d+))?(?P<rest>(?: \w+(?: \d+)?)*?) (?P<name>[\\$]\S+)$", re.M
)
_USE = re.compile(r"(?P<name>[\\$]\S+)(?: \[(?P<high>\d+)[:\]])?")


@dataclass
class _Cell:
    """One cell of the module, as its lines say it."""

    kind: str
    name: str
    parameters: dict[str, int] = field(default_factory=dict)
    connections: dict[str, str] = field(default_factory=dict)

    @classmethod
    def parse(cls, lines: list[str]) -> _Cell:
        _, kind, name = lines[0].split()
        cell = cls(kind, name)
        for line in lines[1:-1]:
            if match := re.match(r"    parameter(?: signed)? \\(\w+) (\d+)$", line):
                cell.parameters[match[1]] = int(match[2])
            elif match := re.match(r"    connect \\(\w+) (.*)$", line):
                cell.connections[match[1]] = match[2]
        return cell

    def lines(self) -> list[str]:
        return [
            f"  cell {self.kind} {self.name}",
            *(f"    parameter \\{name} {value}" for name, value in self.parameters.items()),
            *(f"    connect \\{name} {value}" for name, value in self.connections.items()),
            "  end",
        ]


def equal_widths(rtlil: str) -> str:
    """Return the flat module with every addition, subtraction and comparison at one width.

    ``$logic_not`` of several bits becomes a comparison with 0.
    """
    widths = {match["name"]: int(match["width"] or 1) for match in _WIRE.finditer(rtlil)}
    needed = _needed_widths(rtlil, widths)

    def rewrite(match: re.Match[str]) -> str:
        lines = match[0].splitlines()
        if lines[0].split()[1] not in (*_SUMS, "$mul", *_COMPARISONS, "$logic_not"):
            return match[0]
        cell = _Cell.parse(lines)
        _equalise(cell, widths, needed)
        return "\n".join(cell.lines()) + "\n"

    def declare(match: re.Match[str]) -> str:
        width = needed.get(match["name"])
        if width is None:
            return match[0]
        return f"  wire width {width}{match['rest']} {match['name']}"

    return _WIRE.sub(declare, re.sub(r"^  cell .*?^  end\n", rewrite, rtlil, flags=re.M | re.S))


def _needed_widths(rtlil: str, widths: dict[str, int]) -> dict[str, int]:
    """How many low bits of each sum's result wire are read, for those not read whole."""
    sums: set[str] = set()
    read: dict[str, int] = {}
    kind = ""
    for line in rtlil.splitlines():
        if line.startswith("  cell "):
            kind = line.split()[1]
        elif line.startswith("    connect \\Y ") and kind in (*_SUMS, "$mul"):
            sums.add(line.split(maxsplit=2)[2])
        elif line.lstrip().startswith("connect "):
            _, first, rest = line.split(maxsplit=2)
            # inside a cell the first word is a port name, outside it is a signal
            for match in _USE.finditer(rest if line.startswith("    ") else f"{first} {rest}"):
                name = match["name"]
                if name in widths:
                    top = int(match["high"]) if match["high"] else widths[name] - 1
                    read[name] = max(read.get(name, 0), top + 1)
    return {name: read[name] for name in sums & read.keys() if read[name] < widths[name]}


def _equalise(cell: _Cell, widths: dict[str, int], needed: dict[str, int]) -> None:
    parameters, connections = cell.parameters, cell.connections
    if cell.kind == "$logic_not":
        cell.kind = "$eq"
        bits = parameters["A_WIDTH"]
        parameters |= {"A_SIGNED": 0, "B_SIGNED": 0, "B_WIDTH": bits}
        connections["B"] = f"{bits}'{'0' * bits}"
    if cell.kind in (*_SUMS, "$mul"):
        width = parameters["Y_WIDTH"] = needed.get(connections["Y"], parameters["Y_WIDTH"])
        if cell.kind == "$mul":
            return
    else:
        width = max(parameters["A_WIDTH"], parameters["B_WIDTH"])
    signed = parameters["A_SIGNED"] and parameters["B_SIGNED"]
    for port in "AB":
        missing = width - parameters[f"{port}_WIDTH"]
        if missing > 0:
            fill = top_bit(connections[port], widths) if signed else "1'0"
            connections[port] = f"{{ {' '.join([fill] * missing)} {connections[port]} }}"
            parameters[f"{port}_WIDTH"] = width


def top_bit(sigspec: str, widths: dict[str, int]) -> str:
    """The most significant bit of an RTLIL signal expression, itself as an expression.

    Args:
        sigspec: a wire, a slice, a constant or a concatenation (most significant part first).
        widths: widths of the module's wires.
    """
    first, *rest = (word for word in sigspec.split() if word not in "{}")
    if "'" in first:
        return f"1'{first.partition(chr(39))[2][0]}"
    if rest and rest[0].startswith("["):
        return f"{first} [{rest[0][1:-1].partition(':')[0]}]"
    return f"{first} [{widths[first] - 1}]"
