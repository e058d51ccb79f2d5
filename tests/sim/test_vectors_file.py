import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from position_designs import HIGH_RESOLUTION
from sculler.formats.vectors import VectorsWriter, read_vectors
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock, run_fast
from sculler_model.golden import GoldenModel
from strategies import DESIGNS, random_counts

# the header as docs/reference/vectors.md has it
HEADER = (
    "major,status,alpha_x,alpha_y,alpha_z,coning_within_x,coning_within_y,coning_within_z,"
    "coning_between_x,coning_between_y,coning_between_z,nu_x,nu_y,nu_z,"
    "sculling_within_x,sculling_within_y,sculling_within_z,"
    "sculling_between_x,sculling_between_y,sculling_between_z"
)


def block(rows):
    """Rows of 18 components, majors from 0, as a block."""
    return VectorBlock(
        np.arange(len(rows)),
        np.arange(len(rows)) % 4,
        np.array(rows, object).reshape(len(rows), 18),
    )


def write(path, *blocks):
    with VectorsWriter(path) as writer:
        for each in blocks:
            writer.write(each)
    return path


def test_the_text_is_exactly_that_of_the_format(tmp_path):
    path = write(tmp_path / "v.csv", block([range(-2, 16)]), block([]))
    assert path.read_bytes().decode() == (
        HEADER + "\n0,0,-2,-1,0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15\n"
    )


@given(
    rows=st.lists(
        st.lists(st.integers(-(2**700), 2**700) | st.integers(-3, 3), min_size=18, max_size=18),
        max_size=8,
    ),
    cut=st.integers(0, 8),
    chunk=st.integers(1, 9),
)
def test_integers_of_any_size_come_back(tmp_path_factory, rows, cut, chunk):
    path = tmp_path_factory.mktemp("round") / "v.csv"
    whole = block(rows)
    parts = [
        VectorBlock(whole.major[part], whole.status[part], whole.components[part])
        for part in (slice(cut), slice(cut, None))
    ]
    write(path, *parts)
    blocks = list(read_vectors(path, chunk=chunk))
    assert all(len(each) <= chunk for each in blocks)
    assert [row for each in blocks for row in each.rows()] == list(whole.rows())


@pytest.mark.parametrize("name", ["stim300_4x5", "wide_5p0"])
def test_with_the_design_the_components_have_its_type(tmp_path, name):
    design = DESIGNS[name]
    counts = random_counts(design, 10 * design.samples_per_major, np.random.default_rng(3))
    samples = [(tuple(row[:3]), tuple(row[3:]), 0) for row in counts.tolist()]
    results = list(GoldenModel(design).run(samples))
    path = write(tmp_path / "v.csv", VectorBlock.from_results(results))
    (back,) = read_vectors(path, design)
    assert isinstance(back.components, np.ndarray) == (name == "stim300_4x5")
    assert list(back.rows()) == [result.row() for result in results]


def test_major_begins_again_after_a_reset(tmp_path):
    both = [block([[0] * 18] * 2), block([[1] * 18] * 3)]
    path = write(tmp_path / "v.csv", *both)
    assert VectorBlock.concatenate(list(read_vectors(path))).major.tolist() == [0, 1, 0, 1, 2]


def write_half(path):
    with VectorsWriter(path) as writer:
        writer.write(block([[0] * 18]))
        raise ZeroDivisionError


def test_an_error_while_writing_leaves_nothing(tmp_path):
    with pytest.raises(ZeroDivisionError):
        write_half(tmp_path / "v.csv")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there_is_named(tmp_path):
    with pytest.raises(InputError, match=f"cannot write to folder {tmp_path}/no"):
        write(tmp_path / "no" / "v.csv")


def row(major=0, status=0, first="5"):
    return ",".join([str(major), str(status), first, *["0"] * 17])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"line 1: the header is ''"),
        ("major,status\n", r"line 1: the header is 'major,status\\n'"),
        (HEADER, r"line 1: the header is 'major"),
        (HEADER.replace("nu_x", "nu_X") + "\n", "line 1: the header"),
        (f"{HEADER}\n{row()}\n{row(1)}", "line 3: the last line has no end, the file is cut short"),
        (f"{HEADER}\n{row()}\n{row(1)[:-4]}\n", "line 3: 18 cells, must be 20; is the file cut"),
        (f"{HEADER}\n{row()},0\n", "line 2: 21 cells, must be 20"),
        (f"{HEADER}\n\n", "line 2: major is '', must be a whole number"),
        (f"{HEADER}\n{row(first='1.5')}\n", "line 2: alpha_x is '1.5', must be a whole number"),
        (f"{HEADER}\n{row(first='nan')}\n", "line 2: alpha_x is 'nan', must be"),
        (f"{HEADER}\n{row(first='')}\n", "line 2: alpha_x is '', must be"),
        (f"{HEADER}\n{row(first='1_0')}\n", "line 2: alpha_x is '1_0', must be"),
        (f"{HEADER}\n{row(first=' 1')}\n", "line 2: alpha_x is ' 1', must be"),
        (f"{HEADER}\n{row(first='+1')}\n", r"line 2: alpha_x is '\+1', must be"),
        (f"{HEADER}\n{row(1)}\n", "line 2: major is 1 where 0 should follow"),
        (f"{HEADER}\n{row()}\n{row(2)}\n", "line 3: major is 2 where 1 should follow"),
        (f"{HEADER}\n{row()}\n{row(-1)}\n", "line 3: major is -1 where 1 should follow"),
        (f"{HEADER}\n{row(status=16)}\n", "line 2: status is 16, must be 0 to 15"),
        (f"{HEADER}\n{row(first='٣')}\n", "not a text file"),
        ("\x00\x01\x02\n", "line 1: the header"),
    ],
)
def test_a_bad_file_is_refused_with_its_line(tmp_path, text, message):
    path = tmp_path / "v.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=f"^{path}: {message}") as caught:
        list(read_vectors(path, chunk=1))
    assert "\n" not in str(caught.value)


