"""What came of each mutant, kept from run to run; and what people say of those that live."""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from importlib.resources import files
from itertools import chain
from pathlib import Path

from sculler_model.outputs import replacing
from studies.mutate_python import runs
from studies.mutate_python.changes import Change, drawn
from studies.mutate_python.subjects import ROOT, Subject

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

KINDS = ("equivalent", "hole")
"""What a judgement may say."""


@dataclass(frozen=True)
class Verdict:
    """A mutant and what came of it.

    Attributes:
        path, line, was, now: as of `Change`.
        killed: whether a test failed.
        by: which, or what else ended the run; "" where it lives.
        seconds: of CPU time.
    """

    path: str
    line: int
    was: str
    now: str
    killed: bool
    by: str
    seconds: float


@dataclass(frozen=True)
class Judgement:
    """What somebody says of a mutant that lived when it was first run.

    Attributes:
        path, was, now: of the mutant, as `Change` has them.
        kind: "equivalent": it computes the same.  "hole": it does not, and no test saw it.
        why: the reason, or what is wrong with it.
        test: of a hole, that sees it now; "" for none.
    """

    path: str
    was: str
    now: str
    kind: str
    why: str
    test: str = ""


@dataclass(frozen=True)
class Sample:
    """What came of one subject.

    Attributes:
        places: how many there are to change.
        draws: the mutants of each draw; no place is in two.
    """

    places: int
    draws: tuple[tuple[Verdict, ...], ...]

    @property
    def verdicts(self) -> tuple[Verdict, ...]:
        """Of all draws."""
        return tuple(chain.from_iterable(self.draws))


Key = tuple[str, str, str]
"""A mutant's path, what was, and what is."""

Judgements = Mapping[Key, Judgement]


def key_of(one: Verdict | Judgement) -> Key:
    """By which a mutant and its judgement are found."""
    return one.path, one.was, one.now


def judgements() -> Judgements:
    """Those of judgements.toml."""
    text = files("studies.mutate_python").joinpath("judgements.toml").read_text(encoding="utf-8")
    listed = [Judgement(**each) for each in tomllib.loads(text).get("mutant", [])]
    return {key_of(each): each for each in listed}


def sample(
    subject: Subject,
    count: int,
    seed: int,
    kept: Path,
    copy: Callable[[], Path],
    *,
    draws: int = 1,
    again: bool = False,
    done: Callable[[], None] = lambda: None,
) -> Sample:
    """Draw mutants of a subject and run those of which nothing is known yet.

    Args:
        subject: the subject.
        count: of mutants in each draw.
        seed: of the draws.
        kept: file of what came of mutants before, written after each.  It knows a mutant by the
            whole text of its source: a changed source is run anew.
        copy: gives the copy of the project, when something is to run.
        draws: how many; a later one draws from what the earlier ones left.
        again: run those anew that lived and are not judged equivalent, with the test alone that is
            said to see them, if one is.
        done: called after each mutant.

    Raises:
        InputError: the tests do not pass without a mutant.
    """
    sources = {path: (ROOT / path).read_text(encoding="utf-8") for path in subject.sources}
    changes, places = drawn(sources, draws * count, seed)
    known, judged = _load(kept), judgements()
    limits: dict[Subject, int] = {}
    verdicts = []
    for change in changes:
        key = hashlib.sha256(f"{change.path}\n{change.text}".encode()).hexdigest()
        asked: Subject | None = subject
        if key in known:
            anew = again and not known[key].killed
            asked = _asked(subject, judged.get(key_of(known[key]))) if anew else None
        if asked is not None:
            if asked not in limits:
                limits[asked] = runs.limit_of(copy(), asked)
            known[key] = _verdict(change, runs.tried(copy(), asked, change, limits[asked]))
            _keep(kept, known)
        verdicts.append(known[key])
        done()
    parts = (verdicts[begin : begin + count] for begin in range(0, len(verdicts), count))
    return Sample(places, tuple(map(tuple, parts)))


def _asked(subject: Subject, said: Judgement | None) -> Subject | None:
    """The tests to run again for a mutant that lived: the one that closes the hole, or all."""
    if said is None:
        return subject
    if said.kind == "equivalent":
        return None
    return replace(subject, tests=(said.test,)) if said.test else subject


def _verdict(change: Change, said: runs.Said) -> Verdict:
    return Verdict(
        change.path, change.line, change.was, change.now, not said.passed, said.by, said.seconds
    )


def _load(path: Path) -> dict[str, Verdict]:
    if not path.is_file():
        return {}
    text = path.read_text(encoding="utf-8")
    return {key: Verdict(**each) for key, each in json.loads(text).items()}


def _keep(path: Path, known: Mapping[str, Verdict]) -> None:
    text = json.dumps({key: asdict(each) for key, each in known.items()}, indent=1)
    with replacing(path) as temporary:
        temporary.write_text(text + "\n", encoding="utf-8")
