"""The emitted Verilog in Verilator: fast.

Model and `harness.cpp` are one shared library called through ctypes: no pipes and no files, samples
and results stream through arrays, tens of thousands of clocks a call.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler_hdl import timing
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import Integers, VectorBlock, from_limbs
from sculler_model.golden import result_ports, words_per_result
from sculler_model.outputs import replacing
from sculler_sim.engines.verilator_build import build, limbs
from sculler_sim.run import RESET, CheckedChunk, PortTrace, Progress, wrong_last
from sculler_sim.stimulus import Levels, Stimulus

_CLOCKS = 1 << 15  # clocks in one call of the library
_ROOM = 1 << 14  # bytes


def stream(
    design: Design,
    chunks: Iterator[CheckedChunk | None],
    stimulus: Stimulus,
    progress: Progress,
    wave: Path | None,
) -> Iterator[VectorBlock]:
    """Results of all samples, block by block (see `sculler_sim.engine.simulate`)."""
    with ExitStack() as stack:
        library = build(design, wave)
        target = None if wave is None else stack.enter_context(replacing(wave))
        core = stack.enter_context(_Core(design, library, stimulus, progress, target))
        for chunk in chunks:
            if chunk is RESET:
                while not progress.drained:
                    yield from core.run(_NOTHING)
                core.reset()
                continue
            first, done = progress.samples + progress.lost, 0
            while done < len(chunk.counts):
                yield from core.run(chunk.rest(done))
                done = progress.samples + progress.lost - first
        while not progress.drained:
            yield from core.run(_NOTHING)


_NOTHING = CheckedChunk(np.zeros((0, 6), np.int32), np.zeros(0, np.uint8), np.zeros(0, np.int32))


def trace(
    design: Design, chunks: Iterator[CheckedChunk | None], stimulus: Stimulus, clocks: int
) -> PortTrace:
    """Every output port on each of the first clocks (see `sculler_sim.engine.trace`)."""
    samples = next(chunks, None) or _NOTHING
    with _Core(design, build(design), stimulus, Progress(), None) as core:
        return core.trace(samples, clocks)


class _Levels(ctypes.Structure):
    _fields_ = [(name, ctypes.c_void_p) for name in Levels._fields]

    @classmethod
    def at(cls, levels: Levels, clock: int) -> _Levels:
        return cls(*(level.ctypes.data + clock for level in levels))


class _Counters(ctypes.Structure):
    _fields_ = [(name, ctypes.c_int64) for name in Progress.__dataclass_fields__]


class _Core:
    """A core under simulation; a context manager, because the library holds its state."""

    def __init__(
        self,
        design: Design,
        library: Path,
        stimulus: Stimulus,
        progress: Progress,
        wave: Path | None,
    ) -> None:
        self._design = design
        self._wave = wave
        self._stimulus = stimulus
        self._progress = progress
        self._timing = timing(design)
        self._stream = design.hardware.handover == "stream"
        self._columns = len(design.columns)
        self._many = design.channels > 1
        self._row = 2 + (self._columns - 2) * limbs(design) + self._many
        # numbers that the result ports show in a clock
        self._shown = len(result_ports(design)) if self._stream else self._row
        self._capacity = _CLOCKS // design.samples_per_major + 2
        self._rows = np.empty((self._capacity, self._row), np.uint64)
        self._levels = stimulus.levels(0, _CLOCKS)
        self._levels_from = 0
        try:
            self._library = ctypes.CDLL(str(library))
            self._library.sculler_create.restype = ctypes.c_void_p
            self._library.sculler_run.restype = ctypes.c_int64
        except (OSError, AttributeError) as error:  # damaged, or not what the build should make
            raise InputError(f"cannot load the simulator ({error}), delete {library}") from error
        self._handle = ctypes.c_void_p(
            self._library.sculler_create(b"" if wave is None else os.fsencode(wave))
        )
        if not self._handle:
            raise InputError(f"{wave}: cannot write the waveform, give another file")

    def __enter__(self) -> _Core:
        return self

    def __exit__(self, *error: object) -> None:
        failed = self._library.sculler_destroy(self._handle)
        if self._wave is not None and error[0] is None:
            if failed:
                raise OSError(failed, os.strerror(failed))
            _require_room(self._wave)

    def run(self, samples: CheckedChunk) -> Iterator[VectorBlock]:
        """Some clocks with these samples, or none to drain; the results taken in them."""
        progress = self._progress
        if progress.clocks >= self._levels_from + _CLOCKS:
            self._levels_from = progress.clocks
            self._levels = self._stimulus.levels(progress.clocks, _CLOCKS)
        clock = progress.clocks - self._levels_from
        before = progress.results
        self._call(samples, _Levels.at(self._levels, clock), _CLOCKS - clock, None, None)
        progress.check_alive(self._stimulus, self._timing)
        if progress.results > before:
            yield self._block(self._rows[: progress.results - before])

    def reset(self) -> None:
        """One clock of reset; no sample is offered and no result taken in it."""
        low, high = np.zeros(1, np.uint8), np.ones(1, np.uint8)
        levels = _Levels.at(Levels(low, low, high, low, high), 0)
        handshakes, shown = np.empty((1, 2), np.uint8), np.empty((1, self._shown), np.uint64)
        counters = np.empty((1, 2), np.uint16)
        self._call(_NOTHING, levels, 1, handshakes, shown, counters)

    def trace(self, samples: CheckedChunk, clocks: int) -> PortTrace:
        """All ports on exactly so many clocks."""
        levels = self._stimulus.levels(0, clocks)
        handshakes = np.empty((clocks, 2), np.uint8)
        counters = np.empty((clocks, 2), np.uint16)
        ports = result_ports(self._design)
        shown = np.empty((clocks, self._shown), np.uint64)
        self._call(samples, _Levels.at(levels, 0), clocks, handshakes, shown, counters)
        result = np.empty((clocks, len(ports)), object)
        head = len(ports) if self._stream else 2
        result[:, :head] = shown[:, :head]
        if not self._stream:
            result[:, 2:] = self._components(shown)
        return PortTrace(handshakes[:, 0], handshakes[:, 1], result, counters, ports)

    def _call(
        self,
        samples: CheckedChunk,
        levels: _Levels,
        clocks: int,
        handshakes: NDArray[np.uint8] | None,
        shown: NDArray[np.uint64] | None,
        shown_counters: NDArray[np.uint16] | None = None,
    ) -> None:
        names = Progress.__dataclass_fields__
        counters = _Counters(*(getattr(self._progress, name) for name in names))
        words = self._library.sculler_run(
            self._handle,
            _address(samples.counts),
            _address(samples.faults),
            _address(samples.tags if len(samples.tags) else None),
            ctypes.c_int64(len(samples.counts)),
            ctypes.c_int64(self._design.samples_per_major),
            ctypes.byref(levels),
            ctypes.c_int64(clocks),
            _address(self._rows),
            ctypes.c_int64(self._capacity),
            _address(handshakes),
            _address(shown),
            _address(shown_counters),
            ctypes.byref(counters),
        )
        if words:
            raise wrong_last(words, words_per_result(self._design))
        for name in names:
            setattr(self._progress, name, getattr(counters, name))

    def _block(self, rows: NDArray[np.uint64]) -> VectorBlock:
        major, status = rows[:, :2].astype(np.int64).T
        channels = rows[:, -1].astype(np.int64) if self._many else None
        components = self._components(rows[:, : self._row - self._many])
        return VectorBlock(major, status, components, channels=channels)

    def _components(self, rows: NDArray[np.uint64]) -> Integers:
        """(R, components) integers from two's-complement limbs, lowest first."""
        limbs = rows[:, 2:].astype(np.int64)
        return from_limbs(limbs.reshape(len(rows), self._columns - 2, -1))


def _require_room(wave: Path) -> None:
    """See that there is room after a waveform: the writer of FST passes over a full disk.

    Raises:
        OSError: there is none.
    """
    size = wave.stat().st_size
    with wave.open("r+b") as file:
        try:
            file.seek(size)
            file.write(bytes(_ROOM))
            file.flush()
        finally:
            os.truncate(wave, size)


def _address(array: NDArray[Any] | None) -> ctypes.c_void_p:
    return ctypes.c_void_p(None if array is None else array.ctypes.data)
