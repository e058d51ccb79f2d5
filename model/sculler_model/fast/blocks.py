"""Many results at once, as arrays: what the fast model, the simulators and the host exchange."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import COMPONENTS, HIGH_RESOLUTION_COLUMNS, Design, Result
from sculler_model.tables import Table, vector_columns


def component_dtype(design: Design) -> np.dtype[np.generic]:
    """int64 where every component of the design fits it, else object (Python integers)."""
    widest = max(getattr(design.words, vector).bits for vector in design.vectors)
    return np.dtype(np.int64) if widest <= 64 else np.dtype(object)


@dataclass(frozen=True)
class VectorBlock(Table):
    """Results of consecutive major intervals.

    Attributes:
        major: (R,) int64, counting from 0 after reset.
        status: (R,) int64, bit set (see `sculler_model.design`).
        components: exact integers in the order of the design's components, (R, 18), with
            high-resolution position (R, 27); int64, or object where the numbers may pass 64 bits.
        times: (R,) instant of each interval's end on the log's clock, s; None where the log has
            no stamps.

    Examples:
        >>> import numpy as np, sculler
        >>> design = sculler.Design.preset("stim300")
        >>> block = sculler.FastModel(design).feed(np.full((40, 6), 3))
        >>> block.to_numpy().shape, block.vector("alpha").tolist()
        ((2, 20), [[60, 60, 60], [60, 60, 60]])
    """

    major: NDArray[np.int64]
    status: NDArray[np.int64]
    components: NDArray[np.generic]
    times: NDArray[np.float64] | None = None

    @classmethod
    def empty(cls, dtype: np.dtype[np.generic], components: int = len(COMPONENTS)) -> VectorBlock:
        """A block of no results."""
        none = np.zeros(0, np.int64)
        return cls(none, none, np.zeros((0, components), dtype))

    @classmethod
    def from_results(
        cls,
        results: Sequence[Result],
        dtype: np.dtype[np.generic] | None = None,
        components: int = len(COMPONENTS),
    ) -> VectorBlock:
        """Collect results of the reference model.

        Args:
            results: of one design.
            dtype: of the components; object if not given.
            components: how many there are, told where there may be no result.
        """
        dtype = dtype or np.dtype(object)
        if not results:
            return cls.empty(dtype, components)
        rows = np.array([result.row() for result in results], dtype=object)
        return cls(
            rows[:, 0].astype(np.int64), rows[:, 1].astype(np.int64), rows[:, 2:].astype(dtype)
        )

    @classmethod
    def concatenate(cls, blocks: Sequence[VectorBlock]) -> VectorBlock:
        """Join blocks in order.

        Raises:
            ValueError: there is no block, or some have times and others have not.
        """
        stamped = [block.times is not None for block in blocks if len(block)]
        if any(stamped) and not all(stamped):
            raise ValueError("blocks with and without times cannot be joined")
        times = [block.times for block in blocks if block.times is not None]
        return cls(
            np.concatenate([block.major for block in blocks]),
            np.concatenate([block.status for block in blocks]),
            np.concatenate([block.components for block in blocks]),
            np.concatenate(times) if times else None,
        )

    def __len__(self) -> int:
        return len(self.major)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns of its rows."""
        return HIGH_RESOLUTION_COLUMNS[: 2 + self.components.shape[1]]

    def vector(self, name: str) -> NDArray[np.generic]:
        """A vector by its name, (R, 3).

        Raises:
            ValueError: the block has no such vector.
        """
        first = self.columns.index(f"{name}_x") - 2
        return self.components[:, first : first + 3]

    def named_columns(self) -> dict[str, NDArray[Any]]:
        """`major`, `status`, the components, and `time_s` (s) where the log had stamps."""
        columns: dict[str, NDArray[Any]] = {"major": self.major, "status": self.status}
        columns |= vector_columns(self.columns[2:], self.components)
        return columns if self.times is None else columns | {"time_s": self.times}

    def to_numpy(self) -> NDArray[Any]:
        """All integers (R, 2 + components) in the order of `columns`, exact; `times` stay apart.

        The dtype is int64, or object (Python integers) where the design has a component of more
        than 64 bits.
        """
        return np.column_stack([self.major, self.status, self.components])

    def rows(self) -> Iterator[tuple[int, ...]]:
        """Python integers in the order of `columns`, row by row."""
        columns = zip(
            self.major.tolist(), self.status.tolist(), self.components.tolist(), strict=True
        )
        for major, status, components in columns:
            yield (major, status, *components)

    def first_difference(self, other: VectorBlock) -> tuple[int, str, int, int] | None:
        """First unequal integer as (row, column, ours, theirs), or None, in the common rows."""
        for row, (ours, theirs) in enumerate(zip(self.rows(), other.rows(), strict=False)):
            if ours != theirs:
                unequal = (i for i, (a, b) in enumerate(zip(ours, theirs, strict=True)) if a != b)
                at = next(unequal)
                return row, self.columns[at], ours[at], theirs[at]
        return None
