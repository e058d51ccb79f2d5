"""What all tests share: surroundings that are the same everywhere."""

from __future__ import annotations

import gc
import os
import shutil
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

import pytest

CACHE = Path(__file__).parents[1] / "build" / "cache"
PICTURES = CACHE / "matplotlib"

_LOCALE = ("LANG", "LANGUAGE")
_COLOURS = ("FORCE_COLOR", "NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE", "COLUMNS", "LINES")
_OTHERS = ("PYTHONWARNINGS", "XDG_CACHE_HOME", "MAKEFLAGS", "MFLAGS", "MAKELEVEL")


def pytest_sessionstart(session: pytest.Session) -> None:
    """Have matplotlib find the fonts once, before workers start: it says so where that is slow."""
    if hasattr(session.config, "workerinput") or list(PICTURES.glob("fontlist-*")):
        return
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MPLCONFIGDIR", str(PICTURES))
        try:
            import matplotlib.font_manager  # noqa: F401
        except ImportError:
            return


def pytest_collection_finish() -> None:
    """Python looks for garbage rarely, and never among what was imported.

    A core makes millions of objects that all stay until it is done: to look through them again and
    again costs much.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(100_000, 20, 20)


@pytest.fixture(scope="session", autouse=True)
def _surroundings() -> Iterator[None]:
    """Nothing that whoever starts the tests has set changes what they see.

    Compiled simulators are kept in build/, not in the user's cache; programs speak English.
    """
    import quick_yosys
    from sculler_hdl.export import component

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SCULLER_CACHE", str(CACHE))
        patch.setenv("MPLCONFIGDIR", str(PICTURES))
        for name in [name for name in os.environ if name.startswith(("LC_", "VERILATOR"))]:
            patch.delenv(name)
        for name in (*_LOCALE, *_COLOURS, *_OTHERS):
            patch.delenv(name, raising=False)
        patch.setenv("LC_ALL", "C")
        if not os.access(os.path.expanduser("~"), os.W_OK):  # noqa: PTH111 (there may be none)
            # Yosys and nextpnr are translated at their first start, and that is kept
            patch.setenv("XDG_CACHE_HOME", str(CACHE / "home"))
        _use_quick_compiler(patch)
        patch.setattr(component, "subprocess", quick_yosys)
        yield


_QUICK_COMPILER = """#!/bin/sh
# The C++ compiler for models that run for a moment: it optimises nothing, and reads Verilator's
# header, which every model begins with, once for all.
if [ "$1" = --version ]; then
  {compiler} --version && echo "made quick by tests/conftest.py"
  exit
fi
folder=$(dirname "$0") core= trace=
for word; do
  shift
  case $word in
    -O*) continue;;
    core.cpp) core=1;;
    -DVM_TRACE=*) trace=${{word#*=}};;
  esac
  set -- "$@" "$word"
done
[ "$core" ] || exec {compiler} -O0 "$@"
header=$folder/traced-$trace.h
if ! [ -f "$header.gch" ]; then
  {compiler} -std=c++17 -fPIC -fvisibility=hidden -pthread -O0 -DVM_TRACE=$trace \\
    "-I$VERILATOR_ROOT/include" "-I$VERILATOR_ROOT/include/vltstd" \\
    -x c++-header "$header" -o "$header.$$" && mv "$header.$$" "$header.gch"
fi
exec {compiler} -O0 -include "$header" "$@"
"""


def _use_quick_compiler(patch: pytest.MonkeyPatch) -> None:
    """Point CXX to it, where g++ is there and nothing else is asked for."""
    compiler = shutil.which("g++")
    if os.environ.get("CXX") or compiler is None:
        return
    try:
        verilator = metadata.version("verilator")
    except metadata.PackageNotFoundError:
        return
    folder = CACHE / f"quick-compiler-{verilator}"  # for its header is kept there
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in (
        ("traced-0.h", '#include "verilated.h"\n'),
        ("traced-1.h", '#include "verilated.h"\n'),
        ("c++", _QUICK_COMPILER.format(compiler=f"'{compiler}'")),
    ):
        path, made = folder / name, folder / f"{name}.{os.getpid()}"
        if not path.exists() or path.read_text() != text:
            made.write_text(text)
            made.chmod(0o755)
            made.replace(path)
    patch.setenv("CXX", f"'{folder / 'c++'}'")
