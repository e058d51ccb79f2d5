"""A core and its changed self at once, where what controls them is known and the numbers are not.

Each node of the circuit has a set of pairs of bits that it may have, its own and the changed one's:
{00, 11} is a bit that nobody knows but that is the same in both, {00} one that is 0 in both.  From
power-up on every clock is worked out on such sets.  Registers that control the core are split into
single pairs, each of which is a case of its own; cases in which they are the same are made one, in
which the other registers have the pairs of any.  This ends when no case has anything new, and then
what holds in all cases holds for ever: an induction whose invariant says which registers are equal
at which place of the program.

That no numbers are followed costs proofs, not truth: a set may be larger than what can happen, and
is never smaller.
"""

from __future__ import annotations

import re
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studies.mutate.miter import Circuit, port_of

Sets = NDArray[np.uint8]
"""Bit 2 a + b is whether the pair ab, a of the core and b of the changed one, is in the set."""

ZERO, APART, APART_TOO, ONE = SINGLE = (1, 2, 4, 8)
APART_EITHER = APART | APART_TOO
SAME, ANY = np.uint8(ZERO | ONE), np.uint8(ZERO | APART_EITHER | ONE)

_TOGETHER = 256
"""Cases that are worked out at once."""

_PARTS = 1 << 10
"""Into so many a case may part."""


class TooManyError(Exception):
    """More cases than are worked out; the message names registers."""


def _table() -> Sets:
    """(4 * 256) sets of an AND, by which of its two is inverted and their sets."""
    pairs = range(4)
    found = np.zeros((2, 2, 16, 16), np.uint8)
    for left, right, a, b in product((0, 3), (0, 3), pairs, pairs):
        both = 1 << ((a ^ left) & (b ^ right))
        with_a, with_b = (np.arange(16) >> pair & 1 for pair in (a, b))
        found[left & 1, right & 1] |= (with_a[:, None] * with_b * both).astype(np.uint8)
    return found.reshape(-1)


_AND = _table()
_NOT = np.array([int(f"{mask:04b}"[::-1], 2) for mask in range(16)], np.uint8)


class _Level(NamedTuple):
    """ANDs that depend on none of each other.

    left, right: nodes that they have; inverted: where in `_AND` they begin; given: of them those at
    which cases part.
    """

    nodes: NDArray[np.intp]
    left: NDArray[np.intp]
    right: NDArray[np.intp]
    inverted: NDArray[np.uint16]
    given: list[int]


