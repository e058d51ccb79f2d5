"""The designs that mutants are made of."""

from __future__ import annotations

from sculler_model.design import Design
from sculler_sim.prove.shapes import SHAPES as PROVED


def _three_for_two(design: Design) -> Design:
    """The design, with M = 3 where it has M = 2.

    With two minor intervals the first product of a sum between minor intervals is 0 and the second
    is its last: when such a sum begins and ends then often makes no difference.
    """
    algorithm = design.algorithm
    if algorithm.minors != 2:
        return design
    return design.model_copy(update={"algorithm": algorithm.model_copy(update={"minors": 3})})


SHAPES: dict[str, Design] = {name: _three_for_two(design) for name, design in PROVED.items()}
"""By name: those of the proofs, with another minor interval where they have two."""
