"""Functions compiled by Numba (the extra `fast`), and kept by it on disk between processes.

They are plain Python without it.  Importing this module does not import Numba.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from contextlib import suppress
from types import FunctionType, ModuleType
from typing import Any

# Numba colours its messages, also those that nobody sees, and has colorama exchange `sys.stdout`
# and `sys.stderr` meanwhile.  We compile in threads: it would take away what others print.
os.environ.setdefault("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1")


_alone = False


def alone() -> None:
    """Say that nobody else in this process uses Numba.

    It is then loaded without SciPy, whose linear algebra it would offer to compiled functions.
    Ours use none, and it takes a tenth of a second and 16 MB.
    """
    global _alone
    _alone = True


def _load() -> None:
    """Load what of Numba looks for SciPy, out of its sight."""
    if not _alone or {"numba", "scipy"} & sys.modules.keys():
        return
    sys.modules["scipy"] = None  # type: ignore[assignment]  # it cannot be imported now
    try:
        with suppress(ImportError):
            import numba.np.arraymath  # noqa: F401
    finally:
        del sys.modules["scipy"]


def available() -> bool:
    """Whether Numba is there.  Imports it."""
    _load()
    try:
        import numba  # noqa: F401
    except ImportError:
        return False
    return True


def callable_when_compiled(*modules: ModuleType, **options: Any) -> None:
    """Let compiled functions call all functions that the modules define.

    Args:
        modules: theirs.
        options: of Numba, for these functions.

    Raises:
        ImportError: Numba is missing.
    """
    _load()
    from numba.extending import register_jitable

    made_callable = register_jitable(**options) if options else register_jitable
    for module in modules:
        for function in vars(module).values():
            if isinstance(function, FunctionType) and function.__module__ == module.__name__:
                made_callable(function)


def compiled(function: Callable[..., Any], *sources: ModuleType, **options: Any) -> Any:
    """The function in machine code, made at its first call for each type of its arguments.

    Compiling takes some seconds; what was made is kept on disk.

    Args:
        function: in Python that Numba takes.
        sources: modules, other than its own, whose functions it calls.  Numba sees a change of the
            function's own file only, and cannot read what it kept of types that are gone: with the
            others' text in its name the code of another version has a file of its own.
        options: of Numba, for this function.

    Raises:
        ImportError: Numba is missing.
    """
    _load()
    from hashlib import sha256
    from inspect import getsource

    from numba import njit

    if sources:
        key = sha256("".join(map(getsource, sources)).encode()).hexdigest()[:16]
        function.__qualname__ = f"{function.__name__}_{key}"
    try:
        return njit(cache=True, **options)(function)
    except RuntimeError:  # there is nowhere to keep it: compiled anew in every process
        return njit(**options)(function)
