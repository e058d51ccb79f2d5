"""A log through the golden model or through the simulated hardware, to a vectors file."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sculler.checks.breaks import Break, BreakFinder, Policy
from sculler.formats.log import read_log
from sculler.formats.tables import counting
from sculler.formats.vectors import VectorsWriter
from sculler.runs.channel_source import ChannelSource, ReferenceChannels
from sculler.runs.engines import SimulationEngine
from sculler.words import Advance, plural
from sculler_hdl import timing
from sculler_model.design import (
    STATUS_FAULT,
    STATUS_LOST,
    STATUS_RAIL,
    STATUS_SHORT_HISTORY,
    Design,
)
from sculler_model.fast import FastChannels, FastModel, VectorBlock
from sculler_model.golden import GoldenModel, Sample
from sculler_model.samples import Plausibility, end_after_stamp, in_words
from sculler_sim.engine import simulate
from sculler_sim.run import RESET
from sculler_sim.stimulus import Stimulus

ModelEngine = Literal["fast", "reference"]

WITHOUT_NUMBA = "computed without Numba, several times more slowly: install sculler[fast]"


@dataclass(frozen=True)
class Summary:
    """What a run did.

    Attributes:
        design: the design.
        samples: samples taken.
        results: rows written, one for each complete major interval.
        short_history, faults, rails, losses: how many of them carry status bit 0, 1, 2, 3.
        left_out: samples in intervals that the log's end or a break cut short.
        elapsed: seconds of work.
        breaks: what the log's stamps and its counter showed.
        implausible: counts that no sensor gives, and what was not looked at, in words.
        clocks: clocks simulated; None for the model.
        advice: how to have it faster, in words, where there is a way.
    """

    design: Design
    samples: int
    results: int
    short_history: int
    faults: int
    rails: int
    losses: int
    left_out: int
    elapsed: float
    breaks: BreakFinder
    implausible: list[str]
    clocks: int | None = None
    advice: tuple[str, ...] = ()

    @property
    def seconds(self) -> float:
        """How long the samples took; of many channels, one of them on average."""
        return self.samples * self.design.sample_interval / self.design.channels

    @property
    def warnings(self) -> list[str]:
        """What the user should know."""
        return [*self.breaks.warnings(), *self.implausible, *self.advice]

    def as_json(self) -> dict[str, Any]:
        """As plain data."""
        data: dict[str, Any] = {
            "design": self.design.name,
            "samples": self.samples,
            "seconds": self.seconds,
            "results": self.results,
            "leftover_samples": self.left_out,
            "short_history_results": self.short_history,
            "fault_results": self.faults,
            "rail_results": self.rails,
            "loss_results": self.losses,
            "elapsed_s": self.elapsed,
            "samples_per_s": self.samples / self.elapsed,
        }
        data |= {**self.breaks.as_json(), "warnings": self.warnings}
        return data if self.clocks is None else data | {"clocks": self.clocks}

    def facts(self) -> dict[str, str]:
        """In words."""
        design = self.design
        each = plural(design.samples_per_major, "sample")
        rows = {
            "samples": f"{self.samples:,}, {self.seconds:,.6g} s at"
            f" {design.sensor.sample_rate_hz:g} Hz",
            "results": f"{plural(self.results, 'major interval')} of {each}",
        }
        if design.channels > 1:
            rows["samples"] += f" of {design.channels} channels each, on average"
        if self.left_out and design.channels > 1:
            rows["incomplete"] = (
                f"{plural(self.left_out, 'sample')} before restarts or at the end fill no interval"
                " and give no result"
            )
        elif self.left_out and self.breaks.count:
            rows["incomplete"] = (
                f"{plural(self.left_out, 'sample')} before breaks or at the end fill no interval"
                " and give no result"
            )
        elif self.left_out:
            rows["incomplete"] = (
                f"the last interval has only {self.left_out} of {each} and gives no result"
            )
        if self.short_history:
            rows["status bit 0"] = (
                f"{plural(self.short_history, 'result')} reached before the first sample"
            )
        if self.faults:
            rows["status bit 1"] = f"{plural(self.faults, 'result')} with faulty samples"
        if self.rails:
            rows["status bit 2"] = f"{plural(self.rails, 'result')} with counts at their rails"
        if self.losses:
            rows["status bit 3"] = f"{plural(self.losses, 'result')} with samples lost"
        if self.clocks is not None:
            rows["clocks"] = f"{self.clocks:,}"
        for bits, times in self.breaks.wraps.items():
            rows["sequence"] = f"a counter of {bits} bits, wrapped {plural(times, 'time')}"
        rows["speed"] = f"{self.samples / self.elapsed:,.3g} samples/s, {self.elapsed:.2f} s in all"
        return rows


def model_log(
    design: Design,
    log: str | Path,
    output: Path,
    engine: ModelEngine,
    advance: Advance,
    breaks: Policy = "refuse",
) -> Summary:
    """Run a log through the golden model and write the vectors.

    Args:
        design: the design.
        log: a core log, or `-` for stdin.
        output: the vectors file; appears whole or not at all.
        engine: the vectorised twin, or the plain reference.
        advance: told the bytes of the rows read.
        breaks: what to do where samples are missing.

    Raises:
        InputError: the log is at fault or the output cannot be written.
    """
    start = time.perf_counter()
    model: Any  # what takes the chunks of its source
    source: _Source | ChannelSource
    if design.channels > 1:
        model = FastChannels(design) if engine == "fast" else ReferenceChannels(design)
        source = ChannelSource(design, log, advance)
    else:
        model = FastModel(design) if engine == "fast" else _Reference(design)
        source = _Source(design, log, breaks, advance)

    def blocks() -> Iterator[VectorBlock]:
        for chunk in source:
            if chunk is RESET:
                model.reset()
            else:
                yield source.stamped(model.feed(*chunk))

    counted = _write(design, blocks(), output)
    summary = _summary(design, source, counted, time.perf_counter() - start)
    if engine == "fast" and model.lacks_numba:
        return replace(summary, advice=(WITHOUT_NUMBA,))
    return summary


def simulate_log(
    design: Design,
    log: str | Path,
    output: Path,
    engine: SimulationEngine,
    stimulus: Stimulus,
    wave: Path | None,
    advance: Advance,
    breaks: Policy = "refuse",
) -> Summary:
    """Run a log through the simulated hardware and write the vectors.

    Args:
        design, log, output, advance, breaks: as for `model_log`.
        engine: the emitted Verilog in Verilator, or the Amaranth design in its own simulator.
        stimulus: levels of the handshakes.
        wave: a waveform to write, or None.

    Raises:
        InputError: the log is at fault, a tool is missing, or an output cannot be written.
        SimulationError: the core hangs.
    """
    start = time.perf_counter()
    timing(design)  # a core that cannot be built is told first
    source: _Source | ChannelSource
    if design.channels > 1:
        source = ChannelSource(design, log, advance)
    else:
        source = _Source(design, log, breaks, advance)
    # a log at fault from the beginning is told before anything is compiled
    chunks: Iterator[Any] = iter(source)
    chunks = chain([next(chunks)], chunks)
    run = simulate(design, chunks, engine=engine, stimulus=stimulus, wave=wave)
    counted = _write(design, map(source.stamped, run), output, source.has_times)
    return _summary(design, source, counted, time.perf_counter() - start, run.progress.clocks)


class _Source:
    """A log's samples for a core, `RESET` at its breaks; and what becomes of them.

    It knows the instants at which major intervals end.  Results come in order, however late, and a
    core may have dropped some: each takes the next end of its own major interval.

    Attributes:
        samples: that went by.
        breaks: what its stamps and its counter show.
        has_times: whether the log has stamps, known from the first samples on.
    """

    def __init__(self, design: Design, log: str | Path, policy: Policy, advance: Advance) -> None:
        self._design, self._log, self._advance = design, log, advance
        self.breaks = BreakFinder(design, "stdin" if str(log) == "-" else str(log), policy)
        self._plausibility = Plausibility(design)
        self.samples = self._left_out = 0
        self._phase = 0  # samples in the interval that is not complete
        self._major = 0  # the interval that is not complete
        # major intervals whose results are still to come, and their ends
        self._majors = np.zeros(0, np.int64)
        self._ends: NDArray[np.float64] | None = None

    def __iter__(self) -> Iterator[tuple[NDArray[np.int64], NDArray[np.uint8] | None] | None]:
        span = self._design.samples_per_major
        for chunk in self.breaks(read_log(self._log, self._design, self._advance)):
            if isinstance(chunk, Break):
                self._left_out += self._phase
                self._phase = self._major = 0
                yield RESET
                continue
            if chunk.times is not None:
                ends = chunk.times[span - 1 - self._phase :: span] + end_after_stamp(self._design)
                self._ends = ends if self._ends is None else np.concatenate([self._ends, ends])
                majors = self._major + np.arange(len(ends))
                self._majors = np.concatenate([self._majors, majors])
            complete, self._phase = divmod(self._phase + len(chunk.counts), span)
            self._major += complete
            self.samples += len(chunk.counts)
            self._plausibility(chunk.counts, chunk.times)
            yield chunk.counts, chunk.faults

    @property
    def has_times(self) -> bool:
        return self._ends is not None

    def stamped(self, block: VectorBlock) -> VectorBlock:
        """The next results with the instants of their ends, where the log has stamps."""
        if self._ends is None:
            return block
        rows = np.arange(len(block))
        if not np.array_equal(self._majors[: len(block)], block.major):  # some were dropped
            rows = np.array(list(_places(self._majors.tolist(), block.major.tolist())), np.int64)
        times = self._ends[rows]
        gone = int(rows[-1]) + 1 if len(rows) else 0
        self._majors, self._ends = self._majors[gone:], self._ends[gone:]
        return replace(block, times=times)

    @property
    def left_out(self) -> int:
        """Samples of intervals that are not complete, once all are through."""
        return self._left_out + self._phase

    @property
    def doubts(self) -> list[str]:
        """Counts that no sensor gives, in words, once all samples are through."""
        found = self._plausibility.finish()
        unit, first = counting(self._log)
        return in_words(found, self._plausibility.counts, lambda sample: f"{unit} {sample + first}")


def _summary(
    design: Design,
    source: _Source | ChannelSource,
    counted: tuple[int, int, int, int, int],
    elapsed: float,
    clocks: int | None = None,
) -> Summary:
    """What a run did, once all samples are through."""
    return Summary(
        design,
        source.samples,
        *counted,
        source.left_out,
        elapsed,
        source.breaks,
        source.doubts,
        clocks,
    )


def _places(waiting: list[int], came: list[int]) -> Iterator[int]:
    """Where each that came stands among those that were waited for, in order."""
    place = -1
    for major in came:
        place = waiting.index(major, place + 1)
        yield place


def _write(
    design: Design, blocks: Iterable[VectorBlock], output: Path, times: bool | None = None
) -> tuple[int, int, int, int, int]:
    """Write the vectors; results in all, and those with each of the status bits 0 to 3.

    Whether there are times, the blocks tell where `times` does not.
    """
    results = 0
    marked = dict.fromkeys((STATUS_SHORT_HISTORY, STATUS_FAULT, STATUS_RAIL, STATUS_LOST), 0)
    with VectorsWriter(output, design.columns, times, design) as writer:
        for block in blocks:
            writer.write(block)
            results += len(block)
            for bit in marked:
                marked[bit] += int(((block.status & bit) != 0).sum())
    short, faults, rails, losses = marked.values()
    return results, short, faults, rails, losses


class _Reference:
    """`GoldenModel` with the interface of `FastModel`."""

    def __init__(self, design: Design) -> None:
        self._model = GoldenModel(design)
        self._design = design

    def reset(self) -> None:
        self._model.reset()

    def feed(self, counts: NDArray[np.int64], faults: NDArray[np.uint8] | None) -> VectorBlock:
        flags = [0] * len(counts) if faults is None else faults.tolist()
        samples: Iterator[Sample] = (
            ((gx, gy, gz), (ax, ay, az), fault)
            for (gx, gy, gz, ax, ay, az), fault in zip(counts.tolist(), flags, strict=True)
        )
        return VectorBlock.from_results(self._model.run(samples), self._design)
