"""Mutants of the Python: which places are changed, what the tests say, and the page."""

from __future__ import annotations

import ast
import json
import signal
from dataclasses import asdict, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from sculler_model.errors import InputError
from studies.mutate_python.subjects import ROOT, SUBJECTS

pytest.importorskip("cosmic_ray", reason="the extra `mutants` is not installed")
pytest.importorskip("scipy")

from studies.mutate_python import page, runs, verdicts
from studies.mutate_python.changes import drawn, places
from studies.mutate_python.verdicts import Judgement, Sample, Verdict

SOURCE = '''"""A text of 7 words."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    LEFT_OUT = 1 + 2

Number: TypeAlias = int | float
MORE: tuple[int, int | None] = (3, 4)


@lru_cache(maxsize=8)
def double(x: int | float, by: int = 2) -> int | float:
    """Twice x, or 0."""
    assert x == 5 - 6
    if x < 9:
        raise ValueError(f"{x + 10} is too small")
    for a, b in zip([x], [x], strict=True):
        x = a * b
    return x
'''


def changed(source: str) -> set[str]:
    """The pieces of a source that are changed."""
    lines = source.splitlines()
    found = places("m.py", source)
    assert all(place.begin[0] == place.end[0] for place in found)
    return {lines[each.begin[0] - 1][each.begin[1] : each.end[1]] for each in found}


def test_what_is_changed_and_what_is_left_out() -> None:
    assert changed(SOURCE) == {"3", "4", "2", "x < 9", "<", "9", "zip([x], [x], strict=True)", "*"}


def test_each_change_is_other_python_and_stands_for_itself() -> None:
    changes, of = drawn({"m.py": SOURCE}, 100, 1)
    assert len(changes) == of == 8
    tree = ast.dump(ast.parse(SOURCE))
    for change in changes:
        assert ast.dump(ast.parse(change.text)) != tree
        assert SOURCE.splitlines()[change.line - 1].strip() == change.was
        assert change.text.splitlines()[change.line - 1].strip() == change.now


def test_a_smaller_draw_is_the_beginning_of_a_larger_one() -> None:
    sources = {path: (ROOT / path).read_text() for path in SUBJECTS["wordlength"].sources[1:2]}
    few, of = drawn(sources, 5, 3)
    more, same = drawn(sources, 9, 3)
    assert (more[:5], of) == (few, same)
    assert drawn(sources, 5, 4)[0] != few


def test_all_places_alike_whatever_the_number_of_ways() -> None:
    """A sum can become eleven other operations, a number two: they are drawn as often."""
    source = "a = b + 1\n"
    kinds = [drawn({"m.py": source}, 1, seed)[0][0].now.count("+") for seed in range(100)]
    assert 25 < sum(kinds) < 75  # binomial of a half: 5 standard deviations


def test_a_removed_decorator() -> None:
    source = "class A:\n\n    @property\n    def b(self):\n        return self\n"
    (change,), _ = drawn({"m.py": source}, 1, 1)
    assert (change.was, change.now) == ("@property", "")


def test_every_subject_is_there() -> None:
    names = "golden wordlength cycles coefficients families host navigation compare logs"
    assert list(SUBJECTS) == names.split()
    for subject in SUBJECTS.values():
        for path in (*subject.sources, *(f"tests/{name}" for name in subject.tests)):
            assert (ROOT / path).is_file(), path


def test_what_is_judged_is_there_and_stands_for_itself() -> None:
    """A judgement of a line that has been changed since is of nothing."""
    for one in verdicts.judgements().values():
        assert one.kind in verdicts.KINDS, one
        lines = " ".join(line.strip() for line in (ROOT / one.path).read_text().splitlines())
        assert one.was in lines, one
        assert one.now not in lines or one.now in one.was, one
        if one.test:
            file, name = one.test.split("::")
            assert f"def {name}(" in (ROOT / "tests" / file).read_text(), one


def verdict(killed: bool, number: int) -> Verdict:
    by = "model/test_a.py::test_b" if killed else ""
    return Verdict("a/b.py", number, "x = 1 | 2", f"x = {number}", killed, by, 1.0)


def judged(kind: str, *numbers: int, test: str = "") -> verdicts.Judgements:
    each = [Judgement("a/b.py", "x = 1 | 2", f"x = {n}", kind, "Because.", test) for n in numbers]
    return {verdicts.key_of(one): one for one in each}


