"""What a component is made of: each part's place, kind, signature and what it is for."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from amaranth import Module, Value
from amaranth.hdl import Fragment
from amaranth.hdl._ir import PortDirection
from amaranth.lib import wiring

from sculler_hdl.export.hierarchy import PLAIN_WORDS
from sculler_hdl.export.netlist import quick_netlists


@dataclass(frozen=True)
class Part:
    """A part of a component.

    Attributes:
        kind: its class, in small letters and underscores.
        members: names in its signature.
        note: what it is for, lines of ASCII; none where that is not told.
    """

    kind: str
    members: frozenset[str]
    note: tuple[str, ...]


def prepared(component: wiring.Component, name: str) -> tuple[Any, dict[str, Part]]:
    """A component elaborated once, ready for Amaranth's `rtlil.convert_fragment`, and its parts.

    What it was elaborated to is not kept beside that.

    Args:
        component: its signature's members become ports.
        name: of its module.

    Returns:
        The prepared design, and the parts by the names Amaranth gives their modules.
    """
    ports = {}
    for path, member, signal in component.signature.flatten(component):
        direction = PortDirection.Input if member.flow == wiring.In else PortDirection.Output
        ports["__".join(map(str, path))] = (Value.cast(signal), direction)
    with quick_netlists():
        fragment = Fragment.get(component, None)
        parts = dict(_below(fragment, name))
        _empty_modules(fragment)
        design = fragment.prepare(ports=ports, hierarchy=(name,))
    design.elaboratables.clear()
    for each in design.fragments:  # nor is what they were made from
        each.origins = None
    return design, parts


def _empty_modules(fragment: Fragment) -> None:
    """Let go what Amaranth's modules hold, which refer to themselves and would stay."""
    for origin in fragment.origins or ():
        if isinstance(origin, Module):
            vars(origin).clear()
    for part, _, _ in fragment.subfragments:
        _empty_modules(part)


def _below(fragment: Fragment, path: str) -> Iterator[tuple[str, Part]]:
    for part, name, _ in fragment.subfragments:
        own = f"{path}.{name}"
        made_of = part.origins[0] if part.origins else None
        yield own, _part(made_of)
        yield from _below(part, own)


def _part(component: object) -> Part:
    if component is None or not type(component).__module__.startswith("sculler_hdl."):
        return Part("memory" if type(component).__name__ == "Memory" else "part", frozenset(), ())
    kind = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", type(component).__name__).lower()
    signature = getattr(component, "signature", None)
    members = frozenset() if signature is None else frozenset(signature.members)
    note = _note(inspect.getdoc(type(component)) or "")
    latency = getattr(component, "latency", getattr(getattr(component, "plan", None), "latency", 0))
    if isinstance(latency, int) and latency:
        note = (*note, "", f"Latency here: {latency} clocks.")
    return Part(kind, members, note)


_ASCII = {
    **dict.fromkeys(map(ord, "─┬┴┼├┤└┘┐┌╴╶"), "-"),
    **{ord("│"): "|", ord("▶"): ">", ord("◀"): "<", ord("▲"): "^", ord("▼"): "v"},
    **{ord("·"): "*", ord("×"): "x", ord("Δ"): "d", ord("α"): "alpha", ord("ν"): "nu"},
    **{ord("θ"): "theta", ord("υ"): "upsilon", ord("Σ"): "sum", ord("—"): "-", ord("–"): "-"},
}
"""For the tools that read nothing else, even in comments."""


def _note(text: str) -> tuple[str, ...]:
    """A docstring up to what is about Python; signals by their names in the Verilog text."""
    told = re.split(
        r"^(?:Args|Attributes|Members|Raises|Ports[^\n]*):$", text, maxsplit=1, flags=re.M
    )
    named = re.sub(r"`(\w+)`", lambda word: PLAIN_WORDS.get(word[1], word[1]), told[0])
    return tuple(named.translate(_ASCII).strip().splitlines())
