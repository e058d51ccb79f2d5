"""The words and tables of mutants-python.md."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from importlib.metadata import version

from scipy.stats import binomtest

from sculler_model.errors import InputError
from studies import documents
from studies.mutate_python.runs import CPU_FACTOR, CPU_MORE
from studies.mutate_python.subjects import DRAWS, SUBJECTS
from studies.mutate_python.verdicts import Judgement, Judgements, Sample, Verdict, key_of

Found = Mapping[str, Sample]
"""What came of each subject, by its name."""

GOAL = 95
"""Per cent of the mutants that are not equivalent, which the tests are to kill."""

CONFIDENCE = 0.95


def document(found: Found, judged: Judgements, count: int, draws: int, seed: int) -> str:
    """The text of the page.

    Args:
        found: what came of every mutant.
        judged: what is said of those that lived at first.
        count: mutants of each subject in a draw.
        draws: how many.
        seed: of the draws.
    """
    sections = (
        _introduction(found, count, draws, seed),
        results(found, judged),
        _left_out(),
        _survivors(found, judged),
        _limits(),
    )
    return documents.joined(sections)


def _introduction(found: Found, count: int, draws: int, seed: int) -> Iterator[str]:
    chosen = "".join(f" --only {name}" for name in found) if len(found) < len(SUBJECTS) else ""
    options = f"--count {count} --draws {draws} --seed {seed}{chosen} --write"
    command = f"python -m studies.mutate_python {options}"
    yield from documents.opening("Mutants of the Python", "an hour and more", command)
    yield documents.paragraph(
        "Would the fast tests see a slip in the Python? Each mutant is the project with one change"
        " in one source: an operator, a comparison or a number replaced, a condition negated, a"
        " loop that does nothing, a decorator gone, and whatever else the operators of"
        f" cosmic-ray {version('cosmic-ray')} do. The fast tests of that part of the project run"
        " until one fails: the mutant is *killed*, or it lives."
    )
    yield ""
    yield documents.paragraph(
        f"Places are drawn, all places of a subject alike (seed {seed}), and at each place one of"
        " the changes that are possible there, all alike. So a sum, which can become any of eleven"
        " other operations, counts no more than a number. What is compiled by Numba runs as plain"
        f" Python, of the same source. A run has {CPU_FACTOR} times the CPU time that the tests"
        f" take without a mutant, and {CPU_MORE} s: a mutant that never ends is killed. Hypothesis"
        " gives the same examples in every run. Where a source has changed since this page was"
        " written, the command draws other places of that subject."
    )
    missing = [f"`{name}`" for name in SUBJECTS if name not in found]
    if missing:
        yield ""
        yield documents.paragraph(f"Not run for this page: {', '.join(missing)}.")


def results(found: Found, judged: Judgements) -> Iterator[str]:
    """What came out, draw by draw, of each subject and in all.

    Raises:
        InputError: a mutant that is judged to be equivalent is killed.
    """
    yield "## What came out"
    for draw in range(max(len(one.draws) for one in found.values())):
        if draw:
            yield ""
        yield f"### {DRAWS[draw]} draw"
        yield from _table(
            {n: one for n, one in found.items() if draw < len(one.draws)}, draw, judged
        )
    yield ""
    yield documents.paragraph(
        "*The rest* is all that are not equivalent. *When drawn*: by the tests as they were then,"
        " with the interval that holds the share of all places with a confidence of"
        f" {100 * CONFIDENCE:.0f} % (Clopper and Pearson). *Now*: with the tests that were written"
        " for mutants that lived; that share is of these mutants alone, and no estimate for the"
        " others. So what the tests of now see of slips that nobody looked at is told by the last"
        " draw's share when drawn, and by it alone: its places are in no earlier draw, and no test"
        f" was written for it before it ran. The goal is {GOAL} %. The last row of a table weighs"
        " subjects alike, not places."
    )


def _table(found: Found, draw: int, judged: Judgements) -> Iterator[str]:
    """What came of one draw, of each subject and in all."""
    headings = (
        *("subject", "places", "drawn", "killed", "equivalent", "alive"),
        *("killed when drawn, of the rest", "killed now, of the rest"),
    )
    rows = [
        (f"`{name}`", str(one.places), *_counts(one.draws[draw], judged))
        for name, one in found.items()
    ]
    whole = [verdict for one in found.values() for verdict in one.draws[draw]]
    places = sum(one.places for one in found.values())
    rows.append(("**all**", str(places), *_counts(whole, judged)))
    yield from documents.table("lrrrrrrr", headings, rows)


def _counts(verdicts: Iterable[Verdict], judged: Judgements) -> tuple[str, ...]:
    """Drawn, killed, equivalent, alive and the two shares."""
    verdicts = list(verdicts)
    killed = [each for each in verdicts if each.killed]
    said = [_judgement(each, judged) for each in verdicts]
    equivalent = sum(one is not None and one.kind == "equivalent" for one in said)
    for verdict in killed:
        one = _judgement(verdict, judged)
        if one is not None and one.kind == "equivalent":
            raise InputError(f"{verdict.path}: {verdict.now}: judged equivalent, and killed")
    before = sum(_judgement(each, judged) is None for each in killed)
    rest = len(verdicts) - equivalent
    alive = rest - len(killed)
    shares = ("-", "-") if not rest else (_with_interval(before, rest), _share(len(killed), rest))
    return (*map(str, (len(verdicts), len(killed), equivalent, alive)), *shares)


def _share(some: int, of: int) -> str:
    return f"{100 * some / of:.1f} %"


def _with_interval(some: int, of: int) -> str:
    low, high = binomtest(some, of).proportion_ci(CONFIDENCE)
    return f"{_share(some, of)} ({100 * low:.1f} to {100 * high:.1f})"


def _judgement(verdict: Verdict, judged: Judgements) -> Judgement | None:
    return judged.get(key_of(verdict))


def unjudged(found: Found, judged: Judgements) -> list[Verdict]:
    """The mutants that live and are not said to be equivalent."""
    alive = []
    for one in found.values():
        for verdict in one.verdicts:
            said = _judgement(verdict, judged)
            if not verdict.killed and (said is None or said.kind != "equivalent"):
                alive.append(verdict)
    return alive


_LEFT_OUT = """\
- Strings, docstrings among them: no operator changes them.
- Types: annotations, aliases of types, what stands under `if TYPE_CHECKING`.
- Errors that are raised, with their texts: `raise` statements whole. The conditions before them are
  changed.
