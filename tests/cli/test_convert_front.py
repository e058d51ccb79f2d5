"""Raw captures of what a design's front end reads: convert agrees with the golden front end."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from front_designs import design_of, made
from sculler.formats.log import read_log
from sculler_model.front import FrontModel

Run = Callable[..., Any]


def counts(number: int) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
    return (number + 1, -2 * number, -(2**15)), (2**15 - 1, 3 * number, -560)


@pytest.mark.parametrize("name", ["custom", "stim300", "hg4930"])
def test_convert_and_front_end_read_the_same_bytes_alike(
    name: str, run: Run, tmp_path: Path
) -> None:
    design = design_of(name)
    (tmp_path / "design.toml").write_text(_toml(design.as_json()))
    rng = random.Random(4)
    frames = [bytearray(made(name, *counts(i), i)) for i in range(60)]
    frames[20][9] ^= 8
    del frames[33]
    frames[45] += rng.randbytes(7)
    content = b"".join(frames)
    log, out = tmp_path / "in.bin", tmp_path / "out.csv"
    log.write_bytes(content)
    options = ["--format", "front"] if name != "custom" else []  # its own frames are recognised
    outcome = run(
        *("convert", log, "-o", out, "--design", tmp_path / "design.toml", "--gaps", "bridge"),
        *("--json", *options),
    )
    assert outcome.status == 0, outcome.err
    assert json.loads(outcome.out)["format"] == "front"
    model = list(FrontModel(design.front, timed=False).run(content))
    chunks = list(read_log(out, design))
    rows = np.concatenate([chunk.counts for chunk in chunks]).tolist()
    faults = np.concatenate(
        [np.zeros(len(c.counts)) if c.faults is None else c.faults for c in chunks]
    ).tolist()
    assert faults == [sample.fault for sample in model]
    for row, sample in zip(rows, model, strict=True):
        assert sample.placeholder or row == [*sample.gyro, *sample.accel]
    assert sum(sample.placeholder for sample in model) == 2


def _toml(value: Any) -> str:
    """A design as TOML."""

    def inline(value: Any) -> str:
        if isinstance(value, dict):
            return "{" + ", ".join(f"{key} = {inline(each)}" for key, each in value.items()) + "}"
        if isinstance(value, list):
            return "[" + ", ".join(map(inline, value)) + "]"
        return json.dumps(value)

    return "\n".join(f"{key} = {inline(each)}" for key, each in value.items())


def test_a_design_without_a_front_end_is_told(refused: Callable[..., str], tmp_path: Path) -> None:
    log = tmp_path / "in.bin"
    log.write_bytes(b"x" * 100)
    said = refused(
        "convert", log, "-o", tmp_path / "o.csv", "--design", "stim300", "--format", "front"
    )
    assert "[hardware.front]" in said
