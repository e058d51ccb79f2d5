"""A heading of the page, with its table; and numbers to read."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from studies import documents


@dataclass
class Section:
    """One heading of the document.

    Attributes:
        title: the heading.
        before: what is compared.
        rows: what, the paper's figure, ours, and what gives ours.
        after: what agrees and what does not, by paragraphs.
        pictures: name and caption of each.
        reference: what the second column holds.
    """

    title: str
    before: str
    rows: list[tuple[str, str, str, str]] = field(default_factory=list)
    after: tuple[str, ...] = ()
    pictures: tuple[tuple[str, str], ...] = ()
    reference: str = "paper"

    def add(self, what: str, paper: str, ours: str, how: str) -> None:
        """A row of the table."""
        self.rows.append((what, paper, ours, how))

    def lines(self) -> Iterator[str]:
        """As Markdown."""
        yield from ("", f"## {self.title}", documents.paragraph(self.before), "")
        headings = ("quantity", self.reference, "ours", "given by")
        yield from documents.table("lrrl", headings, self.rows)
        for name, caption in self.pictures:
            yield from ("", f"![{caption}]({documents.IMAGES}/{name})")
        for paragraph in self.after:
            yield from ("", documents.paragraph(paragraph))


def number(value: float, digits: int = 2) -> str:
    """A number to read: 0.044, 1300, 1.5e-6."""
    if value == 0:
        return "0"
    size = abs(value)
    if 1e-3 <= size < 1e6:
        text = f"{float(f'{value:.{digits}g}'):.12g}"
    else:
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        text = f"{mantissa}e{int(exponent)}"
    return text.replace("-", "\N{MINUS SIGN}", 1) if value < 0 else text


def minus(text: str) -> str:
    """The text with minus signs for hyphens."""
    return text.replace("-", "\N{MINUS SIGN}")
