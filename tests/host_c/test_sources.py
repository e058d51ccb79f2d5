"""The host's C sources under compilers, checkers and sanitizers."""

from __future__ import annotations

import os
import re
import shutil
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import tiers
from docs.pages import blocks
from sculler.formats.telemetry import FRAME, frames_of
from sculler.host_c import host_texts, library_texts
from sculler_model.design import Design
from sculler_model.fast import FastModel
from sculler_model.golden import to_words
from sculler_model.host import major_increments
from sculler_model.motion import turn_motion
from sculler_model.navigation import NavHistory, Navigator, NavState
from sculler_model.samples import Quantiser

ROOT = Path(__file__).parents[2]
DESIGNS = (
    Design.preset("hg4930"),
    Design.preset("stim300", position="high-resolution"),
    Design.preset("adis16488"),
)
WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Werror".split()
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-O0")

COMPILERS = ("gcc", "clang")
MATHEMATICS = {"sqrt", "sin", "cos", "asin", "atan2", "exp", "log", "fabs", "copysign"}


def needed(tool: str) -> str:
    if shutil.which(tool) is None:
        pytest.skip(f"needs {tool}")
    return tool


def called(*command: str | Path, given: bytes = b"") -> bytes:
    done = subprocess.run(command, input=given, capture_output=True, check=False)
    assert done.returncode == 0, (
        done.returncode,
        done.stdout[-2000:],
        done.stderr.decode()[-4000:],
    )
    return done.stdout


def sanitized(compiler: str, folder: Path) -> None:
    """Skip where the compiler has no sanitizers: they are a package of their own."""
    (folder / "empty.c").write_text("int main(void) { return 0; }\n")
    command = [needed(compiler), *SANITIZERS, folder / "empty.c", "-o", folder / "empty"]
    if subprocess.run(command, capture_output=True, check=False).returncode:
        pytest.skip(f"needs {compiler}'s sanitizers")


@pytest.fixture(scope="module")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sources")
    for texts in (library_texts(), *map(host_texts, DESIGNS)):
        for name, text in texts.items():
            (folder / name).write_text(text)
    return folder


@pytest.mark.parametrize("compiler", tiers.few_of(COMPILERS, ["gcc"]))
def test_compilers_have_nothing_to_say(compiler: str, sources: Path, tmp_path: Path) -> None:
    """And outside nothing is called but listed functions of <math.h>, and copies of memory."""
    flags = ["-std=c99", "-ffreestanding", "-O2", *WARNINGS]
    for source in sorted(sources.glob("*.c")):
        called(needed(compiler), *flags, "-c", source, "-o", tmp_path / f"{source.stem}.o")
    for header in sorted(sources.glob("*.h")):
        # clang misses the use of functions that stand in a header
        called(compiler, *flags, "-Wno-unused-function", "-fsyntax-only", "-x", "c", header)
    objects = list(tmp_path.glob("*.o"))
    assert len(objects) == 6 + len(DESIGNS)
    names = {
        kind: set(re.findall(rf" {kind} (\w+)", called("nm", *objects).decode())) for kind in "UT"
    }
    outside = names["U"] - names["T"]
    assert outside - {"memcpy", "memset"} <= MATHEMATICS
    assert {"sin", "cos", "asin"} <= outside
    # no object has a state: nothing lies in memory that is written to
    assert not re.findall(r" [BbDdCG] \w+", called("nm", *objects).decode())


def test_cppcheck_finds_nothing(sources: Path) -> None:
    asked = ["--enable=warning,style,performance,portability", "--std=c99", "-q", "--inline-suppr"]
    called(needed("cppcheck"), *asked, "--error-exitcode=1", *sorted(sources.glob("*.c")))


ALLOWED = {
    "9.3": "the checker takes a structure that holds an array for one",
    "12.1": "precedence that C's own grammar makes plain stays without brackets",
    "12.3": "the checker takes `double x, y;` for a comma operator",
    "15.5": "a function that refuses its arguments returns at once",
    "18.4": "a row of a table is found by adding to a pointer",
    "19.2": "the bits of a double are told by a union",
    "2.4": "the names of an enumeration are used, its tag is not",
    "2.5": "a header has constants that its own program may not use",
    "8.7": "functions of a library are called from outside",
    "8.9": "a design's scales stand at the head of its file",
}
"""Advisory rules of MISRA C:2012 that are not followed, and why."""


@pytest.mark.deep
def test_misra(sources: Path, tmp_path: Path) -> None:
    """Every required rule that cppcheck's addon can tell, and all others but a few.

    Of the library of doubles: C++ has rules of its own, and floats take <tgmath.h>.
    """
    for path in sources.iterdir():
        if not path.stem.endswith("_single"):
            shutil.copy(path, tmp_path)
    files = [path for path in tmp_path.glob("*.c") if path.stem.startswith(("sculler_", "stim"))]
    done = subprocess.run(
        [needed("cppcheck"), "--addon=misra", "--std=c99", "-q", *sorted(files)],
        capture_output=True,
        text=True,
        check=False,
    )
    if "addon" in done.stdout + done.stderr and "misra-c2012" not in done.stderr:
        pytest.skip("needs cppcheck's MISRA addon")
    found = set(re.findall(r"misra-c2012-([\d.]+)", done.stderr))
    assert found <= set(ALLOWED)


