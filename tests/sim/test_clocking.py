"""Cores with another reset, with a clock enable, from random values or unknown ones at first."""

from __future__ import annotations

from pathlib import Path

import pytest
from amaranth import EnableInserter

from bench_files import bench_of, run_bench, shell
from rtl import check_trace
from sculler_hdl import ClockedCore, clocked, generate, module_ports
from sculler_model.design import Design
from sculler_sim.engine import EngineName
from sculler_sim.engines.verilator_build import emitted
from sculler_sim.testbench import LEAST
from strategies import DESIGNS, with_hardware
from tiers import few_of

STYLES = {
    "async": {"reset": "async"},
    "low-enable": {"reset_active": "low", "clock_enable": True},
    "async-low-enable-unknown": {
        "reset": "async",
        "reset_active": "low",
        "clock_enable": True,
        "initial": False,
    },
}
BASES = {
    "pipelined": ("smallest", {}, 1200),
    "compact": ("smallest", {"core": "compact"}, 3000),
    "compact-ecp5": ("taylor_2p1", {"core": "compact", "target": "ecp5"}, 9000),
    "compact-ice40": ("smallest", {"core": "compact", "target": "ice40"}, 3000),
    "serial": ("smallest", {"core": "compact", "multipliers": 0}, 16000),
    "pipelined-ecp5": (
        "taylor_2p1",
        {"target": "ecp5", "multipliers": 12, "overrun": "drop-result"},
        3000,
    ),
    "stream-ice40": ("taylor_2p1", {"target": "ice40", "handover": "stream"}, 3000),
}
CASES = {
    f"{base}-{style}": (with_hardware(DESIGNS[name], **hardware, **more), clocks)
    for base, (name, hardware, clocks) in BASES.items()
    for style, more in STYLES.items()
}
CORES = {name: design for name, (design, _) in CASES.items()}
QUICK = [f"{core}-async-low-enable-unknown" for core in ("pipelined", "compact")]


# Amaranth's simulator is slow: at every change it has the pipelined core, Verilator both
ENGINES: tuple[EngineName, ...] = ("verilator", "amaranth")
ON_ENGINES = {f"{engine}-{name}": (engine, name) for engine in ENGINES for name in CASES}


@pytest.mark.parametrize(
    "case",
    few_of(ON_ENGINES, [*(f"verilator-{name}" for name in QUICK), f"amaranth-{QUICK[0]}"]),
)
def test_every_port_on_every_clock(
    case: tuple[EngineName, str], request: pytest.FixtureRequest
) -> None:
    """Under random stalls, enables and resets, those in clocks that are not enabled among them."""
    engine, name = case
    if engine == "verilator":
        request.getfixturevalue("verilator")
    design, clocks = CASES[name]
    check_trace(design, engine, clocks, (1, 2), least=5)


@pytest.mark.usefixtures("icarus")
@pytest.mark.parametrize("name", few_of(list(CASES), QUICK))
def test_the_bench_passes(name: str, tmp_path: Path) -> None:
    """In Icarus, where a register without an initial value is X."""
    run_bench(CORES[name], tmp_path)


@pytest.mark.usefixtures("icarus")
@pytest.mark.parametrize("name", few_of(list(CASES), QUICK[:1]))
def test_the_bench_that_is_handed_out_passes(name: str, tmp_path: Path) -> None:
    """With all its runs: among others resets while a result waits, which then goes."""
    run_bench(CORES[name], tmp_path, LEAST)


def test_ports_are_what_the_style_asks_for() -> None:
    for style, wanted in (
        ({}, ["clk", "rst"]),
        ({"reset": "async"}, ["clk", "rst"]),
        ({"reset_active": "low"}, ["clk", "rst_n"]),
        ({"reset_active": "low", "clock_enable": True}, ["clk", "rst_n", "clk_en"]),
    ):
        ports = module_ports(with_hardware(DESIGNS["smallest"], **style))
        names = [port.name for port in ports]
        assert names[: names.index("sample_valid")] == wanted
        told = ports[1].meaning
        assert told.startswith("asynchronous" if "reset" in style else "synchronous")
        assert told.endswith("active low" if "reset_active" in style else "active high")


@pytest.mark.usefixtures("icarus")
def test_an_asynchronous_reset_needs_no_clock(tmp_path: Path) -> None:
    """The clock stands still; the ports are as at power-up, and so they stay until it runs."""
    design = CORES["compact-async"]
    (tmp_path / "core.v").write_text(emitted(design)[f"{design.name}.v"])
    (tmp_path / "bench.v").write_text(
        f"""module bench;
          reg clk = 0, rst = 0;
          wire ready, valid;
          integer clocks;
          {design.name} core (.clk(clk), .rst(rst), .sample_valid(1'b1), .sample_ready(ready),
            .sample_gyro_x(8'd1), .sample_gyro_y(8'd2), .sample_gyro_z(8'd3),
            .sample_accel_x(9'd4), .sample_accel_y(9'd5), .sample_accel_z(9'd6),
            .sample_fault(1'b0), .result_valid(valid), .result_ready(1'b0));
          initial begin
            while (valid !== 1 && $time < 100000) begin #5 clk = 1; #5 clk = 0; end
            $display("valid %b", valid);
            #2 rst = 1;
            #1 $display("reset: valid %b, ready %b", valid, ready);
            #1 rst = 0;
            #9 $display("after: valid %b, ready %b", valid, ready);
            clocks = 0;
            while (ready !== 1 && clocks < 10000) begin
              #5 clk = 1; #5 clk = 0; clocks = clocks + 1;
            end
            $display("ready %b", ready);
          end
        endmodule"""
    )
    done = shell("iverilog -g2005 -o b.vvp bench.v core.v && vvp -n b.vvp", tmp_path)
    assert done.stdout.splitlines() == [
        "valid 1",
        "reset: valid 0, ready 0",
        "after: valid 0, ready 0",
        "ready 1",
    ]


def without_stop(monkeypatch: pytest.MonkeyPatch) -> None:
    """Vendors' blocks go on while everything else stands still."""
    monkeypatch.setattr(clocked, "ClockEnableInserter", EnableInserter)


def without_gate(monkeypatch: pytest.MonkeyPatch) -> None:
    """Samples seem to be taken before a reset has ended."""
    elaborate = ClockedCore.elaborate

    def changed(self: ClockedCore, platform: object) -> object:
        made = elaborate(self, platform)
        made.add_statements("comb", self.sample_ready.eq(self.core.sample_ready))
        return made

    monkeypatch.setattr(ClockedCore, "elaborate", changed)


@pytest.mark.usefixtures("icarus")
@pytest.mark.parametrize(
    ("name", "fault"),
    [
        pytest.param("compact-ecp5-low-enable", without_stop, id="blocks"),
        pytest.param("pipelined-async", without_gate, id="gate"),
    ],
)
def test_the_bench_sees_what_is_wrong(
    name: str, fault: object, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert callable(fault)
    design: Design = CORES[name]
    commands = bench_of(design, tmp_path)
    fault(monkeypatch)
    text = generate.__wrapped__(design).verilog
    (tmp_path / f"{design.name}.v").write_text(text)
    done = shell(commands["icarus"], tmp_path)
    assert done.stdout.startswith("FAIL: "), done.stdout + done.stderr
