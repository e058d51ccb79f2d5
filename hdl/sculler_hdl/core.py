"""The pipelined core: one six-axis sample per clock, exact results once a major interval.

    sample ─▶ Sequencer ─▶ History ─▶ WeightedSum ×4 ─▶ CrossSum ×4 ─▶ Accumulator ×4 ─▶ HandOver
                                      A, B, theta, v      │                 ▲
                                                          └─ Accumulator alpha, nu

Every branch is brought to the same length by `Delay`, so flags need to travel only once.
"""

from amaranth import C, Cat, Module, Mux, Signal, Value, signed, unsigned
from amaranth.hdl import ShapeLike
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.parts.accumulate import Accumulator
from sculler_hdl.parts.cross import CrossSum, cross_latency
from sculler_hdl.parts.delay import Delay
from sculler_hdl.parts.handover import HandOver
from sculler_hdl.parts.history import History
from sculler_hdl.parts.layout import FLAGS, vector
from sculler_hdl.parts.sequencer import Sequencer
from sculler_hdl.parts.weighted_sum import Rows, WeightedSum, terms_of, tree_latency
from sculler_model.coefficients import TapTable
from sculler_model.cycles import PORT_MAJOR_BITS
from sculler_model.design import Design
from sculler_model.vectors import AXES, VECTORS
from sculler_model.wordlength import ZERO, Interval


def tap_rows(table: TapTable) -> Rows:
    """The table's non-zero rows, for the sums A and B."""
    return {
        k - 1: [(d, c) for d, c in enumerate(table.taps[k - 1], start=1) if c]
        for k in table.active_phases
    }


def weight_rows(table: TapTable) -> Rows:
    """The weights as the row of phase n, for the sums theta and v."""
    return {table.samples - 1: [(d, w) for d, w in enumerate(table.weights) if w]}


def sum_latency(table: TapTable) -> int:
    """Clocks from the history to A, B, theta and v, which all arrive together."""
    return max(tree_latency(terms_of(rows)) for rows in (tap_rows(table), weight_rows(table)))


def core_latency(design: Design) -> int:
    """Clocks from the one that takes an interval's last sample to the first showing its result."""
    return (
        History.latency
        + sum_latency(design.table)
        + cross_latency(2)
        + Accumulator.latency
        + HandOver.latency
    )


