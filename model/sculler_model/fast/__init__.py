"""The golden model's vectorised twin: the same integers, block by block, in numpy.

`FastModel` streams arrays of counts to `VectorBlock`s.  It imports `algorithms`, `design`, and of
`golden` only what the two must agree on by definition.
"""

from sculler_model.fast.blocks import VectorBlock, component_limbs
from sculler_model.fast.channels import FastChannels, channel_runs
from sculler_model.fast.compensation import FastCompensator
from sculler_model.fast.model import FastModel, run_fast
from sculler_model.fast.wide import Integers, WideIntegers, as_integers, from_limbs, limbs_of

__all__ = [
    "FastChannels",
    "FastCompensator",
    "FastModel",
    "Integers",
    "VectorBlock",
    "WideIntegers",
    "as_integers",
    "channel_runs",
    "component_limbs",
    "from_limbs",
    "limbs_of",
    "run_fast",
]
