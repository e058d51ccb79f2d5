"""The Verilog of the test bench's goals, and of how it sets the core's counters."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from sculler_hdl import Port, sample_ports
from sculler_model.design import Design
from sculler_model.golden import COUNTER_MAX, Timing, words_per_column
from sculler_sim.bench_runs import number_bits, numbers


def slices(ports: list[Port]) -> Iterator[tuple[Port, str]]:
    """Each port, and its place in the packed word."""
    low = 0
    for port in ports:
        yield port, f"[{low + port.bits - 1}:{low}]"
        low += port.bits


def goals_of(design: Design, timing: Timing, *, aimed: bool, shown: bool) -> dict[str, object]:
    """What has to have happened at the end; a reason by condition, shorter than 64 letters.

    Args:
        design: the design.
        timing: the core's clocks.
        aimed: whether the bench fails without.
        shown: whether results are dropped, and there is room to show each rail touched alone.
    """
    words = design.words
    ends = {
        end: [getattr(word, end) for word in [words.gyro] * 3 + [words.accel] * 3]
        for end in ("lo", "hi")
    }
    goals = {
        "status_set[1] && status_clear[1]": "an interval with a fault and one without",
        "status_set[2] && status_clear[2]": "an interval with a count at its rail and one without",
        "&lows": "every count at its lower rail",
        "&highs": "every count at its upper rail",
        "longest_wait > LATENCY": "a result that waits longer than the latency",
        "longest_pause > LATENCY": "a pause longer than the latency",
        "back_to_back": "samples and results back to back",
        "resets_early >= STAGES": "a reset at each stage of a result on its way",
        "resets_waiting != 0": "a reset while a result waits",
        "INSIDE == 0 || carries == CARRIES": "carries from limb to limb of a result's number",
        "INSIDE == 0 || counters_ended": "counters of losses at their ends",
    }
    can_lose = not design.drops_results or timing.spacing > 1
    if design.short_majors:
        goals["status_set[0] && status_clear[0]"] = "an interval with short history and one without"
    if design.hardware.handover == "stream":
        goals["resets_between != 0"] = "a reset between two words of a result"
    if design.drops_results:
        goals["all_dropped != 0"] = "a result that is dropped"
        goals["firsts == FIRSTS"] = "the first result after a reset, taken whole each time"
        if shown:
            goals["&alone"] = "each rail touched alone, by a result that the host took"
    else:
        goals["longest_block > LATENCY"] = "samples held up for longer than the latency"
    if can_lose:
        goals["status_set[3] && status_clear[3]"] = "an interval with a lost sample and one without"
    places = [place for _, place in slices(sample_ports(design))][:6]
    at = {
        end: ", ".join(
            f"sample{place} == {_literal(value, bits)}"
            for place, value, bits in zip(
                places, ends[end], (port.bits for port in sample_ports(design)), strict=False
            )
        )
        for end in ends
    }
    return {
        "aimed": int(aimed),
        "can_lose": int(can_lose),
        "at_low": at["lo"],
        "at_high": at["hi"],
        "goal_names": "\n".join(f"* {what}" for what in goals.values()),
        "goals": "\n".join(
            f'      goal({condition}, "{what}");' for condition, what in goals.items()
        ),
    }


def _literal(value: int, bits: int) -> str:
    return f"{bits}'h{value & (1 << bits) - 1:x}"


def inside(design: Design, timing: Timing, cells: Collection[str]) -> str:
    """The Verilog that sets the core's counters; registers are held there for three clocks."""
    compact = design.hardware.core == "compact"
    counters = ["core.losses.count"]
    if design.drops_results:
        counters.append("core.results_dropped" if compact else "core.handover.dropped")
    forced, words = [], []
    settings = numbers(design, timing)
    for limb in range(number_bits(design) // 16):
        bits = f"[{16 * limb + 15}:{16 * limb}]"
        if compact:  # the last result's number
            place = f"core.engine.left.{'block0.memory' if 'DP16KD' in cells else 'words_2'}"
            words.append(f"{place}[{limb}] <= {{2'b00, last_number{bits}}};")
            continue
        place = f"core.handover.major_{16 * limb}"
        forced.append(place)
        words += ["case (settings)"]
        words += [
            f"  {i}: force {place} = 16'h{number >> 16 * limb & 0xFFFF:04x};"
            for i, number in enumerate(settings)
        ]
        words += ["endcase"]
    starts = [f"force {counter} = COUNTER_LOW;" for counter in counters]
    last = ["  wire [NUMBER_BITS-1:0] last_number = next_number - 1'b1;"] if compact else []
    counted = "if (clk_en) " if design.hardware.clock_enable else ""
    lines = [
        "`ifndef SCULLER_PORTS_ONLY",
        f"  localparam [15:0] COUNTER_LOW = 16'd{COUNTER_MAX - 2};",
        *last,
        f"  always @(posedge clk) {counted}begin",
        "    if (setting == 4 && settings < NUMBERS) begin",
        *(f"      {line}" for line in words),
        "    end",
        "    if (setting == 4 && settings == 0) begin",
        *(f"      {line}" for line in starts),
        "    end",
        "    if (setting == 1) begin",
        *(f"      release {place};" for place in [*counters, *forced]),
        "    end",
        "  end",
        "`endif",
    ]
    return "\n".join(lines)


def numbering(design: Design) -> str:
    """The golden result, or a word of it, with a number that was set."""
    if design.hardware.handover != "stream":
        lines = [
            "wire [NUMBER_BITS-1:0] number = golden[NUMBER_BITS-1:0] + base;",
            "wire [RESULT_BITS-1:0] numbered = {golden[RESULT_BITS-1:NUMBER_BITS], number};",
        ]
    else:
        words = words_per_column(design)
        pieces = ", ".join(f"expected[first_word + {i}][15:0]" for i in reversed(range(words)))
        lines = [
            "wire [31:0] first_word = results < RESULTS ? results * PARTS : 0;",
            f"wire [NUMBER_BITS-1:0] number = {{{pieces}}} + base;",
            "wire [RESULT_BITS-1:0] numbered = part < LOST_PART"
            " ? {golden[16], number[16 * part +: 16]} : golden;",
        ]
    return "\n".join(f"  {line}" for line in lines)
