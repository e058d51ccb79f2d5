"""Studies against an earlier commit: which are held, and a side that runs them."""

from __future__ import annotations

from pathlib import Path

import pytest

from sculler_model.errors import InputError
from studies.bench import analyses, before


def test_without_the_earlier_commit_ours_is_measured_alone(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def none(folder: Path) -> Path:
        raise InputError("has no commit")

    monkeypatch.setattr(before, "tree", none)
    found = {contest.name: contest for contest in analyses.contests(tmp_path)}
    assert found["analyze quantisation stim300"].goal == 20
    assert found["advise, coning"].goal == 3
    assert len(found) == len(analyses.DESIGNS) + len(analyses.STUDIES)
    for contest in found.values():
        assert (contest.theirs, contest.missing) == (None, "has no commit")


@pytest.mark.deep
def test_a_side_runs_every_study_and_says_when_one_fails() -> None:
    side = analyses.Side(before.REPOSITORY)
    for job in analyses.STUDIES:
        side.run(job)
    with pytest.raises(RuntimeError, match="no such preset: the study failed"):
        side.run("no such preset")
