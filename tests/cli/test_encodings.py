"""No verb dies of a sign that the terminal's or the pipe's encoding lacks."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import every_verb
from sculler.main import main

QUICK = {
    verb: [*command.split(), *["--no-plots"] * command.startswith("navigate")]
    for verb, command in every_verb.COMMANDS.items()
    if verb not in ("place", "demo", "campaign")
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("verbs")
    every_verb.prepare(folder)
    return folder


@pytest.fixture
def said(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> Callable[[list[str], str], tuple[int, bytes, bytes]]:
    """Run with stdout and stderr in an encoding: status, and the bytes of both."""

    def said(words: list[str], encoding: str) -> tuple[int, bytes, bytes]:
        monkeypatch.chdir(folder)
        streams = [io.TextIOWrapper(io.BytesIO(), encoding, "strict") for _ in range(2)]
        for name, stream in zip(("stdout", "stderr"), streams, strict=True):
            monkeypatch.setattr(sys, name, stream)
        status = main(words)
        contents = []
        for stream in streams:
            stream.flush()
            contents.append(stream.buffer.getvalue())  # type: ignore[attr-defined]
        return status, contents[0], contents[1]

    return said


SLOW = ("quantisation", "advise")
"""Verbs that compute long before they say a word: at every change in ASCII alone."""


@pytest.mark.parametrize(
    ("verb", "encoding"),
    [
        pytest.param(
            verb, encoding, marks=[pytest.mark.deep] * (verb in SLOW and encoding != "ascii")
        )
        for verb in QUICK
        for encoding in ("ascii", "cp1252", "cp437")
    ],
)
def test_every_verb_in_every_encoding(
    said: Callable[..., tuple[int, bytes, bytes]], verb: str, encoding: str
) -> None:
    status, out, err = said(QUICK[verb], encoding)
    assert (status, err) == (0, b"")
    out.decode(encoding)
    assert b"?" not in out


@pytest.mark.parametrize("verb", QUICK)
def test_every_help_in_ascii(said: Callable[..., tuple[int, bytes, bytes]], verb: str) -> None:
    command = QUICK[verb]
    verb_words = command[:2] if command[0] == "analyze" else command[:1]
    status, out, err = said([*verb_words, "--help"], "ascii")
    assert (status, err) == (0, b"")
    assert b"?" not in out


def test_what_is_lacking_is_spelt(said: Callable[..., tuple[int, bytes, bytes]]) -> None:
    words = QUICK["navigate"]
    _, plain, _ = said(words, "ascii")
    _, full, _ = said(words, "utf-8")
    assert "heading 0.0000°" in full.decode()
    assert b"heading 0.0000deg" in plain
    assert b"heading 0.0000\xb0" in said(words, "cp1252")[1]


def test_errors_too(said: Callable[..., tuple[int, bytes, bytes]]) -> None:
    status, out, err = said(["model", "ßµ°日.toml", "log.csv", "-o", "x.csv"], "ascii")
    assert (status, out) == (2, b"")
    assert err.startswith(b"sculler: ?udeg?.toml: no such design file")
    assert err.count(b"\n") == 1


def test_files_stay_utf_8(folder: Path, said: Callable[..., tuple[int, bytes, bytes]]) -> None:
    pages = []
    for encoding in ("ascii", "utf-8"):
        assert said(QUICK["navigate"], encoding)[0] == 0
        pages.append((folder / "nav.html").read_bytes())
    assert pages[0] == pages[1]
    assert "°" in pages[0].decode("utf-8")


PLAIN = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}


@pytest.mark.parametrize(
    "environment", [PLAIN, {"PYTHONIOENCODING": "cp1252"}, {"PYTHONIOENCODING": "ascii:strict"}]
)
def test_as_a_process_with_names_that_are_no_text(
    folder: Path, environment: dict[str, str]
) -> None:
    """File names hold any bytes, and reach us as such where the locale does not know them."""
    name = os.fsdecode(b"caf\xe9 \xff [red].csv")
    (folder / name).write_bytes((folder / "v.csv").read_bytes())
    words = ("navigate", "little.toml", name, "-o", os.fsdecode(b"n\xff.csv"), "--truth",
             "truth.csv", "--report", "nav.html", "--no-plots")  # fmt: skip
    done = subprocess.run(
        [sys.executable, "-m", "sculler", *words],
        cwd=folder, capture_output=True, check=False, env={**os.environ, **environment},
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, b"")
    assert "caf" in (folder / "nav.html").read_text(encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "sculler", "compare", name, "absent[/x]"],
        cwd=folder, capture_output=True, check=False, env={**os.environ, **environment},
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.count(b"\n") == 1
    assert b"absent[/x]: cannot read" in done.stderr
