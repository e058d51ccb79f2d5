"""Many sensors in one model: what each gives is what a model of its own gives, bit for bit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sculler_model.design import STATUS_LOST, Design, Result
from sculler_model.errors import InputError
from sculler_model.fast import FastChannels, VectorBlock
from sculler_model.golden import (
    ChannelCycleModel,
    ChannelModel,
    ChannelSample,
    ChannelTiming,
    GoldenModel,
    PipelinedChannelModel,
    PipelinedChannelTiming,
    Ports,
    clocks_per_major,
    to_words,
    words_per_column,
)
from strategies import DESIGNS, with_hardware

PLAIN = with_hardware(DESIGNS["smallest"], core="compact")


def many(design: Design, channels: int) -> Design:
    return with_hardware(design, core="compact", channels=channels)


def samples(design: Design, count: int, seed: int, restarts: float = 0.0) -> list[ChannelSample]:
    """Samples of all channels in a random order, some of them at a rail, faulty or a restart."""
    rng = np.random.default_rng(seed)
    lo = [design.words.gyro.lo] * 3 + [design.words.accel.lo] * 3
    hi = [design.words.gyro.hi] * 3 + [design.words.accel.hi] * 3
    drawn = []
    for _ in range(count):
        row = [int(rng.choice([a, b, rng.integers(a, b + 1)])) for a, b in zip(lo, hi, strict=True)]
        gyro, accel = (row[0], row[1], row[2]), (row[3], row[4], row[5])
        channel = int(rng.integers(design.channels))
        fault, again = int(rng.random() < 0.1), int(rng.random() < restarts)
        drawn.append(ChannelSample(channel, gyro, accel, fault, again))
    return drawn


def test_one_channel_is_left_unsaid():
    one = with_hardware(DESIGNS["smallest"], core="compact", channels=1)
    assert one.hardware.channels is None
    assert (one.channels, one.digest) == (1, PLAIN.digest)
    assert many(PLAIN, 2).digest != PLAIN.digest
    assert many(PLAIN, 1024).channels == 1024


def test_a_reset_makes_every_channel_forget() -> None:
    design = many(PLAIN, 3)
    model, fresh = ChannelModel(design), ChannelModel(design)
    for channel in range(3):
        model.lose(channel)
        model.step(channel, (5, 6, 7), (8, 9, 10), 1)
    model.reset()
    for channel in (0, 1, 2) * 4:
        sample = (channel + 1, 2, 3), (4, channel, 6)
        assert model.step(channel, *sample) == fresh.step(channel, *sample)


@pytest.mark.parametrize(
    ("hardware", "told"),
    [
        ({"channels": 1025}, "1025 is not allowed, give a whole number from 1 to 1024"),
        (
            {"core": "pipelined", "handover": "parallel", "channels": 2},
            '2 is not built with handover = "parallel": leave one out',
        ),
        (
            {"bus": {"result": "axi-lite"}, "channels": 2},
            "2 is not built for a core with [hardware.bus]: leave one out",
        ),
        (
            {"overrun": "drop-result", "channels": 2},
            '2 is not built with overrun = "drop-result": leave one out',
        ),
        ({"reset": "async", "channels": 2}, '2 is not built with reset = "async": leave one out'),
        (
            {"clock_enable": True, "channels": 2},
            "2 is not built with clock_enable = true: leave one out",
        ),
        (
            {"hardening": "detect", "channels": 2},
            '2 is not built with hardening = "detect": leave one out',
        ),
    ],
)
def test_what_is_not_built_is_refused(hardware: dict[str, object], told: str):
    data = {"preset": "stim300", "hardware": {"core": "compact", **hardware}}
    with pytest.raises(InputError) as raised:
        Design.parse(data)
    assert str(raised.value) == f"design: hardware.channels: {told}"


@pytest.mark.parametrize("further", [{"order": 3}, {"position": "high-resolution"}])
def test_no_further_vectors(further: dict[str, object]):
    data = {"preset": "stim300", "algorithm": further}
    data["hardware"] = {"core": "compact", "channels": 2}
    with pytest.raises(InputError, match=r"channels: 2 is not built with algorithm\.\w+ = .*out"):
        Design.parse(data)


@pytest.mark.parametrize("name", ["smallest", "taylor_3p3"])
@pytest.mark.parametrize("channels", [2, 5])
def test_channels_are_single_models(name: str, channels: int):
    design = many(DESIGNS[name], channels)
    given = samples(design, 40 * design.samples_per_major, seed=channels, restarts=0.02)
    found = list(ChannelModel(design).run(given))
    assert len(found) > 10
    for channel in range(channels):
        single = GoldenModel(DESIGNS[name])
        expected = []
        for sample in given:
            if sample.channel != channel:
                continue
            if sample.restart:  # a model that has seen nothing
                single = GoldenModel(DESIGNS[name])
            result = single.step(sample.gyro, sample.accel, sample.fault)
            expected += [] if result is None else [result]
        assert [result for owner, result in found if owner == channel] == expected


def test_a_sample_that_says_no_more_is_sound_and_goes_on():
    """Twenty samples of one count each are twenty counts."""
    design = Design.parse({"preset": "stim300", "hardware": {"core": "compact", "channels": 2}})
    ((channel, result),) = ChannelModel(design).run([ChannelSample(1, (1, 0, 0), (0, 0, 2))] * 20)
    assert (channel, result.status) == (1, 0)
    assert (result.alpha, result.nu) == ((20, 0, 0), (0, 0, 40))
    model = ChannelModel(design)
    stepped = [model.step(1, (1, 0, 0), (0, 0, 2)) for _ in range(20)]
    assert stepped == [None] * 19 + [result]


@pytest.mark.parametrize("chunk", [7, 64, 10_000])
def test_the_fast_twin_in_any_chunks(chunk: int):
    design = many(DESIGNS["taylor_3p3"], 5)
    given = samples(design, 60 * design.samples_per_major, seed=3, restarts=0.01)
    found = list(ChannelModel(design).run(given))
    fast, blocks = FastChannels(design), []
    for start in range(0, len(given), chunk):
        part = given[start : start + chunk]
        blocks.append(
            fast.feed(
                np.array([(*sample.gyro, *sample.accel) for sample in part]),
                np.array([sample.channel for sample in part]),
                np.array([sample.fault for sample in part]),
                np.array([sample.restart for sample in part]),
            )
        )
    block = VectorBlock.concatenate(blocks)
    assert block.channels is not None
    assert block.channels.tolist() == [channel for channel, _ in found]
    assert list(block.rows()) == [result.row() for _, result in found]


def test_a_loss_marks_its_own_channel_until_it_restarts():
    model = ChannelModel(many(PLAIN, 3))
    span = PLAIN.samples_per_major

    def run(channel: int, restart: int = 0) -> int:
        for i in range(span):
            result = model.step(channel, (1, 2, 3), (4, 5, 6), 0, restart * (i == 0))
        assert result is not None
        return result.status & STATUS_LOST

    model.lose(1)
    assert [run(channel) for channel in range(3)] == [0, STATUS_LOST, 0]
    assert run(1) == 0
    model.lose(2)
    assert run(2, restart=1) == 0


def test_channels_that_are_not_there():
    design = many(PLAIN, 3)
    for channel in (-1, 3):
        told = f"channel {channel} is not there, give 0 to 2"
        with pytest.raises(InputError, match=f"^{told}$"):
            ChannelModel(design).step(channel, (0, 0, 0), (0, 0, 0))
        with pytest.raises(InputError, match=f"^{told}$"):
            ChannelModel(design).lose(channel)
    with pytest.raises(InputError, match="sample 1: channel -1 is not there, give 0 to 2"):
        FastChannels(design).feed(np.zeros((2, 6), int), np.array([0, -1]))
    with pytest.raises(InputError, match="channel 2: sample 0: gyro_x = "):
        FastChannels(design).feed(np.full((1, 6), 1 << 40), np.array([2]))
    for wrong in ("faults", "restarts"):
        for length in (1, 3):
            with pytest.raises(InputError, match=f"{wrong}: .*, give 2 integers or booleans"):
                FastChannels(design).feed(
                    np.zeros((2, 6), int), np.array([0, 1]), **{wrong: np.zeros(length, int)}
                )
    with pytest.raises(InputError, match="give 2 integers"):
        FastChannels(design).feed(np.zeros((2, 6), int), np.array([0.0, 1.0]))


def test_ports_clock_by_clock_by_hand():
    """Taken in clock 3, launched 2 + 1 clocks later, ready 2 clocks after that, valid 9 - 3 after.

    Words come two clocks apart.  A reset amid them takes all back.
    """
    design = many(PLAIN, 2)
    timing = ChannelTiming(
        latency=9, work=(5,), results=2, startup=3, lookup=2, loading=1, handover_spacing=2
    )
    model, sample = ChannelCycleModel(design, timing), ChannelSample(1, (1, 2, -3), (0, 0, 4))
    single = GoldenModel(PLAIN).step(sample.gyro, sample.accel)
    assert single is not None
    words = to_words(design, single.row())
    for rounds in range(2):
        offers = [sample] * 4 + [None] * 20
        seen = [model.clock(offered, 1) for offered in offers[: 24 - 7 * rounds]]
        assert [each.sample_ready for each in seen[:10]] == [0, 0, 0, 1, 0, 0, 0, 0, 1, 1]
        assert [t for t, each in enumerate(seen) if each.result_valid] == [*range(12, len(seen), 2)]
        shown = [each.result for each in seen if each.result_valid]
        assert shown == [(word, 0, 1) for word in words[: len(shown)]]
        assert {each.samples_lost for each in seen} == {0}
        model.clock(sample, 1, rst=1)  # nothing is taken in it
    assert model.ports() == Ports(0, 0, (0, 0, 0))


Shown = tuple[int, int, int]
"""A word, whether it is its result's last, and whose it is."""


