"""Options that describe a vibration and the mount it passes: `analyze vibration`, `advise`."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import click

from sculler import terminal

if TYPE_CHECKING:
    from sculler_model.analysis.vibration import Mount

Command = TypeVar("Command", bound=Callable[..., Any])

SPECTRUM_HELP = (
    "Vibration: savage-98, do160-like, vehicle-like, flat:LOW-HIGH:G2_PER_HZ, or a CSV"
    " freq_hz,psd_g2_per_hz."
)

_MOUNT = (
    ("--linear-hz", "linear_hz", 50.0, "HZ", "Linear mode, undamped natural frequency.", True),
    ("--linear-damping", "linear_damping", 0.125, "RATIO", "Linear mode, damping.", True),
    ("--rotary-hz", "rotary_hz", 71.0, "HZ", "Rotary modes, undamped natural frequency.", True),
    ("--rotary-damping", "rotary_damping", 0.18, "RATIO", "Rotary modes, damping.", True),
    ("--spacing", "spacing", 0.254, "M", "Distance between isolators, m.", True),
    ("--imbalance", "imbalance", 5.0, "PERCENT", "Stiffness and damping imbalance.", False),
    ("--offset", "offset", 1.4, "PERCENT", "Centre of mass off centre, of the spacing.", False),
)


def mount_options(command: Command) -> Command:
    """The mount; left out, that of Savage-98 section VI."""
    for flag, name, default, metavar, text, above in reversed(_MOUNT):
        command = click.option(
            flag,
            name,
            type=terminal.number_type(0, 100 if metavar == "PERCENT" else 1e6, above=above),
            default=default,
            show_default=True,
            metavar=metavar,
            help=text,
        )(command)
    return command


def mount(
    linear_hz: float,
    linear_damping: float,
    rotary_hz: float,
    rotary_damping: float,
    spacing: float,
    imbalance: float,
    offset: float,
) -> Mount:
    """The mount of the options, signs at their worst."""
    from sculler_model.analysis.vibration import Mount

    return Mount.worst(
        imbalance / 100,
        offset / 100,
        hz=linear_hz,
        damping=linear_damping,
        rotary_hz=rotary_hz,
        rotary_damping=rotary_damping,
        spacing=spacing,
    )
