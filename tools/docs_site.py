"""Hooks of MkDocs: the parts of the site that are made from the code.

A line `<!-- made: NAME ARGUMENTS -->` of a page is replaced by what the function of that name here
returns, so a reference cannot say other than the program does.  It imports no more of sculler than
the page asks for.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from typing import Any

import click


def on_page_markdown(markdown: str, **_: Any) -> str:
    """What MkDocs calls with a page's text; the text it goes on with."""
    return re.sub(r"^<!-- made: (\S+) ?(.*?) -->$", _made, markdown, flags=re.MULTILINE)


def _made(found: re.Match[str]) -> str:
    return MAKERS[found[1]](*found[2].split())


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    titles = list(head)
    lines = [titles, ["---"] * len(titles), *map(list, rows)]
    return "\n".join("| " + " | ".join(cells).replace("\n", " ") + " |" for cells in lines)


def design_keys(part: str) -> str:
    """The keys of one table of the design file, from its schema."""
    from pydantic_core import PydanticUndefined

    from sculler_model.design import (
        algorithm,
        band,
        compensation,
        custom_frame,
        design,
        filters,
        front,
        hardware,
        sensor,
        sensor_errors,
    )

    rooms = (design, sensor, sensor_errors, algorithm, hardware, band, filters, front, custom_frame)
    rooms += (compensation,)
    model = next(getattr(room, part) for room in rooms if hasattr(room, part))
    rows = []
    for key, field in model.model_fields.items():
        default = field.default
        if field.is_required() or default is PydanticUndefined:
            stated = "required"
        elif default is None or not isinstance(default, (str, int, float)):
            stated = "may be left out"
        else:
            stated = f"`{default!r}`".replace("'", '"')
        rows.append((f"`{key}`", (field.description or "").replace("|", "\\|"), stated))
    return _table(("key", "allowed", "if left out"), rows)


def presets() -> str:
    """The presets and what each fills in."""
    from sculler_model.design import PRESETS, Design

    rows = []
    for name in sorted(PRESETS):
        of = Design.preset(name)
        sensor, table = of.sensor, of.algorithm
        rows.append(
            (
                f"`{name}`",
                sensor.kind,
                f"{sensor.sample_rate_hz:g}",
                f"{sensor.gyro.bits} bits, {sensor.gyro.lsb:.6g}",
                f"{sensor.accel.bits} bits, {sensor.accel.lsb:.6g}",
                f"`{table.family}`, n = {table.samples}, p = {table.history}, M = {table.minors}",
            )
        )
    head = ("preset", "kind", "samples/s", "gyro, rad a count", "accelerometer, m/s a count")
    return _table((*head, "algorithm"), rows)


def ports(preset: str, *hardware: str) -> str:
    """The ports of a preset's core, from its manifest; `hardware` are key=value."""
    from sculler_hdl import describe_ports
    from sculler_model.design import Design

    keys = dict(pair.split("=") for pair in hardware)
    design = Design.parse({**Design.preset(preset).as_json(), "hardware": keys})
    rows = (
        (
            f"`{port['name']}`",
            port["direction"],
            f"{port['width']}{' signed' if port['signed'] else ''}",
            port["meaning"],
        )
        for port in describe_ports(design)
    )
    return _table(("port", "direction", "bits", "meaning"), rows)


def commands() -> str:
    """Every verb: its help, and its options as a list that fits a narrow screen."""
    from sculler.main import cli

    return "\n".join(_command(cli, ("sculler",), click.Context(cli, info_name="sculler")))


def _command(command: click.Command, path: tuple[str, ...], context: click.Context) -> list[str]:
    lines = []
    if len(path) > 1:
        words = [w for p in command.get_params(context) for w in _usage(p)]
        lines += [f"{'#' * len(path)} {' '.join(path[1:])}", "", "```text"]
        lines += [f"{' '.join(path)} [OPTIONS] {' '.join(words)}".rstrip(), "```", ""]
        lines += [_text(command.help or ""), ""]
        for option in command.get_params(context):
            if isinstance(option, click.Option) and option.name != "help":
                lines += _option(option, context)
        if command.epilog:
            lines += ["", "```text", _epilog(command.epilog), "```", ""]
    if isinstance(command, click.Group):
        for name in command.list_commands(context):
            verb = command.get_command(context, name)
            assert verb is not None
            inner = click.Context(verb, info_name=name, parent=context)
            lines += _command(verb, (*path, name), inner)
    return lines


def _usage(parameter: click.Parameter) -> list[str]:
    if not isinstance(parameter, click.Argument):
        return []
    word = parameter.human_readable_name
    return [f"{word}..." if parameter.nargs == -1 else word]


def _option(option: click.Option, context: click.Context) -> list[str]:
    record = option.get_help_record(context)
    if record is None:
        return []
    names, text = record
    return [f"`{names}`", f":   {_escaped(text)}", ""]


def _escaped(text: str) -> str:
    return re.sub(r"([<>*_`\\])", r"\\\1", text)


def _text(text: str) -> str:
    return _escaped(text.replace("\b\n", "")).replace("\n    ", "\n")


def _epilog(text: str) -> str:
    from inspect import cleandoc

    return cleandoc(text.replace("\b\n", ""))


def registers(preset: str) -> str:
    """The registers of a preset's bus; with all that a design can have."""
    from sculler_hdl.plan.registers import RegisterMap
    from sculler_model.design import Design

    base = {**Design.preset(preset).as_json()}
    hardware = {"overrun": "drop-result", "bus": {"result": "axi-lite"}}
    hardware["front"] = {"sensor": preset, "clock_hz": 1e8}
    words = {"r": "read", "rw": "read, write", "w1c": "read, clear by 1", "pulse": "write"}
    rows = (
        (
            f"`{register.address:03X}`" if not number else "",
            f"`{register.name}`" if not number else "",
            f"{field.low + field.bits - 1}:{field.low}" if field.bits > 1 else str(field.low),
            f"`{field.name}`",
            words[field.access],
            field.meaning,
        )
        for register in RegisterMap(Design.parse({**base, "hardware": hardware})).registers
        for number, field in enumerate(register.fields)
    )
    return _table(("address", "register", "bits", "field", "software", "meaning"), rows)


def bus_ports(result: str, *keys: str) -> str:
    """The ports of NAME_bus on the host's side; `keys` are key=value of [hardware.bus]."""
    from sculler_hdl.plan.bus_ports import bus_ports as ports_of
    from sculler_model.design import Design

    bus = {"result": result, **dict(pair.split("=") for pair in keys)}
    base = {**Design.preset("stim300").as_json(), "hardware": {"bus": bus}}
    own = [port for port in ports_of(Design.parse(base)) if not port.name.startswith("core_")]
    rows = ((f"`{p.name}`", p.direction, str(p.bits), p.meaning) for p in own)
    return _table(("port", "direction", "bits", "meaning"), rows)


def c_header(name: str) -> str:
    """A header of the host in C."""
    from sculler.host_c import library_texts

    return f"```c\n{library_texts()[name]}```"


MAKERS: dict[str, Callable[..., str]] = {
    "design-keys": design_keys,
    "presets": presets,
    "ports": ports,
    "registers": registers,
    "bus-ports": bus_ports,
    "c-header": c_header,
    "commands": commands,
}
