"""A core and its changed self at once, where what controls them is known and the numbers are not.

Each node of the circuit has a set of pairs of bits that it may have, its own and the changed one's:
{00, 11} is a bit that nobody knows but that is the same in both, {00} one that is 0 in both.  From
power-up on every clock is worked out on such sets.  Registers that control the core are split into
single pairs, each of which is a case of its own; cases in which they are the same are made one, in
which the other registers have the pairs of any.  This ends when no case has anything new, and then
what holds in all cases holds for ever: an induction whose invariant says which registers are equal
at which place of the program.

That no numbers are followed costs proofs, not truth: a set may be larger than what can happen, and
is never smaller.  So registers that control nothing may begin as anything that is the same in both,
in place of 0: that is worked out much sooner, and mostly enough.
"""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from sculler_model import machine_code
from studies.mutate.miter import Circuit, port_of

Sets = NDArray[np.uint8]
"""Bit 2 a + b is whether the pair ab, a of the core and b of the changed one, is in the set."""

ZERO, APART, APART_TOO, ONE = SINGLE = (1, 2, 4, 8)
APART_EITHER = APART | APART_TOO
_NOT = np.array([int(f"{mask:04b}"[::-1], 2) for mask in range(16)], np.uint8)
SAME, ANY = np.uint8(ZERO | ONE), np.uint8(ZERO | APART_EITHER | ONE)

_MEMORY = ".words_"
"""In the names of registers that are bits of a memory."""

_PARTS = 1 << 10
"""Into so many a case may part."""


Packed = NDArray[np.uint64]
"""Sets of eight cases in each word, a byte each."""

_TOGETHER = 256
"""Cases that are worked out at once."""

_1, _2, _3 = (np.uint64(n) for n in (1, 2, 3))
_ZERO, _APART, _APART_TOO, _ONE = (np.uint64(0x0101010101010101 * pair) for pair in SINGLE)


class TooManyError(Exception):
    """More cases than are worked out; the message names registers."""


def _turned(a: np.uint64) -> np.uint64:
    """Of the inverse: 00 and 11 change places, and so do 01 and 10."""
    return a >> _3 & _ZERO | a << _3 & _ONE | a >> _1 & _APART | a << _1 & _APART_TOO


def _both(a: np.uint64, b: np.uint64) -> np.uint64:
    """Of an AND; no set is empty."""
    one = a & b & _ONE
    apart = (a & (b | b >> _2) | b & (a | a >> _2)) & _APART
    apart_too = (a & (b | b >> _1) | b & (a | a >> _1)) & _APART_TOO
    zero = (a | b | a >> _1 & b >> _2 | a >> _2 & b >> _1) & _ZERO
    return one | apart | apart_too | zero


def _and_all(
    nodes: Packed, first: int, ands: NDArray[np.int32], given: NDArray[np.int8], asked: Packed
) -> None:
    """Work out all ANDs.

    Args:
        nodes: (nodes, cases / 8), the sets; of ANDs they are filled in.
        first: node of the first AND.
        ands: (ANDs, 2) literals.
        given: (ANDs,) which row of `asked` a case is confined to there, or -1.
        asked: (rows, cases / 8) sets.
    """
    for k in range(len(ands)):
        left, right, found = nodes[ands[k, 0] >> 1], nodes[ands[k, 1] >> 1], nodes[first + k]
        turn_left, turn_right = ands[k, 0] & 1, ands[k, 1] & 1
        for c in range(len(found)):
            a = _turned(left[c]) if turn_left else left[c]
            b = _turned(right[c]) if turn_right else right[c]
            found[c] = _both(a, b)
        if given[k] >= 0:
            found &= asked[given[k]]


@cache
def _machine_code() -> Callable[[Packed, int, NDArray[np.int32], NDArray[np.int8], Packed], None]:
    """`_and_all` in machine code."""
    machine_code.callable_when_compiled(sys.modules[__name__])
    made: Callable[..., None] = machine_code.compiled(_and_all)
    return made


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
        zero: whether all registers begin as 0, as they do, or those that control nothing as
            anything.  With 0, a bit of a memory that is anything in one case is so in all: that
            comes to an end sooner.
    """

    circuit: Circuit
    number: int
    control: re.Pattern[str]
    split: Sequence[str]
    most: int
    seconds: float
    zero: bool = False

    def __post_init__(self) -> None:
        circuit, names = self.circuit, self.circuit.names
        self._first = 1 + circuit.inputs
        latches = range(len(circuit.latches))
        self._control = [i for i in latches if self.control.search(names.get(f"l{i}", ""))]
        self._memory = np.array([_MEMORY in names.get(f"l{i}", "") for i in latches])
        self._anything = np.zeros(len(circuit.latches), np.uint8)  # bits of memories that are
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
        self._ands = np.array(circuit.ands, np.int32).reshape(-1, 2)
        self._known: dict[bytes, int] = {}
        self._cases = np.zeros((_TOGETHER, len(circuit.latches)), np.uint8)
        self._dirty: set[int] = set()

    def same(self) -> bool:
        """Whether no case shows a difference at the ports; False does not say that there is one.

        Raises:
            TooManyError: there are too many cases, or not enough time.
        """
        begin = np.full((1, len(self.circuit.latches)), ZERO if self.zero else SAME, np.uint8)
        begin[:, self._control] = ZERO
        self._add(begin)
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
        count, first = len(cases), self._first + len(self.circuit.latches)
        words = -(-count // 8)
        nodes = np.zeros((first + len(self._ands), 8 * words), np.uint8)
        nodes[0] = ZERO
        nodes[1 : self._first] = self._inputs[:, None]
        nodes[self._first : first, :count] = cases.T
        rows = np.full(len(self._ands), -1, np.int8)
        asked = np.zeros((len(given), 8 * words), np.uint8)
        for row, (node, sets) in enumerate(given.items()):
            asked[row, :count] = sets
            if node < first:
                nodes[node] &= asked[row]
            else:
                rows[node - first] = row
        packed = nodes.view(np.uint64), asked.view(np.uint64)
        _machine_code()(packed[0], first, self._ands, rows, packed[1])
        return nodes[:, :count]

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
            case = case | self._anything
            if (more := case & ~mine).any():
                if mine.any():  # what grows, grows as far as it may, to come to an end soon
                    apart = (mine | case) & APART_EITHER != 0
                    case = case | (more != 0) * np.where(apart, ANY, SAME)
                    self._anything[(more & SAME != 0) & self._memory] = SAME
                mine |= case
                self._dirty.add(at)
