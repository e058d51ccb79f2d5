"""One interface to both simulators: samples in, results out, streaming; or every port's trace.

The rules of a run, whatever the engine:

* The stimulus says in which clocks a sample is offered; once offered it stays offered, unchanged,
  until it is taken or, where the stimulus says so, given up: then nothing is offered in the next
  clock, and the sample after it is the next.  It is taken in a clock with `sample_valid`,
  `sample_ready` and not `rst`; a result is taken in a clock with `result_valid`, `result_ready` and
  not `rst`.  (`rst` is meant where a core has `rst_n`: it is high where that is low.)
* While nothing is offered the sample ports show the next sample's complement, with `fault` set:
  a core that looked at them then would give itself away.
* A result that comes as a stream of words is taken with its last word.
* Where the core has `clk_en`, stalls hold it low at random too.  In such a clock nothing is taken;
  a sample that is offered in it need not stay.
* Where the core has channels, the tags of what is not offered are complements, too; results come in
  the order of the samples that complete them.
* `RESET` in place of a chunk raises `rst` for one clock, once the results of all complete major
  intervals before it have been taken; the next sample is then the first.
* After the last sample the run goes on until the results of all complete major intervals have
  been taken; where the core drops results, until that of the last one has.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sculler_hdl import timing
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock
from sculler_model.golden import (
    ChannelCycleModel,
    ChannelTiming,
    CycleModel,
    PipelinedChannelModel,
    PipelinedChannelTiming,
    Ports,
)
from sculler_sim.engines import amaranth as amaranth_engine
from sculler_sim.engines import verilator as verilator_engine
from sculler_sim.run import CheckedChunk, Chunk, PortTrace, Progress, check_chunks
from sculler_sim.stimulus import Stimulus
from sculler_sim.surroundings import Surroundings

EngineName = Literal["verilator", "amaranth", "model"]
"""`model` is the cycle-accurate model under the same stimulus: the reference for the other two."""

_RESULTS = 1 << 10  # results put into one block by the engines that go clock by clock


class Run(Iterator[VectorBlock]):
    """A simulation under way: iterate over it for the results, in order.

    Attributes:
        progress: clocks, samples and results up to the last block given.
    """

    def __init__(self, design: Design, blocks: Callable[[Progress], Iterator[VectorBlock]]) -> None:
        self.progress = Progress()
        self._design = design
        self._blocks = blocks(self.progress)

    def __next__(self) -> VectorBlock:
        return next(self._blocks)

    @property
    def leftover(self) -> int:
        """Samples since the last reset in major intervals that are not complete."""
        return self.progress.since_reset - self.progress.due * self._design.samples_per_major


def simulate(
    design: Design,
    chunks: Iterable[Chunk | None],
    *,
    engine: EngineName = "verilator",
    stimulus: Stimulus | None = None,
    wave: Path | None = None,
) -> Run:
    """Run the core over all samples.

    Nothing happens before the first step of the iteration; memory is bounded by the chunks' size.

    Args:
        design: the design.
        chunks: the samples, in order; `RESET` (None) resets the core between two.
        engine: `verilator` (the emitted Verilog, compiled), `amaranth` (the Amaranth design in its
            own simulator), or `model`.
        stimulus: levels of the handshakes and the reset; without stalls if not given.
        wave: waveform to write: .vcd, or with Verilator also .fst; complete when the run is.

    Returns:
        The run, an iterator over the results; its `progress` and `leftover` say how far it came.

    Raises (in the iteration):
        InputError: a chunk of wrong shape, a count outside the sensor's width, a missing tool, a
            wave file that cannot be written, fewer multipliers than the core needs.
        SimulationError: the core hangs, or its stream of words is not as it should be.
    """
    stimulus = stimulus or Stimulus.always()
    checked = check_chunks(design, chunks)

    def blocks(progress: Progress) -> Iterator[VectorBlock]:
        if engine == "verilator":
            return verilator_engine.stream(design, checked, stimulus, progress, wave)
        return _stream(design, checked, stimulus, progress, engine, wave)

    return Run(design, blocks)


def trace(
    design: Design,
    counts: NDArray[Any],
    faults: NDArray[Any] | None,
    stimulus: Stimulus,
    clocks: int,
    engine: EngineName,
    channels: NDArray[Any] | None = None,
    restarts: NDArray[Any] | None = None,
) -> PortTrace:
    """Every output port on each of the first `clocks` clocks.

    Args:
        design: the design.
        counts, faults: samples as in a chunk; when they run out, no more are offered.
        stimulus: levels of the handshakes and the reset.
        clocks: how many clocks to run.
        engine: as for `simulate`.
        channels, restarts: as in a chunk, where the core has channels.

    Raises:
        InputError: as for `simulate`.
    """
    chunk = (counts, faults) if channels is None else (counts, channels, faults, restarts)
    checked = check_chunks(design, [chunk])
    if engine == "verilator":
        return verilator_engine.trace(design, checked, stimulus, clocks)
    surroundings = Surroundings(design, timing(design), checked, stimulus, Progress(), clocks)
    return PortTrace.from_ports(design, list(_clocks(design, surroundings, engine, None)))


def _stream(
    design: Design,
    chunks: Iterator[CheckedChunk | None],
    stimulus: Stimulus,
    progress: Progress,
    engine: EngineName,
    wave: Path | None,
) -> Iterator[VectorBlock]:
    """Results of a clock-by-clock engine, in blocks."""
    surroundings = Surroundings(design, timing(design), chunks, stimulus, progress)
    taken = surroundings.taken
    for _ in _clocks(design, surroundings, engine, wave):
        if len(taken) >= _RESULTS:
            yield _block(design, taken)
            taken.clear()
    if taken:
        yield _block(design, taken)


def _block(design: Design, taken: list[tuple[int, ...]]) -> VectorBlock:
    """Results as `Surroundings.taken` has them."""
    if design.channels == 1:
        return VectorBlock.from_rows(taken, design)
    channels = np.array([row[-1] for row in taken], np.int64)
    return replace(VectorBlock.from_rows((row[:-1] for row in taken), design), channels=channels)


def _clocks(
    design: Design, surroundings: Surroundings, engine: EngineName, wave: Path | None
) -> Iterator[Ports]:
    """Run to the end; the output ports of every clock."""
    if engine == "amaranth":
        return amaranth_engine.clocks(design, surroundings, wave)
    if wave is not None:
        raise InputError(f"{wave}: the model has no waveform, choose another engine")
    return _model_clocks(design, surroundings)


def _model_clocks(design: Design, surroundings: Surroundings) -> Iterator[Ports]:
    clocks = timing(design)
    model: Any  # each takes the samples of its designs
    if isinstance(clocks, ChannelTiming):
        model = ChannelCycleModel(design, clocks)
    elif isinstance(clocks, PipelinedChannelTiming):
        model = PipelinedChannelModel(design, clocks)
    else:
        model = CycleModel(design, clocks)
    while not surroundings.done:
        now = surroundings.inputs
        offered = now.sample if now.sample_valid else None
        ports = model.clock(offered, now.result_ready, now.rst, now.clk_en)
        surroundings.clocked(ports)
        yield ports
