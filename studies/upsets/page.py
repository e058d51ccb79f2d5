"""Writes docs/explanation/hardening.md."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib.resources import files

from sculler_sim.place.placement import Placement
from studies.documents import table
from studies.upsets.kept import Count
from studies.upsets.shapes import MODES, Place

_LUTS, _RATE = 30, 5
"""Per cent of look-up tables and of the clock rate that "detect" was to cost at most."""

Placements = Mapping[tuple[Place, str], Placement | None]

_KINDS = ("masked", "seen", "flagged", "late", "stops", "silent", "hang")


def page(
    counts: Mapping[tuple[str, str], Count],
    placements: Placements,
    option: str,
) -> Iterator[str]:
    """The lines of the page.

    Args:
        counts: what came of the flips, by mode and core.
        placements: by core with its device, and mode.
        option: with which the memories' bits were chosen.
    """
    yield _text("about")
    yield from _campaign(counts, option)
    yield from _area(placements)


def _text(name: str) -> str:
    """A piece of the page that no figure changes."""
    place = files("studies.upsets").joinpath("texts", f"{name}.md")
    return place.read_text(encoding="utf-8")


def _campaign(counts: Mapping[tuple[str, str], Count], option: str) -> Iterator[str]:
    yield "## The campaign"
    bits = "each bit of each word" if option else "each word at a random bit"
    yield _text("campaign").format(bits=bits)
    head = ["core", "flip-flops", "memory bits", "flips", *_KINDS, "lasting"]
    for mode in MODES:
        rows = {what: count for (of, what), count in counts.items() if of == mode}
        yield f'### `hardening = "{mode}"`'
        yield ""
        cells = [[what, *_numbers(count)] for what, count in rows.items()]
        yield from table("l" + "r" * (len(head) - 1), head, [*cells, ["**all**", *_sum(rows)]])
        yield ""


def _numbers(count: Count) -> list[str]:
    numbers = [count.flip_flops, count.memory_bits, count.flips]
    return [f"{n:,}" for n in (*numbers, *(count.kinds.get(k, 0) for k in _KINDS), count.lasting)]


def _sum(rows: Mapping[str, Count]) -> list[str]:
    columns = [[int(cell.replace(",", "")) for cell in _numbers(count)] for count in rows.values()]
    return [f"{sum(column):,}" for column in zip(*columns, strict=True)]


def _area(placements: Placements) -> Iterator[str]:
    yield "## What it takes"
    yield ""
    yield _text("area")
    yield from table("lllrrrrrr", _HEAD, map(list, _rows(placements)))
    yield ""
    yield from _verdict(placements)


_HEAD = ["core", "device", "`hardening`", "LUTs", "", "flip-flops", "block RAMs", "MHz", ""]


def _rows(placements: Placements) -> Iterator[tuple[str, ...]]:
    for (place, mode), made in placements.items():
        plain = placements[place, "off"]
        if made is None or plain is None:
            yield place.what, place.device, mode, "does not fit", "", "", "", "", ""
            continue
        luts, rate = _more(made, plain)
        yield (
            place.what,
            place.device,
            mode,
            f"{made.area.luts:,}",
            "" if made is plain else f"{luts:+.0f} %",
            f"{made.area.flip_flops:,}",
            str(made.area.memories),
            f"{made.fmax_mhz:.1f}",
            "" if made is plain else f"{rate:+.0f} %",
        )


def _more(made: Placement, plain: Placement) -> tuple[float, float]:
    """Per cent more look-up tables and more MHz."""
    assert made.fmax_mhz is not None
    assert plain.fmax_mhz is not None
    return (
        100 * (made.area.luts / plain.area.luts - 1),
        100 * (made.fmax_mhz / plain.fmax_mhz - 1),
    )


def _verdict(placements: Placements) -> Iterator[str]:
    yield from table("lll", ["asked of `detect`", "found", "reached"], _judged(placements))
    yield ""
    yield _text("why")


def _judged(placements: Placements) -> Iterator[list[str]]:
    for (place, mode), made in placements.items():
        plain = placements[place, "off"]
        if mode != "detect" or made is None or plain is None:
            continue
        luts, rate = _more(made, plain)
        core = f"{place.what.partition(',')[0]}, {place.device}"
        yield [f"{core}: <= {_LUTS} % more LUTs", f"{luts:+.0f} %", _yes(luts <= _LUTS)]
        yield [f"{core}: <= {_RATE} % fewer MHz", f"{rate:+.0f} %", _yes(rate >= -_RATE)]


def _yes(reached: bool) -> str:
    return "yes" if reached else "**no**"
