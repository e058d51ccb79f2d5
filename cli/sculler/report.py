"""One HTML page that holds a navigated run: figures, pictures and settings, nothing outside it."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from sculler.formats.origin import Step, environment, told
from sculler.runs.navigation import against_truth
from sculler_model.design import Design
from sculler_model.outputs import replacing

_STYLE = """
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, sans-serif; color: #222; background: #fff;
       max-width: 64rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; margin-bottom: 0; }
h2 { font-size: 1.15rem; margin-top: 2rem; border-bottom: 1px solid #ddd; }
p.sub { color: #666; margin-top: 0.2rem; }
table { border-collapse: collapse; }
th, td { padding: 0.15rem 0.9rem 0.15rem 0; text-align: left; vertical-align: top; }
th { font-weight: 600; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
tr.section td { border-top: 1px solid #ddd; }
td.name { color: #666; white-space: nowrap; }
img { max-width: 100%; height: auto; margin: 0.5rem 0; }
ul.warnings { background: #fff4e5; border-left: 4px solid #d55e00; padding: 0.6rem 2rem; }
summary { cursor: pointer; color: #444; margin-top: 0.6rem; }
pre { background: #f6f6f6; padding: 0.8rem; overflow-x: auto; }
"""


def write_report(
    path: Path,
    design: Design,
    facts: Mapping[str, str],
    errors: Mapping[str, Any] | None,
    pictures: Sequence[Path],
    settings: Mapping[str, Any],
    warnings: Sequence[str],
    steps: Sequence[Step] = (),
) -> None:
    """Write the page, whole or not at all.

    Args:
        path: the page.
        design: the design that navigated.
        facts: name and value of what is worth saying.
        errors: `AgainstTruth.summary`, None without a truth.
        pictures: PNG files, taken into the page.
        settings: of the run, as the command line names them.
        warnings: what to look at before trusting the run.
        steps: the files that it comes from, and theirs.
    """
    warnings = [*warnings, *told(steps)]
    parts = [
        f"<h1>{escape(design.name)}: navigated run</h1>",
        f'<p class="sub">{escape(str(settings.get("VECTORS", "")))}</p>',
    ]
    if warnings:
        items = "".join(f"<li>{escape(warning)}</li>" for warning in warnings)
        parts.append(f'<ul class="warnings">{items}</ul>')
    parts += ["<h2>Run</h2>", _facts(facts)]
    if errors is not None:
        parts += ["<h2>Errors against the truth</h2>", _errors(dict(errors))]
    if pictures:
        parts.append("<h2>Pictures</h2>")
        parts += [_picture(picture) for picture in pictures]
    parts += ["<h2>Settings</h2>", _facts({key: str(value) for key, value in settings.items()})]
    parts += ["<h2>Where it comes from</h2>", *_origin(steps)]
    described = json.dumps(design.model_dump(mode="json"), indent=2, ensure_ascii=False)
    parts += ["<h2>Design</h2>", f"<pre>{escape(described)}</pre>"]
    page = (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(design.name)}: navigated run</title>\n<style>{_STYLE}</style>\n"
        "</head>\n<body>\n" + "\n".join(parts) + "\n</body>\n</html>\n"
    )
    with replacing(path) as temporary:
        # a file's name may hold bytes that are no text
        temporary.write_text(page, encoding="utf-8", errors="backslashreplace")


def _facts(rows: Mapping[str, str]) -> str:
    cells = (
        f'<tr><td class="name">{escape(name)}</td><td>{escape(value)}</td></tr>'
        for name, value in rows.items()
    )
    return _table(cells)


def _origin(steps: Sequence[Step]) -> list[str]:
    """The program, the files with their hashes, and what made each of them."""
    lines = ["<tr><th>file</th><th>SHA-256</th><th>made by</th></tr>"]
    parts = []
    for step in steps:
        maker = step.note if step.record is None else _maker(step.record)
        cells = (step.name, step.sha256, maker)
        lines.append("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>")
        if step.record is not None:
            said = {**_flat(step.record.get("settings")), **_flat(step.record.get("result"))}
            parts.append(f"<details><summary>{escape(f'{step.name}: {maker}')}</summary>")
            parts += [_facts(said), "</details>"]
    return [f"<p>This page: {escape(environment())}.</p>", _table(lines), *parts]


def _maker(record: Mapping[str, Any]) -> str:
    return f"{record.get('verb', '?')}, {record.get('program', '?')}"


def _flat(data: Any, before: str = "") -> dict[str, str]:
    """Nested data as rows: names joined by full stops; what is empty is left out."""
    if isinstance(data, dict):
        rows: dict[str, str] = {}
        for name, value in data.items():
            rows |= _flat(value, f"{before}.{name}" if before else str(name))
        return rows
    if data is None or data == [] or data == "":
        return {}
    return {before: str(data)}


def _errors(errors: dict[str, Any]) -> str:
    head = '<tr><th></th><th>unit</th><th class="n">rms</th><th class="n">largest</th>'
    cells = [head + '<th class="n">at the end</th></tr>']
    for number, (what, unit, *figures) in enumerate(against_truth.rows(errors)):
        section = ' class="section"' if number % 4 == 0 else ""
        numbers = "".join(f'<td class="n">{escape(figure)}</td>' for figure in figures)
        cells.append(f"<tr{section}><td>{escape(what)}</td><td>{escape(unit)}</td>{numbers}</tr>")
    return _table(cells)


def _table(lines: Iterable[str]) -> str:
    return "<table>\n" + "\n".join(lines) + "\n</table>"


def _picture(path: Path) -> str:
    data = b64encode(path.read_bytes()).decode("ascii")
    return f'<img alt="{escape(path.stem)}" src="data:image/png;base64,{data}">'
