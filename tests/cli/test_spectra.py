"""How the command line says a vibration spectrum."""

from __future__ import annotations

from pathlib import Path

import pytest

from sculler.formats.spectra import spectrum_of
from sculler_model.analysis.vibration import PROFILES
from sculler_model.errors import InputError


@pytest.mark.parametrize("name", PROFILES)
def test_a_profile_by_its_name(name: str) -> None:
    assert spectrum_of(name) is PROFILES[name]


def test_spectrum_file_and_flat_band(tmp_path: Path) -> None:
    path = tmp_path / "psd.csv"
    path.write_text("freq_hz,psd_g2_per_hz\n20,0.04\n1000,0.04\n2000,0.01\n")
    assert spectrum_of(str(path)).rms == PROFILES["savage-98"].rms
    assert spectrum_of("flat:10-60:0.02").rms == pytest.approx(1.0)
    for wrong in ("flat:10:2", "flat:60-10:0.02", "nowhere.csv"):
        with pytest.raises(InputError):
            spectrum_of(wrong)
