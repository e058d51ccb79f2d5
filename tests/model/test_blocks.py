"""Results as arrays."""

from __future__ import annotations

import numpy as np
import pytest

from position_designs import HIGH_RESOLUTION
from sculler_model.design import (
    COLUMNS,
    COMPONENTS,
    EVERY_COLUMNS,
    FOURTH_ORDER_VECTORS,
    HIGH_RESOLUTION_COLUMNS,
    HIGH_RESOLUTION_VECTORS,
    THIRD_ORDER_VECTORS,
    VECTORS,
    Result,
)
from sculler_model.fast import VectorBlock, WideIntegers, component_limbs
from strategies import DESIGNS

RESULTS = [
    Result(major, major % 4, *((10 * v + major, v, -v) for v in range(1, 7))) for major in range(5)
]


def test_column_names() -> None:
    assert ",".join(COLUMNS) == (
        "major,status,alpha_x,alpha_y,alpha_z,coning_within_x,coning_within_y,coning_within_z,"
        "coning_between_x,coning_between_y,coning_between_z,nu_x,nu_y,nu_z,sculling_within_x,"
        "sculling_within_y,sculling_within_z,sculling_between_x,sculling_between_y,"
        "sculling_between_z"
    )
    third, fourth = THIRD_ORDER_VECTORS, FOURTH_ORDER_VECTORS
    assert Result._fields[2:] == (*VECTORS, *HIGH_RESOLUTION_VECTORS, *third, *fourth)
    assert [len(columns) for columns in EVERY_COLUMNS] == [20, 26, 29, 32]


@pytest.mark.parametrize("name", [None, "stim300_4x5", "wide_5p0"])
def test_results_come_back_as_rows(name: str | None) -> None:
    block = VectorBlock.from_results(RESULTS, None if name is None else DESIGNS[name])
    if name == "wide_5p0":
        assert isinstance(block.components, WideIntegers)
        assert block.components.words == 2
        assert block.to_numpy().dtype == object
    else:
        assert isinstance(block.components, np.ndarray)
        assert block.components.dtype == block.to_numpy().dtype == np.int64
    assert len(block) == 5
    rows = list(block.rows())
    assert rows == [result.row() for result in RESULTS]
    assert all(type(value) is int for row in rows for value in row)


def test_rows_of_more_than_64_bits() -> None:
    huge = RESULTS[0]._replace(sculling_within=(2**90, -(2**90), 2**63))
    block = VectorBlock.from_results([huge])
    assert list(block.rows()) == [huge.row()]
    table = block.to_numpy()
    assert table.dtype == object
    assert table.tolist() == [[*huge.row()]]
    assert block.named_columns()["sculling_within_x"].tolist() == [2**90]
    assert block.vector("sculling_within").astype(np.float64).tolist() == [
        [2.0**90, -(2.0**90), 2.0**63]
    ]
    with pytest.raises(OverflowError):
        VectorBlock.from_results([huge], DESIGNS["stim300_4x5"])


def test_vector_by_name() -> None:
    block = VectorBlock.from_results(RESULTS)
    for name in VECTORS:
        assert block.vector(name).tolist() == [list(getattr(r, name)) for r in RESULTS]


def test_empty_and_concatenate() -> None:
    empty = VectorBlock.from_rows([])
    assert (len(empty), empty.components.shape, list(empty.rows())) == (0, (0, 18), [])
    assert len(VectorBlock.from_results([])) == 0
    whole = VectorBlock.from_results(RESULTS)
    parts = [VectorBlock.from_results(part) for part in (RESULTS[:2], RESULTS[2:])]
    joined = VectorBlock.concatenate([parts[0], empty, parts[1]])
    assert list(joined.rows()) == list(whole.rows())
    assert isinstance(joined.components, np.ndarray)
    with pytest.raises(ValueError, match="at least one"):
        VectorBlock.concatenate([])


def test_first_difference() -> None:
    block = VectorBlock.from_results(RESULTS)
    assert block.first_difference(VectorBlock.from_results(RESULTS)) is None
    changed = [*RESULTS[:3], RESULTS[3]._replace(nu=(43, 4, 0), alpha=(13, 1, 9)), RESULTS[4]]
    assert block.first_difference(VectorBlock.from_results(changed)) == (3, "alpha_z", -1, 9)
    status = [RESULTS[0]._replace(status=2), *changed[1:]]
    assert block.first_difference(VectorBlock.from_results(status)) == (0, "status", 0, 2)
    # rows that only one of them has are for the caller to count
    assert block.first_difference(VectorBlock.from_results(RESULTS[:2])) is None


def test_blocks_of_other_widths_are_joined_in_the_widest() -> None:
    wide = RESULTS[1]._replace(nu=(-(2**100), 2**64, -1))
    parts = [VectorBlock.from_results([each]) for each in (RESULTS[0], wide, RESULTS[2])]
    joined = VectorBlock.concatenate(parts)
    assert isinstance(joined.components, WideIntegers)
    assert [*joined.rows()] == [each.row() for each in (RESULTS[0], wide, RESULTS[2])]


def test_arrays_of_python_integers_are_kept_as_limbs() -> None:
    numbers = np.array([[2**70 + i for i in range(18)]], object)
    block = VectorBlock(np.zeros(1, np.int64), np.zeros(1, np.int64), numbers)
    assert isinstance(block.components, WideIntegers)
    assert block.components.tolist() == numbers.tolist()


def test_limbs_follow_the_widest_vector() -> None:
    assert component_limbs(DESIGNS["stim300_4x5"]) == 1
    assert component_limbs(DESIGNS["taylor_6p2"]) == 1  # 63 bits
    assert component_limbs(DESIGNS["wide_5p0"]) == 2
    widest = {
        name: max(getattr(design.words, vector).bits for vector in VECTORS)
        for name, design in DESIGNS.items()
    }
    for name, design in DESIGNS.items():
        assert 64 * (component_limbs(design) - 1) < widest[name] <= 64 * component_limbs(design)
    assert len(COMPONENTS) == 18


def test_blocks_with_high_resolution_position() -> None:
    vectors = [(100 * i, -i, i) for i in range(9)]
    results = [Result(i, 0, *vectors[:6], *vectors[6:]) for i in range(3)]
    block = VectorBlock.from_results(results)
    assert block.components.shape == (3, 27)
    assert block.columns == HIGH_RESOLUTION_COLUMNS
    assert [*block.rows()] == [result.row() for result in results]
    assert block.vector("nu").tolist() == [list(vectors[3])] * 3
    assert block.vector("scrolling").tolist() == [list(vectors[8])] * 3
    changed = [*results[:2], results[2]._replace(s_nu=(700, -7, 8))]
    other = VectorBlock.from_results(changed)
    assert block.first_difference(other) == (2, "s_nu_z", 7, 8)
    none = VectorBlock.from_results([], HIGH_RESOLUTION["stim300_hr"])
    assert (none.columns, none.components.shape) == (HIGH_RESOLUTION_COLUMNS, (0, 27))
    assert VectorBlock.from_results([]).columns == COLUMNS
    with pytest.raises(ValueError, match="not in tuple"):
        VectorBlock.from_results(RESULTS).vector("s_nu")


def test_column_names_with_high_resolution_position() -> None:
    assert ",".join(HIGH_RESOLUTION_COLUMNS) == ",".join(COLUMNS) + (
        ",s_alpha_x,s_alpha_y,s_alpha_z,s_nu_x,s_nu_y,s_nu_z,scrolling_x,scrolling_y,scrolling_z"
    )
