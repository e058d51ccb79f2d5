"""Designs chosen to differ, by class: the rate that a design nobody tuned may count on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

from sculler_model.design import Design
from sculler_sim.place.placement import Placement
from studies import documents
from studies.hardware.points import Point, variant


@dataclass(frozen=True)
class Class:
    """Designs of one class.

    Attributes:
        name: in words.
        goal: clock rate (MHz) asked of the median of the worst design; by family.
        points: the designs.
    """

    name: str
    goal: dict[str, float]
    points: tuple[Point, ...]


def _design(
    name: str, bits: int, n: int, p: int, minors: int, target: str = "ecp5", **more: Any
) -> Design:
    """A sensor of so many bits; `more` has algorithm, kind and hardware keys."""
    hardware = {"core": "pipelined", "target": target, **more.pop("hardware", {})}
    algorithm = {"samples": n, "history": p, "minors": minors, **more.pop("algorithm", {})}
    kind = more.pop("kind", "increment")
    sensor = {
        "kind": kind,
        "sample_rate_hz": 2000.0,
        "gyro": {"bits": bits, "lsb": 1e-3 if kind == "rate" else 2.0**-bits / 4},
        "accel": {"bits": bits, "lsb": 1e-2 if kind == "rate" else 2.0**-bits * 8},
    }
    algorithm.setdefault("family", "filtered-rate" if kind == "rate" else "frequency-taylor")
    return Design.parse(
        {"name": name, "sensor": sensor, "algorithm": algorithm, "hardware": hardware}
    )


def _point(key: str, what: str, design: Design, device: str) -> Point:
    speed = 6 if device.startswith("LFE5U") else None
    return Point(key, what, design, device, speed)


SMALL, MIDDLE, BIG = "LFE5U-25F", "LFE5U-45F", "LFE5U-85F"
DENSE: dict[str, Any] = {"algorithm": {"family": "time-taylor"}}
LOOSE: dict[str, Any] = {"algorithm": {"family": "uncompressed"}}
HIGH: dict[str, Any] = {"algorithm": {"position": "high-resolution"}}


def classes() -> tuple[Class, ...]:
    """The sixteen, by class."""
    return (
        Class("up to 18 bits", {"ecp5": 250}, _to_18_bits()),
        Class("19 to 24 bits", {"ecp5": 230}, _to_24_bits()),
        Class("25 to 32 bits", {"ecp5": 200}, _to_32_bits()),
        Class("high-resolution, 24 bits", {"ecp5": 200}, _high_resolution()),
        Class("compact", {"ecp5": 180, "ice40": 48}, _compact()),
    )


def _to_18_bits() -> tuple[Point, ...]:
    long = "16-bit, n = 1, p = 1, M = 64"
    return (
        _point("c16-n6", "16-bit, n = 6", _design("c16_n6", 16, 6, 0, 5), MIDDLE),
        _point("c16-n1", long, _design("c16_n1", 16, 1, 1, 64), MIDDLE),
        _point("c18-n2", "18-bit, n = 2, p = 2, M = 8", _design("c18_n2", 18, 2, 2, 8), MIDDLE),
        _point("c18-n4", "18-bit, n = 4", _design("c18_n4", 18, 4, 0, 5), SMALL),
    )


def _to_24_bits() -> tuple[Point, ...]:
    rates = "20-bit rates, n = 4, p = 1, Newton-Cotes weights"
    stream = _design("c24_n8", 24, 8, 0, 1, hardware={"handover": "stream"})
    shared = _design("c24_28", 24, 4, 0, 5, hardware={"multipliers": 28})
    time_taylor, uncompressed = (
        "24-bit, dense, time-taylor, n = 4",
        "24-bit, dense, uncompressed, n = 3",
    )
    return (
        _point("c20-n3", "20-bit, n = 3, p = 1", _design("c20_n3", 20, 3, 1, 4), BIG),
        _point("c20-rate", rates, _design("c20_rate", 20, 4, 1, 5, kind="rate"), BIG),
        _point("c24-dense4", time_taylor, _design("c24_dense4", 24, 4, 0, 5, **DENSE), BIG),
        _point("c24-dense3", uncompressed, _design("c24_dense3", 24, 3, 0, 5, **LOOSE), BIG),
        _point("c24-n8", "24-bit, n = 8, M = 1, as a stream", stream, BIG),
        _point("c24-28", "24-bit, n = 4, 28 multipliers", shared, SMALL),
    )


def _to_32_bits() -> tuple[Point, ...]:
    dense = _design("c32_dense5", 32, 5, 0, 2, **LOOSE)
    return (
        _point("c32-n4", "32-bit, n = 4", _design("c32_n4", 32, 4, 0, 5), BIG),
        _point("c32-dense5", "32-bit, dense, uncompressed, n = 5", dense, BIG),
    )


def _high_resolution() -> tuple[Point, ...]:
    design = _design("c24_high", 24, 4, 0, 5, **HIGH)
    return (_point("c24-high", "24-bit, high-resolution", design, BIG),)


def _compact() -> tuple[Point, ...]:
    past = _design("k16_n6", 16, 6, 2, 3, hardware={"core": "compact"})
    wide = variant(32, "k32_up5k", core="compact", target="ice40")
    return (
        _point("k24", "24-bit, compact", variant(24, "k24", core="compact", target="ecp5"), SMALL),
        _point("k16-n6", "16-bit, n = 6, p = 2, compact", past, SMALL),
        _point("k32-up5k", "32-bit, compact", wide, "iCE40UP5K"),
    )


Found = tuple[Point, Placement]


def spread(found: Sequence[Found]) -> Iterator[str]:
    """The section of those that were placed: worst, median, best of each design, and the goals."""
    yield "## Rates that hold"
    sixteen = sum(len(group.points) for group in classes())
    yield documents.paragraph(
        f"Designs that nobody tuned, chosen to differ; ECP5 -6. These are {len(found)} of"
        f" {sixteen}, asked for by `python -m studies.hardware"
        + "".join(f" --differing {point.key}" for point, _ in found)
        + "`; `--classes` places all and shows them, which takes hours. The goal is for the median"
        " of the worst design of a class."
    )
    yield ""
    rows, goals = [], []
    for group in classes():
        mine = [(point, made) for point, made in found if point in group.points]
        for point, made in mine:
            rates = sorted(seed.mhz for seed in made.seeds)
            rows.append(
                (
                    group.name,
                    point.what,
                    made.device,
                    *(f"{rate:.1f}" for rate in (rates[0], median(rates), rates[-1])),
                    f"{made.latency_clocks}",
                )
            )
        for family, goal in group.goal.items():
            medians = [
                (median(seed.mhz for seed in made.seeds), point.what)
                for point, made in mine
                if point.design.hardware.target == family
            ]
            if medians:
                worst, what = min(medians)
                goals.append(
                    (
                        f"{group.name}, {family}",
                        f"≥ {goal:g} MHz",
                        f"{worst:.1f} MHz ({what}; of {len(medians)})",
                        "yes" if worst >= goal else "**no**",
                    )
                )
    headings = ("class", "design", "device", "worst", "median", "best", "latency, clocks")
    yield from documents.table("lllrrrr", headings, rows)
    yield ""
    yield from documents.table("llll", ("class", "asked", "found", "holds"), goals)
