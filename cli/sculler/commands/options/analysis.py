"""Options of the studies against frequency."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.analyze import subjects

if TYPE_CHECKING:
    from sculler.commands.analyze.frequency import Kind
    from sculler_model.analysis.frequency import Oscillation


def frequency_options(
    unit: str, requirements: Sequence[float]
) -> Callable[[subjects.Command], subjects.Command]:
    """The band, how many frequencies, the sensor and the requirement lines."""

    def decorate(command: subjects.Command) -> subjects.Command:
        return subjects.chain(
            command,
            click.option(
                "--from",
                "low",
                type=terminal.number_type(0, above=True),
                default=1.0,
                show_default=True,
                metavar="HZ",
                help="Lowest frequency.",
            ),
            click.option(
                "--to",
                "high",
                type=terminal.number_type(0, above=True),
                metavar="HZ",
                help="Highest frequency; the fastest design's Nyquist limit if left out.",
            ),
            click.option(
                "--points",
                type=click.IntRange(2, 1_000_000),
                default=1000,
                show_default=True,
                help="Frequencies by closed form.",
            ),
            click.option(
                "--integer-points",
                type=click.IntRange(1, 1000),
                default=10,
                show_default=True,
                help="Frequencies through the integer path.",
            ),
            click.option(
                "--fine", is_flag=True, help="Run designs on a fine sensor, as families are."
            ),
            click.option(
                "--requirement",
                "requirements",
                type=terminal.number_type(0, above=True),
                multiple=True,
                default=tuple(requirements),
                show_default=bool(requirements),
                metavar="DRIFT",
                help=f"A requirement to hold it against, {unit}; repeatable.",
            ),
        )

    return decorate


def run_frequency_study(
    kind: Kind,
    vibration: Oscillation,
    output: Path | None,
    as_json: bool,
    low: float,
    high: float | None,
    points: int,
    integer_points: int,
    fine: bool,
    requirements: tuple[float, ...],
    **chosen: Any,
) -> None:
    """Hand what the options say to the study."""
    from sculler.commands.analyze.frequency import study

    subjects.require_picture(output)
    found = subjects.subjects(**chosen)
    own = {name: not fine and not subject.of_family for name, subject in found.items()}
    designs = {name: subject.design for name, subject in found.items()}
    study(
        kind,
        vibration,
        designs,
        own,
        (low, high),
        points,
        integer_points,
        requirements,
        output,
        as_json,
    )
