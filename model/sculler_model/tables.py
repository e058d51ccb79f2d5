"""What has a row for each interval or instant, as named columns: for numpy, and for pandas."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError

if TYPE_CHECKING:
    import pandas as pd


class Table:
    """Named columns of one length; who inherits says which (`named_columns`)."""

    def named_columns(self) -> dict[str, NDArray[Any]]:
        """The columns (R,) by name, in order; what is not told has none."""
        raise NotImplementedError

    def to_numpy(self) -> NDArray[Any]:
        """All columns as one array (R, columns), in the order of `named_columns`."""
        return np.column_stack(list(self.named_columns().values()))

    def to_pandas(self) -> pd.DataFrame:
        """A frame with the columns of `named_columns` and an index from 0.

        Integers stay exact: int64 columns stay int64, and components wider than 64 bits are
        columns of dtype object that hold Python integers.

        Raises:
            InputError: pandas is not installed.
        """
        try:
            import pandas as pd
        except ImportError as error:
            raise InputError("to_pandas: needs pandas: install sculler[frames]") from error
        return pd.DataFrame(self.named_columns())


def vector_columns(names: tuple[str, ...], vectors: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """The columns of an array (R, len(names)) by their names."""
    return {name: vectors[:, i] for i, name in enumerate(names)}
