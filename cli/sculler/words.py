"""Words for numbers and warnings, and how work tells how far it has come; no terminal."""

from __future__ import annotations

from collections.abc import Callable, Sequence

Advance = Callable[[int], None]
"""Tell a progress bar that this much more is done."""


def plural(count: int, thing: str) -> str:
    """`1 sample`, `2,000 samples`."""
    return f"{count:,} {thing}" + ("" if count == 1 else "s")


def three_digits(value: float) -> str:
    """1.5, 5,900, 0.000761: three significant digits, without an exponent where they are many."""
    if abs(value) >= 1000:
        return f"{float(f'{value:.3g}'):,.0f}"
    return f"{value:.3g}"


def warning_rows(warnings: Sequence[str]) -> dict[str, str]:
    """Warnings as rows of a table: name and text."""
    return {f"warning {at}": told for at, told in enumerate(warnings, start=1)}


def silent(amount: int) -> None:
    """An `Advance` that tells nobody."""