class Results:
    """What the result ports show, worked out result by result; `takes` is `result_ready`."""

    def __init__(self, design: Design, spacing: int, takes: list[bool]) -> None:
        self.design, self.spacing, self.takes = design, spacing, takes
        self.valid: dict[int, Shown] = {}
        self.ports_free = 0
        self.whole: list[int] = []  # clock in which each result's last word was taken

    def hand_over(self, clock: int, channel: int, result: Result) -> None:
        """From a clock on, or later if one before it is not taken."""
        clock = max(clock, self.ports_free)
        words = to_words(self.design, result.row())
        for i, word in enumerate(words):
            last = int(i == len(words) - 1)
            while clock < len(self.takes):
                self.valid[clock] = (word, last, channel)
                if self.takes[clock]:
                    break
                clock += 1
            if last:
                self.whole.append(clock)
            clock += self.spacing
        self.ports_free = clock

    def room_from(self, results: int) -> int:
        """The clock from which there is room for one more of so many."""
        return self.whole[-results] + 1 if len(self.whole) >= results else 0

    def ports(self, ready: list[int], lost: list[int]) -> list[Ports]:
        """Of all clocks; `lost` are those from which losses are counted."""
        return [
            Ports(
                level,
                int(clock in self.valid),
                self.valid.get(clock, (0, 0, 0)),
                sum(since <= clock for since in lost),
            )
            for clock, level in enumerate(ready)
        ]


