"""What the shipped bench says of each mutant, and whether a survivor can be told from the core."""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from sculler_hdl.plan.compact.plan import plan_compact
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.outputs import replacing
from sculler_sim.engines.verilator_build import emitted
from studies.mutate.bench import LONG, Bench, build, icarus_says, write_bench
from studies.mutate.equivalence import EQUIVALENT, compare
from studies.mutate.microprogram import NotFollowedError, same_results
from studies.mutate.mutants import Mutants, mutants, of_program, place, with_unknown

FAIL = "FAIL"
"""What the bench's line begins with where it fails."""

KINDS = ("mutate", "microprogram")
"""What changes of the gates, and those of the microprogram, begin with."""

UNUSED = "unused"
"""Of a bit of the microprogram that may be unknown, with all the others of which this is said."""

LONGER = "differs in a longer bench"
"""Of a mutant that the bench fails if it is a hundred times as long."""


@dataclass(frozen=True)
class Judged:
    """A mutant and what came of it.

    Attributes:
        change: what was changed.
        verilator, icarus: the bench's line in each simulator; Icarus runs what Verilator fails.
        proof: of a survivor: "equivalent", "unused", "differs in a longer bench", "differs after
            N clocks" or "open ..."; empty where it was not tried.
        tried: seconds that the proof was given.
    """

    change: str
    verilator: str
    icarus: str = ""
    proof: str = ""
    tried: int = 0

    @property
    def killed(self) -> bool:
        """Whether the bench failed in both simulators; one that did not end says nothing."""
        return self.verilator.startswith(FAIL) and self.icarus.startswith(FAIL)

    @property
    def settled(self) -> bool:
        """Whether nothing is to be found out any more."""
        return self.killed or self.proof in (EQUIVALENT, UNUSED) or self.proof.startswith("differs")


def judge(
    design: Design,
    count: int,
    seconds: int,
    path: Path,
    done: Callable[[], None] = lambda: None,
) -> list[Judged]:
    """Every mutant of a core, as far as it is not in a file already.

    Args:
        design: the design.
        count: of mutants of the gates.
        seconds: for the proof of a survivor; 0 for none.
        path: of the file with what came out; what is there of this core and bench stays.  Of those
            that were killed it has the number: they come back without saying what was changed.
        done: called after each mutant that has run, and each proof.

    Raises:
        InputError: a simulator or Yosys is not installed.
        ToolError: one of them failed, or the core itself does not pass.
    """
    texts = emitted(design)
    with tempfile.TemporaryDirectory(prefix="sculler-mutate-") as work:
        folder = Path(work)
        vectors = write_bench(design, texts, folder)
        bench_digest = _digest(*(each.read_text(encoding="ascii") for each in vectors))
        kept = _Kept.read(path, _digest(*texts.values(), str(count)), bench_digest)
        if not kept.mutants:
            changed = mutants(design.name, texts, folder, count)
            bench = build(design, changed.verilog, texts, folder)
            found = _followed(design, list(_simulated(bench, changed, kept.proofs, done)))
            found = _unused(design, texts, found, folder)
            kept = replace(kept, mutants=_longer(design, texts, changed, found))
            kept.write(path)
    for change, proof in _proofs(design, texts, kept.mutants, seconds):
        kept.put(change, proof, seconds)
        kept.write(path)
        done()
    return kept.mutants


def _proofs(
    design: Design, texts: Mapping[str, str], found: Sequence[Judged], seconds: int
) -> Iterator[tuple[str, str]]:
    """What is proved of changes that live."""
    for each in found:
        if not each.settled and seconds > each.tried:
            yield each.change, compare(design, texts, [each.change], seconds)


