"""Data of a fit: CSVs of spreadsheets and loggers, with missing values; unusable data give a message that names them."""

import numpy as np
import pytest

from building import BUILD, archive_of, build_systems
from motions import OSCILLATOR, lagrange_fmu, measured  # noqa: F401

TRUTH = {"m": 2.0, "k": 61.0, "d": 0.8, "x": 0.3}
UNITS = {"theta": "rad", "h[1]": "m"}


@pytest.fixture(scope="module", autouse=True)
def built():
    build_systems("measured", {"Oscillator": OSCILLATOR})
    build_systems("measured", {"Back": OSCILLATOR.replace('"Oscillator"', '"Back"')}, "--adjoint", versions=(3,))


def read(folder, text):
    from lagrange_fmu.input_file import read_table

    (folder / "data.csv").write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_table(folder / "data.csv", UNITS)


@pytest.mark.parametrize("text", [
    "time,theta\n0,0.5\n1.5,-2e-3\n",
    "\ufefftime,theta\r\n\r\n0,0.5\r\n1.5,-2e-3\r\n\r\n",  # as Excel starts a file
    "time;theta\n0;0,5\n1,5;-2e-3\n",
    "time\ttheta\n0\t0.5\n1.5\t-2e-3\n",
    "time [s],theta (rad)\n0, 0.5\n1.5 ,-2e-3\n",
    '"time","theta"\n"0","0.5"\n"1.5","-2e-3"\n',
    "time,h[1],theta\n0,,0.5\n1.5,NaN,-2e-3\n",
])  # fmt: skip
def test_spellings(lagrange_fmu, tmp_path, text):  # noqa: F811
    table = read(tmp_path, text)
    assert table["time"].tolist() == [0, 1.5] and table["theta"].tolist() == [0.5, -2e-3]
    assert "h[1]" not in table.dtype.names or np.isnan(table["h[1]"]).all()


@pytest.mark.parametrize("text, why", [
    ("time,theta [deg]\n0,1\n", "'theta' is in 'deg'; expected it in rad"),
    ("time [ms],theta\n0,1\n", "'time' is in 'ms'; expected it in s"),
    ("time;theta\n0;1.234,5\n", "numbers have decimal commas and decimal points"),
    ("time,theta\n\n0,1\n1,x\n", "data.csv:4: 'x' is not a number"),
    ("time,theta\n0,1,2\n", "data.csv:2: '0,1,2' is not 2 numbers"),
    ("time,theta,theta\n0,1,2\n", "expected time and names of variables, each once"),
    ("t;theta\n", "the first line is 't;theta'; expected time"),
    ("0,0.5\n", "the first line is '0,0.5'"),
    ("", "the first line is ''"),
    ("time,angle in °\n".encode("latin1"), "not a text of UTF-8.*'CSV UTF-8'"),
])  # fmt: skip
def test_files_without_a_table(lagrange_fmu, tmp_path, text, why):  # noqa: F811
    with pytest.raises(lagrange_fmu.Problem, match=why):
        read(tmp_path, text)


def table(**columns):
    return np.rec.fromarrays([np.array(values, float) for values in columns.values()], names=list(columns)).view(np.ndarray)


