"""NAME_datasheet.html: a page that says what a core is, with timing diagrams of a real run.

It stands for itself: no other file, no script, nothing from the net.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from statistics import median
from typing import Any

from sculler_hdl import Generated, Manifest, Port, RegisterMap, unit_ports
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_sim.package.diagrams import Diagram, diagrams
from sculler_sim.package.drawing import svg

_STYLE = (
    "body{font:15px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:.5em 0}td,th{border:1px solid #ccc;padding:.2em .6em;"
    "text-align:left;vertical-align:top}code,td:first-child{font-family:monospace}"
    "figure{margin:1.5em 0;overflow-x:auto}@media print{svg{max-width:100%;height:auto}}"
)

_ACCESS = {
    "r": "read",
    "rw": "read, write",
    "w1c": "read, cleared by a 1",
    "pulse": "a 1 acts once",
}


def read_report(path: Path, design: Design) -> dict[str, Any]:
    """The `report.json` that `sculler place -o` has left of this design.

    Args:
        path: the file, or the folder that it is in.
        design: of which it has to be.

    Raises:
        InputError: it cannot be read, is no such report, or one of another design.
    """
    file = path / "report.json" if path.is_dir() else path
    try:
        report = json.loads(file.read_text(encoding="utf-8"))
        name, _ = report["design"], _placed_rows(report)
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}") from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{file}: no report of `sculler place -o`, give that folder") from error
    if name != design.name:
        raise InputError(f"{file}: is of design {name}, place {design.name} and give its folder")
    return dict(report)


def data_sheet_texts(
    generated: Generated, report: Mapping[str, Any] | None = None
) -> dict[str, str]:
    """The page, and its timing diagrams for WaveDrom: texts by the name of their file.

    Args:
        generated: the core; it is simulated.
        report: what `read_report` has of its placement; None where it was not placed.

    Raises:
        ToolError: the simulated core is not as the cycle model says.
    """
    manifest = generated.manifest
    drawn = diagrams(manifest.design)
    waves = json.dumps([each.as_wavejson() for each in drawn], indent=1)
    return {
        f"{manifest.name}_datasheet.html": _page(manifest, drawn, report),
        f"{manifest.name}_timing.json": f"{waves}\n",
    }


def _page(manifest: Manifest, drawn: Sequence[Diagram], report: Mapping[str, Any] | None) -> str:
    design = manifest.design
    sections = [
        ("Figures", [_table(("what", "how much"), _figures(manifest))]),
        ("Area and clock rate", _placed(design, report)),
        ("Ports", [_table(("port", "direction", "bits", "what"), map(_port, manifest.ports))]),
        ("Timing", _timing(drawn)),
        *_unit(design),
    ]
    body = "\n".join(
        "\n".join([f"<h2>{title}</h2>", *content]) for title, content in sections if content
    )
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f"<title>{escape(design.name)}</title><style>{_STYLE}</style></head><body>\n"
        f"<h1>{escape(design.name)}</h1>\n<p>{escape(_about(design))}</p>\n{body}\n"
        f"<p>Design <code>{design.digest}</code>, Verilog"
        f" <code>{manifest.verilog_sha256}</code>, by sculler"
        f" {escape(manifest.as_json()['tools']['sculler'])}.</p>\n</body></html>\n"
    )


def _about(design: Design) -> str:
    algorithm, hardware = design.algorithm, design.hardware
    return (
        f"Exact coning and sculling: {algorithm.family}, {algorithm.samples} samples a minor"
        f" interval, {algorithm.minors} minor intervals a result. {hardware.core.capitalize()}"
        f" core, target {hardware.target}. Nothing is rounded, no input overflows."
    )


def _figures(manifest: Manifest) -> list[tuple[str, str]]:
    design, timing = manifest.design, manifest.timing
    sensor = design.sensor
    return [
        (
            "samples",
            f"{sensor.kind}, gyro {sensor.gyro.bits}, accelerometer {sensor.accel.bits} bits",
        ),
        ("samples a result", f"{design.samples_per_major}"),
        ("latency", f"{manifest.latency_clocks} clocks, last sample to result_valid"),
        ("clocks a minor interval", f"{manifest.clocks_per_minor}, at the fastest"),
        ("clocks a result", f"{manifest.clocks_per_major}, at the fastest"),
        ("between samples", f"{timing.samples_apart} clocks or more"),
        ("after reset", f"{timing.startup} clocks until the first sample"),
        *((name.replace("_", " "), f"{count}") for name, count in manifest.resources.items()),
        *((name, f"{getattr(design.words, name).bits} bits") for name in design.vectors),
    ]


def _placed(design: Design, report: Mapping[str, Any] | None) -> list[str]:
    if report is None:
        told = f"Not placed. <code>sculler place {escape(design.name)}.toml</code> does it."
        return [f"<p>{told}</p>"]
    return [_table(("what", "how much"), _placed_rows(report))]


def _placed_rows(report: Mapping[str, Any]) -> list[tuple[str, str]]:
    area, rates = report["area"], [float(seed["mhz"]) for seed in report["seeds"]]
    rows = [("device", str(report["device"]))]
    rows += [
        (name, f"{area[key]:,}")
        for name, key in (
            ("look-up tables", "luts"),
            ("flip-flops", "flip_flops"),
            ("multiplier blocks", "multipliers"),
            ("block memories", "memories"),
        )
    ]
    if rates:
        spread = f"{min(rates):.1f} to {max(rates):.1f}"
        told = f"{median(rates):.1f} MHz, median of {len(rates)} ({spread})"
        rows.append(("clock rate", told))
    rows.append(("by", ", ".join(f"{name} {version}" for name, version in report["tools"].items())))
    return rows


def _timing(drawn: Sequence[Diagram]) -> list[str]:
    """The diagrams; lanes with a star stand for all ports of that beginning."""
    intro = (
        "Drawn from a run of this design in Amaranth's simulator, in which every port was as the"
        " cycle model says. Numbers above are clocks since power-up. Grey: means nothing."
    )
    figures = [
        f"<figure>\n<figcaption><b>{escape(each.title)}.</b> {escape(each.told)}</figcaption>\n"
        f"{svg(each)}</figure>"
        for each in drawn
    ]
    return [f"<p>{intro}</p>", *figures]


def _unit(design: Design) -> list[tuple[str, list[str]]]:
    """Ports and registers of the unit, where there is a bus."""
    bus = design.hardware.bus
    if bus is None:
        return []
    ports = _table(("port", "direction", "bits", "what"), map(_port, unit_ports(design)))
    sections = [(f"The unit {escape(design.name)}_unit", [ports])]
    if bus.has_registers:
        rows = [row for register in RegisterMap(design).registers for row in _register(register)]
        heads = ("address", "register", "bits", "access", "what")
        sections.append(("Registers", [_table(heads, rows)]))
    return sections


def _register(register: Any) -> Iterable[tuple[str, ...]]:
    yield f"0x{register.address:03X}", register.name, "", "", register.meaning
    for field in register.fields:
        high = field.low + field.bits - 1
        bits = f"{high}:{field.low}" if field.bits > 1 else str(high)
        yield "", f"… {field.name}", bits, _ACCESS[field.access], field.meaning


def _port(port: Port) -> tuple[str, ...]:
    sign = "signed " if port.declared_signed else ""
    return port.name, port.direction, f"{sign}{port.bits}", port.meaning


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = ["<table>", _row("th", heads), *(_row("td", row) for row in rows), "</table>"]
    return "\n".join(lines)


def _row(tag: str, cells: Sequence[str]) -> str:
    return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"
