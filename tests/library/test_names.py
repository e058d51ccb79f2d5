"""The front door: every public name is documented, has an example that runs, and loads lazily."""

from __future__ import annotations

import doctest
import importlib
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import sculler

NAMES = [name for name in sculler.__all__ if name != "__version__"]

PLAIN_ERRORS = {"InputError", "ToolError", "SimulationError"}
"""Kinds of `Error`, whose example shows how they are met."""


def _run(code: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        encoding="utf-8",
        check=True,
        stdin=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)},
    )
    return done.stdout


def test_importing_loads_nothing_heavy() -> None:
    heavy = ("numpy", "click", "amaranth", "pydantic", "pandas", "polars", "rich")
    assert _run(f"import sculler, sys; print([m for m in {heavy} if m in sys.modules])") == "[]\n"


def test_the_library_needs_neither_click_nor_pandas_nor_amaranth_to_model() -> None:
    code = (
        "import sculler, sys, numpy as np\n"
        "design = sculler.Design.preset('stim300')\n"
        "block = sculler.FastModel(design).feed(np.zeros((40, 6), int))\n"
        "sculler.navigate(design, block, lat=1, lon=2, height=3)\n"
        "print([m for m in ('click', 'pandas', 'polars', 'amaranth') if m in sys.modules])"
    )
    assert _run(code) == "[]\n"


def test_names_are_in_dir_and_others_are_no_attributes() -> None:
    assert set(sculler.__all__) <= set(dir(sculler))
    assert set(sculler.__all__) == {*sculler._PLACES, "__version__"}
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = sculler.nothing  # type: ignore[attr-defined]


def test_the_version_is_that_of_the_distribution() -> None:
    text = Path(__file__).parents[2].joinpath("pyproject.toml").read_text(encoding="utf-8")
    assert f'version = "{sculler.__version__}"' in text


@pytest.mark.parametrize("name", NAMES)
def test_every_public_name_is_documented_with_an_example_that_runs(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    thing: Any = getattr(sculler, name)
    text = vars(thing).get("__doc__") if isinstance(thing, type) else thing.__doc__
    assert text, f"sculler.{name} has no docstring"
    assert "\n    Examples:\n" in text, f"sculler.{name} has no example"
    monkeypatch.chdir(tmp_path)
    found = doctest.DocTestParser().get_doctest(text, {}, name, None, None)
    assert found.examples
    report: list[str] = []
    runner = doctest.DocTestRunner(optionflags=doctest.REPORT_NDIFF)
    runner.run(found, out=report.append)
    assert not runner.failures, "".join(report)


def _methods(thing: type) -> list[str]:
    return [
        name
        for name, value in vars(thing).items()
        if not name.startswith("_")
        and (callable(value) or isinstance(value, property | classmethod | staticmethod))
    ]


@pytest.mark.parametrize("name", [n for n in NAMES if isinstance(getattr(sculler, n), type)])
def test_every_public_method_is_documented(name: str) -> None:
    thing = getattr(sculler, name)
    assert [m for m in _methods(thing) if not getattr(thing, m).__doc__] == []


@pytest.mark.parametrize("name", NAMES)
def test_functions_say_what_they_take_give_and_raise(name: str) -> None:
    thing = getattr(sculler, name)
    if isinstance(thing, type):
        return
    text = thing.__doc__
    assert "    Args:\n" in text
    assert "    Raises:\n" in text
    if thing.__annotations__["return"] != "None":
        assert "    Returns:\n" in text


def test_one_class_catches_every_error() -> None:
    for name in PLAIN_ERRORS:
        assert issubclass(getattr(sculler, name), sculler.Error)
    assert issubclass(sculler.InputError, ValueError)
    assert issubclass(sculler.ToolError, RuntimeError)
    assert issubclass(sculler.SimulationError, RuntimeError)
    place = importlib.import_module("sculler_sim.place.tools")
    assert isinstance(place, ModuleType)
    assert issubclass(place.ToolError, sculler.Error)
