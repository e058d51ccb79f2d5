"""`FastChannels`: the twin of `ChannelModel` for arrays: samples sorted out, each channel's run."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast.blocks import VectorBlock
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
        table = np.asarray(counts)
        if table.ndim != 2 or table.shape[1] != 6:
            raise InputError(f"counts: shape {table.shape}, give (samples, 6)")
        whose = self._checked(channels, len(table))
        fault = None if faults is None else np.asarray(faults)
        again = np.zeros(len(table), bool) if restarts is None else np.asarray(restarts) != 0
        blocks, ends = [VectorBlock.from_rows([], self.design)], [np.zeros(0, np.int64)]
        owners = [np.zeros(0, np.int64)]
        order = np.argsort(whose, kind="stable")
        edges = np.flatnonzero(np.diff(whose[order])) + 1
        for mine in np.split(order, edges) if len(order) else []:
            channel = int(whose[mine[0]])
            model = self.models.setdefault(channel, FastModel(self.design, threads=1))
            first = np.flatnonzero(again[mine])
            for number, part in enumerate(np.split(mine, first)):
                if number:
                    model.reset()
                if not len(part):
                    continue
                span = self.design.samples_per_major
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
