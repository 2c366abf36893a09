"""Archives of units that are none, or lead elsewhere: one clear error, and nothing is written or run."""

import stat
import zipfile

import pytest

from seatsim.cosimulation.description import (
    check_parameter,
    describe_unit,
    find_conversion_of,
    find_library,
    find_variable,
    open_archive,
    unpack,
)
from seatsim.schema.errors import InputError

DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="d" guid="{1}">
<CoSimulation modelIdentifier="d"/>
<ModelVariables>
<ScalarVariable name="v" valueReference="0" causality="input"><Real start="0" unit="mm/s"/></ScalarVariable>
<ScalarVariable name="F" valueReference="1" causality="output"><Real unit="m"/></ScalarVariable>
<ScalarVariable name="n" valueReference="2" causality="output" variability="discrete"><Integer/></ScalarVariable>
<ScalarVariable name="c" valueReference="3" causality="parameter" variability="tunable"><Real start="1" max="5"/></ScalarVariable>
</ModelVariables>
<ModelStructure><Outputs><Unknown index="2"/></Outputs></ModelStructure>
</fmiModelDescription>
"""  # noqa: E501  # a variable on a line


@pytest.fixture
def pack(tmp_path):
    """Make an archive of names and texts; a description is added where it is asked for."""

    def make(files, description=DESCRIPTION):
        path = tmp_path / "unit.fmu"
        with zipfile.ZipFile(path, "w") as archive:
            if description:
                archive.writestr("modelDescription.xml", description)
            for name, text in files.items():
                archive.writestr(name, text)
        return path

    return make


HERE = {"binaries/linux64/d.so": "no library"}


@pytest.mark.parametrize(
    "name", ["../outside.txt", "resources/../../outside.txt", "/etc/outside", "c:\\outside", "a\\b"]
)
def test_a_path_out_of_the_folder_is_refused(pack, name, tmp_path):
    path = pack({name: "x", **HERE})
    with pytest.raises(InputError, match="outside the unit's folder"), unpack(path, 2, "d"):
        pass
    assert [p.name for p in tmp_path.iterdir()] == ["unit.fmu"]


def test_an_interrupted_run_leaves_no_folder(pack, tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with pytest.raises(KeyboardInterrupt), unpack(pack(HERE), 2, "d") as (_, library):
        assert library.read_text() == "no library"
        raise KeyboardInterrupt
    assert [p.name for p in tmp_path.iterdir()] == ["unit.fmu"]


def test_a_link_is_refused(pack):
    link = zipfile.ZipInfo("resources/link")
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    with pytest.raises(InputError, match="is a link"), open_archive(pack({link: "/etc/passwd"})):
        pass


@pytest.mark.parametrize("damage", [lambda _: b"hello", *(lambda c, k=k: c[k:] for k in (1, 30, -30))])
def test_a_damaged_archive_and_what_is_none_is_refused(pack, damage):
    path = pack(HERE)
    path.write_bytes(damage(path.read_bytes()))
    with pytest.raises(InputError, match="is no archive"):
        describe_unit(path)


def test_a_library_for_another_platform_is_named(pack):
    with pytest.raises(InputError, match="for this machine; it has libraries for win64"):
        describe_unit(pack({"binaries/win64/d.dll": "x"}))
    with open_archive(pack({})) as archive, pytest.raises(InputError, match="no library at all"):
        find_library("unit.fmu", archive, 3, "d")


@pytest.mark.parametrize(
    "old, new, said",
    [
        ("<fmiModel", "<!DOCTYPE a [<!ENTITY b 'c'>]><fmiModel", "declares a document type"),
        ("</ModelVariables>", "", "cannot be read"),
        (DESCRIPTION, "", r"has no modelDescription\.xml"),
        ('fmiVersion="2.0"', 'fmiVersion="1.0"', "FMI 1.0"),
        ("CoSimulation", "Simulation", "is not for co-simulation"),
    ],
)
def test_a_description_that_cannot_be_used_is_refused(pack, old, new, said):
    with pytest.raises(InputError, match=said):
        describe_unit(pack(HERE, DESCRIPTION.replace(old, new)))


def test_variables_are_what_they_are_taken_for(pack):
    unit = describe_unit(pack(HERE))
    assert find_conversion_of(find_variable(unit, "v", "input"), "velocity").factor == 1e-3
    for name, causality, said in (
        ("w", "input", "no variable 'w'"),
        ("v", "output", "declared as input"),
        ("n", "output", "declared as Integer"),
    ):
        with pytest.raises(InputError, match=said):
            find_variable(unit, name, causality)
    with pytest.raises(InputError, match="cannot be the force"):
        find_conversion_of(find_variable(unit, "F", "output"), "force")
    assert check_parameter(unit, "c", 2) == 2
    for value, said in ((9.0, "at most 5"), ("x", "is a number"), (True, "is a number")):
        with pytest.raises(InputError, match=said):
            check_parameter(unit, "c", value)
