from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sculler.formats.comparison import Difference, compare, difference
from sculler.formats.vectors import VectorsWriter
from sculler_model.design import COLUMNS, HIGH_RESOLUTION_COLUMNS
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock

HUGE = 2**200


def write(path, rows):
    lines = [",".join(COLUMNS), *(",".join(map(str, row)) for row in rows)]
    path.write_text("\n".join(lines) + "\n")
    return path


def rows(count):
    return [[major, 1, *range(HUGE + major, HUGE + major + 18)] for major in range(count)]


@pytest.fixture
def pair(tmp_path):
    """Two files of the given rows."""
    return lambda a, b: (write(tmp_path / "a.csv", a), write(tmp_path / "b.csv", b))


def test_equal_files_have_no_difference(pair):
    assert compare(*pair(rows(5), rows(5))) is None
    assert compare(*pair([], [])) is None


@given(row=st.integers(0, 6), column=st.integers(0, 19), delta=st.sampled_from([-1, 1, HUGE]))
def test_the_first_difference_is_named(tmp_path_factory, row, column, delta):
    folder = tmp_path_factory.mktemp("pair")
    changed = rows(8)
    changed[row][column] += delta if column > 1 else delta % 1000  # `major` and `status` are words
    changed[row][19] -= 7  # later in the row, and in a later row: not the first
    changed[7][2] += 1
    a, b = write(folder / "a.csv", rows(8)), write(folder / "b.csv", changed)
    expected = Difference(row, row, COLUMNS[column], rows(8)[row][column], changed[row][column])
    assert compare(a, b) == expected
    assert str(expected.first) in expected.describe(a, b)


def test_a_difference_in_words():
    difference = Difference(3, 2, "nu_y", 10, -11)
    assert difference.describe("a.csv", "b.csv") == (
        "major 2 (row 3), nu_y: 10 in a.csv, -11 in b.csv"
    )


def test_a_file_that_ends_earlier(pair):
    a, b = pair(rows(3), rows(5))
    assert compare(a, b) == Difference(3, 3, "major", None, 3)
    assert compare(b, a) == Difference(3, 3, "major", 3, None)
    assert Difference(3, 3, "major", None, 3).describe("a.csv", "b.csv") == (
        "a.csv ends after 3 rows, b.csv goes on with major 3"
    )
    assert Difference(3, 3, "major", 3, None).describe("a.csv", "b.csv") == (
        "b.csv ends after 3 rows, a.csv goes on with major 3"
    )


def test_numbers_are_compared_not_their_spelling(pair):
    spelt = rows(2)
    spelt[1][5] = f"00{spelt[1][5]}"
    spelt[1][0] = "01"
    assert compare(*pair(rows(2), spelt)) is None


def test_a_bad_row_is_refused_even_if_both_files_have_it(pair):
    bad = rows(2)
    bad[1][4] = "1e5"
    with pytest.raises(InputError, match=r"line 3: alpha_z is '1e5', must be a whole number"):
        compare(*pair(bad, bad))
    with pytest.raises(InputError, match=r"b\.csv: line 3: alpha_z is '1e5'"):
        compare(*pair(rows(2), bad))
    with pytest.raises(InputError, match=r"a\.csv: line 3: alpha_z is '1e5'"):
        compare(*pair(bad, rows(1)))


def test_a_bad_file_is_refused(pair, tmp_path):
    a, _ = pair(rows(2), rows(2))
    with pytest.raises(InputError, match=r"no\.csv: cannot read"):
        compare(a, tmp_path / "no.csv")
    (tmp_path / "cut.csv").write_text(a.read_text()[:-1])
    with pytest.raises(InputError, match=r"cut\.csv: line 3: .* cut short"):
        compare(a, tmp_path / "cut.csv")
    (tmp_path / "other.csv").write_text("time,x\n1,2\n")
    with pytest.raises(InputError, match=r"other\.csv: line 1: the header"):
        compare(tmp_path / "other.csv", a)


def test_files_of_other_columns_are_refused(tmp_path):
    six, nine = tmp_path / "six.csv", tmp_path / "nine.csv"
    six.write_text(",".join(COLUMNS) + "\n")
    nine.write_text(",".join(HIGH_RESOLUTION_COLUMNS) + "\n" + ",".join(["0"] * 29) + "\n")
    assert compare(nine, nine) is None
    with pytest.raises(InputError, match=r"nine\.csv: 29 columns for 20 of .*six\.csv, give vect"):
        compare(six, nine)
    with pytest.raises(InputError, match=r"six\.csv: 20 columns for 29 of .*nine\.csv, give vect"):
        compare(nine, six)


def test_a_file_with_channels_and_one_without_are_refused(pair):
    """Whichever comes first, the one without is named, and the other as the one that has them."""
    a, b = pair(rows(2), rows(2))
    a.write_text(a.read_text().replace("\n", ",0\n").replace("_z,0\n", "_z,channel\n"))
    for files in ((a, b), (b, a)):
        with pytest.raises(
            InputError, match=r"b\.csv: no column channel, which .*a\.csv has, give"
        ):
            compare(*files)


