"""The vendors' blocks as Yosys ships them, which we did not write, against our cores and models.

What it ships differs: SB_MAC16 and DSP48E1 have behaviour, so cores are simulated with them (and
the netlists of `test_netlist` with all other cells); of MULT18X18D, DP16KD and the Xilinx block
memories it has only the ports.  Our models of the former two are held to those ports, and simulate
what Yosys itself maps to them, which knows the blocks independently of us.
"""

import json
import random
import re
import shlex

import pytest

from bench_files import bench_of, modules_of, shell
from position_designs import HIGH_RESOLUTION
from sculler_hdl import cell_models, generate
from sculler_model.errors import InputError
from sculler_sim.engines.verilator_build import emitted
from sculler_sim.place import netlist, synthesis
from sculler_sim.place.netlist import check_netlist
from sculler_sim.place.tools import YOSYS
from strategies import DESIGNS, with_hardware
from tiers import few_of, tiers


@pytest.fixture(scope="module", autouse=True)
def _tools():
    try:
        YOSYS.version()
    except InputError as error:
        pytest.skip(str(error))


def yosys(folder, script):
    (folder / "script.ys").write_text(script)
    status, log = YOSYS.run(folder, "script.ys")
    assert status == 0, log[-2000:]


@pytest.fixture(scope="module")
def blocks(tmp_path_factory):
    """Direction and width of every port of the blocks that we have models of."""
    folder = tmp_path_factory.mktemp("blocks")
    (folder / "blocks.v").write_text("\n".join(map(shipped, cell_models())))
    yosys(folder, "read_verilog -lib blocks.v\nwrite_json blocks.json\n")
    modules = json.loads((folder / "blocks.json").read_text())["modules"]
    return {name: ports(modules[name]) for name in cell_models()}


LIBRARY = {
    "MULT18X18D": "ecp5/cells_bb.v",
    "DP16KD": "ecp5/cells_sim.v",
    "SB_MAC16": "ice40/cells_sim.v",
    "MULTPREADD18X18": "lattice/cells_sim_nexus.v",
    "MULT18X18": "gowin/cells_xtra_gw2a.v",
    **dict.fromkeys(sorted(netlist._PORTS_ONLY), "xilinx/cells_sim.v"),
}


def shipped(name):
    """The module that Yosys ships for a block."""
    text = YOSYS.share(LIBRARY[name]).read_text()
    return re.search(rf"^module {name}\b.*?^endmodule$", text, re.M | re.S)[0]


def ports(module):
    return {name: (port["direction"], len(port["bits"])) for name, port in module["ports"].items()}


CASCADES = {
    "MULT18X18D": {f"{bus}{bit}" for bus in ("SRIA", "SRIB") for bit in range(18)},
}
"""Inputs that only a neighbour's outputs can be routed to: nextpnr refuses even a constant."""


@pytest.mark.parametrize("name", cell_models())
def test_our_model_has_the_blocks_inputs_and_nothing_of_its_own(name, blocks, tmp_path):
    readable = cell_models()[name].replace("$finish;", "")  # for Yosys, in `always`
    (tmp_path / "model.v").write_text(readable)
    yosys(tmp_path, "read_verilog -lib model.v\nwrite_json model.json\n")
    ours = ports(json.loads((tmp_path / "model.json").read_text())["modules"][name])
    assert ours.items() <= blocks[name].items()
    left_out = {port for port in blocks[name] if port not in ours}
    inputs = {port for port in left_out if blocks[name][port][0] != "output"}
    assert inputs == CASCADES.get(name, set())


def blocks_in(text):
    """The kinds of what a core's text instantiates and does not declare."""
    modules = modules_of(text)
    found = re.findall(r"^  (\w+) (?:#\(.*?\) )?\w+ \($", text, re.M | re.S)
    return [kind for kind in found if kind not in modules]


def instances(text, name):
    """The connections of each instance of a block."""
    for body in re.findall(rf"^  {name} #\(.*?^  \) \S+ +\((.*?)^  \);", text, re.M | re.S):
        yield dict(re.findall(r"^    \.(\w+)\((.*?)\),?$", body, re.M | re.S))


CORES = {
    f"{name}-{core}-{target}-{multipliers}": with_hardware(
        (DESIGNS | HIGH_RESOLUTION)[name], core=core, target=target, multipliers=multipliers
    )
    for target in ("ecp5", "ice40")
    for name, core, multipliers in (
        ("smallest", "compact", 1),
        ("taylor_8p8", "compact", 1),  # a program of more words than a block of 18 bits has
        ("smallest", "compact", 0),
        ("smallest_hr", "compact", 1),
        ("smallest", "pipelined", None),
        ("taylor_2p1", "pipelined", 12),
        ("smallest_hr", "pipelined", None),
    )
} | {
    f"smallest-{core}-{target}": with_hardware(DESIGNS["smallest"], core=core, target=target)
    for target in ("nexus", "gowin")
    for core in ("compact", "pipelined")
}


