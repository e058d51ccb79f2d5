"""A design's hardware, and a log through it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from sculler.library.logs import LogLike, as_log
from sculler.runs.engines import SimulationEngine, choose_engine
from sculler.runs.hardware import texts_of, write_hardware
from sculler_hdl import Generated, Manifest
from sculler_hdl import generate as generate_verilog
from sculler_model.design import Design
from sculler_model.fast import VectorBlock
from sculler_model.samples import end_after_stamp
from sculler_sim import engine as simulators
from sculler_sim.stimulus import Stimulus


@dataclass(frozen=True)
class Core:
    """A generated core.

    Attributes:
        design: what it was made from.
        generated: what was made.

    Examples:
        >>> import sculler
        >>> core = sculler.generate(sculler.Design.preset("hg4930"))
        >>> isinstance(core, sculler.Core), core.manifest.latency_clocks > 0
        (True, True)
    """

    design: Design
    generated: Generated

    @property
    def verilog(self) -> str:
        """The text of NAME.v, plain Verilog-2001."""
        return self.generated.verilog

    @property
    def manifest(self) -> Manifest:
        """Ports, word lengths, scales, clocks and what it takes; `as_json()` as plain data."""
        return self.generated.manifest

    @property
    def files(self) -> dict[str, str]:
        """Texts by name: the Verilog, its manifest, models of vendor blocks, a schedule."""
        return texts_of(self.generated)

    def write(self, folder: str | Path) -> list[Path]:
        """Write `files` and a self-checking test bench; they appear together.

        Args:
            folder: where; it is made if need be.

        Returns:
            The files.

        Raises:
            InputError: the folder cannot be made or written to.
        """
        return list(write_hardware(self.design, Path(folder)).files)


def generate(design: Design) -> Core:
    """Make the core of a design: plain Verilog-2001 and the manifest that describes it.

    The same design gives the same bytes, those of `sculler generate`.

    Args:
        design: the design; its `hardware` says which core and for which target.

    Returns:
        The core.  From an interval's last sample to its result it takes
        `manifest.latency_clocks` clocks.

    Raises:
        InputError: `hardware.multipliers` are too few.
        ToolError: Yosys failed.

    Examples:
        >>> import sculler
        >>> core = sculler.generate(sculler.Design.preset("hg4930"))
        >>> sorted(core.files)
        ['hg4930_4x1.json', 'hg4930_4x1.v', 'hg4930_4x1.vhd', 'hg4930_4x1_properties.sv']
        >>> "module hg4930_4x1" in core.verilog
        True
    """
    return Core(design, generate_verilog(design))


def simulate(
    design: Design,
    log: LogLike,
    *,
    engine: Literal["auto", "model"] | SimulationEngine = "auto",
    stall: int | None = None,
    wave: str | Path | None = None,
) -> VectorBlock:
    """Run samples through the generated hardware, clock by clock.

    The results are the integers of `FastModel`, if the hardware is right: `compare` tells.

    Args:
        design: the design.
        log: (N, 6) counts as a `Log`, an array, a frame, or the path of a log, in the sensor's LSB
            and axes.
        engine: `verilator` (the emitted Verilog, compiled), `amaranth` (slow, needs no compiler),
            `model` (the cycle-accurate model, no hardware), or `auto`: Verilator where it is.
        stall: seed of random stalls on both handshakes; None for none.
        wave: a waveform to write: .vcd, or with Verilator also .fst.

    Returns:
        The results of all complete major intervals, with times where the log has stamps.

    Raises:
        InputError: the samples are at fault, a tool is missing, or the wave cannot be written.
        SimulationError: the core hangs.

    Examples:
        >>> import numpy as np, sculler
        >>> design, counts = sculler.Design.preset("hg4930"), np.full((8, 6), -3)
        >>> rtl = sculler.simulate(design, counts, engine="model")
        >>> sculler.compare(sculler.FastModel(design).feed(counts), rtl) is None
        True
    """
    samples = as_log(log, design)
    chosen = choose_engine()[0] if engine == "auto" else engine
    longest = max(256, 4 * design.samples_per_major)  # so that the host misses a major now and then
    run = simulators.simulate(
        design,
        [(samples.counts, samples.faults)],
        engine=chosen,
        stimulus=Stimulus.always() if stall is None else Stimulus.stalls(stall, longest),
        wave=None if wave is None else Path(wave),
    )
    block = VectorBlock.concatenate([VectorBlock.from_rows([], design), *run])
    if samples.times is None:
        return block
    span = design.samples_per_major
    last = np.asarray(block.major) * span + span - 1  # a core may have dropped results
    return replace(block, times=samples.times[last] + end_after_stamp(design))
