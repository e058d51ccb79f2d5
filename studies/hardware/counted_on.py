"""The rates that `sculler_hdl.rates` tells, and their section on the page."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path

from sculler_hdl import Placed, kind_of, rate_of
from sculler_model.outputs import replacing
from sculler_sim.place.placement import Placement
from studies import documents
from studies.hardware.points import Point

FILE = Path("hdl/sculler_hdl/placed.json")
"""Where the library keeps them."""

Found = Sequence[tuple[Point, Placement]]


def rows(placed: Found, differed: Found) -> list[Placed]:
    """What of the placements is kept.

    Args:
        placed: the points of the page, of which the core was tuned with some in view.
        differed: designs that nobody tuned.
    """
    return [
        Placed(
            point.key,
            point.what,
            kind_of(point.design),
            made.device,
            tuple(sorted(round(seed.mhz, 1) for seed in made.seeds)),
            tuned,
            " ".join(next(tool for tool in made.tools.items() if "nextpnr" in tool[0])),
        )
        for found, tuned in ((placed, True), (differed, False))
        for point, made in found
        if made.seeds
    ]


def write(path: Path, kept: Sequence[Placed]) -> None:
    """Write them for the library, a design a line.

    Raises:
        InputError: the file cannot be written to.
    """
    lines = ",\n".join(json.dumps(one.as_json()) for one in kept)
    with replacing(path) as temporary:
        temporary.write_text(f"[\n{lines}\n]\n", encoding="utf-8")


def section(kept: Sequence[Placed]) -> Iterator[str]:
    """For which designs which rate may be counted on."""
    yield "## Rates to count on"
    yield documents.paragraph(
        "`sculler advise` and the key `expected_rate` of the manifest tell these. A class is the"
        " core, the width of the wider counts, the target, and what else was found to change the"
        " rate or was never placed: a dense tap table, high-resolution position, third and fourth"
        " order, fewer multipliers, results as a stream or dropped, compensation, hardening,"
        " channels, a clock enable, an asynchronous reset. Of a class the slowest of"
        " the designs that nobody tuned counts, by the median of its seeds. Where none was placed"
        " there is no figure: then they say so, and name the nearest design."
    )
    yield ""
    untuned = [one for one in kept if not one.tuned]
    groups = {one.kind.group: one.kind for one in untuned}
    yield from documents.table(
        "lrl",
        ("class", "MHz", "basis"),
        (
            (str(kind), f"{rate.mhz:.1f}", rate.basis.replace(f" of its class ({kind})", ""))
            for kind in groups.values()
            for rate in [rate_of(kind, kept)]
        ),
    )
