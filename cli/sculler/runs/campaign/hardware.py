"""Some of a campaign's runs through the hardware: every integer beside the fast twin's."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sculler.formats.comparison import difference
from sculler.runs.campaign.flights import felt
from sculler.runs.campaign.plan import Campaign
from sculler.runs.engines import choose_engine
from sculler.words import plural
from sculler_model.design import Design
from sculler_model.fast import FastModel, VectorBlock
from sculler_model.outputs import replacing
from sculler_model.samples import Imperfect, Quantiser

if TYPE_CHECKING:
    from sculler_sim.engine import EngineName
    from sculler_sim.run import Chunk

_CHUNK = 4096  # samples: what waits to be compared stays small


@dataclass(frozen=True)
class Held:
    """A run held against the hardware.

    Attributes:
        design: its label.
        seed: of the run.
        engine: what simulated it.
        samples, results: how many went through.
        different: the first difference in words; None if every integer is the same.
    """

    design: str
    seed: int
    engine: str
    samples: int
    results: int
    different: str | None


def held_against_hardware(campaign: Campaign, parts: Path) -> list[Held]:
    """The runs that `[rtl]` asks for; what is done stays done, in `parts`.

    Args:
        campaign: the campaign.
        parts: a folder.

    Raises:
        InputError: a simulator is missing, or a count does not fit the sensor.
        SimulationError: a core hangs.
    """
    table = campaign.tables.rtl
    if table is None:
        return []
    found = []
    for number, label in enumerate(campaign.labels):
        for seed in campaign.rtl_seeds:
            kept = parts / f"rtl-{number}-{seed}-{table.digest}.json"
            if kept.exists():
                held = Held(**json.loads(kept.read_text(encoding="utf-8")))
            else:
                held = _hold(campaign, number, seed)
                with replacing(kept) as temporary:
                    temporary.write_text(json.dumps(asdict(held)) + "\n", encoding="utf-8")
            found.append(Held(**{**asdict(held), "design": label}))
    return found


def _hold(campaign: Campaign, number: int, seed: int) -> Held:
    """One run, or its first seconds."""
    table, design = campaign.tables.rtl, campaign.designs[number]
    assert table is not None
    engine: EngineName = choose_engine()[0] if table.engine == "auto" else table.engine
    twin = _Twin(campaign, design, seed)
    dropping = design.hardware.overrun == "drop-result"
    longest = max(256, 4 * design.samples_per_major)
    stalls = None if dropping or not table.stalls else (seed, longest)
    results, different = 0, None
    for block in simulate(design, twin.chunks(), engine, stalls):
        expected = twin.next(len(block))
        gone = difference(expected, block, results)
        results += len(block)
        if gone is not None:
            different = gone.describe("the twin", "the hardware")
            break
    if different is None and (left := twin.waiting):
        different = f"the hardware lacks the last {plural(left, 'result')}"
    label = campaign.labels[number]
    return Held(label, seed, engine, twin.samples, results, different)


def simulate(
    design: Design, chunks: Iterator[Chunk], engine: EngineName, stalls: tuple[int, int] | None
) -> Iterator[VectorBlock]:
    """Results of the hardware; `stalls`: seed and longest.  Who only flies needs no Amaranth."""
    from sculler_sim.engine import simulate as run
    from sculler_sim.stimulus import Stimulus

    stimulus = Stimulus.always() if stalls is None else Stimulus.stalls(*stalls)
    return run(design, chunks, engine=engine, stimulus=stimulus)


@dataclass
class _Twin:
    """The samples of a run on their way to the hardware, and what the fast twin makes of them."""

    campaign: Campaign
    design: Design
    seed: int
    samples: int = 0
    _blocks: list[VectorBlock] = field(default_factory=list)

    def chunks(self) -> Iterator[Chunk]:
        """Counts, as the run itself has them."""
        design, table = self.design, self.campaign.tables.rtl
        assert table is not None
        seconds = min(table.seconds or self.campaign.tables.seconds, self.campaign.tables.seconds)
        many = round(seconds * design.sensor.sample_rate_hz)
        imperfect, quantise = Imperfect(design, self.seed), Quantiser(design)
        model = FastModel(design)
        for chunk in felt(self.campaign, design):
            counts = quantise(imperfect(chunk))[: many - self.samples]
            for first in range(0, len(counts), _CHUNK):
                part = counts[first : first + _CHUNK]
                self._blocks.append(model.feed(part))
                self.samples += len(part)
                yield part, None
            if self.samples == many:
                return

    @property
    def waiting(self) -> int:
        """Results that the hardware has not given."""
        return sum(map(len, self._blocks))

    def next(self, many: int) -> VectorBlock:
        """The next results, at most so many."""
        joined = VectorBlock.concatenate(self._blocks)
        self._blocks = [joined[many:]]
        return joined[:many]


def as_json(found: list[Held]) -> dict[str, Any]:
    """Plain data."""
    return {
        "identical": all(held.different is None for held in found),
        "samples": sum(held.samples for held in found),
        "results": sum(held.results for held in found),
        "runs": [asdict(held) for held in found],
    }


def told(found: list[Held]) -> str:
    """In words."""
    wrong = [held for held in found if held.different is not None]
    if wrong:
        first = wrong[0]
        return (
            f"{plural(len(wrong), 'run')} of {len(found)} differ, the first is seed {first.seed} of"
            f" {first.design}: {first.different}"
        )
    engines = " and ".join(sorted({held.engine for held in found}))
    results, samples = sum(held.results for held in found), sum(held.samples for held in found)
    return (
        f"{plural(len(found), 'run')} in {engines}: {results:,} results of {samples:,} samples,"
        " every integer that of the fast twin"
    )
