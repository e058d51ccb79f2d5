"""RTLIL, the text Amaranth hands to Yosys, read into modules and written again.

Only what comes of Yosys' `proc` and `memory_collect` is read: wires, cells and connections.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

_WIRE = re.compile(
    r"  wire(?: width (?P<width>\d+))?(?: (?P<direction>input|output) (?P<place>\d+))?"
    r"(?P<signed> signed)? (?P<name>\S+)$"
)
_NAME = re.compile(r"[\\$]\S+")
_INIT = re.compile(r"  attribute \\init (?P<constant>\S+)$")


@dataclass
class Wire:
    """A wire of a module.

    Attributes:
        width: bits.
        direction: "input", "output", or "" where it is no port.
        place: of the port, from 1.
        signed: whether it is declared so.
        init: the bits a register starts with, None where it is not said.
        apart: whether the register is not to be made one with equal ones (`lib.delay.APART`).
    """

    width: int
    direction: str = ""
    place: int = 0
    signed: bool = False
    init: str | None = None
    apart: bool = False


@dataclass
class Cell:
    """A cell of a module: an operation, a register, or an instance of another module.

    Attributes:
        kind: `$add`, `$dff`, ..., or a module's name with a backslash.
        parameters: text by name.
        connections: signal by port.
        block: whether it is a memory that is meant for block memory (`lib.block_memory`).
    """

    kind: str
    parameters: dict[str, str] = field(default_factory=dict)
    connections: dict[str, str] = field(default_factory=dict)
    block: bool = False

    @property
    def memory(self) -> str:
        """The name of the memory that it is."""
        return self.parameters["\\MEMID"].strip('"').lstrip("\\")

    @property
    def is_written(self) -> bool:
        """Whether a memory has ports to write."""
        return int(self.parameters["\\WR_PORTS"]) > 0


@dataclass
class Module:
    """A module; names with their backslash or dollar sign, as they stand."""

    name: str
    wires: dict[str, Wire] = field(default_factory=dict)
    cells: dict[str, Cell] = field(default_factory=dict)
    connections: list[tuple[str, str]] = field(default_factory=list)

    @property
    def ports(self) -> dict[str, Wire]:
        """Its ports in order."""
        found = [(name, wire) for name, wire in self.wires.items() if wire.direction]
        return dict(sorted(found, key=lambda port: port[1].place))

    @property
    def widths(self) -> dict[str, int]:
        """Bits of each wire."""
        return {name: wire.width for name, wire in self.wires.items()}

    def signals(self) -> Iterator[str]:
        """Every signal expression at a cell or in a connection."""
        for cell in self.cells.values():
            yield from cell.connections.values()
        for pair in self.connections:
            yield from pair

    def replace_bits(self, changes: Mapping[Bit, Bit], wires: dict[str, Wire]) -> None:
        """Put others in the place of bits, and `wires`, which have them, in the place of wires."""
        before = self.widths
        self.wires = wires
        after = self.widths
        names = {name for name, _ in changes}

        def changed(signal: str) -> str:
            if names.isdisjoint((signal,) if signal in before else names_in(signal)):
                return signal
            return of_bits([changes.get(bit, bit) for bit in bits_in(signal, before)], after)

        for cell in self.cells.values():
            cell.connections = {port: changed(each) for port, each in cell.connections.items()}
        self.connections = [(changed(left), changed(right)) for left, right in self.connections]

    def text(self) -> str:
        """As RTLIL."""
        lines = [f"module {self.name}"]
        for name, wire in self.wires.items():
            if wire.init is not None:
                lines.append(f"  attribute \\init {len(wire.init)}'{wire.init}")
            lines += ["  attribute \\keep 1"] * wire.apart
            port = f" {wire.direction} {wire.place}" if wire.direction else ""
            lines.append(f"  wire width {wire.width}{port}{' signed' * wire.signed} {name}")
        for name, cell in self.cells.items():
            lines += ['  attribute \\ram_style "block"'] * cell.block
            lines.append(f"  cell {cell.kind} {name}")
            lines += [f"    parameter {key} {value}" for key, value in cell.parameters.items()]
            lines += [f"    connect {port} {signal}" for port, signal in cell.connections.items()]
            lines.append("  end")
        lines += [f"  connect {left} {right}" for left, right in self.connections]
        return "\n".join([*lines, "end", ""])


def read_modules(text: str) -> dict[str, Module]:
    """The modules of an RTLIL text by name.

    Raises:
        ValueError: a line is none of those that this reads.
    """
    modules: dict[str, Module] = {}
    module, cell, init, apart, block = Module(""), None, None, False, False
    for line in text.splitlines():
        words = line.split(maxsplit=2)
        if not words or words[0] in ("autoidx", "end", "#"):
            cell = None
        elif words[0] == "module":
            module = modules[words[1]] = Module(words[1])
        elif words[0] == "attribute":
            found = _INIT.match(line)
            init = _bits(found["constant"]) if found else init
            apart = apart or words[1] == "\\keep"
            block = block or words[1] == "\\ram_style"
        elif words[0] == "wire" and (made := _WIRE.match(line)):
            module.wires[made["name"]] = Wire(
                int(made["width"] or 1),
                made["direction"] or "",
                int(made["place"] or 0),
                bool(made["signed"]),
                init,
                apart,
            )
            init, apart = None, False
        elif words[0] == "cell":
            cell = module.cells[words[2]] = Cell(words[1], block=block)
            block = False
        elif words[0] == "parameter" and cell is not None:
            key, value = line.removeprefix("    parameter ").rsplit(" ", 1)
            cell.parameters[key] = value
        elif words[0] == "connect" and cell is not None:
            cell.connections[words[1]] = words[2]
        elif words[0] == "connect":
            left, right = _two_signals(line.removeprefix("  connect "))
            module.connections.append((left, right))
        else:
            raise ValueError(f"a line of RTLIL that is not known: {line}")
    return modules


def _bits(constant: str) -> str:
    """The bits of a constant, the highest first; Yosys writes one of 32 bits as a number."""
    size, quote, bits = constant.partition("'")
    return bits if quote else f"{int(size) % (1 << 32):032b}"


def _two_signals(text: str) -> tuple[str, str]:
    """Two signal expressions, one after the other."""
    if text.startswith("{"):
        end = text.index("}") + 1
    else:
        found = re.match(r"\S+(?: \[[^]]*\])?", text)
        end = found.end() if found else 0
    return text[:end], text[end + 1 :]


_PIECE = re.compile(r"([\\$]\S+)(?: \[(\d+)(?::(\d+))?\])?|(\d+)'(\S+)|(-?\d+)")

Piece = tuple[str, int, int]
"""A wire, its lowest bit here, how many; for a constant its bits, 0, how many."""


def pieces(signal: str, widths: Mapping[str, int]) -> list[Piece]:
    """What a signal expression is made of, the lowest bits first.

    Args:
        signal: wires, slices, constants, or a concatenation of them.
        widths: bits of the wires.
    """
    if signal in widths:  # most are a whole wire
        return [(signal, 0, widths[signal])]
    found: list[Piece] = []
    for name, high, low, size, constant, integer in reversed(_PIECE.findall(signal)):
        if not name:
            bits = _bits(integer or f"{size}'{constant}")
            found.append((bits, 0, len(bits)))
        elif high:
            first = int(low or high)
            found.append((name, first, int(high) - first + 1))
        else:
            found.append((name, 0, widths[name]))
    return found


def slice_of(name: str, low: int, width: int, whole: int) -> str:
    """Some bits of a wire that has `whole` of them."""
    if width == whole:
        return name
    return f"{name} [{low}]" if width == 1 else f"{name} [{low + width - 1}:{low}]"


Bit = tuple[str, int]
"""A wire and the number of its bit; for a constant "0", "1" or "x", and 0."""


def bits_in(signal: str, widths: Mapping[str, int]) -> list[Bit]:
    """The bits of a signal expression, the lowest first."""
    found: list[Bit] = []
    for name, low, width in pieces(signal, widths):
        if name[0] in "\\$":
            found += [(name, bit) for bit in range(low, low + width)]
        else:
            found += [(bit, 0) for bit in reversed(name)]
    return found


def of_bits(bits: Sequence[Bit], widths: Mapping[str, int]) -> str:
    """The signal expression of some bits, the lowest first."""
    found: list[str] = []
    place = 0
    while place < len(bits):
        name, low = bits[place]
        end = place + 1
        if name[0] in "\\$":
            while end < len(bits) and bits[end] == (name, low + end - place):
                end += 1
            found.append(slice_of(name, low, end - place, widths[name]))
        else:
            while end < len(bits) and bits[end][0][0] not in "\\$":
                end += 1
            constant = "".join(bit for bit, _ in reversed(bits[place:end]))
            found.append(f"{end - place}'{constant}")
        place = end
    return _joined(found)


def _joined(lowest_first: list[str]) -> str:
    if len(lowest_first) == 1:
        return lowest_first[0]
    return f"{{ {' '.join(reversed(lowest_first))} }}"


def names_in(signal: str) -> list[str]:
    """Wires that a signal expression is made of."""
    return _NAME.findall(signal)


def renamed(signal: str, name_of: Callable[[str], str]) -> str:
    """A signal expression with other names for its wires."""
    return _NAME.sub(lambda found: name_of(found[0]), signal)