class ByEvents:
    """What the ports show, worked out sample by sample from the contract, not clock by clock."""

    def __init__(self, design: Design, timing: ChannelTiming, takes: list[bool]) -> None:
        self.design, self.timing = design, timing
        self.golden = ChannelModel(design)
        self.seen = [0] * design.channels  # samples of each, since it began
        self.results = Results(design, timing.handover_spacing, takes)
        self.lost: list[int] = []  # clocks from which losses are counted
        self.free = 0

    def next_after(self, clock: int, sample: ChannelSample) -> int:
        """The clock from which the sample after one that is taken in a clock can be taken."""
        timing, channel = self.timing, sample.channel
        if channel >= self.design.channels:
            return clock + 3
        if sample.restart:
            self.seen[channel] = 0
        number = self.seen[channel]
        self.seen[channel] += 1
        launch = clock + timing.lookup
        if number == 0:
            launch = max(launch, self.free) + timing.clearing
        launch += timing.loading
        result = self.golden.step(*sample)
        work = timing.work[number % len(timing.work)]
        if work:
            launch = max(launch, self.free)
            if result is not None:
                launch = max(launch, self.results.room_from(timing.results))
            self.free = launch + work
        if result is not None:
            shown = launch + timing.latency - timing.lookup - timing.loading
            self.results.hand_over(shown, channel, result)
        return launch + 2

    def run(self, offers: list[ChannelSample | None]) -> list[Ports]:
        ready_from, refused = self.timing.startup, None
        ready = []
        for clock, offered in enumerate(offers):
            ready.append(int(clock >= ready_from))
            if refused is not None and offered is None:
                self.lost.append(clock + 2)
                if refused < self.design.channels:
                    self.golden.lose(refused)
            refused = None
            if offered is not None and ready[-1]:
                ready_from = self.next_after(clock, offered)
            elif offered is not None:
                refused = offered.channel
        return self.results.ports(ready, self.lost)


