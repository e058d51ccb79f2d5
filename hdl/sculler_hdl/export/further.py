"""The files around the core that a design asks for: sensor front end, bus, and all together."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from sculler_model.design import Design

Writer = Callable[[Design], Mapping[str, str]]
"""Gives texts by file name; none where the design does not ask for them."""

_WRITERS: tuple[Writer, ...] = ()


def further_files(design: Design) -> Mapping[str, str]:
    """Texts by file name, beside those of the core.

    Raises:
        ToolError: Yosys failed.
    """
    return MappingProxyType(
        {name: text for write in _WRITERS for name, text in write(design).items()}
    )
