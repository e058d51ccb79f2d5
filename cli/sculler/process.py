"""What a process meets at its edges: output streams of any encoding, and signals that end it."""

from __future__ import annotations

import codecs
import os
import signal
import sys
import threading
import time
import unicodedata
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_PLAIN = {
    "°": "deg", "µ": "u", "μ": "u", "²": "2", "³": "3", "·": "*", "×": "x", "±": "+/-",
    "−": "-", "–": "-", "—": "-", "…": "...", "√": "sqrt", "≤": "<=", "≥": ">=", "≈": "~",
    "→": "->", "Ω": "Omega", "Φ": "Phi", "Δ": "Delta", "Σ": "Sigma", "α": "alpha", "υ": "upsilon",
    "ν": "nu", "θ": "theta", "λ": "lambda", "σ": "sigma", "ω": "omega", "⁻": "-", "•": "*",
    "″": '"', "′": "'",
}  # fmt: skip
"""How what we say is written where the characters are few."""

_BURST = 1.0  # seconds in which further signals are the same wish to end


class Ended(BaseException):
    """A signal asked the process to end.

    Attributes:
        status: the exit status that tells of it, 128 + its number.
    """

    def __init__(self, number: int) -> None:
        super().__init__(signal.Signals(number).name)
        self.status = 128 + number


def any_encoding() -> None:
    """Let stdout and stderr take every text, whatever they are encoded in, and be there.

    What the encoding lacks is written in plain letters: `deg` for the sign of degrees.
    """
    codecs.register_error("sculler", _plainly)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:  # closed by whoever started us
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115, PTH123
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="sculler")


def _plainly(error: UnicodeError) -> tuple[str, int]:
    """An error handler of codecs: the characters in ASCII."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(map(_plain, error.object[error.start : error.end])), error.end


def _plain(character: str) -> str:
    if character in _PLAIN:
        return _PLAIN[character]
    if 0xDC80 <= ord(character) <= 0xDCFF:  # a byte of a file's name that is no text
        return f"\\x{ord(character) - 0xDC00:02x}"
    if 0x2500 <= ord(character) < 0x2580:  # lines of tables
        return "-" if character in "─━╌╍┄┅" else "|" if character in "│┃" else "+"
    base = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode()
    return base or "?"


@contextmanager
def signals_raise(last_words: bool) -> Iterator[None]:
    """Within it SIGINT, SIGTERM and SIGHUP raise `Ended`, so that whatever is at work cleans up.

    A signal that whoever started us has set to be ignored (nohup, a job in the background) stays
    so.  Signals that follow within a second belong to the first, which often come in a burst;
    a later one raises again.

    Args:
        last_words: the process ends after it, so once one has come the rest are ignored: they would
            spoil the exit status of a process that is ending already.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    last = -_BURST

    def ended(number: int, frame: FrameType | None) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last >= _BURST:
            last = now
            raise Ended(number)

    before = {}
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is not signal.SIG_IGN:
            before[number] = signal.signal(number, ended)
    try:
        yield
    finally:
        asked = last >= 0
        for number, handler in before.items():
            signal.signal(number, signal.SIG_IGN if asked and last_words else handler)
