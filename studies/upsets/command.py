"""The command line of `python -m studies.upsets`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import click

from sculler import terminal
from sculler.words import silent
from sculler_model.design import Design
from sculler_sim.place.placement import Placement
from studies import documents
from studies.hardware.kept import Kept as KeptPlacements
from studies.upsets import campaign, page
from studies.upsets.kept import FILE, Count, Flips, Kept
from studies.upsets.shapes import MODES, Place, hardened, places, shapes

PAGE = "hardening.md"

PLACED = Path("studies/upsets/placed.json")
SEEDS = (1, 2, 3)


@click.command(
    epilog=terminal.examples(
        f"python -m studies.upsets -o {documents.PAGES}",
        "python -m studies.upsets --only detect --flips 2",
    )
)
@documents.folder_option(PAGE)
@click.option("--flips", default=1, show_default=True, help="Flips of each flip-flop.")
@click.option("--every-bit", is_flag=True, help="Every bit of the memories, not one of each word.")
@click.option("--seed", default=1, show_default=True, help="Of the random clocks and bits.")
@click.option(
    "--only", type=click.Choice(MODES), help="Cores hardened in this way, shown and not written."
)
def command(folder: Path, flips: int, every_bit: bool, seed: int, only: str | None) -> None:
    """Turn bits of six cores over while they run, and place hardened cores beside plain ones.

    Each run turns one bit over, of a flip-flop or of a memory, after a random clock of the second
    or third major interval, and compares all results with those of the undisturbed core, which are
    the golden model's.  It takes half an hour; with --every-bit, an hour; and as long again to
    place.  What came of a core is kept: only a core that has changed is run or placed again.
    """
    chosen, kept = Flips(flips, every_bit, seed), Kept(FILE)
    counts: dict[tuple[str, str], Count] = {}
    for mode in MODES if only is None else (only,):
        for what, design in shapes(mode).items():
            count = kept.find(design, chosen)
            if count is None:
                count = measure(design, chosen)
                kept.add(design, chosen, count)
            counts[mode, what] = count
            terminal.report({}, False, f"{mode}, {what}: {count.flips} flips, {dict(count.kinds)}")
    if only is not None:
        return
    placed = KeptPlacements(PLACED)
    placements = dict(placements_of(placed))
    placed.drop_others()
    text = "\n".join(page.page(counts, placements, "--every-bit" if every_bit else ""))
    documents.write_page(folder / PAGE, text)


def measure(design: Design, flips: Flips) -> Count:
    """Turn the bits of one core over."""
    core = campaign.prepare(design)
    planned = campaign.plan(core, flips.of_each, every_bit=flips.every_bit, seed=flips.seed)
    kinds: Counter[str] = Counter()
    lasting = 0
    for _, outcome in campaign.run(core, planned):
        kinds[outcome.kind] += 1
        lasting += not outcome.right_within_two
    registers = sum(state.size for state in core.states if state.words is None)
    memories = sum(
        campaign.used_words(core, state) * state.bits
        for state in core.states
        if state.words is not None
    )
    return Count(registers, memories, len(planned), dict(kinds), lasting)


def placements_of(
    kept: KeptPlacements,
) -> Iterator[tuple[tuple[Place, str], Placement | None]]:
    """Each core in its device, plain and hardened; None where it does not fit."""
    for one in places():
        for mode in MODES:
            if mode not in one.fits:
                yield (one, mode), None
                continue
            design = hardened(one.design, mode)
            yield (one, mode), kept.place(design, one.device, one.speed, SEEDS, silent)
