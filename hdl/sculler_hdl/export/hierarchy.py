"""The modules of a design in plain names: one for each part, alike parts share theirs.

Amaranth names a module by its place (`stim300_4x5.within.unit0_x0_tile00`), a signal by the name it
has in the code and what makes that unique.  Here all become identifiers that Verilog, SystemVerilog
and VHDL take without an escape:

* a part that stands in one place is called by it, `stim300_4x5_within`;
* parts that are alike in every bit share one module, called by its kind, `stim300_4x5_running_sum`;
* the parts' names begin with the design's, so that generated cores can stand in one project.

Of a part's inputs only the bits are left that it reads.
"""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from sculler_hdl.export.reserved import RESERVED
from sculler_hdl.export.rtlil_text import (
    Bit,
    Cell,
    Module,
    Wire,
    bits_in,
    of_bits,
    renamed,
)

LONGEST = 64
"""Characters of a name."""

_PLAIN_WORDS = {"input": "data_in", "output": "data_out", "before": "previous"}


def plain_modules(
    modules: Mapping[str, Module], top: str, kinds: Mapping[str, str]
) -> tuple[dict[str, Module], dict[str, str]]:
    """The design's modules, the top one first, in plain names; and what each was called before.

    Args:
        modules: all of it, by name.
        top: the name of the top module, which keeps it and its ports' names.
        kinds: what sort of part a module is, in words joined by underscores, by module; one that
            is not told is a memory.
    """
    order = list(_parts_first(modules, top))
    without_unread_bits(modules, order)
    ports: dict[str, dict[str, str]] = {}  # new names of a module's ports
    names: dict[str, str] = {}  # new name by old name
    alike: dict[str, str] = {}  # the module that a text stands for
    found: dict[str, Module] = {}
    for old in order:
        module = modules[old]
        signals = _plain_signals(module, keep_ports=old == top)
        ports[old] = {name: signals[name] for name in module.ports}
        made = _renamed(module, signals, ports, names)
        text = made.text().partition("\n")[2]
        first = alike.setdefault(text, old)
        names[old] = first
        if first == old:
            found[old] = made
    return _named(found, top, kinds, Counter(_uses(found, top)))


def _parts_first(modules: Mapping[str, Module], top: str) -> Iterator[str]:
    """All modules, each after those it is made of."""
    seen: set[str] = set()

    def visit(name: str) -> Iterator[str]:
        if name in seen:
            return
        seen.add(name)
        for cell in modules[name].cells.values():
            if cell.kind in modules:
                yield from visit(cell.kind)
        yield name

    return visit(top)


def without_unread_bits(modules: Mapping[str, Module], order: list[str]) -> None:
    """Take away wires that are but other names, and the bits of wires and inputs not read.

    Args:
        modules: all modules.
        order: their names, each after those it is made of; the last one's ports stay.
    """
    left: dict[str, dict[str, list[Cut]]] = {}
    for name in order:
        module = modules[name]
        for cell in module.cells.values():
            for port, cuts in left.get(cell.kind, {}).items():
                bits = bits_in(cell.connections.pop(port), module.widths)
                for cut in cuts:
                    some = bits[cut.first : cut.last + 1]
                    cell.connections[cut.name] = of_bits(some, module.widths)
        _without_aliases(module)
        left[name] = _cut(module, inputs=name != order[-1])


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

    def followed(bit: Bit) -> Bit:
        while bit in aliases:
            bit = aliases[bit]
        return bit

    module.connections = [
        (of_bits(list(bits), widths), of_bits(list(bits.values()), widths))
        for bits in (dict(sorted(bits.items())) for bits in outputs.values())
    ]
    module.replace_bits(followed, module.wires)


class Cut(NamedTuple):
    """What is left of a wire: a name, and which bits of the whole it has."""

    name: str
    first: int
    last: int


def _cut(module: Module, *, inputs: bool) -> dict[str, list[Cut]]:
    """Leave of each wire only the bits that stand anywhere; what became of inputs."""
    there: dict[str, set[int]] = {name: set() for name in module.wires}
    for name, bit in module.bits():
        if name in there:
            there[name].add(bit)
    cuts: dict[str, list[Cut]] = {}
    for name, wire in module.wires.items():
        if wire.direction == "output" or (wire.direction == "input" and not inputs):
            continue
        runs = _runs(there[name])
        if runs != [(0, wire.width - 1)]:
            cuts[name] = [
                Cut(name if len(runs) == 1 else f"{name}[{last}:{first}]", first, last)
                for first, last in runs
            ]
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
            wires[cut.name] = Wire(width, wire.direction, wire.place, wire.signed, init)
    found = {name: cut for name, cut in cuts.items() if module.wires[name].direction}
    module.replace_bits(lambda bit: changes.get(bit, bit), wires)
    return found


def _runs(bits: set[int]) -> list[tuple[int, int]]:
    """First and last of each run of neighbours."""
    runs: list[tuple[int, int]] = []
    for bit in sorted(bits):
        if runs and runs[-1][1] == bit - 1:
            runs[-1] = (runs[-1][0], bit)
        else:
            runs.append((bit, bit))
    return runs


