"""`FastChannels`: the twin of `ChannelModel` for arrays: samples sorted out, each channel's run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast.arithmetic import BLOCK
from sculler_model.fast.blocks import VectorBlock
from sculler_model.fast.counts import as_counts, as_faults
from sculler_model.fast.model import FastModel


class FastChannels:
    """Exact coning/sculling accumulators of C sensors, each for itself, fed with arrays.

    Chunks of any length give the results that `ChannelModel` gives for the same samples, in the
    same order: that of the samples which complete them.

    Args:
        design: the design; its `channels` is C.

    Attributes:
        design: the design.
        models: the single models of the channels that have had samples.

    Examples:
        >>> import numpy as np, sculler
        >>> from sculler_model.fast import FastChannels
        >>> hardware = {"core": "compact", "channels": 2}
        >>> design = sculler.Design.parse({"preset": "stim300", "hardware": hardware})
        >>> counts, channels = np.arange(40)[:, None] % 2 + np.ones(6, int), np.arange(40) % 2
        >>> block = FastChannels(design).feed(counts, channels)
        >>> block.channels.tolist(), block.vector("alpha").tolist()
        ([0, 1], [[20, 20, 20], [40, 40, 40]])
    """

    def __init__(self, design: Design) -> None:
        self.design = design
        self.models: dict[int, FastModel] = {}

    def reset(self) -> None:
        """Forget everything, of all channels."""
        self.models.clear()

    @property
    def leftover(self) -> int:
        """Samples in incomplete major intervals so far, of all channels."""
        return sum(model.leftover for model in self.models.values())

    @property
    def lacks_numba(self) -> bool:
        """Whether a channel had samples enough to be compiled for, but Numba is missing."""
        return any(model.lacks_numba for model in self.models.values())

    def feed(
        self,
        counts: ArrayLike,
        channels: ArrayLike,
        faults: ArrayLike | None = None,
        restarts: ArrayLike | None = None,
    ) -> VectorBlock:
        """Take consecutive samples and return the major intervals they complete.

        Args:
            counts: (N, 6) integers: gyro x, y, z, accelerometer x, y, z.
            channels: (N,) integers, whose sample each is.
            faults: (N,) integers or booleans, not 0 where the sample carried `fault`.
            restarts: (N,) likewise, not 0 where its channel begins anew with it.

        Returns:
            Their results with `channels`, in the order of the samples that complete them.

        Raises:
            InputError: the arrays are not of this form, there is no such channel, or a count does
                not fit.  What became of the samples before is then not said.
        """
        table = as_counts(counts)
        whose = self._checked(channels, len(table))
        fault = None if faults is None else as_faults(faults, len(table))
        again = None if restarts is None else as_faults(restarts, len(table), "restarts")
        blocks, ends = [VectorBlock.from_rows([], self.design)], [np.zeros(0, np.int64)]
        owners, span = [np.zeros(0, np.int64)], self.design.samples_per_major
        for channel, anew, part in channel_runs(whose, again):
            model = self._model(channel)
            if anew:
                model.reset()
            ended = part[span - 1 - model.leftover :: span]
            try:
                block = model.feed(table[part], None if fault is None else fault[part])
            except InputError as error:
                raise InputError(f"channel {channel}: {error}") from error
            blocks.append(block)
            ends.append(ended)
            owners.append(np.full(len(ended), channel, np.int64))
        joined, turn = VectorBlock.concatenate(blocks), np.argsort(np.concatenate(ends))
        return replace(joined[turn], channels=np.concatenate(owners)[turn])

    def _model(self, channel: int) -> FastModel:
        """The channel's model; they have as much room for their work together as one has."""
        if channel not in self.models:
            room = max(BLOCK // self.design.channels, 1024)
            self.models[channel] = FastModel(self.design, threads=1, block=room)
        return self.models[channel]

    def _checked(self, channels: ArrayLike, samples: int) -> NDArray[np.int64]:
        whose: NDArray[Any] = np.asarray(channels)
        if whose.shape != (samples,) or whose.dtype.kind not in "iu":
            raise InputError(
                f"channels: {whose.dtype} of shape {whose.shape}, give {samples} integers"
            )
        wrong = (whose < 0) | (whose >= self.design.channels)
        if wrong.any():
            raise InputError(
                f"sample {int(np.argmax(wrong))}: channel {whose[np.argmax(wrong)]} is not there,"
                f" give 0 to {self.design.channels - 1}"
            )
        return whose.astype(np.int64)


def channel_runs(
    channels: NDArray[np.int64], restarts: NDArray[Any] | None
) -> Iterator[tuple[int, bool, NDArray[np.intp]]]:
    """Samples of many channels, sorted out.

    Args:
        channels: (N,) whose sample each is.
        restarts: (N,) not 0 where its channel begins anew with it; None for nowhere.

    Yields:
        A channel, whether it begins anew, and which of the samples are its own until it does so
        again, in order, one or more; channel after channel.
    """
    again = np.zeros(len(channels), np.bool_) if restarts is None else restarts != 0
    order = np.argsort(channels, kind="stable")
    for mine in np.split(order, np.flatnonzero(np.diff(channels[order])) + 1):
        for number, part in enumerate(np.split(mine, np.flatnonzero(again[mine]))):
            if len(part):
                yield int(channels[part[0]]), number > 0, part