@pytest.mark.parametrize("design", tiers(CORES))
def test_no_input_of_a_block_is_left_open(design, blocks):
    text = emitted(design)[f"{design.name}.v"]
    found = 0
    for name, port_list in blocks.items():
        for connections in instances(text, name):
            found += 1
            for port, (direction, _) in port_list.items():
                if direction != "output" and port not in CASCADES.get(name, ()):
                    assert connections.get(port), (name, port)
                    assert not re.search(r"'[bho]\w*[xz]", connections[port]), (name, port)
            if name == "MULT18X18D":
                assert {connections[f"SOURCE{operand}"] for operand in "AB"} == {"1'h0"}
    assert found == len(blocks_in(text))
    assert (found == 0) == (design.hardware.target == "ice40" and design.hardware.multipliers == 0)


def test_xilinx_cores_instantiate_no_block():
    """Synthesis infers them all."""
    for core in ("pipelined", "compact"):
        design = with_hardware(DESIGNS["smallest"], core=core, target="xilinx")
        assert not blocks_in(emitted(design)[f"{design.name}.v"])


@pytest.mark.usefixtures("icarus")
@pytest.mark.parametrize(
    "design", tiers({name: core for name, core in CORES.items() if core.hardware.target == "ice40"})
)
def test_ice40_cores_pass_their_bench_with_the_librarys_block(design, tmp_path):
    command = bench_of(design, tmp_path)["icarus"]
    (tmp_path / "SB_MAC16.v").write_text(shipped("SB_MAC16"))
    done = shell(command, tmp_path)
    assert done.stdout.startswith("PASS: "), done.stdout + done.stderr


NEW = [name for name in CORES if name.endswith(("nexus", "gowin"))]


@pytest.mark.usefixtures("icarus")
@pytest.mark.parametrize("name", few_of(NEW, ["smallest-compact-nexus", "smallest-compact-gowin"]))
def test_nexus_and_gowin_cores_pass_their_bench(name, tmp_path):
    """With our models in Icarus; Nexus' also with the library's block, which has behaviour."""
    design = CORES[name]
    command = bench_of(design, tmp_path)["icarus"]
    done = shell(command, tmp_path)
    assert done.stdout.startswith("PASS: "), done.stdout + done.stderr
    if design.hardware.target == "nexus":
        text = YOSYS.share("lattice/cells_sim_nexus.v").read_text()
        used = [shipped("MULTPREADD18X18")]
        for part in ("OXIDE_DSP_REG", "OXIDE_DSP_SIM"):
            used.append(re.search(rf"^module {part}\b.*?^endmodule$", text, re.M | re.S)[0])
        (tmp_path / "MULTPREADD18X18.v").write_text("\n".join(used))
        done = shell(command.replace(" -Wall", ""), tmp_path)
        assert done.stdout.startswith("PASS: "), done.stdout + done.stderr


@pytest.mark.deep
@pytest.mark.parametrize("name", NEW)
def test_nexus_and_gowin_cores_pass_their_bench_in_verilator(name, verilator, tmp_path):
    command = bench_of(CORES[name], tmp_path)["verilator"]
    command = command.replace("verilator ", shlex.join(verilator.verilator) + " ", 1)
    done = shell(command, tmp_path, **verilator.environment)
    assert "PASS: " in done.stdout, done.stdout + done.stderr


@pytest.mark.usefixtures("icarus")
@pytest.mark.deep
@pytest.mark.parametrize("core", ["pipelined", "compact"])
def test_xilinx_cores_give_the_golden_vectors_with_the_librarys_cells(core, monkeypatch):
    """Memories are made of look-up tables, for block memories have no behaviour there."""
    design = with_hardware(DESIGNS["smallest"], core=core, target="xilinx")
    generated = generate(design)
    script = synthesis._SYNTHESIS["xilinx"]
    monkeypatch.setitem(synthesis._SYNTHESIS, "xilinx", f"{script} -nobram")
    made = synthesis.synthesise(generated, "xilinx")
    assert made.counts()["DSP48E1"] >= 1
    assert not made.counts().keys() & netlist._PORTS_ONLY
    assert check_netlist(design, generated, made.netlist, "xilinx") is None


def test_a_block_without_a_model_is_refused():
    design = with_hardware(DESIGNS["smallest"], core="compact", target="xilinx")
    with pytest.raises(InputError, match="no model of RAMB18E1"):
        check_netlist(design, generate(design), "  RAMB18E1 #(\n", "xilinx")


def test_what_yosys_ships_without_behaviour():
    """Where it gains some, simulate with it."""
    behaviour = re.compile(r"^\s*(assign|always|initial)\b", re.M)
    assert [name for name in LIBRARY if behaviour.search(shipped(name))] == ["SB_MAC16"]


