"""`FastModel` with inputs of any form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler.library.counts import CountsLike, as_marks
from sculler.library.logs import Log
from sculler_model import fast
from sculler_model.design import Design
from sculler_model.fast import VectorBlock
from sculler_model.samples import end_after_stamp


class FastModel(fast.FastModel):
    """Exact coning and sculling sums of a design, fed with arrays of samples.

    The integers are those of `GoldenModel` and of the hardware, bit for bit
    (docs/explanation/exactness.md).  Chunks of any length give the same results; memory is bounded
    by the chunk, its results and one major interval.

    Args:
        design: the design.

    Attributes:
        design: the design.
        samples: samples taken since reset.

    Examples:
        >>> import numpy as np, sculler
        >>> model = sculler.FastModel(sculler.Design.preset("stim300"))
        >>> block = model.feed(np.full((50, 6), 7, np.int8))
        >>> len(block), block.vector("alpha")[0].tolist(), model.leftover
        (2, [140, 140, 140], 10)
    """

    def feed(self, counts: CountsLike, faults: ArrayLike | None = None) -> VectorBlock:
        """Take consecutive samples and return the major intervals that they complete.

        Args:
            counts: (N, 6) whole numbers of any dtype: gyro x, y, z, accelerometer x, y, z, in the
                sensor's LSB and axes; or a pandas or polars frame with the log's columns, or a
                `Log`.
            faults: (N,) of 0 and 1, 1 where the sensor said that the sample is faulty; None for
                what a frame or a `Log` says.

        Returns:
            Their results, in order; none if no major interval has ended.  Their times (s, the end
            of each interval) are told where the samples have stamps.

        Raises:
            InputError: a value is no whole number or does not fit the sensor's width.  Then
                nothing of them is taken.
        """
        log = counts if isinstance(counts, Log) else Log.of(counts)
        marks = log.faults if faults is None else as_marks("faults", faults, len(log))
        phase = self.leftover
        return with_ends(self.design, super().feed(log.counts, marks), log.times, phase)


def with_ends(
    design: Design, block: VectorBlock, stamps: NDArray[np.float64] | None, phase: int = 0
) -> VectorBlock:
    """Results with the instants of their intervals' ends, from the samples' stamps.

    Args:
        design: the design.
        block: the results of consecutive intervals that the samples complete.
        stamps: (N,) s, of the samples; None for none.
        phase: samples before them in the interval that was not complete.
    """
    if stamps is None:
        return block
    span = design.samples_per_major
    return replace(block, times=stamps[span - 1 - phase :: span] + end_after_stamp(design))
