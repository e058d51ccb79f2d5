"""`python -m studies.afternoon`: the commands of a page, run and timed.

The tutorial itself is run by tests/docs, before a release.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from sculler_model.errors import ToolError
from studies.afternoon.command import table, timed

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
