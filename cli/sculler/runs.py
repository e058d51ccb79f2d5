"""A log through the golden model or through the simulated hardware, to a vectors file."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any, Literal

from sculler.logs import Chunk, read_log
from sculler.terminal import Advance, plural
from sculler_model.blocks import VectorBlock, component_dtype
from sculler_model.design import Design
from sculler_model.fast import FastModel
from sculler_model.golden import GoldenModel, Sample
from sculler_model.vectors import STATUS_FAULT, STATUS_LOST, STATUS_RAIL, STATUS_SHORT_HISTORY
from sculler_sim.engine import simulate
from sculler_sim.stimulus import Stimulus
from sculler_sim.vectors_file import VectorsWriter

ModelEngine = Literal["fast", "reference"]
SimulationEngine = Literal["verilator", "amaranth"]


@dataclass(frozen=True)
class Summary:
    """What a run did.

    Attributes:
        design: the design.
        samples: samples taken.
        results: rows written, one for each complete major interval.
        short_history, faults, rails, losses: how many of them carry status bit 0, 1, 2, 3.
        elapsed: seconds of work.
        clocks: clocks simulated; None for the model.
    """

    design: Design
    samples: int
    results: int
    short_history: int
    faults: int
    rails: int
    losses: int
    elapsed: float
    clocks: int | None = None

    @property
    def leftover(self) -> int:
        """Samples in an incomplete last interval."""
        return self.samples % self.design.samples_per_major

    def as_json(self) -> dict[str, Any]:
        """As plain data."""
        data: dict[str, Any] = {
            "design": self.design.name,
            "samples": self.samples,
            "seconds": self.samples * self.design.sample_interval,
            "results": self.results,
            "leftover_samples": self.leftover,
            "short_history_results": self.short_history,
            "fault_results": self.faults,
            "rail_results": self.rails,
            "loss_results": self.losses,
            "elapsed_s": self.elapsed,
            "samples_per_s": self.samples / self.elapsed,
        }
        return data if self.clocks is None else data | {"clocks": self.clocks}

    def facts(self) -> dict[str, str]:
        """In words."""
        design = self.design
        each = plural(design.samples_per_major, "sample")
        rows = {
            "samples": f"{self.samples:,}, {self.samples * design.sample_interval:,.6g} s at"
            f" {design.sensor.sample_rate_hz:g} Hz",
            "results": f"{plural(self.results, 'major interval')} of {each}",
        }
        if self.leftover:
            rows["incomplete"] = (
                f"the last interval has only {self.leftover} of {each} and gives no result"
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
        rows["speed"] = f"{self.samples / self.elapsed:,.3g} samples/s, {self.elapsed:.2f} s in all"
        return rows


def model_log(
    design: Design, log: str | Path, output: Path, engine: ModelEngine, advance: Advance
) -> Summary:
    """Run a log through the golden model and write the vectors.

    Args:
        design: the design.
        log: a core log, or `-` for stdin.
        output: the vectors file; appears whole or not at all.
        engine: the vectorised twin, or the plain reference.
        advance: told the bytes of the log read.

    Raises:
        InputError: the log is at fault or the output cannot be written.
    """
    feed = FastModel(design).feed if engine == "fast" else _reference(design)
    samples = 0

    def blocks() -> Iterator[VectorBlock]:
        nonlocal samples
        for counts, faults in read_log(log, design, advance):
            samples += len(counts)
            yield feed(counts, faults)

    start = time.perf_counter()
    counted = _write(design, blocks(), output)
    return Summary(design, samples, *counted, time.perf_counter() - start)


def simulate_log(
    design: Design,
    log: str | Path,
    output: Path,
    engine: SimulationEngine,
    stimulus: Stimulus,
    wave: Path | None,
    advance: Advance,
) -> Summary:
    """Run a log through the simulated hardware and write the vectors.

    Args:
        design, log, output, advance: as for `model_log`.
        engine: the emitted Verilog in Verilator, or the Amaranth design in its own simulator.
        stimulus: levels of the handshakes.
        wave: a waveform to write, or None.

    Raises:
        InputError: the log is at fault, a tool is missing, or an output cannot be written.
        SimulationError: the core hangs.
    """
    start = time.perf_counter()
    chunks = read_log(log, design, advance)
    first = next(chunks)  # a log at fault from the beginning is told before anything is compiled
    chunks = chain([first], chunks)
    run = simulate(design, chunks, engine=engine, stimulus=stimulus, wave=wave)
    counted = _write(design, run, output)
    elapsed = time.perf_counter() - start
    return Summary(design, run.progress.samples, *counted, elapsed, run.progress.clocks)


def _write(
    design: Design, blocks: Iterable[VectorBlock], output: Path
) -> tuple[int, int, int, int, int]:
    """Write the vectors; results in all, and those with each of the status bits 0 to 3."""
    results = 0
    marked = dict.fromkeys((STATUS_SHORT_HISTORY, STATUS_FAULT, STATUS_RAIL, STATUS_LOST), 0)
    with VectorsWriter(output, design.columns) as writer:
        for block in blocks:
            writer.write(block)
            results += len(block)
            for bit in marked:
                marked[bit] += int(((block.status & bit) != 0).sum())
    short, faults, rails, losses = marked.values()
    return results, short, faults, rails, losses


def _reference(design: Design) -> Callable[..., VectorBlock]:
    model, dtype, components = GoldenModel(design), component_dtype(design), design.components

    def samples(chunk: Chunk) -> Iterator[Sample]:
        counts, faults = chunk
        flags = [0] * len(counts) if faults is None else faults.tolist()
        for (gx, gy, gz, ax, ay, az), fault in zip(counts.tolist(), flags, strict=True):
            yield (gx, gy, gz), (ax, ay, az), fault

    return lambda *chunk: VectorBlock.from_results(
        list(model.run(samples(chunk))), dtype, len(components)
    )
