"""Options that describe a vibration and the mount it passes: `analyze vibration`, `advise`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.options.group import group

if TYPE_CHECKING:
    from sculler_model.analysis.vibration import Mount

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


mount_options = group(
    *(
        click.option(
            flag,
            name,
            type=terminal.number_type(0, 100 if metavar == "PERCENT" else 1e6, above=above),
            default=default,
            show_default=True,
            metavar=metavar,
            help=text,
        )
        for flag, name, default, metavar, text, above in _MOUNT
    ),
    click.option(
        "--cascade",
        is_flag=True,
        help="The rotary modes do not act back on the linear one, as Savage seems to have it.",
    ),
)
"""The mount; left out, that of Savage-98 section VI; see `mount`."""


def mount(options: Mapping[str, Any]) -> Mount:
    """The mount of the options, signs at their worst."""
    from sculler_model.analysis.vibration import Mount

    return Mount.worst(
        options["imbalance"] / 100,
        options["offset"] / 100,
        hz=options["linear_hz"],
        damping=options["linear_damping"],
        rotary_hz=options["rotary_hz"],
        rotary_damping=options["rotary_damping"],
        spacing=options["spacing"],
        cascade=options["cascade"],
    )