- Assertions: in sources they tell the type checker what is so.
- Decorators that keep results for speed or speak to the type checker, and `strict=` of `zip`.
- What is no Python after the change, what Python warns of, and what is the same program.
"""


def _left_out() -> Iterator[str]:
    yield "## What is not changed"
    yield _LEFT_OUT.rstrip()


def _survivors(found: Found, judged: Judgements) -> Iterator[str]:
    yield "## Those that lived"
    lived = [
        (verdict, _judgement(verdict, judged))
        for one in found.values()
        for verdict in one.verdicts
        if not verdict.killed or _judgement(verdict, judged) is not None
    ]
    yield documents.paragraph(
        f"{len(lived)} mutants lived when they were drawn. The judgements are kept in"
        " `studies/mutate_python/judgements.toml`."
    )
    for title, kind, killed in (
        ("Holes that a test closes now", "hole", True),
        ("Equivalent", "equivalent", False),
        ("Alive", "", False),
    ):
        rows = [
            _row(verdict, said)
            for verdict, said in lived
            if verdict.killed == killed and _is(kind, said)
        ]
        if rows:
            yield ""
            yield f"### {title}"
            yield from documents.table("llll", ("source", "was", "became", "judgement"), rows)


def _is(kind: str, said: Judgement | None) -> bool:
    """Whether a judgement is of a kind; "" for any that does not say equivalent."""
    if kind:
        return said is not None and said.kind == kind
    return said is None or said.kind != "equivalent"


def _row(verdict: Verdict, said: Judgement | None) -> tuple[str, str, str, str]:
    why = "not judged yet" if said is None else said.why
    if verdict.killed and said is not None and said.test:
        why += f" Seen by `{said.test}`."
    source = "/".join(verdict.path.split("/")[-2:])
    return f"`{source}`", _code(verdict.was), _code(verdict.now), why


def _code(text: str) -> str:
    return f"`{text}`".replace("|", "\\|") if text else "(nothing)"


def _limits() -> Iterator[str]:
    yield "## What this does not say"
    yield documents.paragraph(
        "A sample of a few mutants of each subject gives wide intervals: the table has them. The"
        " tests are those that belong to a subject by `studies/mutate_python/subjects.py`, without"
        " those that take minutes where Numba does not compile; others, of fast model, command line"
        " and hardware, may see more. That a mutant is equivalent is somebody's reasoning, not a"
        " proof. Two slips that hide each other are not among the mutants, nor is code that is not"
        " there."
    )
