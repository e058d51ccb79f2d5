"""The clock rate that a design may count on, from designs that were placed and routed.

`placed.json` beside this file has them.  `make hardware` writes it with its page,
docs/explanation/hardware.md.  A design's class is its core, its target, for the pipelined core its
width, and what of it was found to change the rate or was never placed: a dense tap table,
high-resolution position, third and fourth order, fewer multipliers, results as a stream or dropped,
compensation, hardening, channels, a clock enable, an asynchronous reset.

The rate to count on is the median over the seeds of the slowest placed design of the class, of
those that nobody tuned.  Where there is none, there is no figure.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from importlib import resources
from statistics import median
from typing import Any

from sculler_model.design import Design

WIDTHS = (18, 24, 32)
"""Widest counts of the pipelined core's classes, bits: a multiplier block takes 18."""


@dataclass(frozen=True)
class Kind:
    """What of a design decides the clock rate.

    Attributes:
        core: "pipelined" or "compact".
        target: as `hardware.target`.
        bits: of the wider of both sensors' counts.
        further: what else counts, in words.
    """

    core: str
    target: str
    bits: int
    further: tuple[str, ...] = ()

    @property
    def limit(self) -> int:
        """Widest counts of its class, bits."""
        if self.core == "compact":  # its engine is the same for all
            return WIDTHS[-1]
        return next(width for width in WIDTHS if self.bits <= width)

    @property
    def group(self) -> tuple[object, ...]:
        """Equal where two are of one class."""
        return self.core, self.target, self.limit, self.further

    def __str__(self) -> str:
        """The class in words."""
        below = [0, *WIDTHS][WIDTHS.index(self.limit)]
        if self.core == "compact":
            width = ""
        else:
            width = f", {below + 1} to {self.limit} bits" if below else f", up to {self.limit} bits"
        return f"{self.core}{width}{''.join(f', {each}' for each in self.further)}; {self.target}"


@dataclass(frozen=True)
class Placed:
    """A design that was placed and routed.

    Attributes:
        key: its name in the study.
        what: the design in words.
        kind: what of it decides the rate.
        device: with its speed grade.
        mhz: clock rates, one a seed, the slowest first.
        tuned: whether the core was tuned with this design in view.
        tool: what routed it, with its version.
    """

    key: str
    what: str
    kind: Kind
    device: str
    mhz: tuple[float, ...]
    tuned: bool
    tool: str

    @property
    def median(self) -> float:
        """MHz."""
        return median(self.mhz)

    def as_json(self) -> dict[str, Any]:
        """As it stands in the file."""
        return asdict(self)

    @classmethod
    def of_json(cls, data: dict[str, Any]) -> Placed:
        """What `as_json` gave."""
        kind = Kind(**data["kind"] | {"further": tuple(data["kind"]["further"])})
        return cls(**data | {"kind": kind, "mhz": tuple(data["mhz"])})


@dataclass(frozen=True)
class ExpectedRate:
    """A clock rate to count on.

    Attributes:
        mhz: MHz; None where no design of the class was placed.
        basis: what it rests on, in one line; or that nothing was placed, and what is nearest.
    """

    mhz: float | None
    basis: str


def kind_of(design: Design) -> Kind:
    """What of a design decides the clock rate of its core; bus and front end are beside it."""
    algorithm, hardware = design.algorithm, design.hardware
    compact = hardware.core == "compact"
    there = {
        "dense table": not compact and len(design.table.active_phases) > 1,
        "high-resolution position": algorithm.position == "high-resolution",
        f"order {design.order}": design.order > 2,
        "no multiplier": hardware.multipliers == 0,
        "limited multipliers": not compact and hardware.multipliers is not None,
        "a stream": not compact and hardware.handover == "stream",
        "dropped results": design.drops_results,
        "compensation": design.compensation is not None,
        f"hardening {hardware.hardening}": hardware.hardening is not None,
        "channels": design.channels > 1,
        "a clock enable": bool(hardware.clock_enable),
        "an asynchronous reset": hardware.resets_at_once,
    }
    bits = max(design.sensor.gyro.bits, design.sensor.accel.bits)
    further = tuple(name for name, present in there.items() if present)
    return Kind(hardware.core, hardware.target, bits, further)


@lru_cache(maxsize=1)
def placed_designs() -> tuple[Placed, ...]:
    """All that `placed.json` has."""
    text = resources.files("sculler_hdl").joinpath("placed.json").read_text(encoding="utf-8")
    return tuple(map(Placed.of_json, json.loads(text)))


def expected_rate(design: Design, placed: Sequence[Placed] | None = None) -> ExpectedRate:
    """The clock rate that a design's core may count on.

    Args:
        design: the design.
        placed: what it rests on; those of `placed.json` if left out.
    """
    return rate_of(kind_of(design), placed_designs() if placed is None else placed)


def rate_of(kind: Kind, placed: Sequence[Placed]) -> ExpectedRate:
    """The same of designs of a kind."""
    mine = [one for one in placed if one.kind.group == kind.group and not one.tuned]
    if not mine:
        return ExpectedRate(None, _nothing(kind, placed))
    slowest = min(mine, key=lambda one: one.median)
    count = (
        "the only placed design" if len(mine) == 1 else f"the worst of {len(mine)} placed designs"
    )
    return ExpectedRate(
        slowest.median,
        f"{count} of its class ({kind}): {slowest.what}, median of {len(slowest.mhz)} seeds, the"
        f" slowest {slowest.mhz[0]:.1f} MHz, {slowest.device}, {slowest.tool}",
    )


def _nothing(kind: Kind, placed: Sequence[Placed]) -> str:
    """That there is no figure, and what is nearest of the same core in the same target."""
    near = [one for one in placed if (one.kind.core, one.kind.target) == (kind.core, kind.target)]
    if not near:
        return f"not placed: no {kind.core} core with target {kind.target} was"

    def distance(one: Placed) -> tuple[int, int, float]:
        further = len({*one.kind.further} ^ {*kind.further})
        return further, abs(one.kind.bits - kind.bits), one.median

    best = min(near, key=distance)
    return (
        f"not placed: no design of its class ({kind}) was; the nearest is {best.what},"
        f" {best.median:.1f} MHz, {best.device}"
    )
