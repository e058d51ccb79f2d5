"""The study of the host in C on small processors: it measures, and says what it cannot."""

from __future__ import annotations

from pathlib import Path

import pytest

from sculler.main import run_command
from sculler_model.errors import InputError
from studies.host_c.command import PAGE, command
from studies.host_c.measure import measure
from studies.host_c.page import GOAL_BYTES, GOAL_INSTRUCTIONS, document
from studies.host_c.stack import CallGraph
from studies.host_c.targets import TARGETS

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    "key",
    ["rv64gc", *(pytest.param(key, marks=pytest.mark.deep) for key in ("m7", "m4f", "rv32im"))],
)
def test_a_processor_is_measured(key: str) -> None:
    one = next(each for each in TARGETS if each.key == key)
    if one.missing is not None:
        pytest.skip(f"needs {one.missing}")
    found = measure(one)
    assert all(count > 100 for count in found.instructions)
    assert 300 < found.data[0] < 600 < found.stack < 4096
    assert 300 < found.bound[0] < found.stack + 2048
    assert 1024 < found.bound[1] < 8192
    assert found.code[1] < found.whole < 64 * 1024  # the memory of the chip of `sculler soc`
    if one.double:
        assert found.update <= GOAL_INSTRUCTIONS
        assert found.whole <= GOAL_BYTES
    text = document([found])
    assert f"{found.update:,.0f}" in text
    assert f"{found.whole:,}" in text


def test_the_page_is_of_this_command() -> None:
    text = (ROOT / "docs/explanation" / PAGE).read_text()
    assert "python -m studies.host_c" in text
    for heading in ("## Instructions an update", "## Memory, bytes"):
        assert heading in text


def test_what_cannot_be_measured_is_said(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert run_command(command, ["-o", str(tmp_path)], "study") == 2
    said = capsys.readouterr().err
    assert "no processor can be measured" in said
    assert "arm-none-eabi-gcc" in said
    assert run_command(command, ["--only", "z80"], "study") == 2
    assert "--only z80: not known, give one of m7, m4f" in capsys.readouterr().err


def test_the_deepest_path_of_a_call_graph() -> None:
    """By hand: a calls b and c, b calls d; what is outside counts nothing."""

    def node(name: str, size: int, kind: str = "static") -> str:
        return f'node: {{ title: "{name}" label: "{name}\\nx.c:1:1\\n{size} bytes ({kind})" }}\n'

    def edge(*names: str) -> str:
        return 'edge: {{ sourcename: "{}" targetname: "{}" label: "x.c:2:2" }}\n'.format(*names)

    first = node("a", 100) + node("x.c:b", 20) + edge("a", "x.c:b") + edge("a", "c")
    second = node("c", 50) + node("d", 40) + edge("x.c:b", "d") + edge("d", "__muldf3")
    graph = CallGraph([first, second])
    assert graph.deepest(["a"]) == 100 + 20 + 40
    assert graph.deepest(["c", "d"]) == 50
    with pytest.raises(InputError, match="e is in no call graph"):
        graph.deepest(["e"])
    with pytest.raises(InputError, match="calls itself"):
        CallGraph([first, second, edge("d", "a")]).deepest(["c", "a"])
    with pytest.raises(InputError, match="dynamic"):
        CallGraph([node("a", 8, "dynamic,bounded")])
    with pytest.raises(InputError, match="by a pointer"):
        CallGraph([edge("a", "__indirect_call")])
