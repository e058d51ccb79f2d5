"""Compiles the host for a processor, weighs it, and counts what an update takes."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from string import Template

import numpy as np

from sculler.host_c import host_texts, library_texts
from sculler.library import motions
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel
from sculler_model.golden import to_words
from studies.host_c.stack import CallGraph
from studies.host_c.targets import FLAGS, LINKING, Target

DESIGN = Design.preset("stim300")
NAVIGATOR = ("sculler_nav", "sculler_increments", f"{DESIGN.name}_host")
TELEMETRY = ("sculler_telemetry",)
ALIGNMENT = ("sculler_align", "sculler_noise", "sculler_fine")
UPDATE = (
    *(f"{DESIGN.name}_host_{part}" for part in ("take_word", "from_words", "increments")),
    *("sculler_nav_begin", "sculler_nav_update", "sculler_nav_state", "sculler_coast"),
    "sculler_telemetry_write",
)
ALIGNING = tuple(f"sculler_align_{part}" for part in ("begin", "take", "finish", "refine"))
"""Functions that a flight calls, and an alignment."""

STAGES = ("decoding and increments", "navigator", "state and frame")
RESULTS, FEW, MANY = 16, 2, 6  # results that come in turn; updates of two programs


@dataclass(frozen=True)
class Measured:
    """What was found of a processor.

    Attributes:
        target: the processor.
        compiler: its version.
        code: bytes of instructions and constants: navigator, telemetry, alignment.
        whole: bytes of a program's navigator and telemetry with all they take of libraries; of a
            hosted target without these.
        data: bytes of memory of a navigator (`sculler_nav`), and of a window of alignment.
        stack: bytes that an update with state and frame takes.
        bound: bytes of stack at most, by the call graph, without libraries: flight, alignment.
        instructions: of an update, each of `STAGES`.
    """

    target: Target
    compiler: str
    code: tuple[int, int, int]
    whole: int
    data: tuple[int, int]
    stack: int
    bound: tuple[int, int]
    instructions: tuple[float, ...]

    @property
    def update(self) -> float:
        """Instructions from words to a navigated state, without telling it."""
        return self.instructions[0] + self.instructions[1]


def measure(target: Target, advance: Callable[[int], None] = lambda steps: None) -> Measured:
    """Everything of a processor.

    Raises:
        InputError: a tool is missing, or fails.
    """
    if target.missing is not None:
        raise InputError(f"{target.name}: {target.missing} is not installed")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _write(folder)
        modules = (*NAVIGATOR, *TELEMETRY, *ALIGNMENT)
        for module in modules:
            _called(
                folder,
                target.compiler,
                *FLAGS,
                *target.optimised,
                *target.flags,
                *target.precision,
                *target.language,
                "-fcallgraph-info=su",
                "-c",
                f"{module}.c",
            )
        sizes = {module: _text(folder, target, f"{module}.o") for module in modules}
        graph = CallGraph((folder / f"{module}.ci").read_text("utf-8") for module in modules)
        advance(1)
        counts, stack, linked = [], 0, 0
        for stage in range(len(STAGES)):
            runs = [_run(folder, target, stage, updates) for updates in (FEW, MANY)]
            counts.append((runs[1][0] - runs[0][0]) / (MANY - FEW))
            stack = runs[1][1]
            linked = _text(folder, target, "program") - _text(folder, target, "program.o")
            advance(1)
        version = _called(folder, target.compiler, "--version").splitlines()[0]
        return Measured(
            target,
            version,
            tuple(sum(sizes[m] for m in group) for group in (NAVIGATOR, TELEMETRY, ALIGNMENT)),  # type: ignore[arg-type]
            sum(sizes[m] for m in (*NAVIGATOR, *TELEMETRY)) if target.hosted else linked,
            _data(folder, target),
            stack,
            (graph.deepest(UPDATE), graph.deepest(ALIGNING)),
            tuple(float(count) for count in np.diff([0.0, *counts])),
        )


def _write(folder: Path) -> None:
    """The library, the design's host, and the program with its results."""
    for texts in (library_texts(), host_texts(DESIGN)):
        for name, text in texts.items():
            (folder / name).write_text(text, encoding="utf-8")
    log = motions.record(DESIGN, motions.motion("turn"), (RESULTS + 2) * DESIGN.major_interval)
    block = FastModel(DESIGN).feed(log.counts)[-RESULTS:]
    rows = zip(block.major, block.status, block.components.tolist(), strict=True)
    words = [to_words(DESIGN, (int(m), int(s), *row)) for m, s, row in rows]
    source = resources.files("studies.host_c").joinpath("program.c.in").read_text("utf-8")
    (folder / "program.c").write_text(
        Template(source).substitute(
            prefix=f"{DESIGN.name}_host",
            guard=f"{DESIGN.name.upper()}_HOST",
            words=",\n".join("    {" + ", ".join(map(str, row)) + "}" for row in words),
        ),
        encoding="utf-8",
    )


def _run(folder: Path, target: Target, stage: int, updates: int) -> tuple[int, int]:
    """Instructions of a whole program, and the bytes of stack that it tells."""
    defined = (f"-DSTAGE={stage}", f"-DUPDATES={updates}u", f"-DRESULTS={RESULTS}u")
    _called(
        folder,
        target.compiler,
        *FLAGS,
        *target.optimised,
        *target.flags,
        *target.precision,
        *defined,
        *("-std=gnu99", "-c", "program.c"),
    )
    objects = [f"{module}.o" for module in ("program", *NAVIGATOR, *TELEMETRY)]
    _called(
        folder,
        *(
            target.compiler,
            *FLAGS,
            *target.optimised,
            *target.flags,
            *LINKING,
            *objects,
            *target.linking,
        ),
        *("-o", "program"),
    )
    # a block of translated code for each instruction, and a line of the log for each block
    command = [*target.emulator, "-singlestep", "-d", "exec,nochain", "./program"]
    with subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        lines = sum(chunk.count(b"Trace ") for chunk in process.stderr)
        told = process.stdout.read()
    if process.returncode or not told.strip().isdigit():
        raise InputError(
            f"{target.name}: {target.emulator[0]} failed (status {process.returncode})"
        )
    return lines, int(told)


def _text(folder: Path, target: Target, name: str) -> int:
    """Bytes of instructions and constants of an object."""
    said = _called(folder, target.compiler.replace("gcc", "size"), name)
    return int(said.splitlines()[1].split()[0])


def _data(folder: Path, target: Target) -> tuple[int, int]:
    """Bytes of a navigator and of a window."""
    (folder / "data.c").write_text(
        '#include "sculler_align.h"\nchar nav[sizeof(sculler_nav)];\n'
        "char window[sizeof(sculler_align)];\n"
    )
    _called(
        folder,
        target.compiler,
        *FLAGS,
        *target.optimised,
        *target.flags,
        *target.precision,
        "-c",
        "data.c",
    )
    said = _called(folder, target.compiler.replace("gcc", "nm"), "-S", "data.o")
    found = {line.split()[3]: int(line.split()[1], 16) for line in said.splitlines()}
    return found["nav"], found["window"]


def _called(folder: Path, *command: str) -> str:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise InputError(f"{command[0]} failed: {done.stderr.strip()[-400:]}")
    return done.stdout


def measured(
    targets: Sequence[Target], advance: Callable[[int], None] = lambda steps: None
) -> list[Measured]:
    """All processors whose tools are there."""
    return [measure(target, advance) for target in targets if target.missing is None]
