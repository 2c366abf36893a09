"""One seat recording written in every format, as other programs export it."""

import gzip

import asammdf
import h5py
import nptdms
import numpy as np
import pandas as pd
import pyuff

from ..text import parse, words

UNITS = parse("""
    {floor_acceleration: m/s^2, frame_acceleration: m/s^2, driver_acceleration: m/s^2,
     suspension_displacement: m, damper_force: N, current_command: A, coil_current: A}
""")


def csv(path, table):
    pd.DataFrame(table).to_csv(path, index=False)


def csv_gz(path, table):
    text = pd.DataFrame(table).to_csv(index=False)
    path.write_bytes(gzip.compress(text.encode()))


def german_csv(path, table):
    """A title, names and a row of units, semicolons, decimal commas, another encoding."""
    names = parse("""
        [Zeit, Beschl. Boden, Beschl. Sitzrahmen, Beschl. Fahrer, Federweg, Dämpferkraft, Strom Soll, Strom Ist]
    """)
    units = ["ms", "m/s²", "g", "m/s²", "mm", "kN", "mA", "A"]
    factors = [1e3, 1, 1 / 9.80665, 1, 1e3, 1e-3, 1e3, 1]
    rows = np.column_stack([factor * values for factor, values in zip(factors, table.values(), strict=True)])
    lines = ["Prüfstand 7; Lauf 3", ";".join(names), ";".join(units)]
    lines += [";".join(f"{value:.12g}".replace(".", ",") for value in row) for row in rows]
    path.write_bytes("\r\n".join([*lines, ""]).encode("cp1252"))


def parquet(path, table):
    pd.DataFrame(table).to_parquet(path)


def feather(path, table):
    pd.DataFrame(table).to_feather(path)


def xlsx(path, table):
    frame = pd.DataFrame(table)
    frame.columns = [f"{name} [{UNITS.get(name, 's')}]" for name in frame]
    frame.to_excel(path, index=False)


def hdf5(path, table):
    with h5py.File(path, "w") as file:
        group = file.create_group("daq")
        group.attrs["sample_rate"] = 500.0
        for name, values in table.items():
            if name != "time":
                group[name] = values
                group[name].attrs["unit"] = UNITS[name]


def mat5(path, table):
    from scipy.io import savemat

    savemat(path, dict(table))


def mat73(path, table):
    """What MATLAB writes: a block of 512 bytes before an HDF5 file."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in table.items():
            file[name] = values[None, :]
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
    content = bytearray(path.read_bytes())
    content[:116] = b"MATLAB 7.3 MAT-file, Platform: PCWIN64".ljust(116)
    path.write_bytes(content)


def lvm(path, table):
    """What LabVIEW writes: keys with a cell for each channel, and remarks in a last column without cells."""
    names = [name for name in table if name != "time"]
    cells = {"Samples": len(table["time"]), "Date": "2026/03/01", "Time": "09:51:40.5", "X_Dimension": "Time"}
    lines = ["LabVIEW Measurement", "Separator\tTab", "Decimal_Separator\t,", "X_Columns\tOne", "***End_of_Header***"]
    lines += ["\t", *("\t".join([key, *[str(cell)] * len(names), ""]) for key, cell in cells.items())]
    lines += ["\t".join(["Y_Unit_Label", *(UNITS[name] for name in names), ""]), "***End_of_Header***\t\t"]
    lines += ["\t".join(["X_Value", *names, "Comment"])]
    rows = np.column_stack(list(table.values()))
    lines += ["\t".join(f"{cell:.15g}".replace(".", ",") for cell in row) for row in rows]
    path.write_text("\n".join([*lines, ""]))


def mdf(path, table):
    signals = [asammdf.Signal(table[name], table["time"], name=name, unit=unit) for name, unit in UNITS.items()]
    with asammdf.MDF(version="4.10") as file:
        file.append(signals, common_timebase=True)
        file.save(path, overwrite=True)


def tdms(path, table):
    with nptdms.TdmsWriter(path) as writer:
        stated = {name: {"unit_string": unit, "wf_increment": 0.002} for name, unit in UNITS.items()}
        writer.write_segment([nptdms.ChannelObject("daq", name, table[name], each) for name, each in stated.items()])


def uff(path, table):
    file = pyuff.UFF(str(path))
    for name, values in table.items():
        if name != "time":
            data = pyuff.prepare_58(
                id1=name, func_type=1, rsp_node=1, rsp_dir=3, ref_node=1, ref_dir=3, x=table["time"], data=values,
                binary=1, abscissa_spacing=1, num_pts=len(values), abscissa_inc=0.002, abscissa_min=0.0,
                ordinate_axis_units_lab=UNITS[name], ordinate_spec_data_type=12, abscissa_spec_data_type=17,
                orddenom_spec_data_type=0, z_axis_axis_units_lab="NONE", ver_num=0, load_case_id=0, rsp_ent_name="NONE",
                ref_ent_name="NONE", z_axis_spec_data_type=0, **dict.fromkeys(("id2", "id3", "id4", "id5"), "NONE"),
            )  # fmt: skip
            file.write_sets(data, "add")


def rpc(path, table):
    channels = {name: values for name, values in table.items() if name != "time"}
    points, frame = len(table["time"]), 1024
    frames = -(-points // frame)
    stated = f"""
        FORMAT=BINARY_IEEE_LITTLE_END NUM_HEADER_BLOCKS= NUM_PARAMS= FILE_TYPE=TIME_HISTORY DATA_TYPE=FLOATING_POINT
        DELTA_T=2.0000000E-03 CHANNELS={len(channels)} PTS_PER_FRAME={frame} PTS_PER_GROUP={2 * frame} FRAMES={frames}
    """
    header = dict(entry.split("=") for entry in words(stated))
    for number, name in enumerate(channels, 1):
        header |= {f"DESC.CHAN_{number}": name, f"UNITS.CHAN_{number}": UNITS[name], f"SCALE.CHAN_{number}": "1.0"}
    header["NUM_PARAMS"] = str(len(header))
    blocks = -(-len(header) // 4)
    header["NUM_HEADER_BLOCKS"] = str(blocks)
    records = b"".join(key.encode().ljust(32, b"\0") + value.encode().ljust(96, b"\0") for key, value in header.items())
    groups = -(-frames // 2)
    padded = np.zeros((len(channels), groups * 2 * frame), dtype="<f4")
    padded[:, :points] = np.array(list(channels.values()))
    body = padded.reshape(len(channels), groups, 2 * frame).transpose(1, 0, 2).tobytes()
    path.write_bytes(records.ljust(blocks * 512, b"\0") + body)


FORMATS = {
    "a.csv": csv, "a.csv.gz": csv_gz, "german.csv": german_csv, "a.parquet": parquet, "a.feather": feather,
    "a.xlsx": xlsx, "a.h5": hdf5, "a.mat": mat5, "v73.mat": mat73,
    "a.lvm": lvm, "a.mf4": mdf, "a.tdms": tdms,
    "a.uff": uff, "a.rsp": rpc,
}  # fmt: skip
"""Name of a file, and what writes it."""
