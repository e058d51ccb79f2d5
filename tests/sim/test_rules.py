"""The rules by which samples are offered and results taken: in Python, and the same in C++.

A stub core shows on its result ports what stands on its inputs, so that a trace of it tells what
was driven.
"""

import numpy as np
import pytest

from sculler_model.design import COLUMNS
from sculler_model.errors import InputError
from sculler_model.golden import Ports, Timing
from sculler_sim.engine import simulate, trace
from sculler_sim.run import Progress, SimulationError, check_chunks
from sculler_sim.stimulus import Stimulus
from sculler_sim.surroundings import Surroundings
from strategies import DESIGNS, make_design, random_counts, with_hardware

DESIGN = make_design("echo", 2, 0, 2, (8, 9))  # four samples a major interval

ECHO = """
  reg [7:0] clock = 0;
  always @(posedge clk) clock <= clock + 1;
  assign sample_ready = clock % 3 != 0;
  assign result_valid = clock % 5 == 0;
  assign result_major = {56'd0, clock};
  assign result_status = {sample_fault, sample_valid};
  assign result_alpha_x = {{2{sample_gyro_x[7]}}, sample_gyro_x};
  assign result_alpha_y = {{2{sample_gyro_y[7]}}, sample_gyro_y};
  assign result_alpha_z = {{2{sample_gyro_z[7]}}, sample_gyro_z};
  assign result_nu_x = {{2{sample_accel_x[8]}}, sample_accel_x};
  assign result_nu_y = {{2{sample_accel_y[8]}}, sample_accel_y};
  assign result_nu_z = {{2{sample_accel_z[8]}}, sample_accel_z};
  assign result_coning_within_x = {15'd0, result_ready};
  assign result_coning_within_y = {15'd0, rst};
"""


# The same with a stream of words: each says which it is and in which clock it was taken.
STREAMING = with_hardware(DESIGN, handover="stream")
WORDS = 40  # the vectors have 17 bits and more, hence two words a column

STREAM_ECHO = f"""
  reg [15:0] clock = 0;
  reg [7:0] word = 0;
  always @(posedge clk) begin
    clock <= clock + 1;
    if (rst) word <= 0;
    else if (result_valid && result_ready) word <= result_last ? 0 : word + 1;
  end
  assign sample_ready = clock % 3 != 0;
  assign result_valid = clock % 5 == 0;
  assign result_data = {{clock[7:0], word}};
  assign result_last = word == {WORDS - 1};
"""


def ready(clock):
    return int(clock % 3 != 0)


def valid(clock):
    return int(clock % 5 == 0)


def counts_of(samples):
    return random_counts(DESIGN, samples, np.random.default_rng(1))


def faults_of(samples):
    return np.arange(samples) % 5 == 0


def driven(counts, faults, stimulus, words=1):
    """What the rules of `sculler_sim.engine` make of the stub, whose results have so many words.

    Returns, until the samples are used up, each clock's (valid, six counts, fault, result_ready,
    rst); for each result the clocks in which its words are taken; and, at the end of the run, the
    clocks, the samples since reset, those taken and those given up.
    """
    offer, take, rst, give_up, _ = (level.tolist() for level in stimulus.levels(0, 20_000))
    queue = [[*row, int(fault)] for row, fault in zip(counts.tolist(), faults, strict=True)]
    shown, results, result, waiting, pause = [], [], [], False, False
    taken = lost = 0
    samples_since_reset = results_since_reset = clock = 0
    while queue or results_since_reset < samples_since_reset // 4:
        if queue:
            waiting = (waiting or bool(offer[clock])) and not pause
            *count, fault = queue[0] if waiting else [*(~c for c in queue[0][:6]), 1]
            shown.append((int(waiting), *count, fault, take[clock], rst[clock]))
        pause = False
        if waiting and give_up[clock] and (rst[clock] or not ready(clock)):
            queue.pop(0)
            waiting, pause = False, True
            lost += 1
        if rst[clock]:
            samples_since_reset = results_since_reset = 0
            result = []
        elif waiting and ready(clock):
            queue.pop(0)
            waiting = False
            samples_since_reset += 1
            taken += 1
        if take[clock] and valid(clock) and not rst[clock]:
            result = [*result, clock]
            if len(result) == words:
                results.append(result)
                results_since_reset += 1
                result = []
        clock += 1
    return shown, results, (clock, samples_since_reset, taken, lost)


def end_of(progress):
    """The same of a run."""
    return progress.clocks, progress.since_reset, progress.samples, progress.lost


