"""The table of the papers' equations: none is missing, and every name exists."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "equations.md"
LETTERS = "abcdefghijklmnopqrstuvwxyz"
NUMBERED = {
    "Yang": [*map(str, range(1, 19)), *(f"19{c}" for c in LETTERS[:14]), "20a", "20b"],
    "Savage-98": [str(k) for k in range(1, 110)],
    "Savage-20": [str(k) for k in range(1, 6)],
    "Zeng": [str(k) for k in range(1, 29)],
}
"""As the papers number them."""


def rows(paper: str) -> list[tuple[str, str, str]]:
    """Equation numbers, what, and where, of a paper's table."""
    text = PAGE.read_text(encoding="utf-8").split(f"## {paper}\n")[1].split("\n## ")[0]
    return re.findall(r"^\| (\d[^|]*?) \| ([^|]*?) \| ([^|]*?) \|$", text, re.MULTILINE)


def expanded(numbers: str) -> list[str]:
    """ "19a-19c, 20" as 19a, 19b, 19c, 20."""
    found: list[str] = []
    for part in numbers.split(", "):
        first, _, last = part.partition("-")
        if not last:
            found.append(first)
        elif first[-1].isalpha():
            a, b = LETTERS.index(first[-1]), LETTERS.index(last[-1])
            found += [first[:-1] + c for c in LETTERS[a : b + 1]]
        else:
            found += [str(k) for k in range(int(first), int(last) + 1)]
    return found


@pytest.mark.parametrize("paper", NUMBERED)
def test_every_equation_once_in_order(paper: str) -> None:
    assert [k for row in rows(paper) for k in expanded(row[0])] == NUMBERED[paper]


def resolve(name: str) -> object:
    """What stands behind a dotted name of the page."""
    parts = (name if name.startswith("sculler") else f"sculler_model.{name}").split(".")
    for split in range(len(parts) - 1, 0, -1):
        try:
            found: object = import_module(".".join(parts[:split]))
        except ModuleNotFoundError:
            continue
        for part in parts[split:]:
            found = getattr(found, part)
        return found
    raise ModuleNotFoundError(name)


@pytest.mark.parametrize("paper", NUMBERED)
def test_every_name_exists_and_every_row_has_a_name_or_a_reason(paper: str) -> None:
    for numbers, _, where in rows(paper):
        names = re.findall(r"`([\w.]+)`", where)
        assert names or re.match(r"no code: \w+", where), numbers
        for name in names:
            assert callable(resolve(name)), name


def test_a_name_that_does_not_exist_is_found() -> None:
    with pytest.raises(AttributeError):
        resolve("host.velocity_rotated")
