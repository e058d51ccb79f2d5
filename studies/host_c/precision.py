"""What each precision of the host's numbers leaves, against the host in Python."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import degrees

import numpy as np

from sculler.host_c import PRECISIONS, HostInC, NavigatorInC, Precision
from sculler.library import motions
from sculler_model.design import Design
from sculler_model.fast import FastModel, VectorBlock
from sculler_model.host import major_increments
from sculler_model.navigation import Navigator, NavState, navigation_errors
from studies import documents

SECONDS = 3600.0
MOTIONS = ("rest", "turn", "flight")
DESIGN = Design.preset("stim300", position="high-resolution")


@dataclass(frozen=True)
class Left:
    """The largest difference from the host in Python after any interval.

    Attributes:
        motion: its name.
        precision: of the numbers.
        attitude: arc seconds.
        velocity: m/s.
        horizontal: m.
        height: m.
    """

    motion: str
    precision: Precision
    attitude: float
    velocity: float
    horizontal: float
    height: float


def left(
    names: Sequence[str] = MOTIONS,
    seconds: float = SECONDS,
    advance: Callable[[int], None] = lambda steps: None,
) -> list[Left]:
    """What every precision leaves over motions, from the core's integers on."""
    found = []
    for name in names:
        found += list(_left_by(name, seconds))
        advance(1)
    return found


def _flown(name: str, seconds: float) -> tuple[VectorBlock, NavState]:
    """The core's results over a motion, and the state before the first of them."""
    moving = motions.motion(name)
    block = FastModel(DESIGN).feed(motions.record(DESIGN, moving, seconds).counts)[1:]
    return block, moving.state(np.full(1, DESIGN.major_interval)).state(0)


def _left_by(name: str, seconds: float) -> Iterator[Left]:
    block, start = _flown(name, seconds)
    expected = Navigator(start, DESIGN.major_interval).run(major_increments(DESIGN, block))
    for precision in PRECISIONS:
        host = HostInC(DESIGN, precision=precision)
        found = NavigatorInC(host, start).run(host.increments(block))
        errors = navigation_errors(found, expected)
        yield Left(
            name,
            precision,
            3600 * degrees(float(np.max(np.linalg.norm(errors.attitude, axis=1)))),
            float(np.max(np.linalg.norm(errors.velocity, axis=1))),
            float(np.max(errors.horizontal)),
            float(np.max(np.abs(errors.position[:, 2]))),
        )


def section(found: Sequence[Left], seconds: float = SECONDS) -> Iterator[str]:
    """The page's section."""
    yield "## Numbers of less than a double"
    yield documents.paragraph(
        "Where hardware has single precision alone the library computes in pairs of floats when it"
        " is compiled as C++ with `SCULLER_DOUBLE_SINGLE` (`sculler_real.h`), or in floats with"
        f" `SCULLER_SINGLE`. Over {seconds:g} s of a motion, from the same integers of the core"
        f" (`{DESIGN.name}`, high-resolution position, {1 / DESIGN.major_interval:g} updates a"
        " second), states differ from those of the host in Python by at most:"
    )
    yield ""
    rows = [
        (
            one.motion,
            one.precision,
            *(f"{value:.1e}" for value in (one.attitude, one.velocity, one.horizontal, one.height)),
        )
        for one in found
    ]
    headings = ("motion", "numbers", "attitude, ″", "velocity, m/s", "position, m", "height, m")
    yield from documents.table("llrrrr", headings, rows)
    yield ""
    yield documents.paragraph(
        "Double-single is far below what any sensor leaves. Single precision is not for"
        " navigation: a float of latitude has steps of half a metre, and what an interval adds to"
        " it is smaller."
    )