STIMULI = [Stimulus.always(), Stimulus.stalls(6, 9), Stimulus.stalls(7, 30).with_resets(0, 31, 32)]
STIMULI += [
    Stimulus.stalls(2, 9).giving_up(),
    Stimulus.stalls(5, 30).giving_up().with_resets(0, 3, 31, 32, 33, 60),
]


def test_some_samples_are_given_up():
    """Of the stimuli above, by those that say so alone."""
    counts, faults = counts_of(60), faults_of(60)
    lost = [driven(counts, faults, stimulus)[2][3] for stimulus in STIMULI]
    assert lost[:3] == [0, 0, 0]
    assert min(lost[3:]) >= 3


@pytest.mark.parametrize("stimulus", STIMULI)
def test_python_drives_by_the_rules(stimulus):
    counts, faults = counts_of(60), faults_of(60)
    expected, results, end = driven(counts, faults, stimulus)
    progress = Progress()
    drive = Surroundings(
        DESIGN, Timing(1), check_chunks(DESIGN, [(counts, faults)]), stimulus, progress
    )
    shown = []
    while not drive.done:
        now, clock = drive.inputs, progress.clocks
        if now.sample is not None:
            gyro, accel, fault = now.sample
            shown.append((now.sample_valid, *gyro, *accel, fault, now.result_ready, now.rst))
        drive.clocked(Ports(ready(clock), valid(clock), (clock,)))
    assert shown == expected
    assert [[row[0]] for row in drive.taken] == results
    assert progress.results == len(results)
    assert end_of(progress) == end
    assert progress.samples + progress.lost == 60


@pytest.mark.parametrize("stimulus", STIMULI)
def test_cpp_drives_by_the_rules(use_verilog, stimulus):
    use_verilog(DESIGN, ECHO)
    counts, faults = counts_of(60), faults_of(60)
    expected, _, _ = driven(counts, faults, stimulus)
    seen = trace(DESIGN, counts, faults, stimulus, len(expected), "verilator")
    assert seen.sample_ready.tolist() == [ready(clock) for clock in range(len(expected))]
    assert seen.result_valid.tolist() == [valid(clock) for clock in range(len(expected))]
    count_columns = "alpha_x alpha_y alpha_z nu_x nu_y nu_z".split()
    places = [COLUMNS.index(name) for name in count_columns]
    ready_and_rst = [COLUMNS.index(name) for name in ("coning_within_x", "coning_within_y")]
    shown = [
        (
            row[1] & 1,
            *(row[place] for place in places),
            row[1] >> 1,
            *(row[place] for place in ready_and_rst),
        )
        for row in seen.result.tolist()
    ]
    # what the stub echoes is on the result ports, and masked where they mean nothing
    nothing = (0,) * len(expected[0])
    assert shown == [row if valid(clock) else nothing for clock, row in enumerate(expected)]


@pytest.mark.parametrize("chunk", [1, 7, 60])
def test_cpp_takes_results_by_the_rules_however_the_samples_are_cut(use_verilog, chunk):
    use_verilog(DESIGN, ECHO)
    counts, faults = counts_of(60), faults_of(60)
    for stimulus in STIMULI:
        _, results, end = driven(counts, faults, stimulus)
        chunks = [(counts[i : i + chunk], faults[i : i + chunk]) for i in range(0, 60, chunk)]
        run = simulate(DESIGN, chunks, stimulus=stimulus)
        majors = [[major] for block in run for major in block.major.tolist()]
        assert majors == results
        assert end_of(run.progress) == end
        assert run.leftover == end[1] % 4


def echoed(result):
    """The columns of a result of the streaming stub, by the clocks in which its words are taken."""
    data = bytes(byte for word, clock in enumerate(result) for byte in (word, clock % 256))
    columns = [data[i : i + 4] for i in range(0, len(data), 4)]
    major_status = [int.from_bytes(column, "little") for column in columns[:2]]
    return (*major_status, *(int.from_bytes(c, "little", signed=True) for c in columns[2:]))


@pytest.mark.parametrize("stimulus", STIMULI)
def test_python_takes_a_result_word_by_word(stimulus):
    counts, faults = counts_of(60), faults_of(60)
    _, results, end = driven(counts, faults, stimulus, WORDS)
    progress = Progress()
    chunks = check_chunks(STREAMING, [(counts, faults)])
    drive = Surroundings(STREAMING, Timing(1), chunks, stimulus, progress)
    word = 0
    while not drive.done:
        now, clock = drive.inputs, progress.clocks
        data, last = clock % 256 << 8 | word, int(word == WORDS - 1)
        drive.clocked(Ports(ready(clock), valid(clock), (data, last)))
        if now.rst:
            word = 0
        elif valid(clock) and now.result_ready:
            word = 0 if last else word + 1
    assert drive.taken == [echoed(result) for result in results]
    assert progress.results == len(results)
    assert end_of(progress) == end
    assert progress.samples + progress.lost == 60


