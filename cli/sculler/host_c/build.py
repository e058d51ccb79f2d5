"""Compiles a design's host in C into a shared library, kept between runs.

Everything made is in the cache of `sculler_sim`.
"""

from __future__ import annotations

import os
import platform
import shlex
import shutil
from pathlib import Path
from typing import Literal

from sculler.host_c.emit import engine_text, host_texts, library_texts
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_sim import processes
from sculler_sim.engines import cache

FLAGS = ("-O2", "-ffp-contract=off", "-fPIC", "-shared")
"""No product is fused with a sum, so that a host rounds as Python does."""

Precision = Literal["double", "double-single", "single"]
PRECISIONS: dict[Precision, tuple[str, ...]] = {
    "double": ("-std=c99",),
    "double-single": ("-std=c++11", "-x", "c++", "-DSCULLER_DOUBLE_SINGLE"),
    "single": ("-std=c99", "-DSCULLER_SINGLE", "-fsingle-precision-constant"),
}
"""What the library's numbers are (sculler_real.h), and what the compiler is told of it."""


def compiler() -> tuple[str, ...]:
    """The C compiler: $CC, else gcc, cc or clang.

    Raises:
        InputError: there is none.
    """
    try:
        wanted = shlex.split(os.environ.get("CC", ""))
    except ValueError as error:
        raise InputError(
            f"CC: {os.environ['CC']!r} is no command ({error}), set it to a C compiler or leave it"
            " out"
        ) from error
    choice = [wanted] if wanted else [["gcc"], ["cc"], ["clang"]]
    for name, *rest in choice:
        path = shutil.which(name)
        if path is not None:
            return (path, *rest)
    raise InputError(
        f"the engine c needs a C compiler ({choice[0][0]}), not found on PATH: on Debian, apt-get"
        " install gcc; or choose the engine python"
    )


def build(design: Design, *more_flags: str, precision: Precision = "double") -> Path:
    """The shared library of a design's host, from the cache or newly built.

    Args:
        design: the design.
        more_flags: of the compiler, such as sanitizers.
        precision: of all numbers.

    Raises:
        InputError: there is no compiler or it fails (its log is kept), the cache cannot be written
            to.
    """
    command = compiler()
    (version,) = processes.run([*command, "--version"])
    name = f"{design.name}_host"
    texts = {**library_texts(), **host_texts(design), "engine.c": engine_text(design)}
    flags = [*FLAGS, *PRECISIONS[precision], *more_flags]
    library = cache.entry(
        name, ".so", version.said, platform.machine(), *flags, *texts, *texts.values()
    )
    if library.exists():
        return library
    with cache.workshop() as work:
        for file, text in texts.items():
            (work / file).write_text(text, encoding="utf-8")
        sources = [file for file in texts if file.endswith(".c")]
        compiling = [*command, *flags, *sources, "-o", "host.so", "-lm"]
        (ended,) = processes.run(
            compiling, folder=work, environment={**os.environ, "TMPDIR": str(work)}
        )
        if ended.status or not (work / "host.so").is_file():
            log = library.with_suffix(".log")
            log.write_text(f"{shlex.join(compiling)}\n{ended.said}", encoding="utf-8")
            raise InputError(
                f"{design.name}: {Path(command[0]).name} failed ({ended.how}) while compiling the"
                f" host, see {log}"
            )
        (work / "host.so").replace(library)
    return library
