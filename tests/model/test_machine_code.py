"""Functions in machine code: what their making must not touch."""

from __future__ import annotations

import subprocess
import sys

import pytest

from sculler_model import machine_code

COMPILES = """
import sys
from types import ModuleType

class Watched(ModuleType):
    def __setattr__(self, name, value):
        assert name not in ("stdout", "stderr"), f"{name} becomes {value!r}"
        super().__setattr__(name, value)

import sculler_model.fast
from sculler_model.machine_code import compiled
from numba.core import errors, types

sys.__class__ = Watched
def add(x):
    return (x + 1) * 2
assert compiled(add)(3) == 8
try:
    compiled(add)("no number")
except errors.TypingError as error:
    assert "No implementation" in str(error)
else:
    raise AssertionError
"""


@pytest.mark.skipif(not machine_code.available(), reason="Numba (extra `fast`) is missing")
def test_compiling_leaves_the_streams_alone() -> None:
    """It is done in threads, beside others who print: colours are not worth an exchange."""
    pytest.importorskip("colorama", reason="Numba colours nothing without it")
    done = subprocess.run(
        [sys.executable, "-"], input=COMPILES, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
