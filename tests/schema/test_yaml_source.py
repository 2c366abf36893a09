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


def test_a_place_is_that_of_the_key_or_of_the_nearest_above_it(tmp_path):
    path = tmp_path / "file.yaml"
    path.write_text(TEXT)
    source = Source(path)
    assert source.data == {"plant": {"mass": 20.0, "ends": [1, 2]}, "other": {"mass": 1e-3, "ends": [1, 2]}}
    assert source.place(("plant", "ends", 1)) == f"{path}, line 3, plant.ends.1"
    assert source.place(("plant", "absent")) == f"{path}, line 1, plant.absent"
    assert source.place(("other", "ends")) == f"{path}, line 5, other.ends"
    assert source.place(()) == f"{path}, line 1"
    assert str(source.error(("other", "mass"), "wrong")) == f"{path}, line 6, other.mass: wrong"


def test_what_is_no_text_is_refused(tmp_path):
    path = tmp_path / "file.yaml"
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(InputError, match="not UTF-8 text"):
        Source(path)
