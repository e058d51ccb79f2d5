"""What `make accuracy` and `make hardware` share: where things go, and Markdown's tables."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from sculler_model.errors import InputError
from studies import documents


def test_a_document_goes_beside_its_pictures(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, images = tmp_path / "docs" / "page" / "figures.md", tmp_path / "docs" / "images"

    def compute(folder: Path) -> tuple[str, list[Path]]:
        assert folder == images
        assert folder.is_dir()
        return "≥ 1\n", [folder / "a.png", folder / "b.png"]

    documents.write_document(path, compute)
    assert path.read_bytes() == "≥ 1\n".encode()
    assert capsys.readouterr().out == f"wrote {path} and 2 pictures in {images}\n"


def test_nothing_is_computed_without_matplotlib(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(InputError, match="pictures need matplotlib"):
        documents.write_document(tmp_path / "figures.md", lambda _: pytest.fail("computed"))
    assert not list(tmp_path.iterdir())


def test_tables() -> None:
    rows = [("a", "1"), ("b", "2")]
    assert list(documents.table("lr", ("what", "how many"), rows)) == [
        "| what | how many |",
        "|---|---:|",
        "| a | 1 |",
        "| b | 2 |",
    ]
