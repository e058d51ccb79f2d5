"""The designs and devices of the page, and the figures asked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from sculler.words import three_digits
from sculler_model.design import Design
from sculler_sim.place.placement import Placement


@dataclass(frozen=True)
class Condition:
    """A figure asked for.

    Attributes:
        text: in words.
        reached: what the placement has of it, in words.
        met: whether that is enough.
    """

    text: str
    reached: Callable[[Placement], str]
    met: Callable[[Placement], bool]


def at_least(mhz: float) -> Condition:
    """A clock rate, in the median."""
    return Condition(
        f"≥ {mhz:g} MHz", lambda p: f"{p.fmax_mhz or 0:.1f} MHz", lambda p: (p.fmax_mhz or 0) >= mhz
    )


def at_most(limit: int, thing: str, count: Callable[[Placement], int]) -> Condition:
    """So many of a thing and no more."""
    return Condition(
        f"≤ {counted(limit, thing)}",
        lambda p: counted(count(p), thing),
        lambda p: count(p) <= limit,
    )


def counted(count: int, thing: str) -> str:
    """`1 multiplier`, `2,000 multipliers`."""
    return f"{count:,} {thing.removesuffix('s') if count == 1 else thing}"


def exactly(amount: float, thing: str, count: Callable[[Placement], float]) -> Condition:
    """So many of a thing."""
    return Condition(
        f"{amount:g} {thing}", lambda p: f"{count(p):g} {thing}", lambda p: count(p) == amount
    )


def keeps_up_with(rate: float) -> Condition:
    """Samples per second."""
    return Condition(
        f"{rate:,.0f} samples/s",
        lambda p: f"{three_digits(p.samples_per_second or 0)} samples/s",
        lambda p: (p.samples_per_second or 0) >= rate,
    )


def clocks_a_minor(limit: int) -> Condition:
    """Clocks for a minor interval."""
    return at_most(limit, "clocks a minor interval", lambda p: p.clocks_per_minor)


ONE_A_CLOCK = exactly(1, "clock a sample", lambda p: p.clocks_per_sample)
LATENCY = at_most(24, "clocks to the result", lambda p: p.latency_clocks)


def multipliers(limit: int) -> Condition:
    """Multiplier blocks."""
    return at_most(limit, "multipliers", lambda p: p.area.multipliers)


def cells(limit: int, kind: str, name: str) -> Condition:
    """Cells of the device."""
    return at_most(limit, name, lambda p: p.area.usage[kind][0])


@dataclass(frozen=True)
class Point:
    """A design in a device.

    Attributes:
        key: for `--only`.
        what: the design in words.
        design: the design.
        device: with its speed grade.
        asked: the figures asked for.
    """

    key: str
    what: str
    design: Design
    device: str
    speed: int | None = None
    asked: tuple[Condition, ...] = ()


def variant(bits: int, name: str, **hardware: Any) -> Design:
    """n = 4, p = 0, M = 5 with a sensor of 18, 24 (STIM300) or 32 bits (HG4930)."""
    preset = "hg4930" if bits == 32 else "stim300"
    data: dict[str, Any] = {"name": name, "preset": preset, "hardware": hardware}
    data["algorithm"] = {"samples": 4, "history": 0, "minors": 5}
    if bits == 18:
        data["sensor"] = {
            "gyro": {"bits": 18, "lsb": 5e-7},
            "accel": {"bits": 18, "lsb": 1.5e-5},
        }
    return Design.parse(data)


def points() -> list[Point]:
    """All of the table, in its order: first those of which something is asked."""
    return [*_pipelined(), *_compact(), *_compared()]


def _pipelined() -> list[Point]:
    fast = {"core": "pipelined", "target": "ecp5"}
    return [
        Point(
            "fast-18",
            "18-bit, pipelined",
            variant(18, "fast_18", **fast),
            "LFE5U-25F",
            6,
            (at_least(270), ONE_A_CLOCK, multipliers(28), LATENCY),
        ),
        Point(
            "fast-24",
            "24-bit, pipelined",
            variant(24, "fast_24", **fast),
            "LFE5U-85F",
            6,
            (at_least(250), ONE_A_CLOCK, LATENCY),
        ),
        Point(
            "fast-24-28",
            "24-bit, pipelined, 28 multipliers",
            variant(24, "fast_24_28", **fast, multipliers=28),
            "LFE5U-25F",
            6,
            (at_least(200), ONE_A_CLOCK, multipliers(28), LATENCY),
        ),
        Point(
            "fast-32",
            "32-bit, pipelined",
            variant(32, "fast_32", **fast),
            "LFE5U-85F",
            6,
            (at_least(220), LATENCY),
        ),
    ]


def _compact() -> list[Point]:
    small: dict[str, Any] = {"core": "compact"}
    return [
        Point(
            "compact-ecp5",
            "24-bit, compact",
            variant(24, "compact_ecp5", **small, target="ecp5"),
            "LFE5U-25F",
            6,
            (
                at_least(180),
                multipliers(1),
                at_most(700, "LUT4", lambda p: p.area.luts),
                clocks_a_minor(350),
            ),
        ),
        Point(
            "compact-up5k",
            "24-bit, compact",
            variant(24, "compact_ice40", **small, target="ice40"),
            "iCE40UP5K",
            None,
            (at_least(50), multipliers(2), cells(1500, "ICESTORM_LC", "logic cells")),
        ),
        Point(
            "compact-0-up5k",
            "24-bit, compact, no multiplier",
            variant(24, "compact_0_ice40", **small, target="ice40", multipliers=0),
            "iCE40UP5K",
            None,
            (multipliers(0), keeps_up_with(10_000)),
        ),
    ]


def _compared() -> list[Point]:
    """Other devices, of which nothing is asked."""
    small: dict[str, Any] = {"core": "compact"}
    return [
        Point(
            "compact-0-hx8k",
            "24-bit, compact, no multiplier",
            variant(24, "compact_0_ice40", **small, target="ice40", multipliers=0),
            "iCE40HX8K",
        ),
        Point(
            "compact-ecp5-8",
            "24-bit, compact",
            variant(24, "compact_ecp5", **small, target="ecp5"),
            "LFE5U-25F",
            8,
        ),
        Point(
            "fast-24-xc7",
            "24-bit, pipelined",
            variant(24, "fast_24_xilinx", core="pipelined", target="xilinx"),
            "xc7",
        ),
        Point(
            "compact-xc7",
            "24-bit, compact",
            variant(24, "compact_xilinx", **small, target="xilinx"),
            "xc7",
        ),
    ]
