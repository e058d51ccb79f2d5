"""What nothing reads, taken out of a design's modules: bits of ports and wires, and dead cells.

Linters of Verilog ask for that, and in a flat module Yosys would do it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import NamedTuple

from sculler_hdl.export.rtlil_text import (
    Bit,
    Cell,
    Module,
    Wire,
    bits_in,
    of_bits,
    pieces,
    slice_of,
)

_RESULTS = frozenset(("\\Y", "\\Q"))
"""Outputs of the cells that Yosys makes of operations and registers."""


def without_unread(modules: Mapping[str, Module], order: list[str]) -> None:
    """Take out wires that are but other names, and all that nothing reads.

    Args:
        modules: all modules.
        order: their names, each after those it is made of; the last one's ports stay.
    """
    for _ in range(2):  # what is unread in one module may have been all that read another's
        _without_unread_outputs(modules, order)
        _without_unread_bits(modules, order)


Masks = dict[str, int]
"""Bits of wires, as numbers in binary, by wire."""


class Cut(NamedTuple):
    """What is left of a wire: a name, and which bits of the whole it has."""

    name: str
    first: int
    last: int


def _without_unread_bits(modules: Mapping[str, Module], order: list[str]) -> None:
    """Take out wires that are but other names, and the bits of wires and inputs not read."""
    left: dict[str, dict[str, list[Cut]]] = {}
    for name in order:
        module = modules[name]
        widths = module.widths
        for cell in module.cells.values():
            for port, cuts in left.get(cell.kind, {}).items():
                bits = bits_in(cell.connections.pop(port), widths)
                for cut in cuts:
                    some = bits[cut.first : cut.last + 1]
                    cell.connections[cut.name] = of_bits(some, widths)
        _without_aliases(module)
        left[name] = _cut(module, inputs=name != order[-1])


def _without_unread_outputs(modules: Mapping[str, Module], order: list[str]) -> None:
    """Take out outputs of parts that nothing reads, and what is there for them alone."""
    used: dict[str, set[str]] = {name: set() for name in order}  # outputs
    for name in reversed(order):
        module = modules[name]
        for port, wire in module.ports.items():
            if wire.direction == "output" and port not in used[name] and name != order[-1]:
                wire.direction = ""
        read = _without_dead_cells(module, modules)
        _narrow_copies(module, read)
        widths = module.widths
        for cell in module.cells.values():
            for port, wire in modules[cell.kind].ports.items() if cell.kind in modules else ():
                if wire.direction == "output" and _any(cell.connections[port], widths, read):
                    used[cell.kind].add(port)
    for name in order:
        for cell in modules[name].cells.values():
            if cell.kind in modules:
                there = modules[cell.kind].ports
                cell.connections = {p: s for p, s in cell.connections.items() if p in there}


def _without_dead_cells(module: Module, modules: Mapping[str, Module]) -> Masks:
    """Take out operations and registers that nothing reads; the bits that are read then."""
    widths = module.widths
    while True:
        read = _read_bits(module, modules, widths)
        dead = [key for key, cell in module.cells.items() if _is_dead(cell, read, widths)]
        if not dead:
            return read
        for key in dead:
            del module.cells[key]


def _narrow_copies(module: Module, read: Masks) -> None:
    """Leave of registers that are copies on purpose only what is read, a register for each run.

    Others are made of what is read of them.
    """
    widths = module.widths
    for key, cell in list(module.cells.items()):
        name = cell.connections.get("\\Q", "")
        if cell.kind != "$dff" or name not in widths or not module.wires[name].apart:
            continue
        if read[name] == (1 << widths[name]) - 1:
            continue
        del module.cells[key]
        data = bits_in(cell.connections["\\D"], widths)
        for first, last in _runs(read[name]):
            width = last - first + 1
            own = {
                "\\D": of_bits(data[first : last + 1], widths),
                "\\Q": slice_of(name, first, width, widths[name]),
            }
            parameters = cell.parameters | {"\\WIDTH": str(width)}
            made = Cell(cell.kind, parameters, cell.connections | own)
            module.cells[f"{key}[{last}:{first}]"] = made


def _read_bits(module: Module, modules: Mapping[str, Module], widths: Mapping[str, int]) -> Masks:
    """The bits that something in a module reads, or that it hands out."""
    signals = [right for _, right in module.connections]
    for cell in module.cells.values():
        for port, signal in cell.connections.items():
            if cell.kind in modules:
                driven = modules[cell.kind].wires[port].direction != "input"
            else:
                driven = cell.kind.startswith("$") and port in _RESULTS
            if not driven:
                signals.append(signal)
    signals += [name for name, wire in module.ports.items() if wire.direction == "output"]
    return _masks(signals, widths)


def _masks(signals: Iterable[str], widths: Mapping[str, int]) -> Masks:
    """The bits of wires in signal expressions."""
    masks = dict.fromkeys(widths, 0)
    for signal in signals:
        for name, low, width in pieces(signal, widths):
            if name in masks:
                masks[name] |= (1 << width) - 1 << low
    return masks


def _any(signal: str, widths: Mapping[str, int], masks: Masks) -> bool:
    """Whether one of the signal's bits is among those of the masks."""
    return any(
        masks.get(name, 0) >> low & (1 << width) - 1 for name, low, width in pieces(signal, widths)
    )


