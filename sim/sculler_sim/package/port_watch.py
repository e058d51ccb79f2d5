"""A core's ports in a real run: the design in Amaranth's simulator, with a host that is late.

The run is short, for the timing diagrams of the data sheet: a reset, samples, the first result.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sculler_hdl import timing
from sculler_model.design import Design
from sculler_model.errors import ToolError
from sculler_sim.engine import EngineName, trace
from sculler_sim.run import PortTrace
from sculler_sim.stimulus import Levels, Stimulus

RESET_CLOCK = 2
"""Clock in which reset is held."""

_LATE = 2
"""Clocks for which the host lets the result wait."""

_PAUSE = 3
"""The sensor has a sample in every so manieth clock, and keeps it until it is taken."""

_MOST = 20_000
"""Clocks of a run; of a slower core no result is waited for."""


@dataclass(frozen=True)
class Clock:
    """One clock at the core's ports.

    Attributes:
        rst, sample_valid, sample_ready, result_valid, result_ready: levels; `rst` is 1 in reset.
        sample: number of the sample that is next, from 0 since power-up.
        result: the result ports as `sculler_model.golden.Ports.result` has them.
    """

    rst: int
    sample_valid: int
    sample_ready: int
    result_valid: int
    result_ready: int
    sample: int
    result: tuple[int, ...]

    @property
    def takes_sample(self) -> bool:
        """Whether the sample is taken in this clock."""
        return bool(self.sample_valid and self.sample_ready and not self.rst)


@dataclass(frozen=True)
class Scripted(Stimulus):
    """A sensor that pauses, one reset, and a host that is not ready in some clocks.

    Attributes:
        not_ready: those clocks.
    """

    not_ready: tuple[int, ...] = ()

    def levels(self, start: int, clocks: int) -> Levels:
        """Levels of `clocks` clocks from clock `start` on."""
        plain = super().levels(start, clocks)
        now = np.arange(start, start + clocks)
        return plain._replace(
            offer=(now % _PAUSE == 0).astype(np.uint8),
            take=(~np.isin(now, self.not_ready)).astype(np.uint8),
        )


def watched(design: Design) -> list[Clock]:
    """A run until a first result has been taken whole, or the reset alone in a slow core.

    Raises:
        ToolError: the simulator does not show what the cycle model says.
    """
    counts = _counts(design)
    stimulus = Scripted(resets=(RESET_CLOCK,))
    shown = trace(design, counts, None, stimulus, _MOST, "model").result_valid
    clocks = RESET_CLOCK + timing(design).startup + 3 * _PAUSE
    if shown.any():
        began = int(shown.argmax())
        late = tuple(range(began, began + _LATE))
        stimulus = Scripted(resets=(RESET_CLOCK,), not_ready=late)
        # whole when as many words have been taken as one result has
        waits = trace(design, counts, None, stimulus, _MOST, "model")
        clocks = _end_of_result(design, waits, began) + 3
    engines: tuple[EngineName, EngineName] = ("model", "amaranth")
    model, found = (trace(design, counts, None, stimulus, clocks, each) for each in engines)
    difference = model.first_difference(found)
    if difference is not None:
        clock, port, wanted, seen = difference
        raise ToolError(f"clock {clock}: the simulator shows {port} {seen}, the model {wanted}")
    return _clocks(stimulus.levels(0, clocks), found)


def _counts(design: Design) -> NDArray[np.int64]:
    """Samples enough for the run, of small counts."""
    samples = np.arange(2 * design.samples_per_major + _MOST // 64)
    return np.stack([samples % 7 - 3 + column for column in range(6)], axis=1)


def _end_of_result(design: Design, found: PortTrace, began: int) -> int:
    """The clock after that in which the first result's last word, or all of it, is taken."""
    if design.hardware.handover != "stream":
        return began + _LATE + 1
    last = np.flatnonzero(found.result_valid[began:] & (found.result[began:, 1] == 1).astype(bool))
    return began + (int(last[0]) if len(last) else 0) + _LATE + 1


def _clocks(levels: Levels, found: PortTrace) -> list[Clock]:
    """Inputs and outputs clock by clock; inputs by the rule that what is offered stays."""
    clocks: list[Clock] = []
    held, sample = 0, 0
    for i in range(len(found)):
        clock = Clock(
            int(levels.rst[i]),
            int(levels.offer[i]) | held,
            int(found.sample_ready[i]),
            int(found.result_valid[i]),
            int(levels.take[i]),
            sample,
            tuple(found.result[i]),
        )
        held = int(clock.sample_valid and not clock.takes_sample)
        sample += clock.takes_sample
        clocks.append(clock)
    return clocks