def flight(design: Design, seconds: float) -> tuple[bytes, NavHistory, list[int]]:
    """Words of a turn as bytes, states by Python, and their status."""
    motion = turn_motion(speed=30.0, bank=None)
    samples = round(seconds * design.sensor.sample_rate_hz)
    quantise, core = Quantiser(design), FastModel(design)
    chunks = motion.chunks(design.sensor.kind, samples, design.sample_interval)
    counts = np.concatenate([quantise(chunk) for chunk in chunks])
    block = core.feed(counts)
    rows = zip(block.major, block.status, block.components.tolist(), strict=True)
    words = b"".join(
        struct.pack(f"<{len(w)}H", *w)
        for w in (to_words(design, (int(m), int(s), *row)) for m, s, row in rows)
    )
    start = NavState(
        0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 30.0, 0.0), *np.radians([48.0, 11.0]).tolist(), 500.0
    )
    found = major_increments(design, block)
    states = Navigator(start, design.major_interval).run(found)
    return words, states, block.status.tolist()


@pytest.mark.deep
@pytest.mark.parametrize("compiler", COMPILERS)
def test_the_program_of_the_page_under_sanitizers(
    compiler: str, sources: Path, tmp_path: Path
) -> None:
    """Its frames are Python's; of a stream that lost words and has others it makes no bad use."""
    sanitized(compiler, tmp_path)
    page = blocks(ROOT / "docs/how-to/host-in-c.md")
    (program,) = [block.text for block in page if block.title == "flight.c"]
    (tmp_path / "flight.c").write_text(program)
    used = [path for path in sources.glob("*.c") if path.stem.startswith(("sculler_", "hg4930"))]
    binary = tmp_path / "flight"
    flags = ["-std=c99", *WARNINGS, *SANITIZERS, f"-I{sources}"]
    called(needed(compiler), *flags, tmp_path / "flight.c", *used, "-lm", "-o", binary)
    words, states, status = flight(DESIGNS[0], 8.0)
    assert called(binary, given=words) == frames_of(states, np.array(status), 0)
    hurt = bytearray(words)
    del hurt[100:116]
    hurt[3000:3400] = b"\xff" * 200 + b"\x80\x00" * 100
    done = subprocess.run([binary], input=hurt, capture_output=True, check=False)
    assert done.returncode in (0, 2)
    assert b"runtime error" not in done.stderr
    assert b"Sanitizer" not in done.stderr
    assert len(done.stdout) % FRAME.itemsize == 0


MODES = """
import ctypes, numpy as np
from sculler.host_c import HostInC, NavigatorInC, align_finely_in_c
from sculler_model.design import Design
from sculler_model.host import MajorIncrements
from sculler_model.fast import VectorBlock, as_integers
from sculler_model.navigation import (
    NORMAL, HeightDamping, NavState, constant_gravity, table_of_gravity
)

random = np.random.default_rng(1)
table = table_of_gravity(np.radians([20.0, 50.0]), np.array([0.0, 900.0]), np.full((2, 2), 9.8))
for name in NAMES:
    design = Design.preset(name, position="high-resolution" if name == "stim300" else "trapezoidal")
    host = HostInC(design, FLAGS)
    rows = []
    for i in range(60):
        words = [getattr(design.words, component[:-2]) for component in design.components]
        rows.append((i, 0, *(int(random.choice([w.lo, w.hi, 0, w.hi // 3])) for w in words)))
    found = host.increments(VectorBlock.from_rows(rows, design), third_order=host.third_order())
    assert np.isfinite(found.phi).all()
    small = np.full((30, 3), 1e-3)
    whole = MajorIncrements(small, small, small, small)
    for lat in (0.8, 1.5707963267948966):
        start = NavState(0.0, (1.0, 0.0, 0.0, 0.0), (1.0, 2.0, 3.0), lat, 0.1, 500.0, 1.0)
        host.coasted(start, 7.0)
        for gravity in (NORMAL, constant_gravity(), *[table] * (lat < 0.8)):
            for every in (1, 7):
                for damping in (None, HeightDamping(500.0, 30.0)):
                    NavigatorInC(host, start, position_every=every, height_damping=damping,
                                 gravity=gravity).run(whole)
    noisy = 1e-7 * random.normal(size=(1300, 3))
    rest = MajorIncrements(noisy, noisy, [0.0, 0.0, -9.81 * design.major_interval] + noisy)
    align_finely_in_c(host, rest, 0.8, 300.0)
print("clean")
"""


@pytest.mark.parametrize("design", tiers.few_of(("stim300", "adis16488"), ()))
def test_every_mode_under_sanitizers(tmp_path: Path, design: str) -> None:
    runtime = called(needed("gcc"), "-print-file-name=libasan.so").decode().strip()
    if not Path(runtime).is_absolute():
        pytest.skip("needs gcc's address sanitizer")
    environment = {
        **os.environ,
        "LD_PRELOAD": runtime,
        "ASAN_OPTIONS": "detect_leaks=0:verify_asan_link_order=0",
        "SCULLER_CACHE": str(tmp_path),
        "CC": "gcc",
    }
    code = MODES.replace("FLAGS", ", ".join(map(repr, SANITIZERS))).replace(
        "NAMES", f"[{design!r}]"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False
    )
    assert done.stdout == "clean\n", done.stderr[-3000:]
    assert "runtime error" not in done.stderr