@pytest.mark.usefixtures("icarus")
@pytest.mark.parametrize("signed", [True, False])
def test_yosyss_multiplications_are_right_with_our_mult18x18d(signed, tmp_path):
    """Products that Yosys maps to the block, with its own idea of ports and signs."""
    kind = "signed" if signed else ""
    (tmp_path / "product.v").write_text(
        f"module product(input {kind} [17:0] a, b, output {kind} [35:0] y);"
        " assign y = a * b; endmodule"
    )
    yosys(tmp_path, "read_verilog product.v\nsynth_ecp5 -top product\nwrite_verilog netlist.v\n")
    rng = random.Random(1)
    ends = (0, 1, 2**17 - 1, 2**17, 2**18 - 1)
    pairs = [(a, b) for a in ends for b in ends]
    pairs += [(rng.randrange(2**18), rng.randrange(2**18)) for _ in range(200)]

    def value(bits):
        return bits - (1 << 18) if signed and bits >> 17 else bits

    checks = "\n".join(
        f"a = {a}; b = {b}; #1 if (y !== 36'd{value(a) * value(b) % 2**36}) $display(a, b, y);"
        for a, b in pairs
    )
    (tmp_path / "bench.v").write_text(
        f"module bench; reg [17:0] a, b; wire [35:0] y; product p (a, b, y);\n"
        f'initial begin {checks}\n$display("done"); end endmodule'
    )
    (tmp_path / "MULT18X18D.v").write_text(cell_models()["MULT18X18D"])
    assert "MULT18X18D" in (tmp_path / "netlist.v").read_text()
    done = shell("iverilog -g2005 -o b bench.v netlist.v MULT18X18D.v && vvp -n b", tmp_path)
    assert done.stdout == "done\n", done.stdout + done.stderr


@pytest.mark.usefixtures("icarus")
@pytest.mark.parametrize(
    ("width", "depth"),
    [
        (18, 1024),
        pytest.param(9, 2048, marks=pytest.mark.deep),
        *(pytest.param(4 >> i, 4096 << i, marks=pytest.mark.deep) for i in range(3)),
    ],
)
def test_yosyss_memories_are_right_with_our_dp16kd(width, depth, tmp_path):
    """A memory that Yosys maps to the block, beside the same as registers: all words, both ways."""
    top = (depth - 1).bit_length() - 1
    rng = random.Random(2)
    initial = " ".join(f"words[{i}] = {rng.randrange(1 << width)};" for i in range(depth))
    if width < 9:  # of zeros, as ours begin
        initial = f"for (i = 0; i < {depth}; i = i + 1) words[i] = 0;"
    text = f"""module NAME(input clk, input [{top}:0] a, b, input w, input [{width - 1}:0] d,
                       output reg [{width - 1}:0] q);
      integer i;
      STYLE reg [{width - 1}:0] words [0:{depth - 1}];
      initial begin
        q = 0;
        {initial}
      end
      always @(posedge clk) begin if (w) words[a] <= d; q <= words[b]; end
    endmodule"""
    style = '(* ram_style = "block", no_rw_check *)'
    mapped = text.replace("NAME", "mapped").replace("STYLE", style).replace("q = 0;", "")
    (tmp_path / "memory.v").write_text(mapped)
    yosys(tmp_path, "read_verilog memory.v\nsynth_ecp5 -top mapped\nwrite_verilog netlist.v\n")
    mapped = (tmp_path / "netlist.v").read_text()
    assert "DP16KD" in mapped
    (tmp_path / "netlist.v").write_text(re.sub(r"^    \.DOA\d+\(.*\),\n", "", mapped, flags=re.M))
    (tmp_path / "DP16KD.v").write_text(cell_models()["DP16KD"])
    (tmp_path / "plain.v").write_text(text.replace("NAME", "plain").replace("STYLE", ""))
    (tmp_path / "bench.v").write_text(
        f"""module bench;
          reg clk = 0, w = 0; reg [{top}:0] a = 0, b = 1; reg [{width - 1}:0] d = 0;
          wire [{width - 1}:0] q, p;
          integer i, seed = 1, wrong = 0;
          mapped m (clk, a, b, w, d, q);
          plain r (clk, a, b, w, d, p);
          initial begin
            for (i = 0; i < {3 * depth}; i = i + 1) begin
              #5 clk = 1; #5 clk = 0;
              if (q !== p) wrong = wrong + 1;
              b = i; a = $random(seed); d = $random(seed);
              w = i > {depth} && a != b;
            end
            $display("%0d wrong", wrong);
          end
        endmodule"""
    )
    done = shell("iverilog -g2005 -o b bench.v netlist.v plain.v DP16KD.v && vvp -n b", tmp_path)
    assert done.stdout == "0 wrong\n", done.stdout + done.stderr
