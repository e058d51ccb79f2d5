"""Vectors files in memory, and the first difference of two runs."""

from __future__ import annotations

from pathlib import Path

from sculler.formats import comparison
from sculler.formats import vectors as files
from sculler.formats.comparison import Difference
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock


def read_vectors(
    path: str | Path, design: Design | None = None, channel: int | None = None
) -> VectorBlock:
    """Read a vectors file (docs/reference/vectors.md) whole.

    Args:
        path: of the file; its ending says which kind, `.npz`, `.parquet` or CSV.
        design: whose vectors they are: every component is checked against its width; None where
            nobody knows.
        channel: whose results to read, of a file of many channels.

    Returns:
        The results of R major intervals, in the sensor's axes, exact integers.

    Raises:
        InputError: the file cannot be read or has a fault; its line is named.

    Examples:
        >>> import numpy as np, sculler
        >>> design = sculler.Design.preset("stim300")
        >>> block = sculler.FastModel(design).feed(np.full((40, 6), 7))
        >>> sculler.write_vectors("vectors.csv", block)
        >>> sculler.read_vectors("vectors.csv", design).major.tolist()
        [0, 1]
    """
    blocks = list(files.read_vectors(path, design, missing=True, channel=channel))
    if not blocks:
        raise InputError(f"{path}: no results, give a longer log")
    return VectorBlock.concatenate(blocks)


def write_vectors(path: str | Path, vectors: VectorBlock, design: Design | None = None) -> None:
    """Write a vectors file (docs/reference/vectors.md); it appears whole or not at all.

    Args:
        path: of the file; its ending says which kind, `.npz`, `.parquet` or CSV.
        vectors: the results; where they have times there is a column `time_s`.
        design: whose they are, which tells a binary file how wide each column is; None for columns
            as wide as the widest component.

    Raises:
        InputError: the file cannot be written.

    Examples:
        >>> import numpy as np, sculler
        >>> design = sculler.Design.preset("stim300")
        >>> block = sculler.FastModel(design).feed(np.ones((20, 6), int))
        >>> sculler.write_vectors("vectors.csv", block)
        >>> from pathlib import Path
        >>> Path("vectors.csv").read_text().splitlines()[1][:10]
        '0,0,20,20,'
    """
    with files.VectorsWriter(path, vectors.columns, design=design) as writer:
        writer.write(vectors)


def compare(first: VectorBlock | str | Path, second: VectorBlock | str | Path) -> Difference | None:
    """The first difference of two runs, or None where every integer is the same.

    Where both have times these are compared too; where one has none, that is no difference.

    Args:
        first, second: results, or the paths of vectors files.

    Returns:
        Where they first differ: `row`, `major`, `column`, and the two values; None for identical.

    Raises:
        InputError: a file cannot be read or has a fault, or the two have other columns.

    Examples:
        >>> import numpy as np, sculler
        >>> design, counts = sculler.Design.preset("stim300"), np.ones((40, 6), int)
        >>> block = sculler.FastModel(design).feed(counts)
        >>> counts[25, 0] = 2
        >>> other = sculler.FastModel(design).feed(counts)
        >>> sculler.compare(block, block) is None
        True
        >>> found = sculler.compare(block, other)
        >>> found.major, found.column, found.first, found.second
        (1, 'alpha_x', 20, 21)
    """
    if not isinstance(first, VectorBlock) and not isinstance(second, VectorBlock):
        return comparison.compare(first, second)
    one, other = (
        each if isinstance(each, VectorBlock) else read_vectors(each) for each in (first, second)
    )
    if one.columns != other.columns:
        raise InputError(
            f"compare: {len(one.columns)} columns and {len(other.columns)}, give vectors of one"
            " design"
        )
    return comparison.difference(one, other)
