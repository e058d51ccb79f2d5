"""The self-checking Verilog test bench of a core with many channels, with its golden vectors.

As that of one channel (`testbench`) it needs no Python to run, and holds every port on every clock
to the golden vectors and to the contract.  That of the compact core and that of the pipelined one
stand in files of their own, in parts that are put into the bench.  It has fewer goals: runs between
resets whose samples come of few channels in random order, some of them restarts; stalls on both
handshakes, offers that are withdrawn, and results that wait until samples are held up.
"""

from __future__ import annotations

import random
from collections.abc import Collection, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from sculler_hdl import result_ports, sample_ports
from sculler_model.design import STATUS_LOST, Design
from sculler_model.fast import FastChannels
from sculler_model.golden import (
    AFTER_LAUNCH,
    ChannelTiming,
    PipelinedChannelTiming,
    clocks_per_major,
    to_words,
    words_per_column,
    words_per_result,
)
from sculler_sim.bench_goals import slices
from sculler_sim.bench_text import (
    checks,
    clocking_connections,
    connections,
    declarations,
    fill,
    packed_hex,
)

_SEED = 2005
_MOST = 12  # channels that samples come of
_RUNS = 6
_CLOCKS = 300_000  # of all runs, about


class ChannelRun(NamedTuple):
    """From a reset to the next.

    Attributes:
        rows: of each sample counts, fault, channel and restart, in the order of `sample_ports`.
        delay: clocks between the last sample and the reset.
        drains: whether all results are taken before it.
    """

    rows: list[tuple[int, ...]]
    delay: int
    drains: bool


AnyTiming = ChannelTiming | PipelinedChannelTiming


