"""How the command line says a vibration spectrum: a profile's name, a flat band, or a CSV file."""

from __future__ import annotations

from pathlib import Path

from sculler_model.analysis.vibration import PROFILES, SPECTRUM_COLUMNS, Spectrum
from sculler_model.errors import InputError


def spectrum_of(text: str) -> Spectrum:
    """A built-in profile's name, `flat:LOW-HIGH:DENSITY` (Hz, g²/Hz), or the path of a CSV file.

    Raises:
        InputError: it is none of these, or the file is at fault (see `Spectrum.load`).
    """
    if text in PROFILES:
        return PROFILES[text]
    if text.startswith("flat:"):
        return _flat_band(text)
    if Path(text).exists():
        return Spectrum.load(text)
    raise InputError(
        f"{text}: no such spectrum, give a CSV file ({','.join(SPECTRUM_COLUMNS)}),"
        f" flat:LOW-HIGH:DENSITY, or one of {', '.join(PROFILES)}"
    )


def _flat_band(text: str) -> Spectrum:
    try:
        band, density = text.removeprefix("flat:").split(":")
        low, high = band.split("-")
        return Spectrum.flat(float(low), float(high), float(density))
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"{text}: not a flat band, give flat:LOW-HIGH:DENSITY in Hz and g²/Hz, such as"
            " flat:20-2000:0.04"
        ) from None
