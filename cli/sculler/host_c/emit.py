"""The files of a design's host in C: what depends on the design, and the library beside it."""

from __future__ import annotations

from importlib import resources
from string import Template

from sculler_model.algorithms import S_DENOMINATOR, SCROLLING_DENOMINATOR
from sculler_model.design import (
    FOURTH_ORDER_VECTORS,
    HIGH_RESOLUTION_VECTORS,
    THIRD_ORDER_VECTORS,
    Design,
    scales_hash,
)
from sculler_model.golden import WORD_BITS, words_per_column, words_per_result

LIBRARY = (
    "sculler_real.h",
    "sculler_single.h",
    "sculler_double_single.h",
    "sculler_double_single.hpp",
    "sculler_math.h",
    "sculler_nav.h",
    "sculler_nav.c",
    "sculler_increments.h",
    "sculler_increments.c",
    "sculler_align.h",
    "sculler_align.c",
    "sculler_noise.c",
    "sculler_fine.c",
    "sculler_telemetry.h",
    "sculler_telemetry.c",
)
"""The files that serve every design."""


def host_texts(design: Design) -> dict[str, str]:
    """The design's own files by name: NAME_host.h and NAME_host.c; the same for the same design."""
    prefix, words = f"{design.name}_host", _words(design)
    return {f"{prefix}.{end}": _filled(f"host.{end}.in", words) for end in ("h", "c")}


def library_texts() -> dict[str, str]:
    """The library's files by name."""
    return {name: _source(name) for name in LIBRARY}


def engine_text(design: Design) -> str:
    """What makes a shared library of a design's host: functions that take arrays."""
    return _filled("engine.c.in", _words(design))


def _source(name: str) -> str:
    room = resources.files("sculler").joinpath("host_c", "src")
    return room.joinpath(name).read_text(encoding="utf-8")


def _filled(name: str, words: dict[str, str]) -> str:
    return Template(_source(name)).substitute(words)


def _words(design: Design) -> dict[str, str]:
    """What the templates ask for."""
    algorithm, sensor = design.algorithm, design.sensor
    guard, per_column = f"{design.name.upper()}_HOST", words_per_column(design)
    registers = -(-per_column // 2)
    major_bits = min(64, WORD_BITS * per_column)
    widest = max(getattr(design.words, vector).bits for vector in design.vectors)
    sums = [
        f"    sums.{vector} = vector_of(result, {guard}_{vector.upper()});"
        for vector in design.vectors
    ]
    optional = (*HIGH_RESOLUTION_VECTORS, *THIRD_ORDER_VECTORS, *FOURTH_ORDER_VECTORS)
    missing = [vector for vector in optional if vector not in design.vectors]
    sums += [f"    sums.{vector} = none;" for vector in missing]
    if missing:
        sums.insert(0, "    const sculler_vector none = {0.0, 0.0, 0.0};")
    sums.insert(0, "    sculler_sums sums;")
    vectors = [
        f"    {guard}_{vector.upper()} = {3 * place},"
        for place, vector in enumerate(design.vectors)
    ]
    vectors[-1] = vectors[-1].rstrip(",")
    return {
        "name": design.name,
        "prefix": f"{design.name}_host",
        "guard": guard,
        "algorithm": f"{algorithm.family}, n = {algorithm.samples}, M = {algorithm.minors}",
        "digest": design.digest[:32],
        "sensor": f"sensor: {sensor.kind}, {sensor.sample_rate_hz:g} samples a second",
        "interval": repr(design.major_interval),
        "columns": str(len(design.columns)),
        "components": str(len(design.components)),
        "bits": str(widest),
        "words_per_column": str(per_column),
        "words": str(words_per_result(design)),
        "registers_per_column": str(registers),
        "registers": str(registers * len(design.columns)),
        "limbs": str(-(-per_column * WORD_BITS // 64)),
        "major_bits": str(major_bits),
        "hash": f"0x{scales_hash(design):08X}u",
        "major_mask": f"0x{(1 << major_bits) - 1:X}u",
        "vectors": "\n".join(vectors),
        "sums": "\n".join(sums),
        "dr_sf": ", dR_SF" if design.high_resolution else "",
        **{name: repr(scale) for name, scale in _scales(design).items()},
        "high_resolution": "true" if design.high_resolution else "false",
        "order": str(design.order),
        "higher": "    sculler_higher_orders(&scales, &sums, increments);\n" * (design.order > 2),
    }


def _scales(design: Design) -> dict[str, float]:
    """What the integers are worth, each expression as `sculler_model.host` has it."""
    g, a, T, table = design.gyro_scale, design.accel_scale, design.sample_interval, design.table
    fine = design.high_resolution
    third = g * g / design.composition.third if design.order > 2 else 0.0
    fourth = g**3 / design.composition.fourth if design.order > 3 else 0.0
    return {
        "alpha": g / table.sum_denominator,
        "nu": a / table.sum_denominator,
        "within": float(table.denominator),
        "between": float(2 * table.sum_denominator**2),
        "coning": g * g,
        "sculling": a * g,
        "s_alpha": g * T / S_DENOMINATOR if fine else 0.0,
        "s_nu": a * T / S_DENOMINATOR if fine else 0.0,
        "scrolling": a * g * T / SCROLLING_DENOMINATOR if fine else 0.0,
        "coning_third": g * third,
        "sculling_third": a * third,
        "coning_fourth": g * fourth,
        "sculling_fourth": a * fourth,
    }
