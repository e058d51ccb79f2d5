"""Ports of parts under the names of their signatures, in the RTLIL that Amaranth writes.

Where a signal of a signature is another one, or made of others, Amaranth names the port after that
other one, or after a number.  Here such ports get the signature's names back.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Set

_MODULE = re.compile(r"^module (?P<name>\S+)\n.*?^end$", re.M | re.S)
_PORT = re.compile(
    r"^  wire width (?P<width>\d+) (?P<direction>input|output) \d+ .*?(?P<name>\S+)$", re.M
)
_ALIAS = re.compile(r"^connect (?P<name>\S+) (?P<of>.+)$", re.M)
_CELL = re.compile(r"^  cell (?P<kind>\S+) \S+\n.*?^  end$", re.M | re.S)
_PIECE = re.compile(r"(?:([\\$]\S+)(?: \[(\d+)(?::(\d+))?\])?|(\d+)'\d+)")
_SIGNAL = re.compile(r"[\\$]\S+")


def with_signature_names(text: str, members: Mapping[str, Set[str]]) -> str:
    """RTLIL whose parts' ports are called as in their signatures.

    Args:
        text: as Amaranth writes it.
        members: names in the signature of a module, by module; those of others stay.
    """
    names: dict[str, dict[str, str]] = {}

    def in_module(found: re.Match[str]) -> str:
        changes = _changes(found[0], members.get(found["name"], frozenset()))
        names[found["name"]] = changes
        swapped = changes | {new: old for old, new in changes.items()}
        return _SIGNAL.sub(lambda name: swapped.get(name[0], name[0]), found[0])

    def in_cell(found: re.Match[str]) -> str:
        changes = names.get(found["kind"], {})

        def port(line: re.Match[str]) -> str:
            return f"{line[1]}{changes.get(line[2], line[2])} "

        return re.sub(r"^(    connect )(\S+) ", port, found[0], flags=re.M)

    return _CELL.sub(in_cell, _MODULE.sub(in_module, text))


def _changes(module: str, members: Set[str]) -> dict[str, str]:
    """New names of ports by old ones."""
    ports = {each["name"]: int(each["width"]) for each in _PORT.finditer(module)}
    changes: dict[str, str] = {}
    taken = set(ports)
    for alias in _ALIAS.finditer(module):
        name = alias["name"]
        if name[1:] not in members or name in ports:
            continue
        pieces = _pieces(alias["of"], ports)
        for low, piece in pieces:
            if piece not in ports or piece[1:] in members or piece in changes:
                continue
            new = name if len(pieces) == 1 else f"{name}_{low}"
            if new not in taken:
                changes[piece] = new
                taken.add(new)
    return changes


def _pieces(signal: str, widths: Mapping[str, int]) -> list[tuple[int, str]]:
    """Where each piece of a signal expression begins, and its wire, "" for a constant."""
    found, low = [], 0
    for piece in reversed(_PIECE.findall(signal)):
        name, high, last, constant = piece
        if constant:
            width = int(constant)
        elif high:
            width = int(high) - int(last or high) + 1
        else:
            width = widths.get(name, 0)
        found.append((low, name))
        low += width
    return found