def test_rows_count_on_through_blocks_of_unlike_lengths(tmp_path, monkeypatch):
    """Of seven rows and of five; the first difference stands in a later block of both, or ends."""
    pytest.importorskip("pyarrow")
    monkeypatch.setattr("sculler.formats.tables.npz.BLOCK_ROWS", 7)
    monkeypatch.setattr("sculler.formats.tables.parquet.BLOCK_ROWS", 5)

    def file(name, rows):
        with VectorsWriter(tmp_path / name, COLUMNS) as writer:
            writer.write(VectorBlock.from_rows(rows))
        return tmp_path / name

    one = file("a.npz", rows(24))
    assert compare(one, file("b.parquet", rows(24))) is None
    for row in (6, 7, 13, 20, 23):
        for step in (-1, 1):
            changed = rows(24)
            changed[row][5] += step
            found = compare(one, file("c.parquet", changed))
            assert found == Difference(row, row, COLUMNS[5], rows(24)[row][5], changed[row][5])
    for count in (5, 7, 20, 21, 22):
        short = file("d.parquet", rows(count))
        assert compare(one, short) == Difference(count, count, "major", count, None)
        assert compare(short, one) == Difference(count, count, "major", None, count)


def test_a_difference_is_one_whichever_is_greater():
    block = VectorBlock.from_rows(rows(6))
    block = replace(block, times=np.arange(6.0), channels=np.arange(6) % 2)
    for name, column in (
        *(("major", "major"), ("status", "status")),
        *(("channels", "channel"), ("times", "time_s")),
    ):
        changed = getattr(block, name).copy()
        changed[3] += 1
        other = replace(block, **{name: changed})
        low, high = getattr(block, name)[3], changed[3]
        for pair, values in (((block, other), (low, high)), ((other, block), (high, low))):
            major = int(pair[0].major[3])
            assert difference(*pair) == Difference(3, major, column, *values)
            assert difference(*pair, 5) == Difference(8, major, column, *values)
    bare = replace(block, times=None, channels=None)
    assert difference(block, bare) is difference(bare, block) is difference(block, block) is None


def test_where_a_block_ends_before_the_other():
    """But for a difference before that, and in rows counted from the first one's number."""
    block = VectorBlock.from_rows(rows(6))
    for first in (0, 5, 7):
        end = first + 3
        assert difference(block, block[:3], first) == Difference(end, 3, "major", 3, None)
        assert difference(block[:3], block, first) == Difference(end, 3, "major", None, 3)
    assert difference(block, block[:3]).row == 3
    changed = rows(6)
    changed[1][2] += 1
    found = difference(block[:3], VectorBlock.from_rows(changed))
    assert found == Difference(1, 1, COLUMNS[2], rows(6)[1][2], changed[1][2])


def test_wide_and_narrow_integers_are_the_same_numbers():
    """A single row, of limbs and of 64 bits: equal where they are, in either order."""
    narrow = [[0, 0, *range(-9, 9)]]
    words = VectorBlock.from_rows(narrow)
    limbs = VectorBlock.from_rows([[0, 0, *range(-9, 8), HUGE]])
    assert difference(limbs, words) == Difference(0, 0, COLUMNS[19], HUGE, 8)
    assert difference(words, limbs) == Difference(0, 0, COLUMNS[19], 8, HUGE)
    two = VectorBlock.from_rows([*narrow, [1, 0, *[HUGE] * 18]])
    assert difference(two[:1], words) is difference(words, two[:1]) is None


def test_a_difference_in_the_last_vector(tmp_path):
    paths = []
    for value in ("4", "5"):
        paths.append(tmp_path / f"{value}.csv")
        row = ",".join(["0"] * 28 + [value])
        paths[-1].write_text(",".join(HIGH_RESOLUTION_COLUMNS) + f"\n{row}\n")
    assert compare(*paths) == Difference(0, 0, "scrolling_z", 4, 5)


def with_times(path, times):
    """The file with a last column."""
    head, *lines = path.read_text().splitlines()
    stamped = [f"{line},{time}" for line, time in zip(lines, times, strict=True)]
    path.write_text("\n".join([f"{head},time_s", *stamped]) + "\n")


def test_times_are_compared_where_both_have_them(pair):
    a, b = pair(rows(3), rows(3))
    with_times(a, ["0.5", "1.0", "1.5"])
    assert compare(a, b) is compare(b, a) is None
    with_times(b, ["0.5", "1.0", "1.50"])  # the same number
    assert compare(a, b) is None
    a, b = pair(rows(3), rows(3))
    with_times(a, ["0.5", "1.0", "1.5"])
    with_times(b, ["0.5", "1.0000000000000002", "1.5"])
    assert compare(a, b) == Difference(1, 1, "time_s", 1.0, 1.0000000000000002)


def test_an_integer_goes_before_a_time(pair):
    changed = rows(3)
    changed[1][19] += 1
    a, b = pair(rows(3), changed)
    with_times(a, ["0.5", "1.0", "1.5"])
    with_times(b, ["0.5", "7.0", "1.5"])
    assert compare(a, b).column == COLUMNS[19]
    b.write_text(b.read_text().replace("0.5", "0,5"))
    with pytest.raises(InputError, match="line 2: 22 cells, must be 21"):
        compare(a, b)
