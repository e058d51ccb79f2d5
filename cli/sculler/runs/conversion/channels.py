"""Samples of many channels to counts, each channel for itself."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.readers.mounting import Mounting
from sculler.readers.recording import Samples, Unit
from sculler.runs.conversion.counts import Biases, Conversion
from sculler.runs.conversion.plan import Plan
from sculler_model.design import Design
from sculler_model.errors import ContradictionError
from sculler_model.fast import channel_runs

_HINTS = 3
"""Channels whose units are told to look wrong."""


def refuse_what_is_not_built(plan: Plan) -> None:
    """Refuse what would make other samples of a channel's than the log has.

    Raises:
        ContradictionError: names the first option that would.
    """
    asked = {
        "--cumulative": plan.sums is not None,
        "--steps resample": plan.steps == "resample",
        "--gaps bridge": plan.gaps == "bridge",
        "--start": plan.start is not None,
        "--stop": plan.stop is not None,
        "--calibration": plan.calibration is not None,
    }
    for option, given in asked.items():
        if given:
            raise ContradictionError(
                f"{option}: not built for a design with channels, convert each channel's log by"
                " itself, with a design without hardware.channels"
            )


class ChannelConversions:
    """Brings samples to counts of the design's sensors, streaming, by a `Conversion` a channel.

    Args:
        path: for messages.
        design: gives kind, scales and widths.
        gyro, accel, mounting, biases: as for `Conversion`, of all channels.
    """

    def __init__(
        self,
        path: Path,
        design: Design,
        gyro: Unit,
        accel: Unit,
        mounting: Mounting,
        biases: Biases,
    ) -> None:
        self._path = path
        self._new = partial(
            Conversion, design=design, gyro=gyro, accel=accel, mounting=mounting, biases=biases
        )
        like_all = self._new(path)
        self.passes, self.made = like_all.passes, like_all.made
        self._of: dict[int, Conversion] = {}

    def __call__(self, chunk: Samples) -> NDArray[np.int64]:
        """Counts (N, 6) of the next samples, whose channels they say.

        Raises:
            InputError: as by a `Conversion`; names the channel, and its sample.
        """
        assert chunk.channels is not None
        counts = np.empty(chunk.values.shape, np.int64)
        for channel, anew, part in channel_runs(chunk.channels, chunk.restarts):
            if channel not in self._of:
                self._of[channel] = self._new(f"{self._path}: channel {channel}")
            if anew:
                self._of[channel].begin_anew()
            counts[part] = self._of[channel](chunk.values[part])
        return counts

    @property
    def samples(self) -> int:
        """Of all channels."""
        return sum(one.samples for one in self._of.values())

    @property
    def largest(self) -> NDArray[np.int64]:
        """The largest count of each column."""
        found: NDArray[np.int64] = np.max([one.largest for one in self._of.values()], axis=0)
        return found

    @property
    def remainder(self) -> tuple[float, ...]:
        """What is left for a next sample, of each column in the channel with most; SI units."""
        left = np.array([one.remainder for one in self._of.values()])
        return tuple(np.take_along_axis(left, abs(left).argmax(axis=0)[None], axis=0)[0].tolist())

    def hints(self) -> list[str]:
        """What makes the units look wrong, of the first channels with which something does."""
        told = {channel: one.hints() for channel, one in sorted(self._of.items())}
        doubtful = [channel for channel, hints in told.items() if hints]
        more = len(doubtful) - _HINTS
        return [
            *(
                f"channel {channel}: {hint}"
                for channel in doubtful[:_HINTS]
                for hint in told[channel]
            ),
            *([f"units look wrong in {more} more channels"] if more > 0 else []),
        ]
