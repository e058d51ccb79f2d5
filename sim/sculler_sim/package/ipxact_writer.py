"""Elements of IP-XACT in either edition of the standard."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal
from xml.etree import ElementTree as Xml

Year = Literal[2014, 2022]

_NAMESPACE = "http://www.accellera.org/XMLSchema/IPXACT/1685-{year}"
SCHEMA_INSTANCE = "http://www.w3.org/2001/XMLSchema-instance"


class Writer:
    """Makes elements of one edition of the standard."""

    def __init__(self, year: Year) -> None:
        self.year = year
        self.namespace = _NAMESPACE.format(year=year)
        Xml.register_namespace("ipxact", self.namespace)
        Xml.register_namespace("xsi", SCHEMA_INSTANCE)

    def tag(self, name: str) -> str:
        """Name of an element, with the namespace."""
        return f"{{{self.namespace}}}{name}"

    def add(
        self,
        parent: Xml.Element,
        name: str,
        text: str | None = None,
        attributes: Mapping[str, str] | None = None,
    ) -> Xml.Element:
        """A new element within another."""
        element = Xml.SubElement(parent, self.tag(name), dict(attributes or {}))
        element.text = text
        return element
