"""The modules of a design in plain names: one for each part, alike parts share theirs.

Amaranth names a module by its place (`stim300_4x5.within.unit0_x0_tile00`), a signal by the name it
has in the code and what makes that unique.  Here all become identifiers that Verilog, SystemVerilog
and VHDL take without an escape:

* a part that stands in one place is called by it, `stim300_4x5_within`;
* parts that are alike in every bit share one module, called by its kind, `stim300_4x5_running_sum`;
* the parts' names begin with the design's, so that generated cores can stand in one project.

What nothing reads is left out (`unread`).
"""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace

from sculler_hdl.export.rtlil_text import (
    Cell,
    Module,
    renamed,
)
from sculler_hdl.export.unread import without_unread
from sculler_model.design import RESERVED_WORDS

LONGEST = 64
"""Characters of a name."""

PLAIN_WORDS = {"input": "data_in", "output": "data_out", "before": "previous"}
"""Other names for members of signatures that are reserved words."""


def plain_modules(
    modules: Mapping[str, Module], top: str, kinds: Mapping[str, str]
) -> tuple[dict[str, Module], dict[str, str]]:
    """The design's modules, the top one first, in plain names; and what each was called before.

    Args:
        modules: all of it, by name.
        top: the name of the top module, which keeps it and its ports' names.
        kinds: what sort of part a module is, in words joined by underscores, by module.
    """
    order = list(_parts_first(modules, top))
    without_unread(modules, order)
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
    name = PLAIN_WORDS.get(head, head) + dot + rest
    name = re.sub(r"-(?=\d)", "m", name)
    name = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
    name = name if name[:1].isalpha() else f"s{name}"
    return f"{name}_s" if name.lower() in RESERVED_WORDS else name


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
        return signals.get(signal) or renamed(signal, signals.__getitem__)

    ports_first = sorted(module.wires.items(), key=lambda each: each[1].place or 1 << 30)
    wires = {signals[name]: replace(wire) for name, wire in ports_first}
    for place, wire in enumerate((wire for wire in wires.values() if wire.direction), start=1):
        wire.place = place
    made = Module(module.name, wires)
    taken = {name[1:].lower() for name in wires}
    number = 0
    for name, cell in module.cells.items():
        if name.startswith("\\"):
            new = "\\" + _free(_word(name[1:]), taken)
        else:
            number += 1
            new = "\\" + _free(f"c{number}", taken)  # that of the function, if it becomes one
        there = ports.get(cell.kind)
        connections = {
            port if there is None else there[port]: changed(signal)
            for port, signal in cell.connections.items()
        }
        parameters = dict(cell.parameters)
        if "\\MEMID" in parameters:
            parameters["\\MEMID"] = '"\\\\' + _free("words", taken) + '"'
        made.cells[new] = Cell(names.get(cell.kind, cell.kind), parameters, connections, cell.block)
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
    many = Counter(kinds[name] for name in order if uses[name] > 1)
    for name in order:
        if name == top:
            continue
        own = name[1:].removeprefix(f"{top[1:]}.")
        if uses[name] > 1:
            own = kinds[name] + "_1" * (many[kinds[name]] > 1)
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
