"""MAT files with structures within structures: both versions are read alike, columns named by their place."""

import numpy as np
import pytest
from scipy.io import savemat

from jaxswarm.errors import InputError
from jaxswarm.logs import LogChoice, parse_reading, read_log

h5py = pytest.importorskip("h5py")
JOINTS = ("shoulder", "elbow")


def arrays():
    t = np.arange(400) * 0.005
    q = np.column_stack([np.sin(2 * t), np.cos(3 * t)])
    return t, q, np.column_stack([3 * np.cos(2 * t), np.sin(3 * t) - 2])


def version_5(path):
    t, q, tau = arrays()
    savemat(path, {"run": {"time": t, "meas": {"pos": np.rad2deg(q), "torque": tau}, "who": "lab"}})
    return path


def version_73(path):
    """Transposed, with a class on every item, behind a block of 512 bytes for what MATLAB says of itself."""
    t, q, tau = arrays()
    with h5py.File(path, "w", userblock_size=512) as file:
        run = file.create_group("run")
        for group, name, values in (
            (run, "time", t[None]),
            (run.create_group("meas"), "pos", np.rad2deg(q).T),
            (run["meas"], "torque", tau.T),
        ):
            group.attrs["MATLAB_class"] = np.bytes_("struct")
            group[name] = values
            group[name].attrs["MATLAB_class"] = np.bytes_("double")
        run["who"] = np.array([[ord(x)] for x in "lab"], np.uint16)
        run["who"].attrs["MATLAB_class"] = np.bytes_("char")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    return path


@pytest.mark.parametrize("write", [version_5, version_73])
@pytest.mark.parametrize("place", ["meas.", "run.meas.", "meas/", ""])
def test_an_array_is_named_by_its_place_or_the_end_of_it(write, place, tmp_path):
    path = write(tmp_path / "log.mat")
    if place.startswith("run") and write is version_5:
        place = "meas."  # its columns are those within the structure that is the log
    said = f"t=time,q={place}pos:deg,tau={place}torque"
    log = read_log(LogChoice(path, parse_reading(said)), JOINTS)
    for values, wanted in zip((log.t, log.q, log.tau), arrays(), strict=True):
        np.testing.assert_allclose(values, wanted, atol=1e-12)


@pytest.mark.parametrize("write", [version_5, version_73])
def test_what_a_file_holds_is_told_where_nothing_is_named_as_ours(write, tmp_path):
    said = parse_reading("t=time")
    with pytest.raises(InputError, match=r"meas[./]pos.*meas[./]torque"):
        read_log(LogChoice(write(tmp_path / "log.mat"), said), JOINTS)


def test_an_end_that_two_places_share_is_none_of_them(tmp_path):
    t, q, tau = arrays()
    run = {"time": t, "raw": {"pos": q}, "filtered": {"pos": q}, "torque": tau}
    savemat(tmp_path / "log.mat", {"run": run})
    said = parse_reading("t=time,q=pos,tau=torque")
    with pytest.raises(InputError, match=r"no column 'pos'.*raw\.pos"):
        read_log(LogChoice(tmp_path / "log.mat", said), JOINTS)