@dataclass
class Pairs:
    """All cases of a circuit.

    Attributes:
        circuit: the core; its input `choice` asks for a change.
        number: of the change.
        control: matches the names of registers that control it.
        split: ports at which a case parts, one after the other, where those depend on them.
        most: cases after which to give up.
        seconds: after which to, too.
    """

    circuit: Circuit
    number: int
    control: re.Pattern[str]
    split: Sequence[str]
    most: int
    seconds: float

    def __post_init__(self) -> None:
        circuit, names = self.circuit, self.circuit.names
        self._first = 1 + circuit.inputs
        latches = range(len(circuit.latches))
        self._control = [i for i in latches if self.control.search(names.get(f"l{i}", ""))]
        self._inputs = np.full(circuit.inputs, SAME, np.uint8)
        ports = {}
        for i in range(circuit.inputs):
            port, _, bit = names.get(f"i{i}", "").partition("[")
            ports[port] = 1 + i
            if port == "choice":
                self._inputs[i] = APART if self.number >> int(bit[:-1]) & 1 else ZERO
        outputs = [names[f"o{i}"] for i in range(len(circuit.outputs))]
        ports |= {
            port_of(name): lit >> 1 for name, lit in zip(outputs, circuit.outputs, strict=True)
        }
        self._reset, *self._split = (ports[name] for name in ("rst", *self.split))
        self._valid = outputs.index("result_valid")
        self._waits = np.array(
            [each.startswith("result_") and each != "result_valid" for each in outputs]
        )
        self._known: dict[bytes, int] = {}
        self._cases = np.zeros((_TOGETHER, len(circuit.latches)), np.uint8)
        self._dirty: set[int] = set()

    @cached_property
    def _levels(self) -> list[_Level]:
        ands, first = self.circuit.ands, self._first + len(self.circuit.latches)
        depth = [0] * (first + len(ands))
        by_depth: dict[int, list[int]] = {}
        for node, (a, b) in enumerate(ands, first):
            depth[node] = 1 + max(depth[a >> 1], depth[b >> 1])
            by_depth.setdefault(depth[node], []).append(node)
        found = []
        for _, nodes in sorted(by_depth.items()):
            a, b = np.array([ands[node - first] for node in nodes], np.intp).T
            inverted = ((a & 1) << 9 | (b & 1) << 8).astype(np.uint16)[:, None]
            given = [node for node in self._split if node in nodes]
            found.append(_Level(np.array(nodes, np.intp), a >> 1, b >> 1, inverted, given))
        return found

    def same(self) -> bool:
        """Whether no case shows a difference at the ports; False does not say that there is one.

        Raises:
            TooManyError: there are too many cases, or not enough time.
        """
        self._add(np.full((1, len(self.circuit.latches)), ZERO, np.uint8))
        begun = time.monotonic()
        while self._dirty:
            if time.monotonic() - begun > self.seconds:
                raise TooManyError("not in this time")
            rows = sorted(self._dirty)[:_TOGETHER]
            self._dirty.difference_update(rows)
            cases = np.repeat(self._cases[rows], 2, axis=0)
            reset = np.tile(np.array([ZERO, ONE], np.uint8), len(rows))
            if not self._follow(cases, {self._reset: reset}, self._split):
                return False
        return True

    def _follow(self, cases: Sets, given: dict[int, Sets], split: Sequence[int]) -> bool:
        """Add the cases a clock later; False if these show a difference.

        Args:
            cases: (cases, registers) of them.
            given: (cases,) of some nodes.
            split: nodes at which they may part.
        """
        nodes = self._nodes(cases, given)
        later = self._of(nodes, self.circuit.latches)
        told = self._told(nodes)
        known = np.isin(later[:, self._control], SINGLE).all(axis=1)
        self._add(later[known & ~told])
        left = np.flatnonzero(~known | told)
        if not len(left):
            return True
        if not split:
            for case in later[left] if not told.any() else ():
                self._add(self._parted(case))
            return not told.any()
        masks = nodes[split[0], left]
        chosen = [(left[masks & pair != 0], pair) for pair in SINGLE]
        rows = np.concatenate([mine for mine, _ in chosen])
        pairs = np.repeat(np.array(SINGLE, np.uint8), [len(mine) for mine, _ in chosen])
        given = {node: sets[rows] for node, sets in given.items()} | {split[0]: pairs}
        return self._follow(cases[rows], given, split[1:])

    def _parted(self, case: Sets) -> Sets:
        """A case, once for each pair of each controlling register."""
        several = [i for i in self._control if case[i] not in SINGLE]
        options = [[pair for pair in SINGLE if case[i] & pair] for i in several]
        if np.prod([len(each) for each in options]) > _PARTS:
            raise TooManyError(" ".join(self.circuit.names[f"l{i}"] for i in several))
        chosen = list(product(*options))
        cases = np.repeat(case[None], len(chosen), axis=0)
        cases[:, several] = chosen
        return cases

    def _nodes(self, cases: Sets, given: dict[int, Sets]) -> Sets:
        """(nodes, cases) of all nodes."""
        first = self._first + len(self.circuit.latches)
        nodes = np.empty((first + len(self.circuit.ands), len(cases)), np.uint8)
        nodes[0] = ZERO
        nodes[1 : self._first] = self._inputs[:, None]
        nodes[self._first : first] = cases.T
        for node, sets in given.items():
            if node < first:
                nodes[node] &= sets
        for level in self._levels:
            at = level.inverted | nodes[level.left] << np.uint16(4) | nodes[level.right]
            nodes[level.nodes] = _AND[at]
            for node in level.given:
                if node in given:
                    nodes[node] &= given[node]
        return nodes

    def _of(self, nodes: Sets, literals: Sequence[int]) -> Sets:
        """(cases, literals) of literals."""
        at = np.array(literals, np.intp)
        found = nodes[at >> 1]
        inverted = np.flatnonzero(at & 1)
        found[inverted] = _NOT[found[inverted]]
        literal_sets: Sets = found.T
        return literal_sets

    def _told(self, nodes: Sets) -> NDArray[np.bool_]:
        """(cases,) whether a port may tell."""
        sets = self._of(nodes, self.circuit.outputs)
        shown = sets[:, self._valid] != ZERO
        differ = sets & APART_EITHER != 0
        told: NDArray[np.bool_] = (differ & (shown[:, None] | ~self._waits)).any(axis=1)
        return told

    def _add(self, cases: Sets) -> None:
        """Cases that come up, each made one with that in which the same controls them."""
        for key, case in zip(cases[:, self._control], cases, strict=True):
            at = self._known.setdefault(key.tobytes(), len(self._known))
            if at == len(self._cases):
                self._cases = np.concatenate([self._cases, np.zeros_like(self._cases)])
            if len(self._known) > self.most:
                raise TooManyError("")
            mine = self._cases[at]
            if (more := case & ~mine).any():
                if mine.any():  # what grows, grows as far as it may, to come to an end soon
                    apart = (mine | case) & APART_EITHER != 0
                    case = case | (more != 0) * np.where(apart, ANY, SAME)
                mine |= case
                self._dirty.add(at)
