"""Every bit of state of an emitted core: its flip-flops and the bits of its memories, by place."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

_MODULE = re.compile(r"^module (?P<name>\w+)\b(?P<body>.*?)^endmodule", re.M | re.S)
_REGISTER = re.compile(
    r"^ *(?:\(\*[^\n]*?\*\) *)*(?:output +)?reg +(?:signed +)?(?:\[(?P<top>\d+):0\] *)?"
    r"(?P<names>[^;()=\n]+?)[;,]? *$",
    re.M,
)
_NAME = re.compile(r"^(?P<name>\w+)(?: *\[(?P<one>\d+):(?P<other>\d+)\])?$")
_INSTANCE = re.compile(r"^  (?P<kind>\w+) +(?:#\(.*?\) *)?(?P<name>\w+) *\(", re.M | re.S)
_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.S)


@dataclass(frozen=True)
class State:
    """A register, or a memory.

    Attributes:
        module: it stands in.
        scope: the instance of that, with the core's own name first.
        name: its name there.
        bits: of a word.
        words: how many; None of a register.
    """

    module: str
    scope: str
    name: str
    bits: int
    words: int | None

    @property
    def size(self) -> int:
        """Bits in all."""
        return self.bits * (self.words or 1)


def states(text: str, top: str) -> list[State]:
    """All state of the instance of module `top`, and of all below it.

    Every `reg` of an emitted text is one: what is combinational is a wire or a function.

    Args:
        text: the emitted Verilog, with the models of its blocks.
        top: the core's module.
    """
    plain = _COMMENT.sub("", text)
    modules = {found["name"]: found["body"] for found in _MODULE.finditer(plain)}
    return list(_below(modules, top, top))


def _below(modules: dict[str, str], kind: str, scope: str) -> Iterator[State]:
    body = re.sub(r"^ *function\b.*?^ *endfunction", "", modules[kind], flags=re.M | re.S)
    for found in _REGISTER.finditer(body):
        for each in found["names"].split(","):
            named = _NAME.match(each.strip())
            if named is None:
                continue
            ends = [int(end) for end in (named["one"], named["other"]) if end is not None]
            words = abs(ends[0] - ends[1]) + 1 if ends else None
            yield State(kind, scope, named["name"], int(found["top"] or 0) + 1, words)
    for found in _INSTANCE.finditer(body):
        if found["kind"] in modules:
            yield from _below(modules, found["kind"], f"{scope}.{found['name']}")
