"""Groups of verbs whose modules are imported when they are asked for."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from typing import Any

import click


class VerbGroup(click.Group):
    """A group that imports a verb's module when the verb is asked for, so that `--help` is quick.

    Args:
        package: the package of the verbs' modules.
        verbs: in the order of the help; verb V is the click command `command` of the module
            `package.V` (with _ for -).
    """

    def __init__(self, *args: Any, package: str, verbs: Sequence[str], **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.package, self.verbs = package, tuple(verbs)

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The verbs."""
        return list(self.verbs)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """A verb's command, None if there is no such verb."""
        if cmd_name not in self.verbs:
            return None
        module = importlib.import_module(f"{self.package}.{cmd_name.replace('-', '_')}")
        command: click.Command = module.command
        return command
