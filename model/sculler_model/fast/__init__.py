"""The golden model's vectorised twin: the same integers, block by block, in numpy.

`FastModel` streams arrays of counts to `VectorBlock`s.  It imports `algorithms`, `design`, and of
`golden` only what the two must agree on by definition.
"""

from sculler_model.fast.blocks import VectorBlock, component_dtype
from sculler_model.fast.twin import FastModel, run_fast

__all__ = [
    "FastModel",
    "VectorBlock",
    "component_dtype",
    "run_fast",
]