def test_shares_leave_out_what_is_equivalent() -> None:
    """40 of 41 killed, two by a test written since, one equivalent: 38 of 40 before."""
    numbers = iter(range(41))
    killed = [verdict(True, next(numbers)) for _ in range(40)]
    found = {"golden": Sample(300, ((*killed, verdict(False, next(numbers))),))}
    said = {**judged("hole", 3, 5, test="model/test_a.py::test_c"), **judged("equivalent", 40)}
    # Clopper and Pearson for 38 of 40: R's binom.test(38, 40) gives 0.8308196 and 0.9938872
    row = "300 | 41 | 40 | 1 | 0 | 95.0 % (83.1 to 99.4) | 100.0 % |"
    lines = list(page.results(found, said))
    assert f"| `golden` | {row}" in lines
    assert f"| **all** | {row}" in lines
    assert page.unjudged(found, said) == []
    text = page.document(found, said, 41, 1, 1)
    assert "| `a/b.py` | `x = 1 \\| 2` | `x = 40` | Because. |" in text
    assert "`x = 3` | Because. Seen by `model/test_a.py::test_c`. |" in text
    assert "### Alive" not in text


def test_a_later_draw_has_its_own_table() -> None:
    """4 of 4 in the first of `cycles`; 2 of 3 when drawn in the second, one by a test since."""
    first = tuple(verdict(True, number) for number in range(4))
    second = tuple(verdict(True, number) for number in range(4, 7))
    found = {"cycles": Sample(9, (first, second)), "golden": Sample(5, (first,))}
    lines = list(page.results(found, judged("hole", 5, test="model/test_a.py::test_c")))
    begin = lines.index("### Second draw")
    # Clopper and Pearson for 2 of 3: R's binom.test(2, 3) gives 0.09429932 and 0.99159627
    assert "| `cycles` | 9 | 3 | 3 | 0 | 0 | 66.7 % (9.4 to 99.2) | 100.0 % |" in lines[begin:]
    assert not any("`golden`" in line for line in lines[begin:])
    assert "| `golden` | 5 | 4 | 4 | 0 | 0 | 100.0 % (39.8 to 100.0) | 100.0 % |" in lines[:begin]


def test_a_hole_without_a_test_and_what_nobody_judged_are_alive() -> None:
    found = {"golden": Sample(9, ((verdict(False, 1), verdict(False, 2)),))}
    said = judged("hole", 2)
    assert page.unjudged(found, said) == list(found["golden"].verdicts)
    assert "9 | 2 | 0 | 0 | 2 | 0.0 % (0.0 to 84.2) | 0.0 % |" in "\n".join(
        page.results(found, said)
    )
    assert "`x = 1` | not judged yet |" in page.document(found, said, 2, 1, 1)


def test_a_mutant_that_is_killed_is_not_equivalent() -> None:
    found = {"golden": Sample(9, ((verdict(True, 1),),))}
    with pytest.raises(InputError, match=r"^a/b.py: x = 1: judged equivalent, and killed$"):
        list(page.results(found, judged("equivalent", 1)))


def test_what_is_known_is_not_run_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """But for those that lived, where that is asked for, and for changed sources."""
    tried: list[str] = []

    def run(root: Path, subject: Any, change: Any, limit: int) -> runs.Said:
        assert limit == 25
        tried.append(change.now)
        return runs.Said(passed=len(tried) == 1, by="", seconds=0.1)

    monkeypatch.setattr(runs, "tried", run)
    monkeypatch.setattr(runs, "limit_of", lambda root, subject: 25)
    subject = SUBJECTS["wordlength"]
    subject = replace(subject, sources=subject.sources[1:2])
    kept = tmp_path / "kept.json"

    def sample(count: int, again: bool = False) -> Sample:
        return verdicts.sample(subject, count, 1, kept, lambda: tmp_path, again=again)

    first = sample(3)
    assert (len(tried), [each.killed for each in first.verdicts]) == (3, [False, True, True])
    assert sample(3) == first
    assert len(tried) == 3
    sample(4)
    assert len(tried) == 4
    assert all(each.killed for each in sample(3, again=True).verdicts)
    assert tried[4:] == tried[:1]
    assert len(json.loads(kept.read_text())) == 4
    two = verdicts.sample(subject, 2, 1, kept, lambda: tmp_path, draws=2)
    assert [len(draw) for draw in two.draws] == [2, 2]
    assert two.verdicts == sample(4).verdicts
    assert len(tried) == 5


