"""Which of many designs a test runs on at every change, and which before a release.

`make test` leaves out what is marked `deep`, `make test-deep` runs all.  A test over many designs
takes at every change a cover of them: few designs that have every feature that any of them has.
The generated bench, which holds all ports on all clocks, takes a pairwise cover: every two features
that meet in any design, such as a target and a hand-over, or a width and a kind of table, meet in
one of the few; and every family is among them.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from itertools import combinations
from typing import Any

import pytest

from sculler_model.design import Design

Met = tuple[tuple[str, object], ...]


def _widest(design: Design) -> int:
    return max(design.sensor.gyro.bits, design.sensor.accel.bits)


def _multipliers(design: Design) -> str:
    """Of the compact core one is the rule; of the pipelined core as many as it takes."""
    wanted = design.hardware.multipliers
    return "as they come" if wanted is None else "some" if wanted else "none"


def _table(design: Design) -> str:
    """How the coefficients come about."""
    family = design.algorithm.family
    if family == "table":
        return "given"
    return "closed form" if family in ("frequency-taylor", "filtered-rate") else "solved for"


FEATURES: dict[str, Callable[[Design], object]] = {
    "target": lambda design: design.hardware.target,
    "core": lambda design: design.hardware.core,
    "handover": lambda design: design.hardware.handover,
    "overrun": lambda design: design.hardware.overrun,
    "multipliers": _multipliers,
    "kind": lambda design: design.sensor.kind,
    # a block takes 18 bits; sums of 24-bit products fit 64
    "bits": lambda design: sum(_widest(design) > most for most in (18, 24)),
    "table": _table,
    "position": lambda design: design.high_resolution,
    "history": lambda design: design.table.history >= design.algorithm.samples,
    "dense": lambda design: len(design.table.active_phases) > 1,
    "one minor": lambda design: design.algorithm.minors == 1,
}
"""What may make one core differ from another."""


def met(design: Design, together: int) -> frozenset[Met]:
    """Every feature of a design; or every two that meet, and its family."""
    found = set(combinations([(name, of(design)) for name, of in FEATURES.items()], together))
    if together > 1:
        found.add((("family", design.algorithm.family),))
    return frozenset(found)


def _effort(design: Design) -> float:
    """How long emitting its core and compiling a simulator takes, about."""
    words = design.sensor.gyro.bits + design.sensor.accel.bits + 3 * design.algorithm.samples
    core = 60 * (design.hardware.core == "pipelined") * (3 if design.high_resolution else 1)
    return words + design.samples_per_major / 4 + core


def _seconds(design: Design) -> float:
    """Seconds of emitting its core and simulating it in Icarus, about: measured on a few."""
    bits = design.sensor.gyro.bits + design.sensor.accel.bits
    blocks = design.hardware.target == "ecp5"  # whose models are slow
    if design.hardware.core == "pipelined":
        return max(1.3, (bits - 12) / 4) * (1.5 if design.high_resolution else 1) + blocks
    return 0.8 + bits * (0.07 if blocks else 0.01)


def cover(designs: Mapping[str, Design], together: int = 1) -> list[str]:
    """Names of few designs in which everything is met that is met in any of them."""
    offered = {name: met(design, together) for name, design in designs.items()}
    missing: set[Met] = set().union(*offered.values())
    cost = _effort if together == 1 else _seconds
    chosen: list[str] = []
    while missing:
        best = max(offered, key=lambda name: len(offered[name] & missing) / cost(designs[name]))
        chosen.append(best)
        missing -= offered[best]
    return sorted(chosen, key=list(designs).index)


def tiers(
    designs: Mapping[str, Design], also: Collection[str] = (), together: int = 1
) -> list[Any]:
    """Parameters of a test that goes over designs: what is not in their cover is deep.

    Args:
        designs: by name.
        also: names of more of them to run at every change.
        together: 2 for a pairwise cover.
    """
    return few_of(designs, [*cover(designs, together), *also])


def few_of(cases: Mapping[str, Any] | Collection[Any], quick: Collection[Any]) -> list[Any]:
    """Parameters of a test: the cases, or names, that are not among these are deep."""
    assert set(quick) <= set(cases)
    every = cases.items() if isinstance(cases, Mapping) else ((case, case) for case in cases)
    return [
        pytest.param(case, id=str(name), marks=[] if name in quick else pytest.mark.deep)
        for name, case in every
    ]
