"""Many results at once, as arrays: what the fast model, the simulators and the host exchange."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import (
    COMPONENTS,
    EVERY_COLUMNS,
    HIGH_RESOLUTION_COLUMNS,
    Design,
    Result,
)
from sculler_model.fast.wide import Integers, as_integers, concatenate, limbs_for
from sculler_model.tables import Table, vector_columns


def component_limbs(design: Design) -> int:
    """W, limbs of 64 bits that hold any component of the design; 1 where int64 does."""
    return limbs_for(max(getattr(design.words, vector).bits for vector in design.vectors))


@dataclass(frozen=True)
class VectorBlock(Table):
    """Results of consecutive major intervals.

    Attributes:
        major: (R,) int64, counting from 0 after reset.
        status: (R,) int64, bit set (see `sculler_model.design`).
        components: exact integers in the order of the design's components, (R, 18), with third
            order (R, 24), high-resolution position (R, 27) or fourth order (R, 30); int64, or
            `WideIntegers` where the numbers may pass 64 bits.  Arrays of Python integers are taken
            and kept so.
        times: (R,) instant of each interval's end on the log's clock, s; None where the log has
            no stamps.
        channels: (R,) int64, whose result it is, of a core with many sensors; else None.

    Examples:
        >>> import numpy as np, sculler
        >>> design = sculler.Design.preset("stim300")
        >>> block = sculler.FastModel(design).feed(np.full((40, 6), 3))
        >>> block.to_numpy().shape, block.vector("alpha").tolist()
        ((2, 20), [[60, 60, 60], [60, 60, 60]])
    """

    major: NDArray[np.int64]
    status: NDArray[np.int64]
    components: Integers
    times: NDArray[np.float64] | None = None
    channels: NDArray[np.int64] | None = None

    def __post_init__(self) -> None:
        if isinstance(self.components, np.ndarray) and self.components.dtype.kind == "O":
            object.__setattr__(self, "components", as_integers(self.components))

    @classmethod
    def from_rows(cls, rows: Iterable[Sequence[int]], design: Design | None = None) -> VectorBlock:
        """Collect results that came as rows of integers.

        Args:
            rows: `major`, `status`, components, of one design.
            design: the design, which says how wide its components are and, where there is no row,
                how many; None for as wide as these need.

        Raises:
            OverflowError: a component is wider than any of the design.
        """
        columns = 2 + len(COMPONENTS if design is None else design.components)
        table = np.array([*rows] or np.empty((0, columns)), object)
        return cls(
            table[:, 0].astype(np.int64),
            table[:, 1].astype(np.int64),
            as_integers(table[:, 2:], None if design is None else component_limbs(design)),
        )

    @classmethod
    def from_results(cls, results: Iterable[Result], design: Design | None = None) -> VectorBlock:
        """Collect results of the reference model.

        Args:
            results: of one design.
            design: as for `from_rows`.
        """
        return cls.from_rows((result.row() for result in results), design)

    @classmethod
    def concatenate(cls, blocks: Sequence[VectorBlock]) -> VectorBlock:
        """Join blocks in order.

        Raises:
            ValueError: there is no block, or some have times or channels and others have not.
        """
        times, channels = (_joined(blocks, name) for name in ("times", "channels"))
        return cls(
            np.concatenate([block.major for block in blocks]),
            np.concatenate([block.status for block in blocks]),
            concatenate([block.components for block in blocks]),
            times,
            channels,
        )

    def __len__(self) -> int:
        return len(self.major)

    def __getitem__(self, part: slice | NDArray[np.bool_ | np.int64]) -> VectorBlock:
        """Some of the results: a slice, or those a mask (R,) or numbers of rows name."""
        times = None if self.times is None else self.times[part]
        channels = None if self.channels is None else self.channels[part]
        components = self.components[part]
        return VectorBlock(self.major[part], self.status[part], components, times, channels)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns of its rows."""
        count = 2 + self.components.shape[1]
        found = next((each for each in EVERY_COLUMNS if len(each) == count), None)
        return HIGH_RESOLUTION_COLUMNS[:count] if found is None else found

    def vector(self, name: str) -> Integers:
        """A vector by its name, (R, 3).

        Raises:
            ValueError: the block has no such vector.
        """
        first = self.columns.index(f"{name}_x") - 2
        return self.components[:, first : first + 3]

    def named_columns(self) -> dict[str, NDArray[Any]]:
        """`major`, `status`, the components, and what there is of `channel` and `time_s` (s)."""
        columns: dict[str, NDArray[Any]] = {"major": self.major, "status": self.status}
        columns |= vector_columns(self.columns[2:], np.asarray(self.components))
        others = {"channel": self.channels, "time_s": self.times}
        return columns | {name: told for name, told in others.items() if told is not None}

    def to_numpy(self) -> NDArray[Any]:
        """All integers (R, 2 + components) in the order of `columns`, exact.

        `times` and `channels` stay apart.

        The dtype is int64, or object (Python integers) where the design has a component of more
        than 64 bits.
        """
        return np.column_stack([self.major, self.status, np.asarray(self.components)])

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


def _joined(blocks: Sequence[VectorBlock], name: str) -> NDArray[Any] | None:
    """One of the columns that blocks may lack, of all of them."""
    there = [getattr(block, name) is not None for block in blocks if len(block)]
    if any(there) and not all(there):
        raise ValueError(f"blocks with and without {name} cannot be joined")
    parts = [getattr(block, name) for block in blocks]
    parts = [part for part in parts if part is not None]
    return np.concatenate(parts) if parts else None
