"""The pages of docs/ and the README do what they say, and their links lead somewhere."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import sysconfig
from collections.abc import Iterator
from pathlib import Path

import pytest

from docs.pages import RUN, blocks, commands, like, run_page
from warm import warm

ROOT = Path(__file__).parents[2]
PAGES = sorted((ROOT / "docs").rglob("*.md"))
READ = [*PAGES, ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
RUNNING = [p for p in READ if any(b.language in RUN and not b.reason for b in blocks(p))]
DEEP = {
    "check-in-ci",
    "choose-an-algorithm",
    "hold-against-a-truth",
    "simulate-a-log",
    "make-a-motion",
    "navigate-and-align",
    "package",
    "sensor-to-bitstream",
    "live-host",
    "design-file",
    "host-in-c",
    "fly-a-campaign",
    "sensor-wire",
    "on-a-bus",
    "stranger",
}
"""Pages that take long to run: whole simulations, pictures, a bitstream."""

NOT_RUN = 33
"""Blocks of all pages that may be left out; four are run by tests of a release."""


def name(page: Path) -> str:
    return str(page.relative_to(ROOT))


@pytest.fixture(scope="session")
def sculler() -> Iterator[Path]:
    """The program, already started."""
    with warm({**os.environ, "LC_ALL": "C.UTF-8"}) as program:
        yield program


@pytest.fixture
def session(
    tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch, sculler: Path
) -> Path:
    """An empty folder to work in, where `sculler` and `python` are those under test."""
    programs, folder = tmp_path_factory.mktemp("bin"), tmp_path_factory.mktemp("session")
    (programs / "sculler").symlink_to(sculler)
    (programs / "python").write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')
    (programs / "python").chmod(0o755)
    # Yosys and nextpnr are programs of this Python's environment
    path = [str(programs), os.environ["PATH"], sysconfig.get_path("scripts")]
    monkeypatch.setenv("PATH", os.pathsep.join(path))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(p for p in sys.path if p))
    monkeypatch.setenv("LC_ALL", "C.UTF-8")
    monkeypatch.chdir(folder)
    return folder


@pytest.mark.parametrize(
    "page",
    [pytest.param(p, marks=pytest.mark.deep if p.stem in DEEP else ()) for p in RUNNING],
    ids=name,
)
def test_a_page_runs(page: Path, session: Path) -> None:
    run_page(page, session)


def test_few_blocks_are_left_out_and_each_says_why() -> None:
    left_out = [(name(p), b.line, b.reason) for p in READ for b in blocks(p) if b.reason]
    assert len(left_out) <= NOT_RUN, left_out


def test_no_command_hides_in_an_indented_block() -> None:
    """Which would not be run; docs/tutorials/drive.md is run by tests/cli/test_real_input.py."""
    hidden = [
        f"{name(page)}: {line.strip()}"
        for page in READ
        if page.name != "drive.md"
        for line in re.sub(
            r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.M | re.S
        ).splitlines()
        if re.match(r"(?:    |\t)\s*(?:\$ )?(?:sculler|make|pip|python\d?|import|from) \S", line)
    ]
    assert not hidden


def test_every_block_says_what_it_is() -> None:
    known = {*RUN, "text", "toml", "verilog", "csv", "json", "yaml", "make", "c", "cpp"}
    unknown = [f"{name(p)}:{b.line}" for p in READ for b in blocks(p) if b.language not in known]
    assert not unknown


def anchors(page: Path) -> set[str]:
    """What the headings of a page can be found by, as MkDocs and GitHub make it."""
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    heads = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {
        re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", head.encode("ascii", "ignore").decode()))
        .strip("-")
        .lower()
        for head in heads
    } | set(re.findall(r'(?:\{ *#|id=")([\w-]+)', text))


@pytest.mark.parametrize("page", READ, ids=name)
def test_links_and_pictures_are_there(page: Path) -> None:
    text = re.sub(r"^( *)```.*?^\1```$", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    text = re.sub(r"`[^`\n]*`", "", text)
    dangling = []
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        path, _, anchor = target.partition("#")
        if re.match(r"[a-z]+:", target):
            continue
        to = (page.parent / path).resolve() if path else page
        if not to.exists() or (anchor and to.suffix == ".md" and anchor not in anchors(to)):
            dangling.append(target)
    assert not dangling


def test_what_a_page_prints_is_compared() -> None:
    """The comparison itself, so that no page passes for nothing."""
    assert like("a  b\nc", "a b\n...")
    assert not like("a b c", "a b\n")
    assert not like("x a b", "a ...")
    assert commands("$ one\nout\n$ two \\\n  more\nbad\n[2]\n") == [
        ("one", "out\n", 0),
        ("two  more", "bad", 2),
    ]


@pytest.mark.deep
def test_the_site_is_built_without_warnings(tmp_path: Path) -> None:
    """As `make docs` does, where what that installs is there; CI runs it everywhere."""
    pytest.importorskip("mkdocs")
    pytest.importorskip("mkdocstrings")
    subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--quiet", "--site-dir", tmp_path / "site"],
        cwd=ROOT,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
        check=True,
    )
    pages = [page.relative_to(ROOT / "docs").with_suffix(".html") for page in PAGES]
    assert all((tmp_path / "site" / page).is_file() for page in pages)
    for page in (tmp_path / "site").rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        fetched = re.findall(
            r'<(?:script|img|link[^>]*stylesheet)[^>]*(?:src|href)="(http[^"]*)"', text
        )
        assert not fetched, page
        assert "<!-- made:" not in text, page
