"""YAML files with the place of every key."""

import pytest

from seatsim.schema.errors import InputError
from seatsim.schema.yaml_source import Source

TEXT = """\
plant: &rig
  mass: 20.0
  ends: [1, 2]
other:
  <<: *rig
  mass: 1e-3
"""


@pytest.fixture
def source(tmp_path):
    path = tmp_path / "file.yaml"
    path.write_text(TEXT)
    return Source(path)


def test_content_is_plain(source):
    assert source.data == {"plant": {"mass": 20.0, "ends": [1, 2]}, "other": {"mass": 1e-3, "ends": [1, 2]}}
    assert type(source.data) is dict and type(source.data["plant"]["ends"]) is list


def test_a_place_is_that_of_the_key_or_of_the_nearest_above_it(source):
    assert source.place(("plant", "mass")) == f"{source.path}, line 2, plant.mass"
    assert source.place(("plant", "ends", 1)) == f"{source.path}, line 3, plant.ends.1"
    assert source.place(("plant", "absent")) == f"{source.path}, line 1, plant.absent"
    assert source.place(("other", "ends")) == f"{source.path}, line 5, other.ends"
    assert source.place(()) == f"{source.path}, line 1"
    assert str(source.error(("other", "mass"), "wrong")) == f"{source.path}, line 6, other.mass: wrong"


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("a: 1\na: 2\n", "line 2: .*write each key once"),
        ("a: [1\n", "line 2: "),
        ("- 1\n", "holds no mapping"),
        ("", "holds no mapping"),
        (b"\xff\xfe", "not UTF-8 text"),
    ],
)
def test_what_is_no_yaml_mapping_is_refused(tmp_path, text, problem):
    path = tmp_path / "file.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError, match=problem):
        Source(path)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(InputError, match="cannot be read: No such file"):
        Source(tmp_path / "absent.yaml")
