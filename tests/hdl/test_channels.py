"""The core with many channels in Amaranth's simulator: every port, on every clock."""

from __future__ import annotations

from typing import Any

import pytest
from amaranth.sim import Simulator

from hdl_channels import drawn, many
from sculler_hdl import StreamCore, sample_layout, timing
from sculler_hdl.plan.compact.banks import left_banks
from sculler_hdl.plan.compact.plan import plan_compact
from sculler_hdl.plan.pipelined_channels import plan_pipelined_channels
from sculler_model.errors import InputError
from sculler_sim.engine import trace
from sculler_sim.stimulus import Stimulus
from strategies import DESIGNS

deep = pytest.mark.deep

CASES: dict[str, tuple[dict[str, Any], int]] = {
    # one tap, a result at every sample; three of four numbers are channels
    "smallest": ({"channels": 3, "target": "ice40"}, 2500),
    # of two phases both have work
    "early_taps_2": ({"channels": 2, "target": "ice40", "initial": False}, 3500),
    "both_taps_2": ({"channels": 2}, 3500),
}
PIPELINED: dict[str, tuple[dict[str, Any], int]] = {
    "smallest": ({"channels": 3, "initial": False}, 1500),
    "early_taps_2": ({"channels": 5, "target": "ice40"}, 2500),
    "both_taps_2": ({"channels": 2, "multipliers": 14}, 3500),  # axes take turns
    "dense_odd_3": ({"channels": 4}, 2500),
    "taylor_3p3": ({"channels": 5, "multipliers": 30, "target": "ecp5"}, 2500),
    "rate_2p0": ({"channels": 2, "target": "nexus"}, 2500),
}


@pytest.mark.parametrize(
    ("core", "name"),
    [
        *(
            pytest.param("compact", name, marks=deep if name == "both_taps_2" else ())
            for name in CASES
        ),
        *(
            pytest.param("pipelined", name, marks=() if name == "early_taps_2" else deep)
            for name in PIPELINED
        ),
    ],
)
def test_every_port_is_as_the_cycle_model_says(core: str, name: str):
    hardware, clocks = (CASES if core == "compact" else PIPELINED)[name]
    design = many(name, core=core, **hardware)
    counts, channels, faults, restarts = drawn(design, clocks // 10, seed=1)
    stimulus = Stimulus.stalls(3, 64).with_resets(clocks // 2).giving_up()
    amaranth, model = (
        trace(design, counts, faults, stimulus, clocks, engine, channels, restarts)
        for engine in ("amaranth", "model")
    )
    assert amaranth.first_difference(model) is None
    assert model.result_valid.sum() > 50
    assert model.counters[:, 0].max() > 3  # samples were lost
    assert len(set(model.result[:, 2])) == design.channels


@pytest.mark.parametrize("channels", [2, 3, 16, 1000, 1024])
@pytest.mark.parametrize("name", ["smallest", "stim300_4x5", "wide_5p0"])
def test_no_two_words_of_the_left_memory_share_a_place(name: str, channels: int):
    design = many(name, channels=channels)
    plan = plan_compact(design)
    names = plan.program.left.names
    banks = left_banks(design, len(names))
    places = []
    for address in range(len(names)):
        own = banks.is_own(address)
        for bank in range(channels) if own else [banks.common_bank]:
            places.append(bank * banks.bank + banks.within(address))
    assert len(set(places)) == len(places)
    assert max(places) < banks.words
    assert banks.words >= channels * banks.own


def test_the_clocks_are_planned_from_what_there_is():
    """Written down by hand: 6 digits, memories of one clock, 4 slots to clear."""
    clocks = timing(many("smallest", channels=3, target="ice40"))
    assert (clocks.lookup, clocks.loading, clocks.clearing) == (1 + 1 + 1, 6, 4 * 6)
    assert clocks.spacing == clocks.lookup + clocks.loading + 2
    large = timing(many("smallest", channels=1024, target="ice40"))
    assert large.startup == 1024 + 1
    assert large.work == clocks.work


def test_streams_carry_the_tags():
    core = StreamCore(many("smallest", channels=5), primitive=False)
    payload, inner = core.samples.payload, core.core

    async def drive(ctx: Any) -> None:
        ctx.set(payload.channel, 4)
        ctx.set(payload.restart, 1)
        assert (ctx.get(inner.sample_channel), ctx.get(inner.sample_restart)) == (4, 1)
        assert ctx.get(core.results.payload.channel) == ctx.get(inner.result_channel)

    simulator = Simulator(core)
    simulator.add_clock(1e-8)
    simulator.add_testbench(drive)
    simulator.run()
    assert "channel" not in sample_layout(DESIGNS["smallest"]).members


def test_the_clocks_of_the_pipelined_core_are_planned_from_what_there_is():
    """Written down by hand: a clock to look, one or two of memory, one to write."""
    small = timing(many("smallest", core="pipelined", channels=3, target="ice40"))
    assert (small.lookup, small.apart, small.spacing, small.startup) == (1 + 1, 1 + 2, 1, 3 + 1)
    large = timing(many("smallest", core="pipelined", channels=1024, target="ecp5"))
    assert (large.lookup, large.apart, large.spacing, large.startup) == (1 + 2, 2 + 2, 1, 1024 + 1)


def test_multipliers_that_are_too_few_are_told():
    units = plan_pipelined_channels(many("stim300_4x5", core="pipelined", channels=9)).resources
    assert units["product_units"] == 18 + 18
    few = many("stim300_4x5", core="pipelined", channels=9, target="ecp5", multipliers=28)
    assert timing(few).spacing == 3
    with pytest.raises(InputError, match=r"hardware\.multipliers: 5 are not enough, .* at least "):
        timing(many("stim300_4x5", core="pipelined", channels=9, multipliers=5))