def test_what_is_judged_equivalent_is_not_run_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runs, "limit_of", lambda root, subject: 25)
    monkeypatch.setattr(runs, "tried", lambda *_: runs.Said(passed=True, by="", seconds=0.1))
    subject = replace(SUBJECTS["compare"], sources=SUBJECTS["compare"].sources[:1])

    def sample(again: bool) -> Sample:
        kept = tmp_path / "kept.json"
        return verdicts.sample(subject, 2, 1, kept, lambda: tmp_path, again=again)

    one, _ = sample(again=False).verdicts
    said = Judgement(one.path, one.was, one.now, "equivalent", "Because.")
    monkeypatch.setattr(verdicts, "judgements", lambda: {verdicts.key_of(said): said})
    monkeypatch.setattr(runs, "tried", lambda *_: runs.Said(passed=False, by="x", seconds=0.1))
    assert [each.killed for each in sample(again=True).verdicts] == [False, True]


@pytest.mark.parametrize(
    ("status", "text", "by"),
    [
        (0, "3 passed", ""),
        (1, "F\nFAILED tests/model/test_a.py::test_b[x y] - assert", "model/test_a.py::test_b[x"),
        (2, "ERROR tests/model/test_a.py\n1 error", "model/test_a.py"),
        (4, "ImportError while loading\nconftest", "ImportError while loading conftest"),
        (-signal.SIGXCPU, "", "time"),
        (-signal.SIGKILL, "", "time"),
        (-signal.SIGSEGV, "", f"signal {int(signal.SIGSEGV)}"),
    ],
)
def test_what_ended_a_run(status: int, text: str, by: str) -> None:
    assert runs._by(status, text) == by


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A project of one module with one test."""
    root = tmp_path_factory.mktemp("project")
    for folder in ("model", "tests"):
        (root / folder).mkdir()
    (root / "studies").symlink_to(ROOT / "studies")
    (root / "pyproject.toml").write_text("[tool.pytest.ini_options]\npythonpath = ['.']\n")
    (root / "model" / "small.py").write_text("def twice(x):\n    return 2 * x\n")
    (root / "tests" / "test_small.py").write_text(
        "from small import twice\n\ndef test_it():\n    assert twice(3) == 6\n"
        "\ndef test_simulate():\n    assert twice(0) == 1\n"
    )
    return root


def of_small(*but: str) -> Any:
    return SimpleNamespace(sources=("model/small.py",), tests=("test_small.py",), but=but)


@pytest.mark.parametrize(
    ("now", "limit", "passed", "by"),
    [
        ("return 3 * x", 60, False, "test_small.py::test_it"),
        pytest.param("return x + x", 60, True, "", marks=pytest.mark.deep),
        pytest.param("while True: pass", 3, False, "time", marks=pytest.mark.deep),
    ],
)
def test_what_the_tests_say_of_a_mutant(
    small: Path, now: str, limit: int, passed: bool, by: str
) -> None:
    """And its source is put back."""
    path = small / "model" / "small.py"
    whole = path.read_text()
    text = whole.replace("return 2 * x", now)
    change: Any = SimpleNamespace(path="model/small.py", text=text)
    said = runs.tried(small, of_small("simulate"), change, limit)
    assert (said.passed, said.by) == (passed, by)
    assert path.read_text() == whole


@pytest.mark.deep
def test_without_a_mutant_the_tests_must_pass(small: Path) -> None:
    assert 20 <= runs.limit_of(small, of_small("simulate")) < 60
    with pytest.raises(
        InputError, match=r"^the tests do not pass without a mutant: test_small\.py"
    ):
        runs.limit_of(small, of_small())


def test_verdicts_come_back_as_they_were_kept(tmp_path: Path) -> None:
    known = {"a": verdict(True, 1), "b": verdict(False, 2)}
    verdicts._keep(tmp_path / "kept.json", known)
    assert verdicts._load(tmp_path / "kept.json") == known
    assert asdict(known["a"])["by"] == "model/test_a.py::test_b"
