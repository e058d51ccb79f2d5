"""The cycle-accurate model of the core's ports: what every output shows on every clock.

It knows the handshake contract, the golden model and one number, the core's latency; nothing of
the pipeline inside.  The contract of the pipelined core (docs/hardware-contract.md):

* A sample is taken in a clock where `sample_valid` and `sample_ready` are both high; a result in
  a clock where `result_valid` and `result_ready` are.
* `sample_ready` is low exactly when the next sample would be a major interval's last and the
  previous interval's result has not been taken yet.  It does not depend on `sample_valid`, nor,
  within the clock, on `result_ready`.
* `result_valid` rises `latency` clocks after the clock in which the interval's last sample was
  taken, and stays high until the result is taken.
* The result ports change only in the clock `result_valid` rises.  Before the first result after
  reset they are 0.
* In a clock with `rst` high no sample is taken; afterwards every output is as at power-up.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from sculler_model.design import Design
from sculler_model.golden import GoldenModel, Sample
from sculler_model.vectors import COLUMNS, Result

PORT_MAJOR_BITS = 64
"""Width of the `result_major` port; `major` is shown modulo 2**64."""


class Ports(NamedTuple):
    """The output ports during one clock."""

    sample_ready: int
    result_valid: int
    result: tuple[int, ...]
    """Major, status and the 18 components, in the order of `COLUMNS`."""


@dataclass
class _Due:
    clock: int
    result: Result


class CycleModel:
    """Clock by clock twin of the pipelined core's ports.

    Args:
        design: the design.
        latency: clocks from the one that takes an interval's last sample to the first that shows
            its result (the core's own figure, as in the manifest).
    """

    def __init__(self, design: Design, latency: int) -> None:
        self.design = design
        self.latency = latency
        self._clock = 0
        self._reset()

    def _reset(self) -> None:
        self._golden = GoldenModel(self.design)
        self._shown: tuple[int, ...] = (0,) * len(COLUMNS)
        self._valid = 0
        self._due: _Due | None = None

    def ports(self) -> Ports:
        """What the outputs show during the present clock, before its inputs are known."""
        awaited = self._due is not None or self._valid
        last_is_next = (self._golden.t + 1) % self.design.samples_per_major == 0
        return Ports(int(not (last_is_next and awaited)), self._valid, self._shown)

    def clock(self, offered: Sample | None, result_ready: int, rst: int = 0) -> Ports:
        """Run one clock.

        Args:
            offered: the sample on the port where `sample_valid` is high, else None.
            result_ready, rst: the inputs' levels.

        Returns:
            The outputs as they were during this clock.
        """
        shown = self.ports()
        if shown.result_valid and result_ready:
            self._valid = 0
        if offered is not None and shown.sample_ready and not rst:
            result = self._golden.step(*offered)
            if result is not None:
                self._due = _Due(self._clock + self.latency, result)
        if rst:
            self._reset()
        self._clock += 1
        if self._due is not None and self._due.clock == self._clock:
            result = self._due.result
            self._shown = (result.major % (1 << PORT_MAJOR_BITS), *result.row()[1:])
            self._valid, self._due = 1, None
        return shown
