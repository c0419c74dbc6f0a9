"""Recordings of joint states: written here by rosbags' own writer, read back by joint name."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from jaxswarm.errors import InputError
from jaxswarm.logs import Reading, bounds, read_log
from jaxswarm.logs.mcap_size import unpacked_size

rosbag2 = pytest.importorskip("rosbags.rosbag2")
from rosbags.typesys import Stores, get_typestore  # noqa: E402

STORE = get_typestore(Stores.ROS2_HUMBLE)
JOINTS = ("shoulder", "elbow")
START = 1_700_000_000_123_456_789
KIND = "sensor_msgs/msg/JointState"


def state(stamp, names, position, velocity=(), effort=()):
    """One message; ``stamp`` in integer nanoseconds."""
    time = STORE.types["builtin_interfaces/msg/Time"](stamp // 10**9, stamp % 10**9)
    header = STORE.types["std_msgs/msg/Header"](time, "")
    arrays = [np.array(values, dtype=np.float64) for values in (position, velocity, effort)]
    return STORE.types[KIND](header, list(names), *arrays)


def record(folder, topics, storage="MCAP"):
    """Write topics (name to messages) to a rosbag2 folder."""
    plugin = rosbag2.StoragePlugin[storage]
    with rosbag2.Writer(folder, version=9, storage_plugin=plugin) as writer:
        for topic, messages in topics.items():
            connection = writer.add_connection(topic, KIND, typestore=STORE)
            for k, message in enumerate(messages):
                raw = STORE.serialize_cdr(message, KIND)
                writer.write(connection, START + k * 10_000_000, raw)
    return folder


def states(samples=50, names=("elbow", "gripper", "shoulder"), start=START, effort=True):
    values = np.sin(0.1 * np.arange(samples)[:, None] + np.arange(len(names)))
    return [
        state(
            start + k * 10_000_000, names, values[k], 2 * values[k], 3 * values[k] if effort else ()
        )
        for k in range(samples)
    ]


@pytest.mark.parametrize("storage", ["MCAP", "SQLITE3"])
@pytest.mark.parametrize("inside", [False, True])
def test_joints_by_name_and_stamps_by_header(tmp_path, storage, inside):
    folder = record(tmp_path / "bag", {"/joint_states": states()}, storage)
    path = next(p for p in folder.iterdir() if p.suffix in (".mcap", ".db3")) if inside else folder
    log = read_log(path, JOINTS)
    expected = np.sin(0.1 * np.arange(50)[:, None] + np.array([2, 0]))
    assert np.array_equal(log.q, expected)
    assert np.array_equal(log.dq, 2 * expected) and np.array_equal(log.tau, 3 * expected)
    assert np.allclose(np.diff(log.t), 0.01, atol=1e-12) and log.t[0] == 0.0
    assert any("1700000000.123456789" in note for note in log.notes)
    assert any("gripper" in note for note in log.notes)


def test_order_unstamped_and_incomplete_messages(tmp_path):
    messages = states()
    messages[10], messages[11] = messages[11], messages[10]
    messages.insert(20, state(START + 5, ["gripper"], [1.0]))
    log = read_log(record(tmp_path / "a", {"/joint_states": messages}), JOINTS)
    assert len(log.t) == 50 and (np.diff(log.t) > 0).all()
    assert any("1 came out of order" in note for note in log.notes)
    assert any("Left out: 1 of the messages of /joint_states" in note for note in log.notes)
    unstamped = [state(0, JOINTS, [k, k], effort=[k, k]) for k in range(5)]
    log = read_log(record(tmp_path / "b", {"/joint_states": unstamped}), JOINTS)
    assert np.allclose(log.t, 0.01 * np.arange(5))
    assert any("carry no time" in note for note in log.notes)


def test_topic_with_efforts_is_chosen(tmp_path):
    topics = {"/commands": states(effort=False), "/measured": states(40)}
    log = read_log(record(tmp_path / "bag", topics), JOINTS)
    assert len(log.t) == 40
    assert any("topic /measured; also recorded: /commands" in note for note in log.notes)


def test_of_two_topics_that_would_do_one_has_to_be_named(tmp_path):
    path = record(tmp_path / "bag", {"/measured": states(50), "/filtered": states(40)})
    with pytest.raises(InputError, match="--topic /"):
        read_log(path, JOINTS)
    assert len(read_log(path, JOINTS, reading=Reading(topic="/filtered")).t) == 40
    with pytest.raises(InputError, match="Did you mean /filtered"):
        read_log(path, JOINTS, reading=Reading(topic="/filterd"))


def test_efforts_are_asked_for_where_currents_would_do_too(tmp_path):
    path = record(tmp_path / "bag", {"/joint_states": states()})
    gains = np.array([10.0, 20.0])
    with pytest.raises(InputError, match="--effort torque or --effort current"):
        read_log(path, JOINTS, gains)
    torque = read_log(path, JOINTS, gains, reading=Reading(effort="torque"))
    current = read_log(path, JOINTS, gains, reading=Reading(effort="current"))
    assert np.array_equal(current.tau, torque.tau * gains)


def split_states(lag=0):
    """The states of an arm whose elbow and shoulder come in messages of their own."""
    found = []
    for k in range(50):
        now = START + k * 10_000_000
        found.append(state(now, ["shoulder"], [np.sin(0.1 * k)], effort=[k]))
        late = np.sin(0.1 * (k + lag / 1e7))
        found.append(state(now + lag, ["elbow", "gripper"], [late, 9.0], effort=[2.0 * k, 0.0]))
    return found


def test_joints_in_messages_of_their_own_are_joined(tmp_path):
    log = read_log(record(tmp_path / "a", {"/joint_states": split_states()}), JOINTS)
    assert len(log.t) == 50 and not any("straight lines" in note for note in log.notes)
    assert np.array_equal(log.tau, np.arange(50)[:, None] * [1.0, 2.0])
    assert any("gripper" in note for note in log.notes)
    late = read_log(record(tmp_path / "b", {"/joint_states": split_states(4_000_000)}), JOINTS)
    assert any("straight lines" in note for note in late.notes)
    clock = late.t + int(round(1e9 * 0)) * 1e-9
    assert np.allclose(np.diff(clock), 0.01)
    # Of a sine of 0.1 rad a sample straight lines miss an eighth of the square at most.
    step = 0.1
    assert np.abs(late.q[:, 0] - late.q[:, 1]).max() < step**2 / 8 + 1e-9


def test_joints_of_two_topics_are_joined_when_both_are_named(tmp_path):
    messages = split_states()
    topics = {"/left": messages[::2], "/right": messages[1::2]}
    path = record(tmp_path / "bag", topics)
    with pytest.raises(InputError, match="together they do: --topic /left,/right"):
        read_log(path, JOINTS)
    assert len(read_log(path, JOINTS, reading=Reading(topic="/left,/right")).t) == 50


def test_joints_that_come_too_rarely_are_refused(tmp_path):
    messages = [m for k, m in enumerate(split_states()) if k % 2 == 0 or k % 20 == 1]
    with pytest.raises(InputError, match="Record all joints at one rate"):
        read_log(record(tmp_path / "bag", {"/joint_states": messages}), JOINTS)


@pytest.mark.parametrize(
    ("messages", "what"),
    [
        (
            states(names=("elbow", "wrist")),
            "no message names all joints of the robot (shoulder, elbow)",
        ),
        ([state(START, JOINTS, [])] * 3, "carry no positions"),
        (
            [state(START + k, JOINTS, [1.0]) for k in range(3)],
            "message 1 of /joint_states has 1 values of q for 2 joints",
        ),
        (states(effort=False), "no torque"),
        ([], "no message names all joints"),
    ],
)
def test_recordings_that_cannot_be_used(tmp_path, messages, what):
    path = record(tmp_path / "bag", {"/joint_states": messages})
    with pytest.raises(InputError) as caught:
        read_log(path, JOINTS)
    assert what in str(caught.value) and "bag" in str(caught.value)


def test_no_joint_states_at_all(tmp_path):
    with pytest.raises(InputError, match="no topic of sensor_msgs/msg/JointState"):
        read_log(record(tmp_path / "bag", {}), JOINTS)


@pytest.fixture(scope="module")
def recording(tmp_path_factory) -> bytes:
    folder = record(tmp_path_factory.mktemp("good") / "bag", {"/joint_states": states(8)})
    return next(folder.glob("*.mcap")).read_bytes()


@given(data=st.data())
@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
def test_changed_and_cut_bytes(tmp_path, recording, data):
    content = bytearray(recording)
    for _ in range(data.draw(st.integers(0, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    length = data.draw(st.one_of(st.just(len(content)), st.integers(0, len(content))))
    path = tmp_path / "log.mcap"
    path.write_bytes(bytes(content[:length]))
    try:
        log = read_log(path, JOINTS)
    except InputError as error:
        assert str(error).startswith(str(path))
    else:
        assert np.isfinite(log.q).all() and np.isfinite(log.tau).all()


def packed(folder, count=40, blank=2**20):
    """A recording whose other topic holds zeros, which pack well."""
    plugin = rosbag2.StoragePlugin.MCAP
    writer = rosbag2.Writer(folder, version=9, storage_plugin=plugin)
    writer.set_compression(rosbag2.CompressionMode.STORAGE, rosbag2.CompressionFormat.ZSTD)
    with writer:
        joints = writer.add_connection("/joint_states", KIND, typestore=STORE)
        camera = writer.add_connection("/camera", "std_msgs/msg/UInt8MultiArray", typestore=STORE)
        for k, message in enumerate(states(count)):
            writer.write(joints, START + k * 10_000_000, STORE.serialize_cdr(message, KIND))
            writer.write(camera, START + k * 10_000_000, bytes(blank))
    return next(folder.glob("*.mcap"))


def test_what_chunks_unpack_to_is_known_before_and_refused(tmp_path, monkeypatch):
    path = packed(tmp_path / "bag")
    assert path.stat().st_size < 2**20
    assert 40 * 2**20 < unpacked_size(path) < 45 * 2**20
    assert len(read_log(path, JOINTS).t) == 40
    monkeypatch.setattr(bounds, "LARGEST_LOG", 2**25)
    for name in (path, path.parent):
        with pytest.raises(InputError, match=r"at most 0\.0312 GiB are read"):
            read_log(name, JOINTS)


def test_a_chunk_that_lies_about_its_size_is_measured_by_its_frame(tmp_path):
    path = packed(tmp_path / "bag")
    data = bytearray(path.read_bytes())
    frame = data.index(b"\x28\xb5\x2f\xfd")
    name = data.rindex(b"zstd", 0, frame)
    data[name - 16 : name - 8] = bytes(8)
    path.write_bytes(bytes(data))
    assert unpacked_size(path) > 40 * 2**20


@pytest.mark.parametrize(
    "content", [b"", b"\x89MCAP0\r\n", b"\x89MCAP0\r\n\x06" + b"\xff" * 40, bytes(99)]
)
def test_what_is_no_recording_unpacks_to_nothing_or_is_refused(tmp_path, content):
    path = tmp_path / "log.mcap"
    path.write_bytes(content)
    assert unpacked_size(path) >= 0
    with pytest.raises(InputError, match="log.mcap"):
        read_log(path, JOINTS)