@pytest.mark.parametrize("data, words, why", [
    (table(time=[0, 1], angle=[0, 1]), {}, "'angle' of the data is not an output, .* one of these names: x, v, der"),
    (table(time=[0, 1], k=[0, 1]), {}, "'k' of the data is not an output"),
    (table(time=[0, 1], F=[0, 1]), {}, "no column of the data is an output or state of the system"),
    (table(time=[0], x=[0]), {}, "fewer than two rows"),
    (table(time=[0, 2, 1], x=[0, 0, 0]), {}, "the time 1 s of the data follows 2 s; expected sorted rows"),
    (table(time=[0, 1, 1], x=[0, 0, 0]), {}, "the time 1 s of the data follows 1 s"),
    (table(time=[0, np.nan], x=[0, 0]), {}, "a row without a finite time"),
    (table(time=[0, 1], x=[0, np.inf]), {}, "'x' of the data has an infinite value"),
    (table(time=[0, 1], x=[np.nan, np.nan]), {}, "or none at all"),
    (table(time=[0, 1], x=[0, 1], F=[0, np.nan]), {}, "the input 'F' of the data has rows without a value"),
    (np.zeros((3, 2)), {}, "the data have no time with measurements; expected a CSV, a dict of arrays, a DataFrame or a structured array"),
    ({"time": [0, 1]}, {}, "the data have no time with measurements"),
    ({"x": [0, 1]}, {}, "the data have no time with measurements"),
    ({"time": [0, 1], "x": [0, 1, 2]}, {}, "'x' of the data has 3 values and 'time' 2; expected one for each time"),
    ({"time": [0, 1], "x": [0, "one"]}, {}, "'x' of the data has values that are not numbers"),
    (table(time=[0, 1], x=[0, 1]), {"bounds": {"k": 5}}, "bounds has 5 for 'k'; expected a pair"),
    (table(time=[0, 1], x=[0, 1]), {"bounds": [1, 2]}, "expected a dict of pairs by name"),
    (table(time=[0, 1], x=[0, 1]), {"noise": {"x": 0.0}}, "the noise is x=0; expected positive"),
    (table(time=[0, 1], x=[0, 1]), {"noise": {"y": 1.0}}, "the noise of 'y' is given, which was not measured"),
    (table(time=[0, 1], x=[0, 1]), {"bounds": {"m": (1, 2)}}, "'m' has bounds and does not vary"),
    (table(time=[0, 1], x=[0, 1]), {"vary": ["k", "k"]}, "'k' is given twice"),
])  # fmt: skip
def test_unusable_data(lagrange_fmu, data, words, why):  # noqa: F811
    with pytest.raises(lagrange_fmu.Problem, match=why):
        lagrange_fmu.fit(archive_of(BUILD / "measured", "Oscillator"), data, **({"vary": ["k"]} | words))


def test_dicts_and_data_frames(lagrange_fmu):  # noqa: F811
    """A dict of arrays in any order, or an object with columns such as a DataFrame, gives the same data as a structured array."""
    data = measured(np.random.default_rng(6), TRUTH)[::4]

    class Frame(dict):
        columns = property(lambda self: list(self))
        reset_index = None

    columns = {name: data[name] for name in reversed(data.dtype.names)}
    expected, *found = (lagrange_fmu.fit(archive_of(BUILD / "measured", "Oscillator"), one, vary=["k"]).values for one in (data, columns, Frame(columns)))
    assert found == [expected, expected]


def test_missing_values(lagrange_fmu):  # noqa: F811
    """
    Missing values have no weight, in a fit and in the sum of squares: the result is that without their rows. A second column lacks other
    values.
    """
    data = measured(np.random.default_rng(6), TRUTH)[::4]
    both = table(time=data["time"], x=data["x"], v=np.full(len(data), np.nan))
    both["x"][3::5] = np.nan
    both["v"][0] = 0.0  # it starts at rest
    few = data[np.isfinite(both["x"])]
    oscillator = archive_of(BUILD / "measured", "Oscillator")
    found, expected = lagrange_fmu.fit(oscillator, both, list(TRUTH)[1:]), lagrange_fmu.fit(oscillator, few, list(TRUTH)[1:])
    assert list(found.values.values()) == pytest.approx(list(expected.values.values()), rel=0.05) and found.rms.keys() == {"x", "v"}
    alone = lagrange_fmu.fit(oscillator, both[["time", "x"]], list(TRUTH)[1:])
    assert list(alone.values.values()) == pytest.approx(list(expected.values.values()), rel=1e-9) and alone.rms == pytest.approx(expected.rms)
    squares = [lagrange_fmu.gradient(archive_of(BUILD / "measured", "Back", 3), by=["k"], data=part) for part in (both[["time", "x"]], few)]
    assert squares[0].value == pytest.approx(squares[1].value, rel=1e-9)
    assert squares[0].derivatives == pytest.approx(squares[1].derivatives, rel=1e-7)