class PipelinedCore(wiring.Component):
    """Coning and sculling accumulators of one design, exact in every bit.

    Ports (clock `clk`, synchronous `rst`; the handshake contract is `sculler_model.cycles`):
        sample_valid, sample_ready; sample_gyro_x..z, sample_accel_x..z (signed counts),
        sample_fault.
        result_valid, result_ready; result_major (unsigned), result_status (2 bits), and
        result_NAME for each of `sculler_model.vectors.COMPONENTS`, signed, worst-case wide.

    Throughput: one sample per clock.  Within a major interval nothing stalls; the last sample of
    an interval waits until the previous result has been taken.

    Attributes:
        latency: see `core_latency`.
    """

    def __init__(self, design: Design) -> None:
        self.design = design
        words, table = design.words, design.table

        def weighted(rows: Rows, gyro: Interval, accel: Interval) -> list[WeightedSum]:
            return [
                WeightedSum(counts, table.history, rows, result, table.samples)
                for counts, result in ((words.gyro, gyro), (words.accel, accel))
            ]

        self.sequencer = Sequencer(design)
        self.gyro_history = History(words.gyro, table.history)
        self.accel_history = History(words.accel, table.history)
        self.gyro_taps, self.accel_taps = weighted(
            tap_rows(table), words.gyro_taps, words.accel_taps
        )
        self.theta, self.v = weighted(weight_rows(table), words.theta, words.v)
        # alpha and nu before the last minor interval's, which is all the between products see
        alpha, nu = (item.repeated(design.algorithm.minors - 1) for item in (words.theta, words.v))
        self.alpha = Accumulator(words.theta, words.alpha, alpha)
        self.nu = Accumulator(words.v, words.nu, nu)
        self.cross = {
            "coning_within": CrossSum((words.gyro_taps, words.gyro)),
            "sculling_within": CrossSum(
                (words.gyro_taps, words.accel), (words.accel_taps, words.gyro)
            ),
        }
        if words.coning_between != ZERO:  # M > 1
            self.cross |= {
                "coning_between": CrossSum((alpha, words.theta)),
                "sculling_between": CrossSum((alpha, words.v), (nu, words.theta)),
            }
        self.handover = HandOver(words)

        self.latency = core_latency(design)
        super().__init__(port_members(design))

    def elaborate(self, platform: object) -> Module:
        m = Module()
        words = self.design.words
        sums, products = sum_latency(self.design.table), cross_latency(2)
        sequencer, handover = self.sequencer, self.handover
        m.submodules.sequencer = sequencer
        m.submodules.handover = handover

        def delayed(
            name: str, value: Value, shape: ShapeLike, clocks: int, *, resets: bool = False
        ) -> Value:
            line = Delay(shape, clocks, resets=resets)
            m.submodules[f"delay_{name}"] = line
            m.d.comb += line.input.eq(value)
            return line.output

        # sample port
        m.d.comb += [
            sequencer.sample_valid.eq(self.sample_valid),
            sequencer.sample_fault.eq(self.sample_fault),
            sequencer.result_taken.eq(handover.taken),
            self.sample_ready.eq(sequencer.sample_ready),
        ]
        for sensor, history in (("gyro", self.gyro_history), ("accel", self.accel_history)):
            m.submodules[f"{sensor}_history"] = history
            m.d.comb += history.shift.eq(sequencer.accept)
            for i, axis in enumerate(AXES):
                m.d.comb += history.input[i].eq(getattr(self, f"sample_{sensor}_{axis}"))

        # flags beside the sample: in the history, beside the sums, beside the cross products
        in_history = delayed("flags_history", sequencer.flags, FLAGS, History.latency, resets=True)
        phase = C(0)
        if self.gyro_taps.phased:
            phase = delayed("phase", sequencer.phase, sequencer.phase.shape(), History.latency)
        at_sums = delayed("flags_sums", in_history, FLAGS, sums, resets=True)
        late = ["valid", "start", "tapped", "major_end", "short", "fault"]
        if "coning_between" in self.cross:
            late.append("minor_end")
        at_totals = {
            name: delayed(f"{name}_cross", at_sums[name], unsigned(1), products, resets=True)
            for name in late
        }

        # A, B, theta, v and the sample itself, all at the same clock
        def summed(name: str, part: WeightedSum, history: History) -> Value:
            m.submodules[name] = part
            m.d.comb += [part.samples.eq(history.output), part.phase.eq(phase)]
            shape = vector(part.result)
            return delayed(name, part.output, shape, sums - part.latency)

        A = summed("gyro_taps", self.gyro_taps, self.gyro_history)
        B = summed("accel_taps", self.accel_taps, self.accel_history)
        theta = summed("theta", self.theta, self.gyro_history)
        v = summed("v", self.v, self.accel_history)
        s = delayed("s", self.gyro_history.output[0], vector(words.gyro), sums)
        r = delayed("r", self.accel_history.output[0], vector(words.accel), sums)

        # alpha and nu: `before` is what the between products take
        for name, part, item in (("alpha", self.alpha, theta), ("nu", self.nu, v)):
            m.submodules[name] = part
            m.d.comb += [
                part.step.eq(at_sums.valid),
                part.start.eq(at_sums.start),
                part.add.eq(at_sums.minor_end),
                part.input.eq(item),
            ]

        # the four products, accumulated
        alpha, nu = self.alpha.before, self.nu.before
        operands = {
            "coning_within": {"left0": A, "right0": s},
            "sculling_within": {"left0": A, "right0": r, "left1": B, "right1": s},
            "coning_between": {"left0": alpha, "right0": theta},
            "sculling_between": {"left0": alpha, "right0": v, "left1": nu, "right1": theta},
        }
        totals = {
            "alpha": delayed("alpha", self.alpha.total, vector(words.alpha), products),
            "nu": delayed("nu", self.nu.total, vector(words.nu), products),
        }
        within = ("coning_within", "sculling_within")
        for name, part in self.cross.items():
            m.submodules[f"{name}_cross"] = part
            m.d.comb += [getattr(part, port).eq(value) for port, value in operands[name].items()]
            lag = products - part.latency
            accumulator = Accumulator(part.result, getattr(words, name))
            m.submodules[name] = accumulator
            m.d.comb += [
                accumulator.step.eq(at_totals["valid"]),
                accumulator.start.eq(at_totals["start"]),
                accumulator.add.eq(at_totals["tapped" if name in within else "minor_end"]),
                accumulator.input.eq(delayed(name, part.output, vector(part.result), lag)),
            ]
            totals[name] = accumulator.total

        # status, and the hand-over in the clock after the interval's last addition
        status = Signal(2)
        news = Cat(at_totals["short"], at_totals["fault"])  # STATUS_SHORT_HISTORY, STATUS_FAULT
        with m.If(at_totals["valid"]):
            m.d.sync += status.eq(Mux(at_totals["start"], 0, status) | news)
        load = Signal()
        m.d.sync += load.eq(at_totals["major_end"])
        m.d.comb += [
            handover.load.eq(load),
            handover.input_status.eq(status),
            handover.ready.eq(self.result_ready),
            self.result_valid.eq(handover.valid),
            self.result_major.eq(handover.major),
            self.result_status.eq(handover.status),
        ]
        for name in VECTORS:
            if name in totals:  # else it is always 0
                m.d.comb += handover.input[name].eq(totals[name])
            for i, axis in enumerate(AXES):
                m.d.comb += getattr(self, f"result_{name}_{axis}").eq(handover.output[name][i])
        return m


def port_members(design: Design) -> dict[str, wiring.Member]:
    """Ports of the core by name, in the order they stand in the Verilog."""
    words = design.words
    members = {"sample_valid": In(1), "sample_ready": Out(1)}
    for sensor in ("gyro", "accel"):
        for axis in AXES:
            members[f"sample_{sensor}_{axis}"] = In(signed(getattr(words, sensor).bits))
    members |= {
        "sample_fault": In(1),
        "result_valid": Out(1),
        "result_ready": In(1),
        "result_major": Out(unsigned(PORT_MAJOR_BITS)),
        "result_status": Out(2),
    }
    for name in VECTORS:
        for axis in AXES:
            members[f"result_{name}_{axis}"] = Out(signed(getattr(words, name).bits))
    return members