def offered(
    design: Design, clocks: int, seed: int, rng: np.random.Generator, longest: int
) -> list[ChannelSample | None]:
    """Offers that come, wait up to so many clocks and go, some of a channel that is not there."""
    given = iter(samples(design, clocks, seed, restarts=0.02))
    offers: list[ChannelSample | None] = []
    while len(offers) < clocks:
        sample = next(given)
        if rng.random() < 0.05:
            sample = sample._replace(channel=design.channels)
        offers += [sample] * int(rng.integers(1, longest)) + [None] * int(rng.integers(0, 2))
    return offers[:clocks]


def shown_as_by_events(
    model: ChannelCycleModel | PipelinedChannelModel,
    by_events: type[ByEvents] | type[PipelinedByEvents],
    offers: list[ChannelSample | None],
    rng: np.random.Generator,
) -> list[Ports]:
    """The ports at offers, held to the contract's, before a reset."""
    takes = (rng.random(len(offers)) < rng.choice([0.2, 0.7, 1.0])).tolist()
    found = [model.clock(*pair) for pair in zip(offers, takes, strict=True)]
    assert found == by_events(model.design, model.timing, takes).run(offers)
    assert any(each.samples_lost for each in found)
    model.clock(offers[0], 1, rst=1)
    return found


@pytest.mark.parametrize("seed", range(8))
def test_ports_are_those_of_the_contract(seed: int):
    """Any timing, offers that come, wait and go, results that wait, and a reset."""
    rng = np.random.default_rng(seed)
    plain = DESIGNS["taylor_3p3" if seed % 3 else "smallest"]
    design = many(plain, 3)
    n = design.algorithm.samples
    timing = ChannelTiming(
        latency=int(rng.integers(8, 14)),
        work=(*(rng.integers(1, 12, n - 1) * (rng.random(n - 1) < 0.8)).tolist(), 17),
        startup=int(rng.integers(0, 5)),
        handover_spacing=int(rng.integers(1, 4)),
        results=int(rng.integers(1, 4)),
        lookup=int(rng.integers(1, 4)),
        loading=int(rng.integers(1, 4)),
        clearing=int(rng.integers(0, 6)),
    )
    model = ChannelCycleModel(design, timing)
    for _ in range(2):
        shown_as_by_events(model, ByEvents, offered(design, 300, seed, rng, longest=9), rng)
    longest = timing.startup + timing.spacing + timing.latency + timing.handover_spacing
    assert timing.longest_wait == longest + 2 * max(timing.work) + timing.clearing


PIPELINED = PipelinedChannelTiming(latency=9, startup=3, lookup=3, apart=4, waiting=4, results=1)
STIM300 = Design.preset("stim300")


def test_a_pipelined_core_with_channels_streams():
    two = with_hardware(STIM300, core="pipelined", channels=2)
    assert two.hardware.handover == "stream"
    assert with_hardware(two, **{**two.as_json()["hardware"], "channels": 1}).channels == 1


