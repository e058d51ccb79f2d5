"""Writes docs/explanation/evidence.md."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib.resources import files
from os.path import relpath

from studies.documents import PAGES, table
from studies.evidence.evidence import Requirement, goals, proofs, proved, tools, unclaimed


def page(listed: Sequence[Requirement]) -> str:
    """The text of the page."""
    return "\n".join([*_all(listed)])


def _text(name: str) -> str:
    place = files("studies.evidence").joinpath("texts", f"{name}.md")
    return place.read_text(encoding="utf-8")


def _all(listed: Sequence[Requirement]) -> Iterator[str]:
    yield _text("about")
    yield "## Requirements at a glance"
    rows = (
        [
            f"[{one.id}](#{one.id.lower()})",
            str(len(one.design)),
            str(len(one.tests)),
            str(len(one.claims)),
            str(len(one.faults)),
            "yes" if one.open else "",
        ]
        for one in listed
    )
    yield from table(
        "lrrrrl", ["requirement", "modules", "tests", "claims", "faults", "open point"], rows
    )
    yield ""
    yield "## Each requirement"
    yield ""
    for one in listed:
        yield from _one(one)
    yield from _rest(listed)


def _link(path: str) -> str:
    """To a page of docs; other files by name."""
    if path.startswith("docs/"):
        return f"[{path}]({relpath(path, PAGES)})"
    return f"`{path}`"


def _one(one: Requirement) -> Iterator[str]:
    known = proofs()
    yield f"### {one.id}"
    yield one.says
    yield ""
    yield f"- Source: {_link(one.source)}"
    yield f"- Design: {', '.join(map(_link, one.design))}"
    yield from (f"- Test: `{test}`" for test in one.tests)
    yield from (f"- Proof: `{claim}`, {proved(known.get(claim, {}))}" for claim in one.claims)
    if one.faults:
        yield f"- Faults made on purpose: {', '.join(f'`{fault}`' for fault in one.faults)}"
    if one.open:
        yield f"- **Open**: {one.open}"
    yield ""


def _rest(listed: Sequence[Requirement]) -> Iterator[str]:
    yield "## Open points"
    yield from (f"- [{one.id}](#{one.id.lower()}): {one.open}" for one in listed if one.open)
    yield _text("open")
    left = unclaimed(listed)
    for kind, names in left.items():
        if names:
            told = ", ".join(f"`{name}`" for name in names)
            yield f"No requirement names these {kind}: {told}."
            yield ""
    yield "## Coverage goals"
    yield _text("goals")
    yield from (f"- {goal}" for goal in goals("stim300"))
    yield ""
    yield "## Tools"
    yield "That wrote this page, and that the tests and proofs of this tree run with:"
    yield ""
    yield from table("ll", ["tool", "version"], map(list, tools().items()))
    yield ""
