import pytest

from sculler_model.errors import InputError
from sculler_model.outputs import make_folder, replacing


def test_the_file_appears_when_the_body_ends_well(tmp_path):
    target = tmp_path / "out.csv"
    with replacing(target) as temporary:
        temporary.write_text("all of it")
        assert temporary.parent == tmp_path
        assert temporary.suffix == ".csv"
        assert not target.exists()
    assert target.read_text() == "all of it"
    assert list(tmp_path.iterdir()) == [target]


def half_way(path):
    path.write_text("half")
    raise ZeroDivisionError


def test_an_error_leaves_what_was_there_and_nothing_else(tmp_path):
    target = tmp_path / "out.csv"
    target.write_text("old")
    with pytest.raises(ZeroDivisionError), replacing(target) as temporary:
        half_way(temporary)
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_a_temporary_file_the_body_removed_is_an_error_not_a_success(tmp_path):
    with pytest.raises(FileNotFoundError), replacing(tmp_path / "out") as temporary:
        temporary.unlink()
    assert list(tmp_path.iterdir()) == []


def test_a_symbolic_link_stays_one(tmp_path):
    (tmp_path / "there").mkdir()
    link = tmp_path / "link.txt"
    link.symlink_to(tmp_path / "there" / "file.txt")
    with replacing(link) as temporary:
        temporary.write_text("x")
    assert link.is_symlink()
    assert (tmp_path / "there" / "file.txt").read_text() == "x"


def test_a_device_is_written_directly():
    with replacing("/dev/null") as path:
        assert str(path) == "/dev/null"
        path.write_text("gone")


def test_permissions_are_those_of_any_new_file(tmp_path):
    with replacing(tmp_path / "out") as temporary:
        temporary.write_text("x")
    (tmp_path / "plain").write_text("x")
    modes = {(tmp_path / name).stat().st_mode for name in ("out", "plain")}
    assert len(modes) == 1


@pytest.mark.parametrize("folder", ["absent", "file"])
def test_a_folder_that_cannot_be_written_to_is_named(tmp_path, folder):
    (tmp_path / "file").write_text("not a folder")
    where = tmp_path / folder
    with pytest.raises(InputError, match=f"cannot write to folder {where}"), replacing(where / "x"):
        pytest.fail("the body ran")


def test_a_folder_in_place_of_a_file_is_refused(tmp_path):
    with pytest.raises(InputError, match="is a folder"), replacing(tmp_path):
        pytest.fail("the body ran")


def test_make_folder(tmp_path):
    deep = tmp_path / "a" / "b"
    assert make_folder(deep) == deep
    assert make_folder(deep).is_dir()
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot make the folder"):
        make_folder(tmp_path / "file" / "x")
