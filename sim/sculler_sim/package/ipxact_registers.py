"""The memory map of a unit's bus in IP-XACT: the registers, of the table that makes NAME.rdl."""

from __future__ import annotations

from xml.etree import ElementTree as Xml

from sculler_hdl import RegisterMap
from sculler_sim.package.ipxact_writer import Writer

MAP = "registers"
"""Name of the map, to which the bus refers."""

_ACCESS = {"r": "read-only", "rw": "read-write", "w1c": "read-write", "pulse": "write-only"}


def memory_map(writer: Writer, parent: Xml.Element, table: RegisterMap) -> None:
    """Add `memoryMaps` to a component: one map of one block of 4 KiB."""
    add = writer.add
    found = add(add(parent, "memoryMaps"), "memoryMap")
    add(found, "name", MAP)
    block = add(found, "addressBlock")
    add(block, "name", f"{table.design.name}_bus")
    add(block, "baseAddress", "0")
    add(block, "range", "4096")
    add(block, "width", "32")
    for register in table.registers:
        element = _register(writer, block, register.name, register.meaning, register.address)
        for field in register.fields:
            one = add(element, "field")
            add(one, "name", field.name)
            add(one, "description", field.meaning)
            add(one, "bitOffset", str(field.low))
            if writer.year == 2014:
                _reset(writer, one, field.reset)
                add(one, "bitWidth", str(field.bits))
                _how(writer, one, field.access)
            else:
                add(one, "bitWidth", str(field.bits))
                _reset(writer, one, field.reset)
                policies = add(one, "fieldAccessPolicies")
                _how(writer, add(policies, "fieldAccessPolicy"), field.access)
    for entry in table.window.entries:
        address = table.window_address + 4 * entry.first
        name, meaning = f"result_{entry.name}", f"{entry.meaning}, least significant word first"
        element = _register(writer, block, name, meaning, address, entry.words)
        one = add(element, "field")
        add(one, "name", "value")
        add(one, "bitOffset", "0")
        add(one, "bitWidth", "32")
        if writer.year == 2014:
            add(one, "access", "read-only")
        else:
            policies = add(one, "fieldAccessPolicies")
            add(add(policies, "fieldAccessPolicy"), "access", "read-only")
    add(found, "addressUnitBits", "8")


def _register(
    writer: Writer, parent: Xml.Element, name: str, meaning: str, address: int, words: int = 1
) -> Xml.Element:
    add = writer.add
    element = add(parent, "register")
    add(element, "name", name)
    add(element, "description", meaning)
    if words > 1 and writer.year == 2014:
        add(element, "dim", str(words))
    elif words > 1:
        add(add(element, "array"), "dim", str(words))
    add(element, "addressOffset", f"'h{address:X}")
    add(element, "size", "32")
    return element


def _reset(writer: Writer, parent: Xml.Element, value: int | None) -> None:
    if value is not None:
        reset = writer.add(writer.add(parent, "resets"), "reset")
        writer.add(reset, "value", f"'h{value:X}")


def _how(writer: Writer, parent: Xml.Element, access: str) -> None:
    writer.add(parent, "access", _ACCESS[access])
    if access == "w1c":
        writer.add(parent, "modifiedWriteValue", "oneToClear")
