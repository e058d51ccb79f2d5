"""Places of a source and the changes that cosmic-ray makes there, one at a time."""

from __future__ import annotations

import ast
import random
import warnings
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import unified_diff
from typing import Any

from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator, operator_names

Point = tuple[int, int]
"""Line, from 1, and column, from 0."""

SPEED = ("lru_cache", "cache", "cached_property")
TYPING = ("overload", "abstractmethod", "override", "final")
"""Decorators that change nothing that is computed."""


@dataclass(frozen=True)
class Place:
    """A piece of a source, and the ways to change it.

    Attributes:
        path: of the source, from the root.
        begin, end: where it is.
        ways: name of cosmic-ray's operator and its occurrence in the source, of each change.
    """

    path: str
    begin: Point
    end: Point
    ways: tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class Change:
    """A mutant of one source.

    Attributes:
        path: of the source, from the root.
        line: where it begins, from 1.
        was, now: the lines that are changed, without space around them.
        text: the whole changed source.
    """

    path: str
    line: int
    was: str
    now: str
    text: str


def places(path: str, source: str) -> list[Place]:
    """Every piece that can be changed, but for what `_left_out` names."""
    tree = get_ast(source)
    nodes = [node for node in ast_nodes(tree) if not _dull(node)]
    out = list(_left_out(tree))
    ways: dict[tuple[Point, Point], list[tuple[str, int]]] = defaultdict(list)
    for name in _operators():
        operator, occurrence = get_operator(name)(), 0
        for node in nodes:
            for begin, end in operator.mutation_positions(node):
                if not any(first <= begin < last for first, last in out):
                    ways[begin, end].append((name, occurrence))
                occurrence += 1
    return [Place(path, *span, tuple(found)) for span, found in sorted(ways.items())]


def drawn(sources: dict[str, str], count: int, seed: int) -> tuple[list[Change], int]:
    """Changes at so many places, all places alike, and how many places there are.

    Args:
        sources: their text, by path.
        count: of places; there may be fewer.
        seed: of the draw.  Of two counts the smaller one's changes are the larger one's first.
    """
    found = [place for path, text in sources.items() for place in places(path, text)]
    rng = random.Random(seed)
    shuffled = rng.sample(found, len(found))
    changes: list[Change] = []
    for place in shuffled:
        if len(changes) == count:
            break
        change = _change(place, sources[place.path], rng)
        if change is not None:
            changes.append(change)
    return changes, len(found)


def _change(place: Place, source: str, rng: random.Random) -> Change | None:
    """One of the ways, all alike; None where all of them are no Python, or no change."""
    for name, occurrence in rng.sample(place.ways, len(place.ways)):
        text = mutate_code(source, get_operator(name)(), occurrence)
        if text is not None and _is_other_python(source, text):
            line, was, now = _lines(source, text)
            return Change(place.path, line, was, now, text)
    return None


def _is_other_python(source: str, text: str) -> bool:
    """Whether a text compiles without a warning, to something else than the source."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            compile(text, "mutant", "exec")
        except (SyntaxError, ValueError, SyntaxWarning):
            return False
        return ast.dump(ast.parse(text)) != ast.dump(ast.parse(source))


def _lines(source: str, text: str) -> tuple[int, str, str]:
    """Number of the first line that differs, and the lines that do."""
    old, new = source.splitlines(), text.splitlines()
    told = list(unified_diff(old, new, n=0, lineterm=""))[3:]  # after two names and a place
    was, now = (" ".join(line[1:].strip() for line in told if line[0] == by) for by in "-+")
    first = next(i for i, pair in enumerate(zip(old, new, strict=False)) if pair[0] != pair[1])
    return first + 1, was.strip(), now.strip()


def _operators() -> Sequence[str]:
    """Names of cosmic-ray's operators, but for the two that are told which variable to change."""
    return [name for name in operator_names() if "/Variable" not in name]


def _dull(node: Any) -> bool:
    """Whether a node is of a kind that no operator changes: many are."""
    kind = node.type
    return kind in ("name", "string", "newline", "endmarker") or (
        kind == "operator" and node.value in "()[]{},.:="
    )


def _left_out(node: Any) -> Iterator[tuple[Point, Point]]:
    """Pieces that are not changed: types, errors that are raised, assertions, decorators for speed.

    Strings, docstrings among them, are changed by no operator.
    """
    kind = node.type
    if kind in ("raise_stmt", "assert_stmt") or _is_checking(node) or _is_strict(node):
        yield node.start_pos, node.end_pos
        return
    if kind == "decorator" and _decorates_with(node) in SPEED + TYPING:
        yield node.start_pos, node.end_pos
        return
    if kind == "annassign":
        last = node if "TypeAlias" in node.children[1].get_code() else node.children[1]
        yield node.start_pos, last.end_pos
    elif kind == "tfpdef":
        yield node.children[1].start_pos, node.end_pos
    elif kind == "funcdef" and node.annotation is not None:
        yield node.annotation.start_pos, node.annotation.end_pos
    for child in getattr(node, "children", ()):
        yield from _left_out(child)


def _is_checking(node: Any) -> bool:
    return bool(node.type == "if_stmt" and node.children[1].get_code().strip() == "TYPE_CHECKING")


def _decorates_with(node: Any) -> str:
    """The name of a decorator, without a module's before it and arguments behind it."""
    name = node.children[1].get_code().partition("(")[0]
    return str(name.strip().rpartition(".")[2])


def _is_strict(node: Any) -> bool:
    """`strict=` of `zip`: it checks what cannot be."""
    return bool(node.type == "argument" and node.get_first_leaf().value == "strict")
