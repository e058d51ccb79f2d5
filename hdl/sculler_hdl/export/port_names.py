"""Ports of parts as in their signatures, in the RTLIL that Amaranth writes.

Where a signal of a signature is but another name, or made of other signals, Amaranth makes ports of
those others, under their names or under numbers.  Here

* a port that is the whole of a signature's signal gets its name;
* outputs that together are one become that one;
* what is a part of one is called after it and the part's lowest bit.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Set
from dataclasses import dataclass, field

from sculler_hdl.export.rtlil_text import Bit, bits_in, renamed

_MODULE = re.compile(r"^module (?P<name>\S+)\n.*?^end$", re.M | re.S)
_WIRE = re.compile(
    r"^  wire width (?P<width>\d+)(?: (?P<direction>input|output) (?P<place>\d+))?"
    r" +(?:signed +)?(?P<name>\S+)$",
    re.M,
)
_ALIAS = re.compile(r"^connect (?P<name>\S+) (?P<of>.+)$", re.M)
_INSTANCE = re.compile(r"^  cell (?P<kind>\\\S+) \S+\n.*?^  end$", re.M | re.S)
_CONNECTION = re.compile(r"^    connect (?P<port>\S+) (?P<signal>.+)\n", re.M)
_LINE = re.compile(r"^(  cell .*|    parameter .*|    connect \S+ |)(.*)$", re.M)


@dataclass
class _Changes:
    """What becomes of a module's ports.

    Attributes:
        names: new names by old ones.
        whole: for an output, the outputs it takes the place of, the highest bits first.
    """

    names: dict[str, str] = field(default_factory=dict)
    whole: dict[str, list[str]] = field(default_factory=dict)


def with_signature_names(text: str, members: Mapping[str, Set[str]]) -> str:
    """RTLIL whose parts' ports are those of their signatures.

    Args:
        text: as Amaranth writes it.
        members: names in the signature of a module, by module; those of others stay.
    """
    changes: dict[str, _Changes] = {}

    def in_module(found: re.Match[str]) -> str:
        made = _changes(found[0], members.get(found["name"], frozenset()))
        changes[found["name"]] = made
        module = _renamed(found[0], made.names | {new: old for old, new in made.names.items()})
        for whole, parts in made.whole.items():
            module = _collected(module, whole, parts)
        return module

    def in_instance(found: re.Match[str]) -> str:
        made = changes.get(found["kind"])
        return found[0] if made is None else _connected(found[0], made)

    return _INSTANCE.sub(in_instance, _MODULE.sub(in_module, text))


def _changes(module: str, members: Set[str]) -> _Changes:
    wires = {wire["name"]: wire for wire in _WIRE.finditer(module)}
    widths = {name: int(wire["width"]) for name, wire in wires.items()}
    taken = {name for name, wire in wires.items() if wire["direction"]}
    found_aliases = [(found["name"], found["of"]) for found in _ALIAS.finditer(module)]
    if not any(name[1:] in members and name not in taken for name, _ in found_aliases):
        return _Changes()
    aliases = [(name, bits_in(of, widths)) for name, of in found_aliases]
    sources = {(name, bit): of for name, bits in aliases for bit, of in enumerate(bits)}

    def source(bit: Bit) -> Bit:
        while bit in sources:
            bit = sources[bit]
        return bit

    # ports under other names than the signature's, by the bits that they show
    shown = {
        source((name, bit)): (name, bit)
        for name, wire in wires.items()
        if wire["direction"] and name[1:] not in members
        for bit in range(widths[name])
    }
    made = _Changes()
    used: set[str] = set()  # ports that have got their place
    for name, bits in aliases:
        if name[1:] not in members or name in taken:
            continue
        found = [shown.get(source(bit)) for bit in bits]
        found = [port if port and port[0] not in used else None for port in found]
        ports = list(dict.fromkeys(port for port, _ in filter(None, found)))
        whole = [(port, bit) for port in ports for bit in range(widths[port])]
        if len(ports) > 1 and found == whole and wires[ports[0]]["direction"] == "output":
            made.whole[name] = ports[::-1]
            taken.add(name)
            used.update(ports)
            continue
        for port in ports:
            low = found.index((port, 0)) if (port, 0) in found else 0
            new = name if found == whole and len(ports) == 1 else f"{name}_{low}"
            if new not in taken:
                made.names[port] = new
                taken.add(new)
                used.add(port)
    return made


def _renamed(module: str, names: Mapping[str, str]) -> str:
    """A module with other names for its signals; cells, their ports and parameters keep theirs."""
    if not names:
        return module

    def line(found: re.Match[str]) -> str:
        return found[1] + renamed(found[2], lambda name: names.get(name, name))

    return _LINE.sub(line, module)


def _collected(module: str, whole: str, parts: list[str]) -> str:
    """A module with one output in the place of several."""
    places = []

    def inner(wire: re.Match[str]) -> str:
        if wire["name"] not in parts:
            return wire[0]
        places.append(wire["place"])
        return wire[0].replace(f" output {wire['place']}", "")

    module = _WIRE.sub(inner, module)

    def outer(wire: re.Match[str]) -> str:
        if wire["name"] != whole:
            return wire[0]
        return wire[0].replace(
            f"width {wire['width']}", f"width {wire['width']} output {places[0]}"
        )

    return _WIRE.sub(outer, module)


def _connected(cell: str, made: _Changes) -> str:
    """An instance with its ports' new names."""
    found = {each["port"]: each["signal"] for each in _CONNECTION.finditer(cell)}
    head = _CONNECTION.sub("", cell).removesuffix("  end")
    lines = []
    for whole, parts in made.whole.items():
        signals = [found.pop(part) for part in parts]
        inner = " ".join(signal.strip("{} ") for signal in signals)
        lines.append(f"    connect {whole} {{ {inner} }}\n")
    for port, signal in found.items():
        lines.append(f"    connect {made.names.get(port, port)} {signal}\n")
    return f"{head}{''.join(lines)}  end"
