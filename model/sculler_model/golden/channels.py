"""The reference model of one core with many sensors: as many single models as there are channels.

A core with `hardware.channels = C` takes samples that say which of C sensors they come from, in any
order.  What it hands over of a channel is what a core of one channel hands over that takes this
channel's samples and no others.  So the model is C single models, which share nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from sculler_model.algorithms import Vec
from sculler_model.design import Design, Result
from sculler_model.errors import InputError
from sculler_model.golden.reference import GoldenModel


class ChannelSample(NamedTuple):
    """A sample of one of many sensors.

    Attributes:
        channel: whose it is, from 0.
        gyro, accel, fault: as of a single sensor's sample.
        restart: 1 where the channel begins anew with this sample.
    """

    channel: int
    gyro: Vec
    accel: Vec
    fault: int = 0
    restart: int = 0


class ChannelModel:
    """Exact coning/sculling accumulators of C sensors, each for itself.

    Args:
        design: the design; its `channels` is C.

    Attributes:
        models: the single models, by channel.

    Examples:
        >>> import sculler
        >>> from sculler_model.golden import ChannelModel
        >>> hardware = {"core": "compact", "channels": 2}
        >>> design = sculler.Design.parse({"preset": "stim300", "hardware": hardware})
        >>> model = ChannelModel(design)
        >>> results = [model.step(i % 2, (1 + i % 2, 0, 0), (0, 0, 0)) for i in range(40)]
        >>> results[38].alpha, results[39].alpha
        ((20, 0, 0), (40, 0, 0))
    """

    def __init__(self, design: Design) -> None:
        self.design = design
        self.models = [GoldenModel(design) for _ in range(design.channels)]

    def reset(self) -> None:
        """Forget everything, of all channels."""
        for model in self.models:
            model.reset()

    def lose(self, channel: int) -> None:
        """A sample of a channel was offered and not taken: it marks that channel's next one."""
        self._of(channel).lose()

    def step(
        self, channel: int, gyro: Vec, accel: Vec, fault: int = 0, restart: int = 0
    ) -> Result | None:
        """Take the next sample of a channel.

        Args:
            channel: whose it is, 0 to C - 1.
            gyro, accel, fault: as of `GoldenModel.step`.
            restart: 1: the channel forgets everything first, losses not yet told included.  The
                sample is its first, and its next result is number 0.

        Returns:
            That channel's result after the last sample of its major interval, else None.

        Raises:
            InputError: there is no such channel, or as `GoldenModel.step`.
        """
        model = self._of(channel)
        if restart:
            model.reset()
        return model.step(gyro, accel, fault)

    def run(self, samples: Iterable[ChannelSample]) -> Iterator[tuple[int, Result]]:
        """Channel and result of every major interval that a sequence of samples completes.

        Raises:
            InputError: as `step`.
        """
        for sample in samples:
            result = self.step(*sample)
            if result is not None:
                yield sample.channel, result

    def _of(self, channel: int) -> GoldenModel:
        if not 0 <= channel < len(self.models):
            raise InputError(f"channel {channel} is not there, give 0 to {len(self.models) - 1}")
        return self.models[channel]
