"""What came of the flips of each core, kept: only a core that has changed is run again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from pydantic import TypeAdapter

from sculler_model.design import Design
from sculler_model.outputs import replacing
from sculler_sim.engines.verilator_build import emitted

FILE = Path("studies/upsets/counts.json")


@dataclass(frozen=True)
class Flips:
    """Which bits of a core are turned over.

    Attributes:
        of_each: flips of each flip-flop, and of each word of a memory at random bits.
        every_bit: one flip of each bit of each word instead.
        seed: of the random clocks and bits.
    """

    of_each: int
    every_bit: bool
    seed: int


@dataclass(frozen=True)
class Count:
    """What came of the flips of one core.

    Attributes:
        flip_flops, memory_bits: of the core, those of words that it uses.
        flips: how many.
        kinds: how many of each `Outcome.kind`.
        lasting: after which the second interval's result, or a later one, is wrong or missing.
    """

    flip_flops: int
    memory_bits: int
    flips: int
    kinds: Mapping[str, int]
    lasting: int


_COUNTS = TypeAdapter(dict[str, Count])


class Kept:
    """Counts of the same flips of the same Verilog.

    Args:
        path: of the file; written anew after each core.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._counts = _COUNTS.validate_json(path.read_bytes()) if path.is_file() else {}

    def find(self, design: Design, flips: Flips) -> Count | None:
        """What is known; None if nothing is."""
        return self._counts.get(_key(design, flips))

    def add(self, design: Design, flips: Flips, count: Count) -> None:
        """Put down what came out; the count of the same flips of an older Verilog goes."""
        label = _label(design, flips)
        rest = {key: one for key, one in self._counts.items() if key.rpartition(" ")[0] != label}
        self._counts = dict(sorted({**rest, _key(design, flips): count}.items()))
        with replacing(self.path) as temporary:
            temporary.write_bytes(_COUNTS.dump_json(self._counts, indent=1) + b"\n")


def _label(design: Design, flips: Flips) -> str:
    """The design, and which bits are turned over."""
    bits = f"{flips.of_each} of each{', every bit' if flips.every_bit else ''}"
    return f"{design.name}, {design.hardware.hardening or 'off'}, {bits}, seed {flips.seed}"


def _key(design: Design, flips: Flips) -> str:
    """By which a count is found: its label, and a hash of the Verilog."""
    verilog = "\0".join(emitted(design).values())
    return f"{_label(design, flips)} {sha256(verilog.encode()).hexdigest()[:16]}"