@pytest.mark.parametrize(
    ("channels", "ready"),
    [
        # launched in 6, 10, 14, ...; four wait after 7, and one place is free after each launch
        (1, "000 11111 0001 0001 0001 0001"),
        # launched in 6 and 7, 10 and 11, ...; four wait after 8
        (2, "000 111111 0011 0011 0011 0011"),
        (4, "000 1111 1111 1111 1111 1111"),
    ],
)
def test_samples_of_one_channel_come_apart(channels: int, ready: str):
    """Look-ups begin one clock after a sample is taken, launches come two clocks after that."""
    model = PipelinedChannelModel(with_hardware(STIM300, channels=4), PIPELINED)
    wanted = [int(level) for level in ready.replace(" ", "")]
    seen, taken = [], 0
    for _ in wanted:
        sample = ChannelSample(taken % channels, (1, 2, 3), (4, 5, 6))
        seen.append(model.clock(sample, 1).sample_ready)
        taken += seen[-1]
    assert seen == wanted


@pytest.mark.parametrize("spacing", [1, 3])
def test_launches_come_apart(spacing: int):
    """Eight channels by turns; each launch frees a place in the next clock."""
    timing = replace(PIPELINED, spacing=spacing)
    model = PipelinedChannelModel(with_hardware(STIM300, channels=8), timing)
    seen = [
        model.clock(ChannelSample(t % 8, (1, 2, 3), (4, 5, 6)), 1).sample_ready for t in range(30)
    ]
    free = [t for t, ready in enumerate(seen) if ready and t > 12]
    assert free == [*range(13, 30, spacing)]


def test_a_result_keeps_the_next_ones_last_sample_back_by_hand():
    """Taken in 3 and 4, launched in 6; then when the first result has been taken, and 1 more."""
    design = with_hardware(DESIGNS["smallest"], channels=2)
    model = PipelinedChannelModel(design, PIPELINED)
    first, second = (ChannelSample(c, (1 + c, 2, -3), (0, 0, 4)) for c in (0, 1))
    offers = [None, None, None, first, second] + [None] * 400
    seen = [model.clock(offered, 1) for offered in offers]
    words = []
    for sample in (first, second):
        result = GoldenModel(PLAIN).step(sample.gyro, sample.accel)
        assert result is not None
        words.append(to_words(design, result.row()))
    count = len(words[0])
    valid = [t for t, each in enumerate(seen) if each.result_valid]
    again = 12 + count  # the second is launched
    assert valid == [*range(12, 12 + count), *range(again + 6, again + 6 + count)]
    shown = [seen[t].result for t in valid]
    assert [word for word, _, _ in shown] == [*words[0], *words[1]]
    assert [last for _, last, _ in shown] == [*[0] * (count - 1), 1] * 2
    assert [channel for _, _, channel in shown] == [0] * count + [1] * count


def test_losses_of_a_pipelined_core_by_hand():
    """One before anything could be taken marks nothing; one of channel 1 marks that one's next."""
    design = with_hardware(DESIGNS["smallest"], channels=2)
    model = PipelinedChannelModel(design, replace(PIPELINED, waiting=1))
    one, other = (ChannelSample(c, (1, 2, 3), (4, 5, 6)) for c in (1, 0))
    offers = [one, None, None, other, one, None, one] + [one] * 300
    seen = [model.clock(offered, 1) for offered in offers]
    assert [each.samples_lost for each in seen[:9]] == [0, 0, 0, 1, 1, 1, 1, 2, 2]
    place = words_per_column(design)
    told = {}
    for each in seen:
        if each.result_valid:
            told.setdefault(each.result[2], []).append(each.result[0])
    assert told[0][place] & STATUS_LOST == 0
    assert told[1][place] & STATUS_LOST == STATUS_LOST
    assert model.golden.models[1].t >= 1