@pytest.mark.parametrize("chunk", [1, 7, 60])
def test_cpp_takes_a_result_word_by_word_however_the_samples_are_cut(use_verilog, chunk):
    use_verilog(STREAMING, STREAM_ECHO)
    counts, faults = counts_of(60), faults_of(60)
    for stimulus in STIMULI:
        _, results, end = driven(counts, faults, stimulus, WORDS)
        chunks = [(counts[i : i + chunk], faults[i : i + chunk]) for i in range(0, 60, chunk)]
        run = simulate(STREAMING, chunks, stimulus=stimulus)
        rows = [row for block in run for row in block.rows()]
        assert rows == [echoed(result) for result in results]
        assert end_of(run.progress) == end


def test_a_trace_of_a_stream_shows_its_ports_where_they_mean_something(use_verilog):
    use_verilog(STREAMING, STREAM_ECHO)
    counts = counts_of(60)
    seen = trace(STREAMING, counts, None, Stimulus.always(), 250, "verilator")
    assert seen.ports == ("data", "last")
    assert seen.result_valid.tolist() == [valid(clock) for clock in range(250)]
    shown = [
        [clock << 8 | clock // 5 % WORDS, int(clock // 5 % WORDS == WORDS - 1)]
        if valid(clock)
        else [0, 0]
        for clock in range(250)
    ]
    assert seen.result.tolist() == shown


@pytest.mark.parametrize("bits", [(8, 9), (12, 12), (24, 24), (32, 32)])
def test_words_of_every_number_of_columns_keep_their_sign(use_verilog, bits):
    """Two to five words a column, of both signs, through numpy; `major` and `status` have none."""
    taps = {8: [1], 12: [999999], 24: [1], 32: [2**20]}[bits[0]]
    design = make_design(
        "signs", 1, 1, 1, bits, hardware={"handover": "stream"}, denominator=1, taps=taps
    )
    count = {8: 2, 12: 3, 24: 4, 32: 6}[bits[0]]
    use_verilog(
        design,
        f"""
  reg [15:0] word = 0;
  always @(posedge clk) if (result_ready) word <= result_last ? 0 : word + 1;
  assign sample_ready = 1;
  assign result_valid = 1;
  assign result_data = word < {2 * count} ? word : {{word[1] ^ word[2], word[14:0]}} ^ 16'h1234;
  assign result_last = word == {20 * count - 1};
""",
    )
    run = simulate(design, [(np.zeros((1, 6), int), None)])
    row = next(row for block in run for row in block.rows())
    words = [
        word if word < 2 * count else (word | ((word >> 1 ^ word >> 2) & 1) << 15) ^ 0x1234
        for word in range(20 * count)
    ]
    data = np.array(words, "<u2").tobytes()
    size = 2 * count
    columns = [data[i : i + size] for i in range(0, len(data), size)]
    signed = [int.from_bytes(column, "little", signed=True) for column in columns[2:]]
    assert row[2:] == tuple(signed)
    assert {number < 0 for number in signed} == {True, False}
    # 64 bits of major and status are shown
    assert row[:2] == tuple(int.from_bytes(c, "little") % 2**64 for c in columns[:2])


@pytest.mark.parametrize(
    ("last", "message"),
    [
        ("word == 38", "result_last is high with word 39 of 40"),
        ("word == 41", "result_last is low with word 40 of 40"),
        ("1", "result_last is high with word 1 of 40"),
    ],
)
def test_a_stream_that_marks_a_wrong_word_as_its_last(use_verilog, last, message):
    use_verilog(STREAMING, STREAM_ECHO.replace(f"word == {WORDS - 1}", last))
    with pytest.raises(SimulationError, match=message):
        list(simulate(STREAMING, [(counts_of(60), None)]))
    chunks = check_chunks(STREAMING, [(counts_of(60), None)])
    drive = Surroundings(STREAMING, Timing(1), chunks, Stimulus.always(), Progress())
    with pytest.raises(SimulationError, match=message):  # noqa: PT012 - the word that breaks it
        for word in range(WORDS + 1):
            drive.clocked(Ports(1, 1, (0, int(eval(last, {"word": word})))))


def test_results_wider_than_any_machine_word_arrive_with_their_sign(use_verilog):
    huge = make_design("huge", 1, 1, 3, (32, 20), denominator=3, taps=[2**150 + 1])
    within, between = huge.words.coning_within.bits, huge.words.coning_between.bits
    assert within > 192
    assert 64 < between <= 128
    assert huge.words.alpha.bits <= 64
    use_verilog(
        huge,
        f"""
  assign sample_ready = 1;
  assign result_valid = 1;
  assign result_coning_within_x = {{1'b1, {{{within - 1}{{1'b0}}}}}};
  assign result_coning_within_y = ~0;
  assign result_coning_within_z = {{1'b0, {{{within - 1}{{1'b1}}}}}};
  assign result_coning_between_x = {{1'b1, {{{between - 1}{{1'b0}}}}}};
  assign result_coning_between_y = 1 << 64;
  assign result_coning_between_z = 0;
  assign result_alpha_x = ~1;
  assign result_alpha_y = 5;
""",
    )
    seen = trace(huge, np.zeros((1, 6), int), None, Stimulus.always(), 1, "verilator").result[0]
    shown = dict(zip(COLUMNS, seen, strict=True))
    top = 2 ** (within - 1)
    assert [shown[f"coning_within_{axis}"] for axis in "xyz"] == [-top, -1, top - 1]
    assert [shown[f"coning_between_{axis}"] for axis in "xyz"] == [-(2 ** (between - 1)), 2**64, 0]
    assert (shown["alpha_x"], shown["alpha_y"]) == (-2, 5)


def test_more_results_than_there_can_be_are_all_taken(use_verilog):
    design = DESIGNS["savage_1p1"]  # 64 samples a major interval
    use_verilog(
        design,
        """
  reg [63:0] clock = 0;
  always @(posedge clk) clock <= clock + 1;
  assign result_major = clock;
  assign result_valid = 1;
  assign sample_ready = 1;
""",
    )
    run = simulate(design, [(np.zeros((20_000, 6), int), None)])
    assert [major for block in run for major in block.major.tolist()] == list(range(20_000))


def test_a_core_that_stops_is_found_out(use_verilog):
    use_verilog(DESIGN, "assign sample_ready = 0; assign result_valid = 0;")
    with pytest.raises(SimulationError, match=r"hangs: no sample and no result taken .* sample 0"):
        list(simulate(DESIGN, [(counts_of(3), None)]))
    use_verilog(DESIGN, "assign sample_ready = 1; assign result_valid = 0;")
    with pytest.raises(SimulationError, match=r"hangs: .* after sample 9"):
        list(simulate(DESIGN, [(counts_of(9), None)]))


@pytest.mark.parametrize("engine", ["verilator", "amaranth", "model"])
@pytest.mark.parametrize(
    ("chunk", "message"),
    [
        ((np.zeros((3, 5), int), None), r"samples from 4 on: int64 counts of shape \(3, 5\)"),
        ((np.zeros((3, 6)), None), "samples from 4 on: float64 counts"),
        ((np.zeros((3, 6), int), [0, 1]), r"samples from 4 on: faults of shape \(2,\), give 3"),
        ((np.zeros((3, 6), int), [0, 1, 2]), "samples from 4 on: faults"),
        ((np.full((3, 6), -129), None), "sample 4: gyro_x = -129 does not fit 8 bits"),
        (
            (np.array([[0] * 6, [1, 2, 3, 4, 255, 256]]), None),
            "sample 5: accel_z = 256 does not fit 9 bits, give -256 to 255",
        ),
        ((np.full((1, 6), 2**63, np.uint64), None), "sample 4: gyro_x = 9223372036854775808"),
    ],
)
def test_bad_samples_are_refused(verilator, engine, chunk, message):
    smallest = DESIGNS["smallest"]  # 8 and 9 bits
    good = (np.zeros((4, 6), int), None)
    with pytest.raises(InputError, match=message):
        list(simulate(smallest, [good, chunk], engine=engine))


@pytest.mark.parametrize("engine", ["verilator", "amaranth", "model"])
@pytest.mark.parametrize("chunks", [[], [(np.zeros((0, 6), int), None)]])
def test_no_samples_give_no_results(verilator, engine, chunks):
    run = simulate(DESIGNS["smallest"], chunks, engine=engine)
    assert list(run) == []
    assert run.progress == Progress()
    assert run.leftover == 0
