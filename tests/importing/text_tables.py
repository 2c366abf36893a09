"""Text tables as loggers, spreadsheets, R, MATLAB, NumPy and LabVIEW write them, with what they say."""

import datetime
import json

import numpy as np

ROWS, RATE = 600, 250
T = np.arange(ROWS) / RATE
X, Y, Z = np.random.default_rng(1).normal(size=(3, ROWS)).round(4)
FORCE = (3000.0 * np.sin(7.0 * T)).round()
TRAVEL = (40.0 * np.cos(7.0 * T)).round(3)
XYZ = {"x": ("", X), "y": ("", Y), "z": ("", Z)}
ACC = {"acc_x": ("", X), "acc_z": ("", Z)}
START = datetime.datetime(2020, 1, 24, 16, 53, 12)
MIDNIGHT = datetime.datetime(2020, 1, 31, 23, 59, 59)


def table(*columns, head=(), sep=",", dec=".", end="\n", tail=()):
    """Return a text table of columns of numbers, or of texts as they stand."""
    texts = [[cell if isinstance(cell, str) else f"{cell:.4f}".replace(".", dec) for cell in each] for each in columns]
    return end.join([*head, *(sep.join(row) for row in zip(*texts, strict=True)), *tail, ""])


def texts(values, pattern):
    return [pattern.format(value) for value in values]


def stamps(pattern, start=START):
    """Return times with three digits of a second behind `pattern`, which may name what follows them, too."""
    each = [start + datetime.timedelta(seconds=float(t)) for t in T]
    return [(moment.strftime(pattern)).replace("MS", f"{moment.microsecond // 1000:03d}") for moment in each]


def german(values):
    return [f"{value:,.0f}".replace(",", ".") for value in values]