@dataclass(frozen=True)
class _Kept:
    """What is kept of a shape: of which core and bench, and its mutants (none: to be run)."""

    core: str
    bench: str
    mutants: list[Judged]
    proofs: dict[str, tuple[str, int]]

    @classmethod
    def read(cls, path: Path, core: str, bench: str) -> _Kept:
        """From a file; of the same core the proofs are still good, if the bench is another."""
        if not path.is_file():
            return cls(core, bench, [], {})
        found = json.loads(path.read_text(encoding="utf-8"))
        if found["core"] != core:
            return cls(core, bench, [], {})
        judged = [Judged(**each) for each in found["live"]]
        judged += [Judged(of, FAIL, FAIL) for of in KINDS for _ in range(found["killed"][of])]
        proofs = {each.change: (each.proof, each.tried) for each in judged if each.tried}
        return cls(core, bench, judged if found["bench"] == bench else [], proofs)

    def put(self, change: str, proof: str, tried: int) -> None:
        """What came of the proof of a mutant."""
        for number, mutant in enumerate(self.mutants):
            if mutant.change == change:
                self.mutants[number] = replace(mutant, proof=proof, tried=tried)

    def write(self, path: Path) -> None:
        """Whole or not at all."""
        killed = [each for each in self.mutants if each.killed]
        found = {
            "core": self.core,
            "bench": self.bench,
            "killed": {of: sum(each.change.startswith(of) for each in killed) for of in KINDS},
            "live": [asdict(each) for each in self.mutants if not each.killed],
        }
        with replacing(path) as temporary:
            temporary.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


def _digest(*texts: str) -> str:
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:16]


def _simulated(
    bench: Bench, changed: Mutants, proofs: dict[str, tuple[str, int]], done: Callable[[], None]
) -> Iterator[Judged]:
    for simulator in bench.commands:
        said = bench.run(simulator, 0)
        if not said.startswith("PASS"):
            raise InputError(f"{simulator}: the core itself does not pass: {said}")
    for number, change in enumerate(changed.changes, start=1):
        said = bench.run("verilator", number)
        again = "" if said.startswith("PASS") else bench.run("icarus", number)
        yield Judged(change, said, again, *proofs.get(change, ("", 0)))
        done()


def _followed(design: Design, found: list[Judged]) -> list[Judged]:
    """The same, in which bits of the microprogram that change nothing on symbols are equivalent."""
    return [
        replace(each, proof=EQUIVALENT)
        if of_program(each.change) and not each.killed and _same_program(design, each.change)
        else each
        for each in found
    ]


def _same_program(design: Design, change: str) -> bool:
    try:
        return same_results(plan_compact(design), *place(change))
    except NotFollowedError:
        return False


def _longer(
    design: Design, texts: Mapping[str, str], changed: Mutants, found: list[Judged]
) -> list[Judged]:
    """The same, in which survivors that a much longer bench fails in Verilator differ."""
    if all(each.settled for each in found):
        return found
    with tempfile.TemporaryDirectory(prefix="sculler-mutate-") as work:
        write_bench(design, texts, Path(work), LONG)
        bench = build(design, changed.verilog, texts, Path(work))
        return [
            replace(each, proof=LONGER)
            if not each.settled and bench.run("verilator", number).startswith(FAIL)
            else each
            for number, each in enumerate(found, start=1)
        ]


def _unused(
    design: Design, texts: Mapping[str, str], found: list[Judged], folder: Path
) -> list[Judged]:
    """The same, in which bits of the microprogram that are open and can all be unknown are unused.

    They are x, all at once: then no port ever shows x in Icarus Verilog.  If one does, halves are
    tried, and so on.
    """
    open_ = [each.change for each in found if of_program(each.change) and not each.settled]
    shown = set(_without_effect(design, texts, open_, folder))
    return [replace(each, proof=UNUSED) if each.change in shown else each for each in found]


def _without_effect(
    design: Design, texts: Mapping[str, str], changes: Sequence[str], folder: Path
) -> list[str]:
    """A large part of these bits of the microprogram that can all be unknown."""
    good: list[str] = []
    groups = [list(changes)] if changes else []
    while groups:
        group = groups.pop()
        text = with_unknown(texts[f"{design.name}.v"], [*good, *group])
        if icarus_says(design, text, texts, folder).startswith("PASS"):
            good += group
        elif len(group) > 1:
            half = len(group) // 2
            groups += [group[half:], group[:half]]
    return good
