"""The self-checking Verilog-2001 test bench of a design, with its golden vectors.

It needs no Python to run: any simulator of Verilog-2001 does.  Inside,

* samples come from a file of random counts, full-scale ones among them; an LFSR stalls both
  handshakes, and every fourth result waits until the core has had to stop the samples;
* after a part of the samples, in mid-interval, reset is held for some clocks while a sample is
  offered; the rest of the samples then starts from nothing;
* every result port is compared with the golden model's, bit for bit, when the result comes and
  for as long as it waits; the latency is checked, and that no result comes too many;
* a line beginning with PASS or FAIL ends it.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator
from importlib import resources
from pathlib import Path
from string import Template

import numpy as np
from numpy.typing import NDArray

from sculler_model.cycles import PORT_MAJOR_BITS
from sculler_model.design import Design
from sculler_model.fast import run_fast
from sculler_model.vectors import AXES, VECTORS
from sculler_sim.files import make_folder, replacing

_SEED = 2001
_LEAST = ((1, 200), (2, 400))  # major intervals and samples before and after the reset


class _Template(Template):
    delimiter = "%%"  # neither Verilog nor Markdown has it


def write_testbench(design: Design, folder: str | Path, latency: int) -> list[Path]:
    """Write NAME_tb.v, its two vector files and a README.md beside the design's NAME.v.

    The same design gives the same bytes.

    Args:
        design: the design.
        folder: where NAME.v lies; made if need be.
        latency: the core's latency in clocks (`latency_clocks` in the manifest).

    Returns:
        The files written.

    Raises:
        InputError: the folder cannot be made or written to.
    """
    files = testbench(design, latency)
    folder = make_folder(folder)
    for name, text in files.items():
        with replacing(folder / name) as temporary:
            temporary.write_text(text, encoding="ascii", newline="\n")
    return [folder / name for name in files]


def testbench(design: Design, latency: int) -> dict[str, str]:
    """The test bench's files, text by name."""
    # whole major intervals and a part of one (where one is more than a sample)
    per_major = design.samples_per_major
    before, after = (
        max(intervals, -(-least // per_major)) * per_major + per_major // 2
        for intervals, least in _LEAST
    )
    samples = _samples(design, before + after)
    first = run_fast(design, samples[:before, :6], samples[:before, 6])
    second = run_fast(design, samples[before:, :6], samples[before:, 6])  # after a reset
    results = [*first.rows(), *second.rows()]

    words = design.words
    sample_ports = [
        *(
            (f"sample_{s}_{axis}", getattr(words, s).bits)
            for s in ("gyro", "accel")
            for axis in AXES
        ),
        ("sample_fault", 1),
    ]
    result_ports = [
        ("result_major", PORT_MAJOR_BITS),
        ("result_status", 2),
        *((f"result_{v}_{axis}", getattr(words, v).bits) for v in VECTORS for axis in AXES),
    ]
    numbers = {
        "name": design.name,
        "samples": len(samples),
        "before": before,
        "results": len(results),
        "results_before": len(first),
        "per_major": per_major,
        "latency": latency,
        "timeout": 1000 + 16 * len(samples) + (latency + 200) * len(results),
        "sample_bits": sum(bits for _, bits in sample_ports),
        "result_bits": sum(bits for _, bits in result_ports),
        "declarations": "\n".join(_declarations(result_ports)),
        "connections": ",\n".join(_connections(sample_ports, result_ports)),
        "checks": "\n".join(_checks(result_ports)),
    }
    return {
        f"{design.name}_tb.v": _fill("testbench.v.in", numbers),
        f"{design.name}_samples.hex": _hex(samples.tolist(), sample_ports),
        f"{design.name}_expected.hex": _hex(results, result_ports),
        "README.md": _fill("testbench.md.in", numbers),
    }


def _samples(design: Design, count: int) -> NDArray[np.int64]:
    """(count, 7) random counts and fault: half of the counts full-scale, some in long runs."""
    rng = random.Random(_SEED)
    allowed = [design.words.gyro] * 3 + [design.words.accel] * 3
    rows: list[list[int]] = []
    while len(rows) < count:
        held = [rng.choice((word.lo, word.hi)) for word in allowed]  # drives sums to their ends
        for _ in range(rng.choice((1, 2, 3, 40))):
            counts = [
                rng.choice((end, end, word.lo, word.hi, rng.randint(-3, 3), uniform))
                for end, word in zip(held, allowed, strict=True)
                for uniform in [rng.randint(word.lo, word.hi)]
            ]
            rows.append([*counts, int(rng.random() < 0.01)])
    return np.array(rows[:count], np.int64)


def _fill(template: str, values: dict[str, object]) -> str:
    text = resources.files("sculler_sim").joinpath(template).read_text(encoding="ascii")
    return _Template(text).substitute(values)


def _hex(rows: Iterable[Iterable[int]], ports: list[tuple[str, int]]) -> str:
    """One packed word a line for $readmemh, the first port in the lowest bits."""
    digits = -(-sum(bits for _, bits in ports) // 4)
    lines = []
    for row in rows:
        word = shift = 0
        for value, (_, bits) in zip(row, ports, strict=True):
            word |= (value & ((1 << bits) - 1)) << shift
            shift += bits
        lines.append(f"{word:0{digits}x}\n")
    return "".join(lines)


def _slices(ports: list[tuple[str, int]]) -> Iterator[tuple[str, int, str]]:
    """Each port's name, width and place in the packed word."""
    low = 0
    for name, bits in ports:
        yield name, bits, f"[{low + bits - 1}:{low}]"
        low += bits


def _declarations(ports: list[tuple[str, int]]) -> Iterator[str]:
    for name, bits, place in _slices(ports):
        kind = "" if name in ("result_major", "result_status") else "signed "
        wanted = name.replace("result_", "want_")
        yield f"  wire {kind}[{bits - 1}:0] {name};"
        yield f"  wire {kind}[{bits - 1}:0] {wanted} = want{place};"


def _connections(
    sample_ports: list[tuple[str, int]], result_ports: list[tuple[str, int]]
) -> Iterator[str]:
    for name, _, place in _slices(sample_ports):
        yield f"    .{name}(sample{place})"
    for name, _ in result_ports:
        yield f"    .{name}({name})"


def _checks(ports: list[tuple[str, int]]) -> Iterator[str]:
    for name, _ in ports:
        wanted = name.replace("result_", "want_")
        yield f"    end else if (want_valid && {name} !== {wanted}) begin"
        yield f'      $display("FAIL: result %0d, {name}: %0d, expected %0d",'
        yield f"               results, {name}, {wanted});"
        yield "      fail;"
