"""The synthesised netlist of both cores gives the golden vectors, in each family."""

import re
from functools import cache

import pytest

from sculler_hdl import generate
from sculler_model.errors import InputError
from sculler_model.fast import run_fast
from sculler_sim.place import netlist
from sculler_sim.place.netlist import check_netlist, simulate_netlist
from sculler_sim.place.synthesis import synthesise
from sculler_sim.place.tools import NEXTPNR, YOSYS
from strategies import DESIGNS
from tiers import few_of


def core(name, target, **hardware):
    """One of the named designs, small, with a core."""
    data = DESIGNS["smallest"].as_json()
    data["name"] = name
    data["hardware"] = {"core": name.partition("_")[0], "target": target, **hardware}
    return type(DESIGNS["smallest"]).parse(data)


CORES = {
    "pipelined_ecp5": core("pipelined_ecp5", "ecp5"),
    "compact_ecp5": core("compact_ecp5", "ecp5"),
    "pipelined_ice40": core("pipelined_ice40", "ice40"),
    "compact_ice40": core("compact_ice40", "ice40"),
    **{
        f"compact_enabled_{target}": core(
            f"compact_enabled_{target}", target, reset="async", clock_enable=True
        )
        for target in ("ecp5", "ice40")
    },
}
CORES |= {
    f"{kind}_{target}": core(f"{kind}_{target}", target)
    for target in ("nexus", "gowin")
    for kind in ("pipelined", "compact")
}
CORES["compact_gatemate"] = core("compact_gatemate", "generic", multipliers=0)
QUICK = ("compact_ecp5",)  # the other family has rows of a few samples at every change


@pytest.fixture(scope="module", autouse=True)
def _tools():
    try:
        for tool in (YOSYS, *NEXTPNR.values()):
            tool.version()
    except InputError as error:
        pytest.skip(str(error))


@cache
def made(name):
    design = CORES[name]
    generated = generate(design)
    return design, generated, synthesise(generated, name.rpartition("_")[2])


@pytest.mark.parametrize("name", few_of(list(CORES), QUICK))
def test_the_netlist_gives_the_golden_vectors(name):
    design, generated, synthesis = made(name)
    family = name.rpartition("_")[2]
    assert check_netlist(design, generated, synthesis.netlist, family) is None


@pytest.mark.parametrize(
    ("name", "block"),
    [
        pytest.param("pipelined_ecp5", "MULT18X18D", marks=pytest.mark.deep),
        ("compact_ecp5", "DP16KD"),
        pytest.param("pipelined_ice40", "SB_MAC16", marks=pytest.mark.deep),
        pytest.param("compact_ice40", "SB_RAM40_4K", marks=pytest.mark.deep),
        pytest.param("compact_nexus", "PDPSC16K", marks=pytest.mark.deep),
        pytest.param("pipelined_nexus", "MULTPREADD18X18", marks=pytest.mark.deep),
        pytest.param("compact_gowin", "DPX9B", marks=pytest.mark.deep),
        pytest.param("pipelined_gowin", "MULT18X18", marks=pytest.mark.deep),
        pytest.param("compact_gatemate", "CC_BRAM_20K", marks=pytest.mark.deep),
    ],
)
def test_the_familys_blocks_are_in_it(name, block):
    """And so were simulated: no core falls back on look-up tables."""
    assert made(name)[2].counts()[block] >= 1


def test_results_come_as_rows_of_the_columns():
    design, generated, synthesis = made("pipelined_ice40")
    counts, faults = netlist._random_samples(design, 5, 3)
    rows = simulate_netlist(design, generated, synthesis.netlist, "ice40", counts, faults)
    assert rows == list(run_fast(design, counts, faults).rows())


@pytest.mark.parametrize("name", few_of(["pipelined_ecp5", "compact_ecp5"], ["compact_ecp5"]))
def test_wrong_cells_are_found(name):
    """The adders' lower look-up tables turned into something else."""
    design, generated, synthesis = made(name)
    broken = re.sub(r"\.INIT0\(16'h\w+\)", ".INIT0(16'h1234)", synthesis.netlist)
    assert broken != synthesis.netlist
    try:
        said = check_netlist(design, generated, broken, "ecp5")
    except RuntimeError as error:  # it may never hand a result over
        said = str(error)
    assert said is not None
    assert re.search(r"result \d+, \w+: -?\d+, the golden model has -?\d+|results, not", said)


@pytest.mark.deep
def test_verilator_does_it_where_icarus_is_missing(verilator, monkeypatch):
    monkeypatch.setattr(netlist.shutil, "which", lambda _: None)
    monkeypatch.setattr(netlist.Tools, "find", lambda: verilator)
    design, generated, synthesis = made("pipelined_ecp5")
    assert check_netlist(design, generated, synthesis.netlist, "ecp5") is None