def _is_dead(cell: Cell, read: Masks, widths: Mapping[str, int]) -> bool:
    """Whether nothing reads what an operation or a register gives."""
    results = [cell.connections[port] for port in _RESULTS & cell.connections.keys()]
    if not cell.kind.startswith("$") or not results:
        return False
    return not any(_any(signal, widths, read) for signal in results)


def _without_aliases(module: Module) -> None:
    """Put what a wire is connected to in its place, but for outputs."""
    widths = module.widths
    aliases: dict[Bit, Bit] = {}
    outputs: dict[str, dict[Bit, Bit]] = {}
    for left, right in module.connections:
        for bit, of in zip(bits_in(left, widths), bits_in(right, widths), strict=True):
            if module.wires[bit[0]].direction:
                outputs.setdefault(bit[0], {})[bit] = of
            else:
                aliases[bit] = of
    module.connections = [
        (of_bits(list(bits), widths), of_bits(list(bits.values()), widths))
        for bits in (dict(sorted(bits.items())) for bits in outputs.values())
    ]
    if aliases:
        module.replace_bits({bit: _followed(aliases, bit) for bit in aliases}, module.wires)


def _followed(aliases: Mapping[Bit, Bit], bit: Bit) -> Bit:
    while bit in aliases:
        bit = aliases[bit]
    return bit


def _cut(module: Module, *, inputs: bool) -> dict[str, list[Cut]]:
    """Leave of each wire only the bits that stand anywhere; what became of inputs."""
    there = _masks(module.signals(), module.widths)
    cuts: dict[str, list[Cut]] = {}
    for name, wire in module.wires.items():
        if wire.direction == "output" or (wire.direction == "input" and not inputs):
            continue
        if there[name] != (1 << wire.width) - 1:
            runs = _runs(there[name])
            cuts[name] = [
                Cut(name if len(runs) == 1 else f"{name}[{last}:{first}]", first, last)
                for first, last in runs
            ]
    if not cuts:
        return {}
    changes = {
        (name, bit): (cut.name, bit - cut.first)
        for name, parts in cuts.items()
        for cut in parts
        for bit in range(cut.first, cut.last + 1)
    }
    wires: dict[str, Wire] = {}
    for name, wire in module.wires.items():
        for cut in cuts.get(name, [Cut(name, 0, wire.width - 1)]):
            width = cut.last - cut.first + 1
            init = wire.init and wire.init[wire.width - 1 - cut.last : wire.width - cut.first]
            wires[cut.name] = replace(wire, width=width, init=init)
    found = {name: cut for name, cut in cuts.items() if module.wires[name].direction}
    module.replace_bits(changes, wires)
    return found


def _runs(mask: int) -> list[tuple[int, int]]:
    """First and last of each run of ones."""
    runs: list[tuple[int, int]] = []
    place = 0
    while mask >> place:
        rest = mask >> place
        first = place + (rest & -rest).bit_length() - 1
        ones = mask >> first
        last = first + (~ones & ones + 1).bit_length() - 2
        runs.append((first, last))
        place = last + 1
    return runs