def channel_bench(design: Design, timing: AnyTiming, cells: Collection[str]) -> dict[str, str]:
    """The test bench's files, text by name; see `testbench.write_testbench`."""
    runs = list(_runs(design, timing))
    golden = [_expected(design, run.rows) for run in runs]
    words = [row for results in golden for row in results]
    parts = words_per_result(design)
    inputs, outputs = sample_ports(design), result_ports(design)
    places = {port.name: place for port, place in slices(inputs)}
    restart = places["sample_restart"]
    samples = sum(len(run.rows) for run in runs)
    slowest = timing.longest_wait + (timing.handover_spacing + 64) * parts
    values: dict[str, Any] = {
        "name": design.name,
        "sources": " ".join(f"{name}.v" for name in (design.name, *cells)),
        "samples": samples,
        "results": len(words) // parts,
        "runs": len(runs),
        "channels": design.channels,
        "active": len({row[-2] for run in runs for row in run.rows}),
        "per_major": design.samples_per_major,
        "parts": parts,
        "startup": timing.startup,
        "handover_spacing": timing.handover_spacing,
        "results_at_once": timing.results,
        "lost_part": words_per_column(design),
        "lost_bit": STATUS_LOST.bit_length() - 1,
        "timeout": 10_000 + (samples + len(words) // parts) * slowest,
        "sample_bits": sum(port.bits for port in inputs),
        "result_bits": sum(port.bits for port in outputs),
        "channel_top": inputs[-2].bits - 1,
        "channel_place": places["sample_channel"],
        "restart_place": f"[{restart[1:].split(':')[0]}]",
        "declarations": "\n".join(declarations(outputs)),
        "connections": ",\n".join(connections(inputs, outputs)),
        "checks": "\n".join(checks(outputs)),
        "clocking_connections": "\n".join(f"    {each}," for each in clocking_connections(design)),
        "plans": "\n".join(_plans(runs, [len(results) // parts for results in golden])),
        **_contract(design, timing, inputs[-2].bits - 1),
    }
    return {
        f"{design.name}_tb.v": fill("channel_bench.v.in", values),
        f"{design.name}_samples.hex": packed_hex((row for run in runs for row in run.rows), inputs),
        f"{design.name}_expected.hex": packed_hex(words, outputs),
        "README.md": fill("channel_bench.md.in", values),
    }


def _contract(design: Design, timing: AnyTiming, channel_top: int) -> dict[str, Any]:
    """The parts of the contract by their places in the bench."""
    values: dict[str, Any] = {"lookup": timing.lookup, "channel_top": channel_top}
    if isinstance(timing, ChannelTiming):
        template, before = "channel_contract_compact.v.in", timing.lookup + timing.loading
        values |= {
            "loading": timing.loading,
            "clearing": timing.clearing,
            "after": AFTER_LAUNCH,
            "phases": design.algorithm.samples,
            "work": "\n".join(
                f"      {phase}: work = {clocks};"
                for phase, clocks in enumerate(timing.work)
                if clocks
            ),
        }
    else:
        template, before = "channel_contract_pipelined.v.in", timing.lookup
        values |= {name: getattr(timing, name) for name in ("spacing", "apart", "waiting")}
    _, *parts = fill(template, values).split("//// ")
    named = (part.split("\n", 1) for part in parts)
    told = {f"contract_{name}": text.rstrip("\n") for name, text in named}
    return {**told, "shown": timing.latency - before}


def _plans(runs: Sequence[ChannelRun], results: Sequence[int]) -> Iterator[str]:
    """The table of the runs."""
    samples = made = 0
    for number, (run, more) in enumerate(zip(runs, results, strict=True)):
        samples, made = samples + len(run.rows), made + more
        yield (
            f"      {number}: plan_of = {{32'd{samples}, 32'd{made}, 32'd{run.delay},"
            f" 1'd{int(run.drains)}}};"
        )


def active_channels(design: Design, most: int = _MOST) -> list[int]:
    """The channels that samples come of: the first, the last, and by turns others far apart."""
    last = design.channels - 1
    few = [0, last, *(last ^ (1 << bit) for bit in range(last.bit_length()))]
    few += [1 << bit for bit in range(last.bit_length())]
    return sorted(list(dict.fromkeys(channel for channel in few if channel <= last))[:most])


def _runs(design: Design, timing: AnyTiming) -> Iterator[ChannelRun]:
    """Two long runs, whose results are all taken, and short ones that a reset cuts."""
    rng = random.Random(_SEED)
    clocks = clocks_per_major(design, timing)
    most = min(_MOST, max(2, _CLOCKS // (clocks * 4 * (3 + _RUNS))))
    channels = active_channels(design, most)
    interval = len(channels) * design.samples_per_major
    for number in range(_RUNS):
        whole = number in (0, _RUNS - 1)
        count = max(4 * interval, 150) if whole else max(interval, 20)
        rows = list(_rows(design, channels, count, rng))
        yield ChannelRun(rows, rng.randrange(2 * timing.latency), whole)


def _rows(
    design: Design, channels: Sequence[int], count: int, rng: random.Random
) -> Iterator[tuple[int, ...]]:
    """Random samples, many counts at an end of their width; restarts and faults, not often."""
    words = design.words
    allowed = [words.gyro] * 3 + [words.accel] * 3
    span = design.samples_per_major
    for _ in range(count):
        wild = rng.random() < 0.3
        counts = (
            rng.choice((word.lo, word.hi))
            if wild and rng.random() < 0.7
            else rng.randint(word.lo + 1, word.hi - 1)
            for word in allowed
        )
        fault = rng.random() < 0.5 / span
        restart = rng.random() < 0.2 / span
        yield (*counts, int(fault), rng.choice(channels), int(restart))


def _expected(design: Design, rows: Sequence[Sequence[int]]) -> list[tuple[int, ...]]:
    """The words of all results of a run, as `result_ports` has them."""
    table = np.array(rows, np.int64)
    block = FastChannels(design).feed(table[:, :6], table[:, 7], table[:, 6], table[:, 8])
    assert block.channels is not None
    found: list[tuple[int, ...]] = []
    for row, channel in zip(block.rows(), block.channels.tolist(), strict=True):
        words = to_words(design, row)
        found += [(word, int(i == len(words)), channel) for i, word in enumerate(words, start=1)]
    return found
