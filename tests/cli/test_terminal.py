"""Progress bars: on a terminal only, and only for work that lasts."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any

import pytest

from sculler import terminal
from sculler.words import plural, three_digits


class FakeTerminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def shown(monkeypatch: pytest.MonkeyPatch, stderr: io.StringIO, after: float) -> str:
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr("sys.stderr", stderr)
    monkeypatch.setattr(terminal, "PROGRESS_AFTER", after)
    with terminal.progress("counting sheep", 3) as advance:
        for _ in range(3):
            advance(1)
    return stderr.getvalue()


def test_long_work_on_a_terminal_shows_a_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "counting sheep" in shown(monkeypatch, FakeTerminal(), -1.0)


def test_short_work_shows_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    assert shown(monkeypatch, FakeTerminal(), 60.0) == ""


def test_no_bar_off_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    assert shown(monkeypatch, io.StringIO(), -1.0) == ""


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (1.5, "1.5"),
        (5902.7, "5,900"),
        (20_149_000.0, "20,100,000"),
        (7.61e-4, "0.000761"),
    ],
)
def test_three_digits(value: float, text: str) -> None:
    assert three_digits(value) == text


def test_plural() -> None:
    assert plural(1, "row") == "1 row"
    assert plural(2000, "row") == "2,000 rows"


def test_streams_that_are_exchanged_while_a_verb_runs_are_told(
    run: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the tests themselves: else what a verb says is lost, and nobody knows to whom."""

    def exchanges(words: object) -> int:
        monkeypatch.setattr("sys.stderr", io.StringIO())
        return 0

    monkeypatch.setitem(run.__globals__, "main", exchanges)  # type: ignore[attr-defined]
    with pytest.raises(AssertionError, match=r"stderr becomes .* in MainThread"):
        run("demo")
