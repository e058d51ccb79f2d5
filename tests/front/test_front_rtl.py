"""The emitted front end on a line with known faults: samples and counters are the model's."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from front_bench import needs_icarus, run_verilog
from front_designs import design_of, made
from front_runs import Run, edges, run_line, run_model, whole_at
from sculler_hdl import generate
from sculler_hdl.plan.front import BaudPlan, FrontPlan
from sculler_model.design import Design
from sculler_model.front import Uart
from tiers import few_of

SLOW = 16 * 921600.0  # as few clocks as there may be in a bit


def without_initial_values() -> Design:
    data = design_of("custom", clock_hz=SLOW).as_json()
    data["hardware"]["initial"] = False
    return Design.parse(data)


def without_counter() -> Design:
    data = design_of("custom", clock_hz=SLOW).as_json()
    del data["hardware"]["front"]["frame"]["counter"]
    return Design.parse(data)


CASES = {
    "stim300": (design_of("stim300", clock_hz=SLOW, datagram=0x91), "stim300", 1),
    "stim300 any": (design_of("stim300", clock_hz=SLOW), "stim300", 1),
    "stim300 A7": (
        design_of("stim300 A7 at 125 Hz", clock_hz=SLOW, baud=921600.0),
        "stim300 A7 at 125 Hz",
        4,
    ),
    "hg4930": (design_of("hg4930", 500.0, clock_hz=16e6), "hg4930", 1),
    "custom": (design_of("custom", clock_hz=SLOW), "custom", 1),
    "no initial values": (without_initial_values(), "custom", 1),
    "custom, no counter": (without_counter(), "custom", 1),
    "custom, parity": (design_of("custom", clock_hz=1.7 * SLOW, parity="odd"), "custom", 1),
}
QUICK = ["stim300", "custom, no counter", "no initial values"]
Counts = tuple[tuple[int, int, int], tuple[int, int, int]]


def counts(number: int) -> Counts:
    return (number, -number, 1000 + number), (77 * number, 5, -3 * number)


class Line:
    """A line with faults, and what each of them is to do.

    Attributes:
        stream: bytes with the clocks of their start bits.
        damage: levels that disturb the line, with their clocks.
        lost: numbers of the frames that a placeholder stands for.
        marked: those with a fault of their own.
    """

    def __init__(self, design: Design, name: str, seed: int, frames: int) -> None:
        assert design.front is not None
        wire = design.front.wire
        assert isinstance(wire, Uart)
        rng = random.Random(seed)
        self.stream: list[tuple[int, int]] = []
        self.damage: list[tuple[int, int]] = []
        self.lost: set[int] = set()
        self.interval = design.front.interval
        self.begin = 400
        self.per_byte = 1 + int(design.front.clock_hz / wire.baud * wire.bits_per_byte)
        for number in range(frames):
            frame = made(name, *counts(number), number)
            at = self.begin + number * self.interval
            self._add(rng, number, bytearray(frame), at)
        self.end = self.begin + frames * self.interval

    def _add(self, rng: random.Random, number: int, frame: bytearray, at: int) -> None:
        kind = rng.choice(
            ["whole"] * 6 + ["bit", "cut", "dropped", "framing", "garbage"]
            if number > 1
            else ["whole"]
        )
        if kind == "bit":
            frame[rng.randrange(len(frame))] ^= 1 << rng.randrange(8)
        elif kind == "cut":
            del frame[rng.randrange(len(frame)) :]
        elif kind == "dropped":
            frame.clear()
        if kind not in ("whole", "garbage"):
            self.lost.add(number)
        last = at
        for place, byte in enumerate(frame):
            last = at + place * self.per_byte
            self.stream.append((last, byte))
        if kind == "garbage":  # ends before the next frame begins
            room = (at + self.interval - last) // self.per_byte - 2
            for place in range(min(room, 6)):
                self.stream.append((last + (place + 1) * self.per_byte, rng.randrange(256)))
        if kind == "framing":
            clock, _ = self.stream[-rng.randrange(1, len(frame))]
            self.damage.append((clock, 0))

    def levels(self, design: Design) -> list[tuple[int, int]]:
        """Of the line: a framing error is a stop bit drawn low."""
        found = edges(design, self.stream)
        assert design.front is not None
        assert isinstance(design.front.wire, Uart)
        bits = design.front.wire.bits_per_byte
        starts = {clock: place for place, (clock, _) in enumerate(self.stream)}
        for clock, _ in reversed(self.damage):
            at = bits * starts[clock] + bits - 1
            found[at] = (found[at][0], 0)
            found.insert(at + 1, (found[at][0] + self.per_byte // bits - 2, 1))
        return sorted(found)

    def whole_bytes(self, design: Design) -> list[tuple[int, int]]:
        """Bytes that the receiver gives, and the clocks in which it does."""
        bad = {clock for clock, _ in self.damage}
        return [(whole_at(design, clock), byte) for clock, byte in self.stream if clock not in bad]

    def expected(self) -> list[int | None]:
        """The frames whose samples come in order; None for placeholders."""
        frames = round((self.end - self.begin) / self.interval)
        return [None if number in self.lost else number for number in range(frames)]


def accounted(run: Run, line: Line) -> None:
    """Every sample is in its place, every damaged frame has a placeholder, and nothing else has.

    Frames lost at the end show only later.
    """
    expected = line.expected()
    for (six, fault), number in zip(run.samples, expected, strict=False):
        if number is None:
            assert fault
        else:
            gyro, accel = counts(number)
            assert (six, fault) == ((*gyro, *accel), 0)
    assert len(expected) - 5 <= len(run.samples) <= len(expected)
    counters = run.counters
    placeholders = counters["frames_missed"] + counters["frames_late"]
    assert counters["frames_taken"] + placeholders == len(run.samples)
    assert placeholders == sum(number is None for number in expected[: len(run.samples)])
    assert counters["sensor_faults"] == 0


@needs_icarus
@pytest.mark.parametrize("case", few_of(CASES, []))
def test_every_fault_on_the_line_is_accounted_for(
    case: tuple[Design, str, int], tmp_path: Path
) -> None:
    design, name, _ = case
    verilog = generate(design).further[f"{design.name}_front.v"]
    seen = set()
    assert design.front is not None
    seeds = range(2) if design.front.interval < 10_000 else range(1)
    for seed in seeds:
        line = Line(design, name, seed, 24)
        run = run_verilog(design, verilog, line.levels(design), line.end, tmp_path)
        model = run_model(design, line.whole_bytes(design), line.end)
        assert run.samples == model.samples
        assert run.counters == model.counters
        accounted(run, line)
        seen |= {counter for counter, value in run.counters.items() if value}
    assert seen >= {"frames_taken", "frames_bad"}
    assert seen & {"frames_missed", "frames_late"}


@pytest.mark.deep
@needs_icarus
def test_silence_brings_placeholders_and_a_frame_finds_its_place_again(tmp_path: Path) -> None:
    """And a core that takes a sample in every third interval loses samples, but no time."""
    design, name, _ = CASES["stim300"]
    assert design.front is not None
    interval = design.front.interval
    stream = [
        (400 + number * interval + 200 * place, byte)
        for number in (0, 1, 2, 10, 11, 12, 16, 17)
        for place, byte in enumerate(made(name, *counts(number), number))
    ]
    end = 400 + 25 * interval
    verilog = generate(design).further[f"{design.name}_front.v"]
    bytes_ = [(whole_at(design, clock), byte) for clock, byte in stream]
    model = run_model(design, bytes_, end)
    run = run_verilog(design, verilog, edges(design, stream), end, tmp_path)
    assert (run.samples, run.counters) == (model.samples, model.counters)
    assert run.counters["frames_late"] == 7 + 6  # before 10, after 17
    assert run.counters["frames_missed"] == 3
    assert [six[0] for six, fault in run.samples if not fault] == [0, 1, 2, 10, 11, 12, 16, 17]
    assert run.samples[10][0][0] == 10
    slow = run_verilog(design, verilog, edges(design, stream), end, tmp_path, busy=3 * interval)
    assert slow.counters == run.counters
    for place, (six, fault) in enumerate(slow.samples):
        assert fault or run.samples[place] == (six, 0)


@needs_icarus
@pytest.mark.parametrize("case", few_of(CASES, QUICK))
def test_latency_and_instant_are_as_stated(case: tuple[Design, str, int], tmp_path: Path) -> None:
    design, name, _ = case
    assert design.front is not None
    plan, wire = FrontPlan(design.front), design.front.wire
    assert isinstance(wire, Uart)
    per_byte = round(design.front.clock_hz / wire.baud) * wire.bits_per_byte
    stream = [
        (400 + 37 * number + number * design.front.interval + 9 * per_byte * place // 8, byte)
        for number in range(4)
        for place, byte in enumerate(made(name, *counts(number), number))
    ]
    verilog = generate(design).further[f"{design.name}_front.v"]
    end = 400 + 4 * design.front.interval
    run = run_verilog(design, verilog, edges(design, stream), end, tmp_path)
    length = len(made(name, *counts(0), 0))
    last = [whole_at(design, clock) for clock, _ in stream[length - 1 :: length]]
    zeros = [plan.layout.kinds[0].zeros]
    if len(plan.layout.kinds) > 1:
        zeros = [kind.zeros for kind in plan.layout.kinds if kind.length == length]
    most = max(kind.zeros for kind in plan.layout.kinds)
    assert run.taken_at == [clock + plan.latency - most + zeros[0] for clock in last]
    assert run.instants == [clock + 2 for clock, _ in stream[::length]]


def test_amaranths_simulator_gives_the_same() -> None:
    """A short run, where there is no other simulator."""
    design, name, _ = CASES["custom"]
    assert design.front is not None
    frame = made(name, *counts(1), 1)
    damaged = bytearray(made(name, *counts(2), 2))
    damaged[5] ^= 4
    stream = [
        (100 + 161 * place, byte)
        for place, byte in enumerate(frame + bytes(damaged) + made(name, *counts(3), 3))
    ]
    end = stream[-1][0] + 400
    run = run_line(design, edges(design, stream), end)
    model = run_model(design, [(whole_at(design, at), byte) for at, byte in stream], end)
    assert (run.samples, run.counters) == (model.samples, model.counters)
    assert [six[0] for six, _ in run.samples] == [1, 1, 3]


@pytest.mark.parametrize("ratio", [16.0, 17.3, 54.25, 108.5, 1085.07])
def test_the_rate_error_is_as_small_as_stated(ratio: float) -> None:
    plan = BaudPlan.of(ratio * 921600, 921600)
    assert plan.step / 2**24 * ratio == pytest.approx(1 + plan.error, abs=1e-12)
    assert abs(plan.error) <= ratio / 2**25
