"""The core with Amaranth's streams at its boundary, for users' own Amaranth designs."""

from __future__ import annotations

from amaranth import Module, unsigned
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.core import build_core
from sculler_hdl.lib.layout import vector
from sculler_hdl.plan.ports import channel_bits, counter_ports
from sculler_model.design import AXES, Design
from sculler_model.golden import COUNTER_BITS, PORT_MAJOR_BITS, WORD_BITS


def sample_layout(design: Design) -> data.StructLayout:
    """A sample: `gyro` and `accel`, three signed counts each, and `fault`, the sensor's mark.

    Where the core has channels `channel`, whose it is, and `restart`, with which that one begins
    anew, follow.
    """
    words = design.words
    members = {"gyro": vector(words.gyro), "accel": vector(words.accel), "fault": unsigned(1)}
    tags = {"channel": unsigned(channel_bits(design)), "restart": unsigned(1)}
    return data.StructLayout(members | (tags if design.channels > 1 else {}))


def result_layout(design: Design) -> data.StructLayout:
    """A result, or with `handover = "stream"` a word of it.

    A result has `major` (unsigned, 64 bits), `status` (4 bits, 5 of a hardened core) and the
    design's vectors, three signed components each: `alpha`, `coning_within` and so on, as wide as
    their worst case.  A word has `data` (16 bits) and `last`, which marks the last of a result,
    and where the core has channels `channel`, whose it is.
    """
    if design.hardware.handover == "stream":
        word = {"data": unsigned(WORD_BITS), "last": unsigned(1)}
        whose = {"channel": unsigned(channel_bits(design))}
        return data.StructLayout(word | (whose if design.channels > 1 else {}))
    vectors = {name: vector(getattr(design.words, name)) for name in design.vectors}
    head = {"major": unsigned(PORT_MAJOR_BITS), "status": unsigned(design.status_bits)}
    return data.StructLayout(head | vectors)


class StreamCore(wiring.Component):
    """Coning and sculling accumulators of one design: a stream of samples in, of results out.

    Members:
        samples (in): a stream of `sample_layout`.
        results (out): a stream of `result_layout`.
        samples_lost (out): unsigned, 16 bits: samples offered and withdrawn.  A source that keeps
            to the rules of streams holds its offer and loses none.
        results_dropped (out): the same of results, where the design drops them.
        upset (out): of a hardened core: an upset was seen (`sculler_model.golden`).

    It works in the domain `sync`, with whatever reset that has, and without one from its initial
    values; `DomainRenamer` takes it to another.  For a clock enable use `ClockEnableInserter`,
    which stops vendors' blocks too.  `hardware.reset`, `reset_active` and `clock_enable` concern
    the Verilog module alone.

    Latency and throughput: `timing`, of the core inside; nothing is added.

    Args:
        design: the design.
        primitive: whether to instantiate the target's own blocks; False for Amaranth's simulator,
            which cannot run instances, with the same behaviour on every clock.

    Attributes:
        core: the core inside.
        timing: its clocks.

    Raises:
        InputError: `hardware.multipliers` are too few.
    """

    def __init__(self, design: Design, *, primitive: bool = True) -> None:
        self.design = design
        self.primitive = primitive
        self.core = build_core(design, primitive=primitive)
        self.timing = self.core.timing
        super().__init__(
            {
                "samples": In(stream.Signature(sample_layout(design))),
                "results": Out(stream.Signature(result_layout(design))),
                **{port.name: Out(unsigned(COUNTER_BITS)) for port in counter_ports(design)},
                **({"upset": Out(1)} if design.hardware.hardening else {}),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.core = core = self.core
        sample, result = self.samples.payload, self.results.payload
        m.d.comb += [
            core.sample_valid.eq(self.samples.valid),
            self.samples.ready.eq(core.sample_ready),
            core.sample_fault.eq(sample.fault),
            self.results.valid.eq(core.result_valid),
            core.result_ready.eq(self.results.ready),
        ]
        if self.design.channels > 1:
            m.d.comb += [
                core.sample_channel.eq(sample.channel),
                core.sample_restart.eq(sample.restart),
            ]
        m.d.comb += [
            getattr(core, f"sample_{sensor}_{axis}").eq(sample[sensor][i])
            for sensor in ("gyro", "accel")
            for i, axis in enumerate(AXES)
        ]
        for name in result_layout(self.design).members:
            shown = (
                [(result[name], name)]
                if name not in self.design.vectors
                else [(result[name][i], f"{name}_{axis}") for i, axis in enumerate(AXES)]
            )
            m.d.comb += [there.eq(getattr(core, f"result_{port}")) for there, port in shown]
        m.d.comb += [
            getattr(self, port.name).eq(getattr(core, port.name))
            for port in counter_ports(self.design)
        ]
        if self.design.hardware.hardening:
            m.d.comb += self.upset.eq(core.upset)
        return m
