"""Compensation before both cores: the emitted Verilog in Verilator.

Amaranth's simulator has every port on every clock in `hdl/test_compensated.py`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from rtl import anywhere_in_four_majors, check_files, check_resets, check_trace
from sculler_hdl import properties, timing
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_sim.testbench import write_testbench
from strategies import with_hardware

pytestmark = pytest.mark.usefixtures("verilator")

ERRORS: dict[str, Any] = {
    "delay_samples": 0.4,
    "gyro": {"bias": [20.0, -40.0, 10.0], "scale_factor": 500.0, "misalignment": [1.0] * 6},
    "accel": {"bias": [2.0, -1.0, 3.0], "misalignment": [-1.0, 0.5, 0.3, -0.8, 0.2, -0.4]},
}


def stim300(samples: int, minors: int, **more: Any) -> Design:
    algorithm = {"samples": samples, "minors": minors, **more}
    name = f"compensated_{samples}x{minors}"
    data = {"preset": "stim300", "name": name, "algorithm": algorithm}
    return Design.parse({**data, "compensation": ERRORS})


FORMS = {
    "pipelined": stim300(4, 5),
    "pipelined-ecp5": with_hardware(stim300(2, 2, history=1), target="ecp5"),
    "pipelined-drop": with_hardware(stim300(1, 1, history=1), overrun="drop-result"),
    "pipelined-clocking": with_hardware(
        stim300(2, 2), reset="async", reset_active="low", clock_enable=True
    ),
    "compact": with_hardware(stim300(4, 5), core="compact"),
    "compact-ecp5": with_hardware(stim300(2, 2), core="compact", target="ecp5"),
    "compact-ice40": with_hardware(stim300(2, 1), core="compact", target="ice40"),
    "compact-drop": with_hardware(
        stim300(1, 1, history=1), core="compact", overrun="drop-result", initial=False
    ),
}
ARMED = {
    "arms_m": [[0.05, 0.02, -0.03], [0.01, -0.05, 0.02], [-0.02, 0.03, 0.05]],
    "accel_denominator": 1 << 34,
}
for name in ("pipelined-ecp5", "compact-ice40"):
    data = FORMS[name].as_json()
    FORMS[f"{name}-arms"] = Design.parse(
        {**data, "name": "armed", "compensation": data["compensation"] | ARMED}
    )
EACH = pytest.mark.parametrize("design", FORMS.values(), ids=FORMS)


@pytest.mark.deep
@EACH
def test_results_and_ports(design: Design, tmp_path: Path) -> None:
    """The golden model's vectors, the cycle model's clocks, and both after resets."""
    if design.drops_results:
        check_trace(design, "verilator", 6000, range(4))
        return
    check_files(design, tmp_path, ["model", "verilator"], 200)
    check_trace(design, "verilator", 6000, range(4))
    check_resets(design, tmp_path, 10 * design.samples_per_major, anywhere_in_four_majors(design))


def test_what_is_not_built_is_told(tmp_path: Path) -> None:
    design = FORMS["compact"]
    with pytest.raises(InputError, match="compensation: the test bench is that of a core without"):
        write_testbench(design, tmp_path, timing(design))
    with pytest.raises(InputError, match="compensation: the properties are those of a core"):
        properties(design)