def _plain_signals(module: Module, *, keep_ports: bool) -> dict[str, str]:
    """Names for the wires of a module: those from the code first, then those Yosys made."""
    taken: set[str] = set()
    names: dict[str, str] = {}
    if keep_ports:
        names = {name: name for name in module.ports}
        taken = {name[1:].lower() for name in names}
    told = [name for name in module.wires if name.startswith("\\") and name not in names]
    # of two signals of one name the one that the code did not have to tell apart goes first
    for name in sorted(told, key=lambda each: ("$" in each, each)):
        names[name] = "\\" + _free(_word(name[1:]), taken)
    number = 0
    for name in module.wires:
        if name not in names:
            number += 1
            names[name] = "\\" + _free(f"n{number}", taken)
    return names


def _word(name: str) -> str:
    """A name without what Verilog or VHDL would have to escape."""
    name = re.sub(r"\$\d+", "", name)
    name = re.sub(r"\[\d+:(\d+)\]$", r"_\1", name)  # a part, by its lowest bit
    head, dot, rest = name.partition(".")
    name = _PLAIN_WORDS.get(head, head) + dot + rest
    name = re.sub(r"-(?=\d)", "m", name)
    name = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
    name = name if name[:1].isalpha() else f"s{name}"
    return f"{name}_s" if name.lower() in RESERVED else name


def _free(name: str, taken: set[str]) -> str:
    """The name, or with a number behind it; VHDL does not tell capitals from small letters."""
    name = _short(name)
    number, found = 1, name
    while found.lower() in taken:
        number += 1
        found = f"{_short(name, len(str(number)) + 1)}_{number}"
    taken.add(found.lower())
    return found


def _short(name: str, room: int = 0) -> str:
    """The name, cut where it is too long, with a digest that keeps it apart from others."""
    if len(name) + room <= LONGEST:
        return name
    digest = hashlib.sha256(name.encode()).hexdigest()[:8]
    return f"{name[: LONGEST - room - 9].rstrip('_')}_{digest}"


def _renamed(
    module: Module,
    signals: Mapping[str, str],
    ports: Mapping[str, Mapping[str, str]],
    names: Mapping[str, str],
) -> Module:
    """A module with its wires and cells renamed, and its parts by the modules they share."""

    def changed(signal: str) -> str:
        return renamed(signal, signals.__getitem__)

    wires = {
        signals[name]: Wire(wire.width, wire.direction, place, wire.signed, wire.init)
        for place, (name, wire) in enumerate(
            sorted(module.wires.items(), key=lambda each: each[1].place or 1 << 30)
        )
    }
    place = 0
    for wire in wires.values():
        if wire.direction:
            place += 1
            wire.place = place
    made = Module(module.name, wires)
    taken = {name[1:].lower() for name in wires}
    number = 0
    for name, cell in module.cells.items():
        if name.startswith("\\"):
            new = "\\" + _free(_word(name[1:]), taken)
        else:
            number += 1
            new = f"$c{number}"
        there = ports.get(cell.kind)
        connections = {
            port if there is None else there[port]: changed(signal)
            for port, signal in cell.connections.items()
        }
        parameters = dict(cell.parameters)
        if "\\MEMID" in parameters:
            parameters["\\MEMID"] = '"\\\\' + _free("words", taken) + '"'
        made.cells[new] = Cell(names.get(cell.kind, cell.kind), parameters, connections)
    made.connections = [(changed(left), changed(right)) for left, right in module.connections]
    return made


def _uses(modules: Mapping[str, Module], top: str) -> Iterator[str]:
    yield top
    for module in modules.values():
        for cell in module.cells.values():
            if cell.kind in modules:
                yield cell.kind


def _named(
    modules: Mapping[str, Module], top: str, kinds: Mapping[str, str], uses: Counter[str]
) -> tuple[dict[str, Module], dict[str, str]]:
    """The modules under their own names, the top one first, each before those it is made of."""
    taken: set[str] = {top[1:].lower()}
    names = {top: top}
    order = list(reversed(list(modules)))
    kind = {name: kinds.get(name, "memory") for name in order}
    many = Counter(kind[name] for name in order if uses[name] > 1)
    for name in order:
        if name == top:
            continue
        own = name[1:].removeprefix(f"{top[1:]}.")
        if uses[name] > 1:
            own = kind[name] + "_1" * (many[kind[name]] > 1)
        names[name] = "\\" + _numbered(_word(f"{top[1:]}_{own}"), taken)
    found = {}
    for old in order:
        module = modules[old]
        module.name = names[old]
        for cell in module.cells.values():
            cell.kind = names.get(cell.kind, cell.kind)
        found[module.name] = module
    return found, {new: old for old, new in names.items()}


def _numbered(name: str, taken: set[str]) -> str:
    """The name, its last number raised until it is free."""
    stem, number = re.fullmatch(r"(.*?)(?:_(\d+))?", name).groups()  # type: ignore[union-attr]
    found = _short(name)
    count = int(number or 1)
    while found.lower() in taken:
        count += 1
        found = _short(f"{stem}_{count}")
    taken.add(found.lower())
    return found
