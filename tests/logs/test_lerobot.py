"""One episode of a LeRobot data set, in the layouts of versions 2 and 3."""

import json

import numpy as np
import pytest
from log_samples import JOINTS, make_log, read

from jaxswarm.errors import InputError
from jaxswarm.logs import Reading, parse_reading

pa = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")
LOG = make_log()


def episode(k):
    count = len(LOG.t)
    return {
        "observation.state": (LOG.q + k).astype(np.float32).tolist(),
        "observation.effort": LOG.tau.tolist(),
        "action": LOG.q.tolist(),
        "timestamp": LOG.t,
        "frame_index": np.arange(count),
        "episode_index": np.full(count, k),
    }


def data_set(folder, version, names):
    (folder / "meta").mkdir(parents=True)
    features = {"observation.state": {"dtype": "float32", "shape": [2], "names": names}}
    info = {"codebase_version": version, "fps": 100, "features": features}
    (folder / "meta" / "info.json").write_text(json.dumps(info))
    chunk = folder / "data" / "chunk-000"
    chunk.mkdir(parents=True)
    if version == "v2.1":
        for k in range(3):
            parquet.write_table(pa.table(episode(k)), chunk / f"episode_{k:06d}.parquet")
    else:
        whole = pa.concat_tables([pa.table(episode(k)) for k in range(3)])
        parquet.write_table(whole, chunk / "file-000.parquet")
    return folder


@pytest.mark.parametrize("version", ["v2.1", "v3.0"])
def test_an_episode_is_a_log(tmp_path, version):
    folder = data_set(tmp_path / "set", version, [f"{joint}.pos" for joint in JOINTS[::-1]])
    log = read(folder, reading=Reading(topic="2"))
    np.testing.assert_allclose(log.q, LOG.q[:, ::-1] + 2, atol=1e-6)
    assert np.array_equal(log.tau, LOG.tau[:, ::-1])
    assert any("does not say units" in note for note in log.notes)
    with pytest.raises(InputError, match="Say which: --topic 0"):
        read(folder)
    with pytest.raises(InputError, match="no episode 7; there are 0 to 2"):
        read(folder, reading=Reading(topic="7"))


def test_names_of_the_set_that_the_robot_lacks_are_refused_unless_the_order_is_said(tmp_path):
    folder = data_set(tmp_path / "set", "v3.0", ["pan", "lift"])
    with pytest.raises(InputError, match="--columns q=q"):
        read(folder, reading=parse_reading(topic="1"))
    log = read(folder, reading=parse_reading("q=q", topic="1"))
    np.testing.assert_allclose(log.q, LOG.q + 1, atol=1e-6)


def test_a_file_of_one_episode_needs_no_number(tmp_path):
    folder = data_set(tmp_path / "set", "v2.1", None)
    log = read(folder / "data" / "chunk-000" / "episode_000001.parquet")
    np.testing.assert_allclose(log.q, LOG.q + 1, atol=1e-6)


def test_a_row_without_its_episode_is_told(tmp_path):
    folder = data_set(tmp_path / "set", "v3.0", list(JOINTS))
    path = folder / "data" / "chunk-000" / "file-000.parquet"
    table = parquet.read_table(path).to_pydict()
    table["episode_index"][5] = None
    parquet.write_table(pa.table(table), path)
    with pytest.raises(InputError, match="every row belongs to an episode"):
        read(folder)
