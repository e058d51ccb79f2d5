"""A timing diagram as SVG: levels as lines, numbers in boxes, a break where clocks are left out."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from itertools import groupby

from sculler_sim.package.diagrams import GAP, Diagram, Lane

_COLUMN, _LANE, _HIGH = 44, 30, 18
_LEFT, _TOP, _SLOPE = 110, 26, 4

_STYLE = (
    "text{font:12px monospace;fill:#222}"
    ".w{fill:none;stroke:#1f4e8c;stroke-width:1.5}"
    ".d{fill:#e8f0fb;stroke:#1f4e8c;stroke-width:1.5}"
    ".n{fill:#ddd;stroke:#aaa}"
    ".g{stroke:#ddd}.c{fill:#888;font-size:10px}.b{fill:#fff;stroke:none}"
)


def svg(diagram: Diagram) -> str:
    """The text of an SVG element; the same diagram gives the same text."""
    columns = len(diagram.clocks)
    width, height = _LEFT + _COLUMN * columns + 10, _TOP + _LANE * len(diagram.lanes) + 6
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}"'
        f' viewBox="0 0 {width} {height}" role="img">',
        f"<title>{escape(diagram.title)}</title><style>{_STYLE}</style>",
        f'<rect class="b" width="{width}" height="{height}"/>',
    ]
    for i, clock in enumerate(diagram.clocks):
        x = _LEFT + i * _COLUMN
        parts.append(f'<path class="g" d="M{x} {_TOP - 8}V{height - 4}"/>')
        if clock is not GAP:
            parts.append(_text(x + _COLUMN // 2, 12, str(clock), "c", "middle"))
    for number, lane in enumerate(diagram.lanes):
        base = _TOP + number * _LANE + _HIGH
        parts.append(_text(_LEFT - 8, base - 4, lane.name, "", "end"))
        parts += _lane(lane, base, columns)
    parts += [_break(i, height) for i, clock in enumerate(diagram.clocks) if clock is GAP]
    return "\n".join([*parts, "</svg>", ""])


def _text(x: int, y: int, text: str, kind: str, anchor: str) -> str:
    kind = f' class="{kind}"' if kind else ""
    return f'<text x="{x}" y="{y}"{kind} text-anchor="{anchor}">{escape(text)}</text>'


def _lane(lane: Lane, base: int, columns: int) -> list[str]:
    if not lane.cells:
        half = _COLUMN // 2
        return [f'<path class="w" d="M{_LEFT} {base}{_clock(half) * columns}"/>']
    parts: list[str] = []
    line: list[str] = []
    x = _LEFT
    for cell, same in groupby(_filled(lane.cells)):
        end = x + _COLUMN * len(list(same))
        if isinstance(cell, int):
            y = base - _HIGH * cell
            line.append(f"{'L' if line else 'M'}{x + (_SLOPE if line else 0)} {y}H{end}")
        else:
            parts += _flushed(line)
            parts += _box(cell, x, end, base)
        x = end
    return [*parts, *_flushed(line)]


def _clock(half: int) -> str:
    return f"v-{_HIGH}h{half}v{_HIGH}h{half}"


def _filled(cells: Sequence[int | str | None]) -> list[int | str]:
    """What stands before a gap goes on in it, as far as it is drawn at all."""
    filled: list[int | str] = []
    for cell in cells:
        filled.append(filled[-1] if cell is GAP else cell)
    return filled


def _flushed(line: list[str]) -> list[str]:
    """The line so far, which ends."""
    path = [f'<path class="w" d="{"".join(line)}"/>'] if line else []
    line.clear()
    return path


def _box(text: str, x: int, end: int, base: int) -> list[str]:
    """A number, or what means nothing."""
    middle, top = base - _HIGH // 2, base - _HIGH
    points = (
        f"{x},{middle} {x + _SLOPE},{top} {end - _SLOPE},{top} {end},{middle}"
        f" {end - _SLOPE},{base} {x + _SLOPE},{base}"
    )
    shape = f'<polygon class="{"d" if text else "n"}" points="{points}"/>'
    return [shape, *([_text((x + end) // 2, base - 4, text, "", "middle")] if text else [])]


def _break(column: int, height: int) -> str:
    x = _LEFT + column * _COLUMN + _COLUMN // 2
    return (
        f'<rect class="b" x="{x - 6}" y="{_TOP - 8}" width="12" height="{height - _TOP + 4}"/>'
        + _text(x, height // 2, "…", "", "middle")
    )
