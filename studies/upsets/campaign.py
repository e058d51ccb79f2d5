"""Turns bits of a running core over, one a run, and tells what came of each."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler_hdl import result_ports, timing
from sculler_hdl.plan.compact.plan import plan_compact
from sculler_model.design import Design
from sculler_model.golden import GoldenModel, clocks_per_major, to_words
from sculler_sim.engines.verilator_build import emitted
from studies.upsets.build import library
from studies.upsets.state import State, states

RESULTS = 6
"""Results of a run; the flip comes in the second or third interval."""

_SAMPLES = 1024


class Flip(NamedTuple):
    """A bit that is turned over: number of its state, word there, bit, and after which clock."""

    state: int
    word: int
    bit: int
    clock: int


class Outcome(ctypes.Structure):
    """What came of a flip.

    Attributes:
        interval: in which it was: how many had ended before.
        results: handed over.
        wrong: of them; `own`: told by their own status; `late`: told by the port `upset` or by the
            next result's status only; `silent`: not told.
        last_wrong, last_flagged: number of the last such result, or -1.
        told: whether the port `upset` was ever high; told_at_end: whether it is in the last clock.
    """

    _fields_ = [
        (name, ctypes.c_int64)
        for name in (
            "interval results wrong own late silent last_wrong last_flagged told told_at_end"
        ).split()
    ]

    @property
    def hangs(self) -> bool:
        """Whether results are missing at the end."""
        return int(self.results) < RESULTS

    @property
    def kind(self) -> str:
        """What it did, the worst of it.

        `hang`: results are missing, and nothing tells so; `stops`: they are, and the port `upset`
        tells so; `silent`, `late`, `flagged`: see the attributes; `seen`: told, and nothing is
        wrong; `masked`: nothing at all.
        """
        if self.hangs:
            return "stops" if self.told_at_end else "hang"
        for kind in ("silent", "late"):
            if getattr(self, kind):
                return kind
        if self.wrong:
            return "flagged"
        return "seen" if self.told or self.last_flagged >= 0 else "masked"

    @property
    def right_within_two(self) -> bool:
        """Whether the results of the second interval after the flip's and all later are right."""
        return not self.hangs and int(self.last_wrong) < int(self.interval) + 2


@dataclass(frozen=True)
class Core:
    """A compiled core with its undisturbed run, as `prepare` makes it.

    Attributes:
        design: the design.
        states: all its state that can be turned over.
        ends: the clocks that took the last sample of each interval.
    """

    design: Design
    states: tuple[State, ...]
    ends: tuple[int, ...]
    _library: ctypes.CDLL
    _campaign: ctypes.c_void_p
    _counts: NDArray[np.int32]  # kept alive

    def flip(self, flip: Flip) -> Outcome:
        """Run from a reset with one flip."""
        outcome = Outcome()
        self._library.upsets_flip(
            self._campaign, flip.state, flip.word, flip.bit, flip.clock, ctypes.byref(outcome)
        )
        return outcome

    def result(self, number: int) -> list[int]:
        """The 64-bit words of a result of the undisturbed run."""
        words = (ctypes.c_uint64 * 4096)()
        count = self._library.upsets_words(self._campaign, number, words)
        return list(words[:count])