class PipelinedByEvents:
    """What the ports of a pipelined core show, sample by sample from the contract.

    Clocks in which a result has no room stand still for all that is looked up (`still`).
    """

    def __init__(self, design: Design, timing: PipelinedChannelTiming, takes: list[bool]) -> None:
        self.design, self.timing = design, timing
        self.golden = ChannelModel(design)
        self.results = Results(design, timing.handover_spacing, takes)
        self.still: set[int] = set()
        self.begun = -timing.spacing  # clock in which the last look-up began
        self.launched: list[int] = []  # of all samples that wait or waited
        self.last: dict[int, int] = {}  # the clock of each channel's last launch

    def moved(self, clock: int, count: int) -> int:
        """So many clocks on, those not counted that stand still."""
        while count:
            clock += 1
            count -= clock not in self.still
        return clock

    def take(self, clock: int, sample: ChannelSample) -> None:
        """A sample that is taken in a clock."""
        timing, channel = self.timing, sample.channel
        if channel >= self.design.channels:
            return
        apart = self.last.get(channel, -timing.apart) + timing.apart - timing.lookup + 1
        begun = max(clock + 1, self.moved(self.begun, timing.spacing), apart)
        while begun in self.still:
            begun += 1
        launch = self.moved(begun, timing.lookup - 1)
        result = self.golden.step(*sample)
        if result is not None:
            room = self.results.room_from(timing.results)
            self.still |= set(range(launch, room))
            launch = max(launch, room)
            shown = launch + timing.latency - timing.lookup
            self.results.hand_over(shown, channel, result)
        self.begun, self.last[channel] = begun, launch
        self.launched.append(launch)

    def run(self, offers: list[ChannelSample | None]) -> list[Ports]:
        ready, lost, refused = [], [], None
        for clock, offered in enumerate(offers):
            waiting = sum(launch >= clock for launch in self.launched)
            started = clock >= self.timing.startup
            ready.append(int(started and waiting < self.timing.waiting))
            if refused is not None and offered is None:
                lost.append(clock + 2)
                if started and refused < self.design.channels:
                    self.golden.lose(refused)
            refused = None
            if offered is not None and ready[-1]:
                self.take(clock, offered)
            elif offered is not None:
                refused = offered.channel
        return self.results.ports(ready, lost)


@pytest.mark.parametrize("seed", range(12))
def test_ports_of_a_pipelined_core_are_those_of_the_contract(seed: int):
    """Any timing, offers that come, wait and go, results that wait, and a reset."""
    rng = np.random.default_rng(seed)
    plain = DESIGNS["taylor_3p3" if seed % 3 else "smallest"]
    design = with_hardware(plain, core="pipelined", channels=3)
    lookup = int(rng.integers(2, 5))
    timing = PipelinedChannelTiming(
        latency=int(rng.integers(8, 14)),
        spacing=int(rng.integers(1, 4)),
        startup=int(rng.integers(0, 5)),
        handover_spacing=int(rng.integers(1, 3)),
        results=int(rng.integers(1, 4)),
        lookup=lookup,
        apart=lookup + int(rng.integers(0, 5)),
        waiting=int(rng.integers(1, 6)),
    )
    model = PipelinedChannelModel(design, timing)
    for _ in range(2):
        offers = offered(design, 400, seed, rng, longest=4)
        found = shown_as_by_events(model, PipelinedByEvents, offers, rng)
        assert any(each.result_valid for each in found)


def test_figures_that_follow_from_a_pipelined_timing_by_hand():
    """`waiting` samples of one channel before it; the look-up passes beside a result's words."""
    timing = PipelinedChannelTiming(7, spacing=3, startup=2, work=(4,), handover_spacing=5)
    assert (timing.lookup, timing.apart, timing.waiting) == (2, 3, 4)
    assert timing.longest_wait == 2 + 3 + 4 + 7 + 5 + 4 * (3 + 2)
    other = replace(timing, lookup=6, apart=8, waiting=9)
    assert other.longest_wait == 2 + 3 + 4 + 7 + 5 + 9 * (8 + 6)
    assert (timing.beside, other.beside) == (2, 6)
    plain = ChannelTiming(7)
    assert (plain.lookup, plain.loading, plain.clearing) == (1, 1, 0)
    assert plain.longest_wait == 1 + 7 + 1
    one = {"preset": "stim300", "algorithm": {"minors": 1}}
    design = Design.parse(one | {"hardware": {"core": "pipelined", "channels": 2}})
    words = 20 * 4  # of 64 bits each, 57 are needed
    quick = PipelinedChannelTiming(latency=12, lookup=5)
    assert clocks_per_major(design, quick) == 12 - 5 + words
