"""The core, or the unit, as an IP-XACT component: IEEE 1685-2014 and IEEE 1685-2022.

Both have the same content: ports, standard interfaces, files, and parameters that tell what the
core is.  Elements stand in the order that the schemas of either year ask for.  The definitions of
AMBA's interfaces are those of Arm's IP-XACT library (amba.com, AMBA4).
"""

from __future__ import annotations

from xml.etree import ElementTree as Xml

from sculler_hdl import Port
from sculler_sim.package.contents import LIBRARY, VENDOR, Contents, Interface
from sculler_sim.package.ipxact_registers import MAP, memory_map
from sculler_sim.package.ipxact_writer import SCHEMA_INSTANCE, Writer, Year

YEARS: tuple[Year, ...] = (2014, 2022)

_BUSES = {
    "axi-stream": ("amba.com", "AMBA4", "AXI4Stream", "r0p0_1"),
    "axi-lite": ("amba.com", "AMBA4", "AXI4-Lite", "r0p0_0"),
    "apb": ("amba.com", "AMBA4", "APB4", "r0p0_0"),
}

_MODES: dict[Year, tuple[str, str]] = {2014: ("slave", "master"), 2022: ("target", "initiator")}
"""What the side that takes is called, and that which gives."""


def ipxact_component(contents: Contents, year: Year) -> str:
    """The text of NAME_ipxact_YEAR.xml."""
    writer = Writer(year)
    add = writer.add
    root = Xml.Element(writer.tag("component"))
    root.set(
        f"{{{SCHEMA_INSTANCE}}}schemaLocation",
        f"{writer.namespace} {writer.namespace}/index.xsd",
    )
    for name, text in (
        ("vendor", VENDOR),
        ("library", LIBRARY),
        ("name", contents.name),
        ("version", contents.version),
    ):
        add(root, name, text)
    if year == 2022:
        add(root, "description", contents.summary)
    if contents.interfaces:
        buses = add(root, "busInterfaces")
        for interface in contents.interfaces:
            _bus_interface(writer, buses, interface)
    if contents.registers is not None:
        memory_map(writer, root, contents.registers)
    _model(writer, root, contents)
    _file_sets(writer, root, contents)
    if year == 2014:
        add(root, "description", contents.summary)
    _parameters(writer, root, contents)
    Xml.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + Xml.tostring(root, "unicode") + "\n"


def _bus_interface(writer: Writer, parent: Xml.Element, interface: Interface) -> None:
    add = writer.add
    vendor, library, name, version = _BUSES[interface.kind]
    reference = {"vendor": vendor, "library": library, "version": version}
    element = add(parent, "busInterface")
    add(element, "name", interface.name)
    add(element, "busType", None, {**reference, "name": name})
    abstraction = add(add(element, "abstractionTypes"), "abstractionType")
    add(abstraction, "abstractionRef", None, {**reference, "name": f"{name}_rtl"})
    maps = add(abstraction, "portMaps")
    for logical, physical in interface.ports.items():
        mapped = add(maps, "portMap")
        add(add(mapped, "logicalPort"), "name", logical)
        add(add(mapped, "physicalPort"), "name", physical)
    mode = add(element, _MODES[writer.year][interface.gives])
    if interface.kind != "axi-stream":
        add(mode, "memoryMapRef", None, {"memoryMapRef": MAP})


def _model(writer: Writer, parent: Xml.Element, contents: Contents) -> None:
    add = writer.add
    model = add(parent, "model")
    view = add(add(model, "views"), "view")
    add(view, "name", "rtl")
    add(view, "envIdentifier", ":*Simulation:")
    add(view, "envIdentifier", ":*Synthesis:")
    add(view, "componentInstantiationRef", "verilog")
    instantiation = add(add(model, "instantiations"), "componentInstantiation")
    add(instantiation, "name", "verilog")
    add(instantiation, "language", "Verilog")
    add(instantiation, "moduleName", contents.top)
    add(add(instantiation, "fileSetRef"), "localName", "rtl")
    ports = add(model, "ports")
    for port in contents.ports:
        _port(writer, ports, port)


def _port(writer: Writer, parent: Xml.Element, port: Port) -> None:
    add = writer.add
    element = add(parent, "port")
    add(element, "name", port.name)
    add(element, "description", port.meaning)
    wire = add(element, "wire")
    add(wire, "direction", "out" if port.output else "in")
    if port.bits > 1:
        vector = add(add(wire, "vectors"), "vector")
        add(vector, "left", str(port.bits - 1))
        add(vector, "right", "0")


def _file_sets(writer: Writer, parent: Xml.Element, contents: Contents) -> None:
    sets = {
        "rtl": [(file, "verilogSource") for file in contents.verilog],
        "models": [(file, "verilogSource") for file in contents.models],
        "vhdl": [(contents.vhdl, "vhdlSource")] if contents.vhdl else [],
        "bench": [
            (file, "verilogSource" if file.endswith(".v") else "user") for file in contents.bench
        ],
        "constraints": [(f"{contents.name}.sdc", "SDC")],
    }
    add = writer.add
    element = add(parent, "fileSets")
    for name, files in sets.items():
        if not files:
            continue
        one = add(element, "fileSet")
        add(one, "name", name)
        for file, kind in files:
            entry = add(one, "file")
            add(entry, "name", file)
            user = {"user": "vectors"} if kind == "user" else {}
            add(entry, "fileType", kind, user)


def _parameters(writer: Writer, parent: Xml.Element, contents: Contents) -> None:
    add = writer.add
    element = add(parent, "parameters")
    for name, kind, value, meaning in (
        ("design_sha256", "string", f'"{contents.design.digest}"', "SHA-256 of the design"),
        ("samples_per_result", "int", str(contents.design.samples_per_major), "samples a result"),
    ):
        one = add(element, "parameter", None, {"parameterId": name, "type": kind})
        add(one, "name", name)
        add(one, "description", meaning)
        add(one, "value", value)
