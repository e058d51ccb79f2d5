"""A core with a change that an input asks for, beside itself without: one output tells them apart.

What the change cannot reach, by any number of clocks, is there once: that leaves little to prove.
More can be there once: if nothing but what the change reaches in few clocks ever differs, no output
does.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Circuit:
    """A circuit of an AIGER file: literals are 2 * node, and 1 more if inverted; node 0 is 0.

    Attributes:
        inputs: how many; their nodes are 1, 2, ...
        latches: what each is next; their nodes follow.  All begin as 0.
        ands: what each AND has; their nodes follow.
        outputs: literals.
        names: of inputs and outputs, as "i0" and "o0", where they have any.
    """

    inputs: int
    latches: list[int]
    ands: list[tuple[int, int]]
    outputs: list[int]
    names: dict[str, str]

    def reached(self, nodes: set[int], clocks: int | None = None) -> set[int]:
        """These nodes and all that depend on them, through so many latches; None: any number."""
        found, before = set(nodes), 0
        first = 1 + self.inputs
        passed = -1
        while len(found) > before and passed != clocks:
            before = len(found)
            passed += 1
            found |= {first + i for i, lit in enumerate(self.latches) if lit >> 1 in found}
            for node, (a, b) in enumerate(self.ands, first + len(self.latches)):
                if a >> 1 in found or b >> 1 in found:
                    found.add(node)
        return found


def read(path: Path) -> Circuit:
    """A circuit of a binary AIGER file without initial values or properties."""
    data = path.read_bytes()
    end = data.index(b"\n")
    _, inputs, latches, outputs, ands = map(int, data[:end].split()[1:6])
    lines = []
    for _ in range(latches + outputs):
        begun, end = end + 1, data.index(b"\n", end + 1)
        lines.append(int(data[begun:end]))
    place, gates = end + 1, []
    for i in range(ands):
        literals = [2 * (1 + inputs + latches + i)]
        for _ in range(2):
            step = shift = 0
            while True:
                byte = data[place]
                place += 1
                step |= (byte & 127) << shift
                shift += 7
                if byte < 128:
                    break
            literals.append(literals[-1] - step)
        gates.append((literals[1], literals[2]))
    symbols = data[place:].partition(b"c\n")[0].decode("ascii").splitlines()
    names = dict(line.split(" ", 1) for line in symbols if line[:1] in ("i", "o", "l"))
    return Circuit(inputs, lines[:latches], gates, lines[latches:], names)


class _Maker:
    """Makes a circuit, with an AND once."""

    def __init__(self, inputs: int, latches: int) -> None:
        self.ands: list[tuple[int, int]] = []
        self._first = 1 + inputs + latches
        self._made: dict[tuple[int, int], int] = {}

    def both(self, a: int, b: int) -> int:
        """The literal of an AND."""
        high, low = max(a, b), min(a, b)
        if low == 0 or high == low ^ 1:
            return 0
        if low == 1 or high == low:
            return high
        if (high, low) not in self._made:
            self._made[high, low] = 2 * (self._first + len(self.ands))
            self.ands.append((high, low))
        return self._made[high, low]

    def either(self, literals: Sequence[int]) -> int:
        """The literal of an OR."""
        found = 1
        for literal in literals:
            found = self.both(found, literal ^ 1)
        return found ^ 1

    def differ(self, a: int, b: int) -> int:
        """The literal of an exclusive OR."""
        return self.either([self.both(a, b ^ 1), self.both(a ^ 1, b)])


def write_miter(circuit: Circuit, choice: str, path: Path, clocks: int | None = None) -> None:
    """Write a circuit whose one output is high where the two differ at their ports.

    Ports whose names begin with result_ count while result_valid is high.  Registers that the
    change reaches in more clocks than given are there once, and the output is high where they
    would become different, too: it may be high then though the ports never differ.

    Args:
        circuit: the core.
        choice: name of the input that is 0 in the core as it is, and anything beside it.
        path: of the AIGER file.
        clocks: as above; None for any number.
    """
    asked = {1 + int(key[1:]) for key, name in circuit.names.items() if port_of(name) == choice}
    reached = circuit.reached(asked, clocks)
    first = 1 + circuit.inputs
    doubled = [i for i in range(len(circuit.latches)) if first + i in reached]
    maker = _Maker(circuit.inputs, len(circuit.latches) + len(doubled))
    same = {0: 0} | {node: 2 * node for node in range(1, first + len(circuit.latches))}
    other = same | {
        first + i: 2 * (first + len(circuit.latches) + k) for k, i in enumerate(doubled)
    }
    same |= dict.fromkeys(asked, 0)
    for node, (a, b) in enumerate(circuit.ands, first + len(circuit.latches)):
        same[node] = maker.both(same[a >> 1] ^ a & 1, same[b >> 1] ^ b & 1)
        other[node] = (
            maker.both(other[a >> 1] ^ a & 1, other[b >> 1] ^ b & 1)
            if node in reached
            else same[node]
        )
    latches = [same[lit >> 1] ^ lit & 1 for lit in circuit.latches]
    latches += [other[lit >> 1] ^ lit & 1 for lit in (circuit.latches[i] for i in doubled)]
    once = [lit for i, lit in enumerate(circuit.latches) if first + i not in reached]
    parted = [maker.differ(same[lit >> 1], other[lit >> 1]) for lit in once]
    told = maker.either([*_differences(circuit, same, other, maker), *parted])
    _write(Circuit(circuit.inputs, latches, maker.ands, [told], {}), path)


def _differences(
    circuit: Circuit, same: dict[int, int], other: dict[int, int], maker: _Maker
) -> Iterator[int]:
    names = [port_of(circuit.names[f"o{i}"]) for i in range(len(circuit.outputs))]
    valid = circuit.outputs[names.index("result_valid")]
    shown = same[valid >> 1] ^ valid & 1
    for name, lit in zip(names, circuit.outputs, strict=True):
        differ = maker.differ(same[lit >> 1] ^ lit & 1, other[lit >> 1] ^ lit & 1)
        looked = name.startswith("result_") and name != "result_valid"
        yield maker.both(shown, differ) if looked else differ


def port_of(name: str) -> str:
    """The port of a bit."""
    return name.partition("[")[0]


def _write(circuit: Circuit, path: Path) -> None:
    count = circuit.inputs + len(circuit.latches) + len(circuit.ands)
    sizes = count, circuit.inputs, len(circuit.latches), len(circuit.outputs), len(circuit.ands)
    lines = ["aig " + " ".join(map(str, sizes)), *map(str, circuit.latches + circuit.outputs)]
    data = bytearray("\n".join(lines).encode() + b"\n")
    for node, (high, low) in enumerate(circuit.ands, 1 + circuit.inputs + len(circuit.latches)):
        for step in (2 * node - high, high - low):
            while step > 127:
                data.append(step & 127 | 128)
                step >>= 7
            data.append(step)
    path.write_bytes(bytes(data))
