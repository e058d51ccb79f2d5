"""The command line of `python -m studies.upsets`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import click

from sculler import terminal
from sculler_sim.place.devices import DEVICES
from sculler_sim.place.placement import Placement, place
from studies import documents
from studies.upsets import campaign, page
from studies.upsets.shapes import MODES, placed, shapes

PAGE = "hardening.md"

_PLACES = (("ecp5", "LFE5U-25F", 6), ("ice40", "iCE40UP5K", None))


@dataclass(frozen=True)
class Count:
    """What came of the flips of one core.

    Attributes:
        flip_flops, memory_bits: of the core, those of words that it uses.
        flips: how many.
        kinds: how many of each `Outcome.kind`.
        lasting: after which the second interval's result, or a later one, is wrong or missing.
    """

    flip_flops: int
    memory_bits: int
    flips: int
    kinds: Mapping[str, int]
    lasting: int


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
    the golden model's.  It takes half an hour; with --every-bit, an hour.
    """
    counts: dict[tuple[str, str], Count] = {}
    for mode in MODES if only is None else (only,):
        for what in shapes(mode):
            count = counts[mode, what] = measure(mode, what, flips, every_bit, seed)
            terminal.report({}, False, f"{mode}, {what}: {count.flips} flips, {dict(count.kinds)}")
    if only is not None:
        return
    placements = dict(placements_of())
    text = "\n".join(page.page(counts, placements, "--every-bit" if every_bit else ""))
    documents.write_page(folder / PAGE, text)


def measure(mode: str, what: str, flips: int, every_bit: bool, seed: int) -> Count:
    """Turn the bits of one core over."""
    core = campaign.prepare(shapes(mode)[what])
    planned = campaign.plan(core, flips, every_bit=every_bit, seed=seed)
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


def placements_of() -> Iterator[tuple[tuple[str, str], Placement | None]]:
    """The preset in each device, plain and hardened; None where it does not fit."""
    for target, name, speed in _PLACES:
        for mode in MODES:
            if (target, mode) == ("ice40", "recover"):  # 36 block memories of 30
                yield (name, mode), None
                continue
            yield (name, mode), place(placed(target, mode), DEVICES[name], speed)