def test_a_file_from_another_system_is_read(tmp_path):
    path = tmp_path / "v.csv"
    path.write_bytes(f"{HEADER}\r\n{row()}\r\n".encode())
    assert [len(each) for each in read_vectors(path)] == [1]


def test_an_absent_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"no\.csv: cannot read the vectors file \(No such file"):
        list(read_vectors(tmp_path / "no.csv"))


def test_a_component_wider_than_the_designs_is_refused(tmp_path):
    design = DESIGNS["smallest"]  # 8-bit gyro, a result at every sample: alpha_x is 8 bits
    path = tmp_path / "v.csv"
    path.write_text(f"{HEADER}\n{row(first='-128')}\n{row(1, first='127')}\n")
    assert [len(each) for each in read_vectors(path, design)] == [2]
    for value in ("128", "-129", "1" * 60):
        path.write_text(f"{HEADER}\n{row()}\n{row(1, first=value)}\n")
        with pytest.raises(InputError, match=r"line 3: alpha_x is .* smallest can give \(8 bits\)"):
            list(read_vectors(path, design))


def test_vectors_with_high_resolution_position(tmp_path):
    """Their header is longer; with a design the columns must be its own."""
    design = HIGH_RESOLUTION["stim300_hr"]
    counts = random_counts(design, 3 * design.samples_per_major, np.random.default_rng(1))
    block = run_fast(design, counts)
    path = tmp_path / "v.csv"
    with VectorsWriter(path, design.columns) as writer:
        writer.write(block)
    lines = path.read_text().splitlines()
    assert lines[0] == HEADER + ",s_alpha_x,s_alpha_y,s_alpha_z,s_nu_x,s_nu_y,s_nu_z" + (
        ",scrolling_x,scrolling_y,scrolling_z"
    )
    assert [tuple(map(int, line.split(","))) for line in lines[1:]] == [*block.rows()]
    for known in (None, design):
        (again,) = read_vectors(path, known)
        assert [*again.rows()] == [*block.rows()]
    with pytest.raises(InputError, match=r"line 1: 29 columns, but design .* gives 20; is this"):
        next(read_vectors(path, DESIGNS["stim300_4x5"]))
    wide = lines[-1].split(",")
    wide[-1] = str(design.words.scrolling.hi + 1)
    path.write_text("\n".join([*lines[:-1], ",".join(wide)]) + "\n")
    with pytest.raises(InputError, match=r"line 4: scrolling_z is .* \(71 bits\)"):
        next(read_vectors(path, design))


def test_a_block_of_other_columns_is_not_written(tmp_path):
    design = HIGH_RESOLUTION["smallest_hr"]
    block = run_fast(design, np.zeros((3, 6), np.int64))
    with pytest.raises(ValueError, match="29 columns for 20"), VectorsWriter(tmp_path / "v") as out:
        out.write(block)
    assert not [*tmp_path.iterdir()]


def stamped(count, first=0.0):
    """Rows of zeros that end at instants a third of a second apart."""
    times = first + np.arange(count) / 3
    return VectorBlock(np.arange(count), np.zeros(count, int), np.zeros((count, 18), int), times)


def test_times_are_the_last_column_and_come_back_exactly(tmp_path):
    path = tmp_path / "v.csv"
    blocks = [stamped(2, 1e9), stamped(0), stamped(3, 1e-7)]
    with VectorsWriter(path, times=True) as writer:
        for each in blocks:
            writer.write(each)
    text = path.read_text().splitlines()
    assert text[0] == HEADER + ",time_s"
    assert text[2].endswith(",0,1000000000.3333334")
    (back,) = read_vectors(path)
    assert back.times.tobytes() == VectorBlock.concatenate(blocks).times.tobytes()
    assert [*back.rows()] == [*VectorBlock.concatenate(blocks).rows()]


def test_times_go_with_the_file_not_with_the_block(tmp_path):
    for times, bad in ((True, block([[0] * 18])), (False, stamped(1))):
        with (
            pytest.raises(ValueError, match="exactly where the file has them"),
            VectorsWriter(tmp_path / "v.csv", times=times) as writer,
        ):
            writer.write(bad)
    with pytest.raises(ValueError, match="with and without times"):
        VectorBlock.concatenate([stamped(1), block([[0] * 18])])


@pytest.mark.parametrize(
    ("cell", "message"),
    [
        ("x", "time_s is 'x', must be decimal seconds"),
        ("nan", "time_s is 'nan', must be"),
        ("1e999", "time_s is '1e999', must be"),
        ("", "time_s is '', must be"),
        ("1,2", "22 cells, must be 21"),
    ],
)
def test_a_bad_time_is_refused(tmp_path, cell, message):
    path = tmp_path / "v.csv"
    path.write_text(f"{HEADER},time_s\n{row()},0.5\n{row(1)},{cell}\n")
    with pytest.raises(InputError, match=f"line 3: {message}"):
        list(read_vectors(path))
