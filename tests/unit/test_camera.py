"""Every kind of source, written here by the real writers and read back."""

import json

import cv2
import numpy as np
import pytest
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

from course_lib.camera import CameraError, open_camera

STEP_NS = 40_000_000
START_NS = 1_700_000_000_123_456_789
KINDS = ["bag", "mcap", "sqlite3"]


def picture(number, width=64, height=48):
    """A frame that tells its number, its channels and its orientation."""
    image = np.zeros((height, width, 3), np.uint8)
    image[: height // 2, :, 0] = 200
    image[:, : width // 2, 2] = 100
    image[5:15, 5:15, 1] = 10 + number
    return image


def raw(image, encoding="bgr8", padding=0):
    """The fields of a sensor_msgs/Image."""
    conversions = {
        "bgr8": None,
        "rgb8": cv2.COLOR_BGR2RGB,
        "bgra8": cv2.COLOR_BGR2BGRA,
        "rgba8": cv2.COLOR_BGR2RGBA,
        "mono8": cv2.COLOR_BGR2GRAY,
    }
    code = conversions[encoding]
    data = image if code is None else cv2.cvtColor(image, code)
    rows = data.reshape(data.shape[0], -1)
    rows = np.pad(rows, ((0, 0), (0, padding)), constant_values=77)
    return {
        "height": image.shape[0],
        "width": image.shape[1],
        "encoding": encoding,
        "is_bigendian": 0,
        "step": rows.shape[1],
        "data": np.ascontiguousarray(rows).ravel(),
    }


class Recorder:
    """Writes image messages with the real rosbags writers, in any of the three formats."""

    def __init__(self, kind, place):
        self.kind = kind
        ros1 = kind == "bag"
        self.store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
        if ros1:
            self.path = place / "flight.bag"
            self.writer = Writer1(self.path)
        else:
            self.path = place / f"flight_{kind}"
            plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
            self.writer = Writer2(self.path, version=9, storage_plugin=plugin)
        self.connections = {}

    def __enter__(self):
        self.writer.open()
        return self

    def __exit__(self, *_):
        self.writer.close()

    def write(self, topic, stamp_ns, fields, *, unstamped=False):
        kind = "CompressedImage" if "format" in fields else "Image"
        types = self.store.types
        time_type = types["builtin_interfaces/msg/Time"]
        seconds, rest = (0, 0) if unstamped else divmod(stamp_ns, 1_000_000_000)
        header = {"stamp": time_type(sec=seconds, nanosec=rest), "frame_id": "camera"}
        if self.kind == "bag":
            header["seq"] = 0
        message = types[f"sensor_msgs/msg/{kind}"](
            header=types["std_msgs/msg/Header"](**header), **fields
        )
        name = f"sensor_msgs/msg/{kind}"
        if topic not in self.connections:
            self.connections[topic] = self.writer.add_connection(topic, name, typestore=self.store)
        serialise = self.store.serialize_ros1 if self.kind == "bag" else self.store.serialize_cdr
        self.writer.write(self.connections[topic], stamp_ns + 5, serialise(message, name))


def record(kind, place, messages, topic="/camera/rgb/image_raw", **options):
    with Recorder(kind, place) as recorder:
        for number, fields in enumerate(messages):
            recorder.write(topic, START_NS + number * STEP_NS, fields, **options)
    return recorder.path


def compressed(image, form="jpeg"):
    suffix = ".png" if form == "png" else ".jpg"
    return {"format": form, "data": cv2.imencode(suffix, image)[1].ravel()}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("encoding", ["bgr8", "rgb8", "bgra8", "rgba8"])
def test_raw_pictures_come_back_exactly(kind, encoding, tmp_path):
    path = record(kind, tmp_path, [raw(picture(n), encoding, padding=7) for n in range(3)])
    with open_camera(path) as source:
        assert len(source) == 3
        frames = list(source)
        assert len(source) == 3
    assert [frame.stamp_ns for frame in frames] == [START_NS + n * STEP_NS for n in range(3)]
    for number, frame in enumerate(frames):
        assert np.array_equal(frame.image, picture(number))
        assert frame.image.flags.writeable
        assert frame.truth is None


@pytest.mark.parametrize("kind", KINDS)
def test_compressed_pictures(kind, tmp_path):
    path = record(kind, tmp_path, [compressed(picture(1)), compressed(picture(2), "png")])
    first, second = open_camera(str(path))
    assert np.abs(first.image.astype(int) - picture(1)).mean() < 5
    assert np.array_equal(second.image, picture(2))


def test_single_ros2_storage_files(tmp_path):
    for kind, suffix in (("mcap", "mcap"), ("sqlite3", "db3")):
        path = record(kind, tmp_path, [raw(picture(0))])
        (storage,) = path.glob(f"*.{suffix}")
        (frame,) = open_camera(storage)
        assert np.array_equal(frame.image, picture(0))


def test_mono_becomes_grey_bgr(tmp_path):
    path = record("bag", tmp_path, [raw(picture(3), "mono8", padding=3)])
    (frame,) = open_camera(path)
    grey = cv2.cvtColor(picture(3), cv2.COLOR_BGR2GRAY)
    assert np.array_equal(frame.image, cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR))


@pytest.mark.parametrize(("endian", "word"), [(0, "little"), (1, "big")])
def test_sixteen_bits_are_refused_by_name(tmp_path, endian, word):
    fields = raw(picture(0), "mono8") | {"encoding": "mono16", "is_bigendian": endian}
    path = record("bag", tmp_path, [fields])
    with pytest.raises(CameraError, match=rf"mono16.*{word}-endian.*rgb8"):
        list(open_camera(path))


@pytest.mark.parametrize("change", [{"step": 3}, {"height": 480}, {"width": 0}])
def test_contradictory_sizes_are_an_error(tmp_path, change):
    path = record("bag", tmp_path, [raw(picture(0)) | change])
    source = open_camera(path)
    with pytest.raises(CameraError, match="damaged image message"):
        next(source)
    assert source.closed


def test_damaged_jpeg_is_an_error(tmp_path):
    fields = compressed(picture(0))
    fields["data"] = fields["data"][:20]
    path = record("bag", tmp_path, [compressed(picture(0)), fields])
    source = open_camera(path)
    next(source)
    with pytest.raises(CameraError, match="damaged compressed image: 20 bytes"):
        next(source)


def test_depth_is_refused(tmp_path):
    path = record("bag", tmp_path, [compressed(picture(0)) | {"format": "16UC1; compressedDepth"}])
    with pytest.raises(CameraError, match="depth"):
        next(open_camera(path))


def test_unset_stamp_falls_back_to_the_time_of_recording(tmp_path):
    path = record("mcap", tmp_path, [raw(picture(0))], unstamped=True)
    (frame,) = open_camera(path)
    assert frame.stamp_ns == START_NS + 5


@pytest.mark.parametrize("kind", KINDS)
def test_several_topics_must_be_chosen_from(kind, tmp_path):
    with Recorder(kind, tmp_path) as recorder:
        recorder.write("/front/image_raw", START_NS, raw(picture(1)))
        recorder.write("/down/image_raw/compressed", START_NS, compressed(picture(2), "png"))
    with pytest.raises(CameraError, match="/down/image_raw/compressed, /front/image_raw"):
        open_camera(recorder.path)
    with pytest.raises(CameraError, match=r"no image topic '/up'.*/front/image_raw"):
        open_camera(recorder.path, topic="/up")
    (frame,) = open_camera(recorder.path, topic="/front/image_raw")
    assert np.array_equal(frame.image, picture(1))
    assert len(open_camera(recorder.path, topic="/front/image_raw")) == 1


def test_recording_without_pictures(tmp_path):
    store = get_typestore(Stores.ROS1_NOETIC)
    path = tmp_path / "talk.bag"
    with Writer1(path) as writer:
        connection = writer.add_connection("/chatter", "std_msgs/msg/String", typestore=store)
        message = store.types["std_msgs/msg/String"](data="hello")
        writer.write(connection, 1, store.serialize_ros1(message, "std_msgs/msg/String"))
    with pytest.raises(CameraError, match="no image topic; its topics: /chatter"):
        open_camera(path)


@pytest.mark.parametrize("size", [0, 10, 4000])
def test_cut_off_bag_is_an_error_that_says_so(tmp_path, size):
    path = record("bag", tmp_path, [raw(picture(n)) for n in range(4)])
    path.write_bytes(path.read_bytes()[:size])
    with pytest.raises(CameraError, match=r"not a readable recording.*reindex"):
        open_camera(path)


def test_garbage_in_every_format_is_an_error(tmp_path):
    for name in ("a.bag", "a.mcap", "a.db3"):
        (tmp_path / name).write_bytes(bytes(range(256)) * 20)
        with pytest.raises(CameraError, match="not a readable recording"):
            open_camera(tmp_path / name)
    folder = tmp_path / "ros2"
    folder.mkdir()
    (folder / "metadata.yaml").write_text("rosbag2_bagfile_information: {")
    with pytest.raises(CameraError, match="not a readable recording"):
        open_camera(folder)


def test_truth_is_matched_by_stamp(tmp_path):
    path = record("bag", tmp_path, [raw(picture(n)) for n in range(3)])
    (tmp_path / "truth").mkdir()
    frames = [
        {"stamp_ns": START_NS + 2 * STEP_NS, "well": "third"},
        {"stamp_ns": START_NS + 300, "well": "first, rounded through a float"},
    ]
    (tmp_path / "truth" / "flight.json").write_text(json.dumps({"frames": frames}))
    wells = [frame.truth and frame.truth["well"] for frame in open_camera(path)]
    assert wells == ["first, rounded through a float", None, "third"]


def test_damaged_truth_is_named(tmp_path):
    path = record("bag", tmp_path, [raw(picture(0))])
    (tmp_path / "truth").mkdir()
    (tmp_path / "truth" / "flight.json").write_text("{")
    with pytest.raises(CameraError, match=r"flight\.json is not a readable truth record"):
        open_camera(path)


def test_a_course_flight_by_its_name(tmp_path, monkeypatch):
    record("bag", tmp_path, [raw(picture(0))])
    monkeypatch.setenv("COURSE_IMAGES", str(tmp_path))
    (frame,) = open_camera("flight.bag")
    assert np.array_equal(frame.image, picture(0))
    with pytest.raises(CameraError, match=r"No fligth\.bag.*Did you mean 'flight\.bag'"):
        open_camera("fligth.bag")


@pytest.fixture
def video(tmp_path):
    path = tmp_path / "clip.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), 25, (64, 48))
    assert writer.isOpened()
    for number in range(10):
        writer.write(picture(number * 10))
    writer.release()
    return path


def test_video_file(video):
    source = open_camera(video)
    assert len(source) == 10
    frames = list(source)
    assert source.closed
    assert len(frames) == 10
    assert [round(frame.stamp_ns / 1e6) for frame in frames] == list(range(0, 400, 40))
    for number, frame in enumerate(frames):
        assert np.abs(frame.image.astype(int) - picture(number * 10)).mean() < 6


def test_video_that_is_none(tmp_path):
    path = tmp_path / "clip.mp4"
    path.write_bytes(b"not a video")
    with pytest.raises(CameraError, match=r"clip\.mp4 is not a video"):
        open_camera(path)


def test_absent_webcam():
    with pytest.raises(CameraError, match="webcam 97 cannot be opened"):
        open_camera(97)
    with pytest.raises(CameraError, match="webcam 97 cannot be opened"):
        open_camera("97")


def test_folder_in_natural_order(tmp_path):
    for number in (10, 2, 1):
        cv2.imwrite(str(tmp_path / f"frame_{number}.png"), picture(number))
    (tmp_path / "notes.txt").write_text("not a picture")
    source = open_camera(tmp_path, rate=10)
    assert len(source) == 3
    frames = list(source)
    assert [frame.stamp_ns for frame in frames] == [0, 100_000_000, 200_000_000]
    for frame, number in zip(frames, (1, 2, 10), strict=True):
        assert np.array_equal(frame.image, picture(number))


def test_folder_named_by_nanoseconds(tmp_path):
    for number in range(2):
        cv2.imwrite(str(tmp_path / f"{START_NS + number * STEP_NS}.png"), picture(number))
    assert [f.stamp_ns for f in open_camera(tmp_path)] == [START_NS, START_NS + STEP_NS]


def test_folder_with_truth(tmp_path):
    cv2.imwrite(str(tmp_path / "box.png"), picture(0))
    (tmp_path / "truth").mkdir()
    (tmp_path / "truth" / "box.json").write_text('{"objects": {}}')
    (frame,) = open_camera(tmp_path)
    assert frame.truth == {"objects": {}}
    assert repr(frame) == "Frame(stamp_ns=0, image 64 x 48, truth known)"


def test_unreadable_picture_in_a_folder_is_named(tmp_path):
    cv2.imwrite(str(tmp_path / "a.png"), picture(0))
    (tmp_path / "b.png").write_bytes(b"")
    source = open_camera(tmp_path)
    next(source)
    with pytest.raises(CameraError, match=r"b\.png exists \(0 bytes\)"):
        next(source)
    with pytest.raises(StopIteration):
        next(source)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda place: place / "nowhere.bag", r"No .*nowhere\.bag"),
        (lambda place: place, "holds no pictures"),
        (lambda place: (place / "a.txt").write_text("x") and place / "a.txt", "is no recording"),
    ],
)
def test_nothing_to_read(tmp_path, make, message):
    with pytest.raises(CameraError, match=message):
        open_camera(make(tmp_path))


@pytest.mark.parametrize("source", [None, 1.5, True, b"flight.bag"])
def test_wrong_source(source):
    with pytest.raises(TypeError, match="source must be a path"):
        open_camera(source)


def test_topic_and_rate_are_checked(tmp_path, video):
    cv2.imwrite(str(tmp_path / "a.png"), picture(0))
    with pytest.raises(CameraError, match="leave topic out"):
        open_camera(video, topic="/camera")
    with pytest.raises(CameraError, match="rate must be a positive number"):
        open_camera(tmp_path, rate=0)


def test_leaving_early_closes(tmp_path, video):
    bag = record("bag", tmp_path, [raw(picture(n)) for n in range(3)])
    for path in (bag, video):
        with open_camera(path) as source:
            assert source
            next(source)
            assert not source.closed
        assert source.closed
        assert list(source) == []
        source.close()
