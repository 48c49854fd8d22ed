"""Series as Bladed writes them."""

from pathlib import Path

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.records import read_output

HEADER = """FILE\trun.$12
ACCESS\tD
FORM\t{form}
RECL\t4
FORMAT\tR*4
CONTENT\t'LOAD'
NDIMENS\t{n}
DIMENS\t{sizes}
GENLAB\t'Tower base'
VARIAB\t'Tower Mx' 'Tower Fx'
VARUNIT\tFL F
{stations}AXISLAB\t'Time'
AXIUNIT\tT
AXIMETH\t2
MIN\t0.5
STEP\t0.1
NVARS\t0
"""
STATIONS = "AXISLAB\t'Height'\nAXIUNIT\tL\nAXIMETH\t3\nAXIVAL\t10.0 20.5\n"


def written(folder: Path, values: np.ndarray, *, form: str = "U", stations: str = "") -> Path:
    """Write values (times, [stations,] variables): the variables vary fastest."""
    sizes = " ".join(str(n) for n in values.shape[::-1])
    text = HEADER.format(form=form, n=values.ndim, sizes=sizes, stations=stations)
    (folder / "run.%12").write_text(text)
    data = folder / "run.$12"
    if form == "U":
        data.write_bytes(values.astype("<f4").tobytes())
    else:
        data.write_text("\n".join(" ".join(map(str, row)) for row in values.reshape(len(values), -1)))
    return folder / "run.%12"


@pytest.mark.parametrize("form", ["U", "F"])
def test_series_of_two_variables(tmp_path: Path, form: str) -> None:
    values = np.arange(8.0).reshape(4, 2)
    found = read_output(written(tmp_path, values, form=form))
    assert found.names == ("Tower Mx", "Tower Fx")
    assert [found.channels[name].unit for name in found.names] == ["N m", "N"]
    np.testing.assert_array_equal(found.data, values.T)
    np.testing.assert_allclose(found.times_s, [0.5, 0.6, 0.7, 0.8])


def test_stations_along_a_part_are_channels(tmp_path: Path) -> None:
    """DNV's order: z0_x0_s0, z0_x0_s1, z0_x1_s0 …, the last axis slowest."""
    values = np.arange(12.0).reshape(3, 2, 2)
    found = read_output(written(tmp_path, values, stations=STATIONS))
    assert found.names == ("Tower Mx @ 10", "Tower Fx @ 10", "Tower Mx @ 20.5", "Tower Fx @ 20.5")
    np.testing.assert_array_equal(found.data[2], [2.0, 6.0, 10.0])


def test_damaged_files_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path, np.arange(8.0).reshape(4, 2))
    data = tmp_path / "run.$12"
    data.write_bytes(data.read_bytes()[:-3])
    with pytest.raises(InputError, match="another number of values"):
        read_output(path)
    data.unlink()
    with pytest.raises(InputError, match="numbers are missing"):
        read_output(path)
    path.write_text(path.read_text().replace("AXIMETH\t2", "AXIMETH\t3"))
    with pytest.raises(InputError, match="not even time"):
        read_output(path)
    path.write_text("nothing")
    with pytest.raises(InputError, match="a key is missing"):
        read_output(path)