COUNT = texts(range(1, ROWS + 1), "{:d}")
PLAIN = table(T, X, Z, head=["t,acc_x,acc_z"])
MIDDLE = f"{T[300]:.4f},"
PAIRS = "".join(
    f"{T[k]:.4f};{Z[k]:.4f};" + (f"{2 * T[k]:.4f};{TRAVEL[k]:.4f}\n" if k < 300 else ";\n") for k in range(ROWS)
)
READ = {
    # Names and columns that differ in number
    "savetxt": (table(X, Y, Z, head=["# x y z"], sep=" "), XYZ, None),
    "savetxt, comma between numbers": (table(X, Y, Z, head=["# x y z"]), XYZ, None),
    "savetxt, comma between names": (table(X, Y, Z, head=["# x,y,z"], sep=" "), XYZ, None),
    "savetxt, comma and blank": (table(T, X, Y, Z, head=["# t, x, y, z"], sep=", "), XYZ, RATE),
    "MATLAB": (table(T, X, Y, Z, head=["%t\tx\ty\tz"], sep="\t"), XYZ, RATE),
    "label before names": (table(T, X, Y, Z, head=["# Columns: t, x, y, z"], sep=" "), XYZ, RATE),
    "label among names": (table(T, X, Y, Z, head=[";Gain, low", ";Headers, t,x,y,z"]), XYZ, RATE),
    "title and names in remarks": (table(T, X, Y, Z, head=["# by logger 7", "# t x y z"], sep=" "), XYZ, RATE),
    "R write.csv": (table(texts(COUNT, '"{}"'), X, Y, Z, head=['"","x","y","z"']), XYZ, None),
    "pandas counts columns": (table(COUNT, X, Z, head=[",0,1"]), {"0": ("", X), "1": ("", Z)}, None),
    "numbers as names": (table(T, X, Z, head=["time,1,2"]), {"1": ("", X), "2": ("", Z)}, RATE),
    "comma in quotation marks": (
        table(T, Z, head=['Time [s],"Acceleration, driver [m/s^2]"']), {"Acceleration, driver": ("m/s^2", Z)}, RATE,
    ),
    "key and value below the names": (table(T, Z, head=["Time,acc_z", "Rate,999"]), {"acc_z": ("", Z)}, RATE),
    "a key and a text below the names": (table(T, X, Z, head=["t,acc_x,acc_z", "Operator,Miller"]), ACC, RATE),
    "delimiter behind each row": (table(T, X, texts(Z, "{:.4f};"), head=["t;acc_x;acc_z"], sep=";"), ACC, RATE),
    "delimiter behind the names": (table(T, X, Z, head=["t;acc_x;acc_z;"], sep=";"), ACC, RATE),
    "empty first column": (table([""] * ROWS, X, Z, head=["Marke\tacc_x\tacc_z"], sep="\t"), ACC, None),
    "empty first column of few rows": (
        table([""] * 6, X[:6], Z[:6], head=["Marke [-]\tx [g]\tz [g]"], sep="\t"),
        {"x": ("g", X[:6]), "z": ("g", Z[:6])}, None,
    ),
    "few rows below long titles": (
        table(X[:4], Z[:4], head=["a long title, of words", "", "acc_x;acc_z"], sep=";", dec=","),
        {"acc_x": ("", X[:4]), "acc_z": ("", Z[:4])}, None,
    ),
    "names over two lines": (
        table(T, X, Z, head=['"Time\n[s]","acc_x\n[g]","acc_z\n[g]"']), {"acc_x": ("g", X), "acc_z": ("g", Z)}, RATE,
    ),
    "units, factors, serial numbers": (
        table(T, X, Z, head=["t;acc_x;acc_z", "s;g;g", "Factor;1.0;2.5", "Sensor;PCB 356;PCB 357"], sep=";"),
        {"acc_x": ("g", X), "acc_z": ("g", Z)}, RATE,
    ),
    "catman": (
        table(T, Z, FORCE, head=["HBM_CATMAN\t5.0", "Zeit  1\tSitz z\tKraft", "s\tm/s²\tN"], sep="\t", dec=","),
        {"Sitz z": ("m/s²", Z), "Kraft": ("N", FORCE)}, RATE,
    ),
    "oscilloscope": (
        table(T, X, Z, head=["Model,MSO", "Record Length,1000", "Vertical Units,V,V", "", "TIME,CH1,CH2"]),
        {"CH1": ("V", X), "CH2": ("V", Z)}, RATE,
    ),
    "names with units, parted by blanks": (
        table(T, Z, TRAVEL, head=["Time [s]  Seat acc z [m/s2]  Travel [mm]"], sep="  "),
        {"Seat acc z": ("m/s2", Z), "Travel": ("mm", TRAVEL)}, RATE,
    ),
    "a mark in quotation marks": (table(X, Y, Z, head=['"# x","y","z"']), XYZ, None),
    "units before names": (
        table(T, X, Z, head=["s,g,-", "t,acc_x,acc_z"]), {"acc_x": ("g", X), "acc_z": ("", Z)}, RATE,
    ),
    "two columns of one name": (table(T, X, Z, head=["t,acc,acc"]), {"acc": ("", X), "acc#2": ("", Z)}, RATE),
    "numbers among titles": (
        table(T, X, Z, head=["Channels\t3\t3", "Samples\t40\t40", "***End***", "X_Value\tacc_x\tacc_z"], sep="\t"),
        ACC, RATE,
    ),
    "LabVIEW": (table(T, X, Z, head=["X_Value\tacc_x\tacc_z\tComment"], sep="\t"), ACC, RATE),
    # Ways to write
    "Excel's sep=": (table(T, X, Z, head=["sep=;", "t;acc_x;acc_z"], sep=";", dec=","), ACC, RATE),
    "byte order mark": ("\ufeff" + PLAIN, ACC, RATE),
    "UTF-16": (PLAIN.encode("utf-16"), ACC, RATE),
    "UTF-16 without a mark": (PLAIN.encode("utf-16-le"), ACC, RATE),
    "old Mac": (PLAIN.replace("\n", "\r"), ACC, RATE),
    "empty lines between": (PLAIN.replace("\n", "\r\r\n"), ACC, RATE),
    "padded": (table(texts(T, "{:9.3f}"), texts(X, "{:9.4f}"), texts(Z, "{:9.4f}"), head=["  t  acc_x  acc_z"],
                     sep=" "), ACC, RATE),
    "Fortran": (table(*(texts(each, " {:.8e}") for each in (T, X, Z)), head=["t acc_x acc_z"], sep="  ")
                .replace("e-", "D-").replace("e+", "D+"), ACC, RATE),
    "bars": (table(texts(T, "|{:.4f}"), X, texts(Z, "{:.4f}|"), head=["|t|acc_x|acc_z|", "|---|---|---|"], sep="|"),
             ACC, RATE),
    "all in quotation marks": (table(*(texts(each, '"{:.4f}"') for each in (T, X, Z)), head=['"t","acc_x","acc_z"'])
                               .replace(".", ","), ACC, RATE),
    "one column with a decimal comma": (table(Z, head=["acc_z"], dec=","), {"acc_z": ("", Z)}, None),
    "two decimal signs": (table(T, [cell.replace(".", ",") for cell in texts(Z, "{:.4f}")], head=["t;acc_z"], sep=";"),
                          {"acc_z": ("", Z)}, RATE),
    "a minus of typesetting": (PLAIN.replace("-", "\u2212"), ACC, RATE),
    "a dash for a minus": (PLAIN.replace("-", "\u2013").encode("cp1252"), ACC, RATE),
    "German thousands": (table(T, german(FORCE), head=["t;F [N]"], sep=";", dec=","), {"F": ("N", FORCE)}, RATE),
    "German thousands and decimals": (
        table(T[:30], [f"1.2{k:02d},5" for k in range(30)], head=["t;F"], sep=";", dec=","),
        {"F": ("", 1200.5 + np.arange(30))}, RATE,
    ),
    "Swiss thousands": (table(T, texts(FORCE, "{:,.1f}"), head=["t;F [N]"], sep=";").replace(",", "'"),
                        {"F": ("N", FORCE)}, RATE),
    "thousands with narrow blanks": (table(T, texts(FORCE, "{:,.0f}"), head=["t;F [N]"], sep=";")
                                     .replace(",", "\u202f"), {"F": ("N", FORCE)}, RATE),
    "English thousands": (table(T, texts(FORCE, '"{:,.1f}"'), head=["t,F [N]"]), {"F": ("N", FORCE)}, RATE),
    "whole numbers beyond 64 bits": (table(T, texts(range(ROWS), "9{:019d}"), Z, head=["t,serial,acc_z"]),
                                     {"serial": ("", 9e19 + np.arange(ROWS)), "acc_z": ("", Z)}, RATE),
    "names again": (PLAIN.replace(MIDDLE, f"t,acc_x,acc_z\n{MIDDLE}"), ACC, RATE),
    "a column of texts": (table(T, ["run"] * ROWS, Z, head=["t,state,acc_z"]), {"acc_z": ("", Z)}, RATE),
    # Time
    "times in pairs": ("t1 [s];acc_z;t2 [s];Weg [mm]\n" + PAIRS,
                       {"acc_z": ("", Z), "Weg": ("mm", TRAVEL[:300])}, [RATE, RATE / 2]),
    "times in pairs of one name": ("Zeit;acc_z;Zeit;Weg [mm]\n" + PAIRS, None, [RATE, RATE / 2]),
    "pairs of equal times": (table(T, X, T, Y, T, Z, head=["t1,x,t2,y,t3,z"]), XYZ, RATE),
    "whole seconds": (table(stamps("%Y-%m-%d %H:%M:%S", START + datetime.timedelta(seconds=0.5)), X, Z,
                            head=["t,acc_x,acc_z"]), ACC, RATE),
    "milliseconds at 1024 Hz": (table(texts(T * RATE / 1024, "{:.3f}"), X, Z, head=["t,acc_x,acc_z"]), ACC, 1024),
    "milliseconds at 900 Hz": (table(texts(T * RATE / 900, "{:.3f}"), X, Z, head=["t,acc_x,acc_z"]), ACC, 900),
    "hundredths": (table(np.floor(100 * T) / 100, X, Z, head=["t,acc_x,acc_z"]), ACC, RATE),
    "first column without a name": (table(T, X, Y, Z, head=[",x,y,z"]), XYZ, RATE),
    "no names": (table(T, X, Z), {"column 2": ("", X), "column 3": ("", Z)}, RATE),
    "a count is no time": (table(COUNT, X, Y, Z, head=["n,x,y,z"]), XYZ, None),
    "rate above": (table(X, Y, Z, head=["Sample rate: 250 Hz", "x,y,z"]), XYZ, RATE),
    "rate in a remark": (table(X, Y, Z, head=["# dt = 0.004 s", "# x,y,z"]), XYZ, RATE),
    "interval above": (table(X, Y, Z, head=["Sampling interval [ms]\t4", "x\ty\tz"], sep="\t"), XYZ, RATE),
    **{
        f"time called {name}": (table(T * factor, X, Z, head=[f"{name};acc_x;acc_z"], sep=";"), ACC, RATE)
        for name, factor in {
            "Temps (s)": 1, "Time (in ms)": 1e3, "Zeit / ms": 1e3, "Time, s": 1, "time{s}": 1, "ms": 1e3, "seconds": 1,
            "Uhrzeit (hh:mm:ss)": 1, "time_us": 1e6,
        }.items()
    },
    **{
        f"moments {pattern}": (table(stamps(pattern, start), X, Z, head=["Zeit;acc_x;acc_z"], sep=";"), ACC, RATE)
        for pattern, start in {
            "%d.%m.%Y %H:%M:%S,MS": START, "%d.%m.%Y %H:%M:%S.MS": MIDNIGHT,
            "%m/%d/%Y %I:%M:%S.MS %p": datetime.datetime(2020, 1, 12, 11, 59, 59, 500000), "%M:%S.MS": START,
            "%H:%M:%S:MS": START, "%Y-%m-%dT%H:%M:%S.MSZ": START, "%d-%b-%Y %H:%M:%S.MS": START,
            "%Y/%m/%d %H:%M:%S.MS": START,
        }.items()
    },
    "date and time in two columns": (
        table(stamps("%d.%m.%Y", MIDNIGHT), stamps("%H:%M:%S.MS", MIDNIGHT), X, Z, head=["Datum;Zeit;acc_x;acc_z"],
              sep=";"),
        ACC, RATE,
    ),
    "nanoseconds since 1970": (
        table(texts(1_579_884_792 * 10**9 + (T * 1e9).astype(np.int64), "{:d}"), X, Z,
              head=["timestamp_ns,acc_x,acc_z"]),
        ACC, RATE,
    ),
    # Units
    "name (left)": (table(T, FORCE, FORCE, head=["t,Force (left) [N],Kraft (links)"]),
                    {"Force (left)": ("N", FORCE), "Kraft (links)": ("", FORCE)}, RATE),
    "quantity over unit": (table(T, FORCE, TRAVEL, head=["t/s,F/kN,a/(m/s²)"]),
                           {"F": ("kN", FORCE), "a": ("m/s²", TRAVEL)}, RATE),
}  # fmt: skip
"""What stands in a file; the columns beside the time with units and values; and the rate in Hz, of each group."""
QUOTED = r"line {}: has {} names, '{}', but the rows have {} columns, such as"
REFUSED = {
    "a name too many": (table(X, Y, Z, head=["# x y z w"], sep=" "), QUOTED.format(1, 4, "# x y z w", 3)),
    "names that say nothing": (table(X, Y, Z, head=["a,b,c,d"]), QUOTED.format(1, 4, "a,b,c,d", 3)),
    "a comma in a name": (table(T, Z, head=["Time,Acceleration, driver"]), QUOTED.format(1, 3, ".*", 2)),
    "a name too few": (table(T, X, Y, Z, head=["x,y,z"]), QUOTED.format(1, 3, "x,y,z", 4)),
    "a key and a text alone": (table(T, X, Z, head=["Operator,Miller"]), QUOTED.format(1, 2, "Operator,Miller", 3)),
    "a unit too few": (table(T, X, Z, head=["t;acc_x;acc_z", "s;g"], sep=";"), QUOTED.format(2, 2, "s;g", 3)),
    "JSON": (json.dumps({"t": T.tolist()}), "is a JSON file"),
    "JSON records": (json.dumps([{"t": t} for t in T.tolist()], indent=1), "is a JSON file"),
    "XML": ("<?xml version='1.0'?>\n" + PLAIN, "is an XML or HTML file"),
    "a row with a column too many": (
        PLAIN.replace(MIDDLE, f"{MIDDLE},"),
        r"line 302: has 4 columns where the others have 3: '.*'; correct",
    ),
    "cut": (PLAIN[:-9], "line 601: has 2 columns where the others have 3: .* the file is truncated"),
    "a letter": ("Dear sir,\nthis is no table.\n", "no row of numbers; it is no table, or csv.delimiter has to be"),
}
"""What stands in a file, and the sentence with which it is refused."""
