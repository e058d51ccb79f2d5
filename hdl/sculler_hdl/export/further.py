"""The files beside the core: its properties, and what a design asks for around it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from sculler_hdl.export.bus_files import bus_files
from sculler_hdl.export.front import front_files
from sculler_hdl.export.properties import property_file
from sculler_hdl.export.unit import unit_files
from sculler_model.design import Design

Writer = Callable[[Design], Mapping[str, str]]
"""Gives texts by file name; none where the design does not ask for them."""

_WRITERS: tuple[Writer, ...] = (property_file, front_files, bus_files, unit_files)


def further_files(design: Design) -> Mapping[str, str]:
    """Texts by file name, beside those of the core.

    Raises:
        ToolError: Yosys failed.
    """
    return MappingProxyType(
        {name: text for write in _WRITERS for name, text in write(design).items()}
    )
