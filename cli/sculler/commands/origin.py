"""What the running verb tells of itself in the record beside its output."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click


def settings() -> dict[str, Any]:
    """What the command line said, in its own names, and the defaults that came to be used."""
    context, said = click.get_current_context(), {}
    for parameter in context.command.params:
        assert parameter.name is not None
        value = context.params[parameter.name]
        if value not in (None, False):
            option = isinstance(parameter, click.Option)
            said[parameter.opts[-1] if option else parameter.human_readable_name] = value
    return said


def write_origin(output: Path, inputs: Mapping[str, str | Path], result: Mapping[str, Any]) -> None:
    """Write the record of a file that the running verb has written; none for a pipe.

    Args:
        output, inputs, result: as for `sculler.formats.origin.write_origin`.

    Raises:
        InputError: the record cannot be written.
    """
    from sculler.formats import origin

    verb = click.get_current_context().info_name
    origin.write_origin(output, inputs, result, verb=verb, settings=settings())