def random_counts(design: Design, rng: np.random.Generator) -> NDArray[np.int32]:
    """Samples of a whole number of major intervals, over the counts' whole range."""
    per = design.samples_per_major
    words = design.words
    lows = [words.gyro.lo] * 3 + [words.accel.lo] * 3
    highs = [words.gyro.hi] * 3 + [words.accel.hi] * 3
    shape = (-(-_SAMPLES // per) * per, 6)
    return rng.integers(lows, highs, shape, endpoint=True).astype(np.int32)


def prepare(design: Design, seed: int = 1) -> Core:
    """Compile a core and run it undisturbed; its results are held to the golden model.

    Raises:
        InputError: a tool is missing.
        ToolError: a tool fails.
        RuntimeError: state is not found in the compiled model, or the undisturbed run is wrong.
    """
    made = library(design)
    made.upsets_create.restype = ctypes.c_void_p
    made.upsets_reference.restype = ctypes.c_uint64
    made.upsets_words.restype = ctypes.c_int64
    counts = random_counts(design, np.random.default_rng(seed))
    handle = ctypes.c_void_p(
        made.upsets_create(
            counts.ctypes.data_as(ctypes.c_void_p),
            ctypes.c_int64(len(counts)),
            ctypes.c_int64(design.samples_per_major),
            ctypes.c_int64(RESULTS),
        )
    )
    found = states("\n".join(emitted(design).values()), design.name)
    missing = [
        state
        for state in found
        if not made.upsets_target(handle, f"TOP.{state.scope}".encode(), state.name.encode())
    ]
    if missing:
        raise RuntimeError(f"{design.name}: the model has no {missing}")
    clocks = timing(design)
    limit = clocks.startup + 3 * (RESULTS + 1) * clocks_per_major(design, clocks) + clocks.latency
    ends = (ctypes.c_uint64 * RESULTS)()
    if not made.upsets_reference(handle, ctypes.c_uint64(limit + 1000), ends):
        raise RuntimeError(f"{design.name}: the undisturbed run hangs, or tells of an upset")
    core = Core(design, tuple(found), tuple(ends), made, handle, counts)
    _hold_to_golden(core)
    return core


def _hold_to_golden(core: Core) -> None:
    design = core.design
    model = GoldenModel(design)
    samples = ((tuple(row[:3]), tuple(row[3:]), 0) for row in core._counts.tolist())
    for number, result in zip(range(RESULTS), model.run(samples), strict=False):
        row = result.row()
        if design.hardware.handover == "stream":
            expected = to_words(design, row)
        else:
            expected = []
            ports = result_ports(design)
            for port, value in zip(ports, row, strict=True):
                bits = port.bits
                size = 64 if bits <= 64 else 32  # as Verilator keeps them
                rest = value & (1 << bits) - 1
                expected += [rest >> low & (1 << size) - 1 for low in range(0, max(bits, 1), size)]
        if core.result(number)[:-1] != list(expected):
            raise RuntimeError(f"{design.name}: result {number} is not the golden model's")


_PARTS = {
    "program": "program_words",
    "left": "left_words",
    "right": "right_words",
    "samples": "sample_words",
    "results": "result_words",
}
"""The memories of a compact core, and what `plan.resources` calls the number of their words."""


def used_words(core: Core, state: State) -> int:
    """Words of a memory that the core uses; a block of a device may have more."""
    assert state.words is not None
    made = plan_compact(core.design).resources
    parts = [_PARTS[part] for part in _PARTS if re.search(rf"\.{part}\b|\.{part}_", state.scope)]
    return min(state.words, made[parts[-1]]) if parts else state.words


def plan(core: Core, per_bit: int, *, every_bit: bool = False, seed: int = 1) -> list[Flip]:
    """Flips of every bit of state at random clocks.

    Args:
        core: the core.
        per_bit: flips of each flip-flop, and of each used word of a memory at random bits.
        every_bit: one flip of each bit of each used word instead.
        seed: of the random clocks.
    """
    rng = np.random.default_rng(seed)
    places: list[tuple[int, int, int]] = []
    for number, state in enumerate(core.states):
        bits = range(state.bits)
        if state.words is None:
            places += [(number, 0, bit) for bit in bits] * per_bit
        elif every_bit:
            used = range(used_words(core, state))
            places += [(number, word, bit) for word in used for bit in bits]
        else:
            for word in list(range(used_words(core, state))) * per_bit:
                places.append((number, word, int(rng.integers(state.bits))))
    clocks = rng.integers(core.ends[0], core.ends[2], len(places)).tolist()
    return [Flip(*place, clock) for place, clock in zip(places, clocks, strict=True)]


def run(core: Core, flips: Sequence[Flip]) -> Iterator[tuple[Flip, Outcome]]:
    """Each flip with what came of it."""
    for flip in flips:
        yield flip, core.flip(flip)
