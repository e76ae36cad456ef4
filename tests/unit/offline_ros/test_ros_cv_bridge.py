"""Pictures through cv_bridge: nothing lost, nothing swapped, errors that help."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from course_lib.offline_ros.messages import message_class
from course_lib.offline_ros.modules.cv_bridge import CvBridge, CvBridgeError

BRIDGE = CvBridge()
PICTURE = np.random.default_rng(0).integers(0, 256, (6, 8, 3), dtype=np.uint8)
GRAY = PICTURE[..., 0].copy()


@given(
    hnp.arrays(
        st.sampled_from([np.uint8, np.int8, np.uint16, np.int16, np.int32, np.float32, np.float64]),
        hnp.array_shapes(min_dims=2, max_dims=3, max_side=5),
    ),
    st.integers(0, 2),
)
def test_any_picture_survives_as_it_is(picture: np.ndarray, cut: int) -> None:
    picture = picture[:, cut:] if picture.shape[1] > cut else picture  # rows no longer adjoin
    message = BRIDGE.cv2_to_imgmsg(picture)
    again = BRIDGE.imgmsg_to_cv2(message)
    np.testing.assert_array_equal(again, picture.reshape(again.shape))
    assert again.dtype == picture.dtype
    assert message.step * message.height == len(message.data)


@pytest.mark.parametrize(
    ("source", "target", "code"),
    [
        ("bgr8", "rgb8", cv2.COLOR_BGR2RGB),
        ("bgr8", "mono8", cv2.COLOR_BGR2GRAY),
        ("rgb8", "mono8", cv2.COLOR_RGB2GRAY),
        ("rgb8", "bgr8", cv2.COLOR_RGB2BGR),
        ("bgr8", "bgra8", cv2.COLOR_BGR2BGRA),
        ("rgb8", "bgra8", cv2.COLOR_RGB2BGRA),
    ],
)
def test_colours(source: str, target: str, code: int) -> None:
    message = BRIDGE.cv2_to_imgmsg(PICTURE, source)
    np.testing.assert_array_equal(
        BRIDGE.imgmsg_to_cv2(message, target), cv2.cvtColor(PICTURE, code)
    )


def test_sixteen_bits_keep_white_white() -> None:
    message = BRIDGE.cv2_to_imgmsg(np.uint16([[0, 65535, 257]]), "mono16")
    assert BRIDGE.imgmsg_to_cv2(message, "mono8").tolist() == [[0, 255, 1]]
    message = BRIDGE.cv2_to_imgmsg(np.uint8([[0, 255, 1]]), "mono8")
    assert BRIDGE.imgmsg_to_cv2(message, "mono16").tolist() == [[0, 65535, 257]]


def test_padding_and_byte_order_of_the_message() -> None:
    image = message_class("sensor_msgs/Image")
    padded = image(height=2, width=2, encoding="mono8", step=4, data=b"12..34..")
    assert BRIDGE.imgmsg_to_cv2(padded).tobytes() == b"1234"
    big = image(height=1, width=2, encoding="16UC1", step=4, is_bigendian=1, data=b"\1\2\3\4")
    assert BRIDGE.imgmsg_to_cv2(big).tolist() == [[0x0102, 0x0304]]


def test_a_converted_picture_may_be_drawn_on() -> None:
    message = BRIDGE.cv2_to_imgmsg(PICTURE, "bgr8")
    cv2.circle(BRIDGE.imgmsg_to_cv2(message, "bgr8"), (3, 3), 2, 0)
    assert message.data == PICTURE.tobytes()
    assert not BRIDGE.imgmsg_to_cv2(message).flags.writeable  # so does cv_bridge


@pytest.mark.parametrize(
    ("encoding", "target", "said"),
    [
        ("8UC3", "bgr8", "8UC3 does not say what its values mean"),
        ("bgr8", "8UC1", "cannot convert bgr8 to 8UC1: it has 3 channels"),
        ("bgr8", "yuv422", "cannot convert bgr8 to yuv422"),
        ("bgr8", "BGR8", "'BGR8' is not an image encoding; use one of mono8"),
    ],
)
def test_impossible_conversions(encoding: str, target: str, said: str) -> None:
    with pytest.raises(CvBridgeError, match=said):
        BRIDGE.imgmsg_to_cv2(BRIDGE.cv2_to_imgmsg(PICTURE, encoding), target)


@pytest.mark.parametrize(
    ("picture", "encoding", "said"),
    [
        (GRAY, "bgr8", "encoding specified as bgr8, but the image is 8UC1, not 8UC3"),
        (PICTURE.astype(float), "bgr8", "the image is 64FC3, not 8UC3"),
        (PICTURE.astype(int), "passthrough", "an image of int64 has no encoding"),
        (None, "bgr8", "not NoneType: was it read from a file that does not exist?"),
        ([[1]], "mono8", "a picture is a numpy array, not list"),
        (np.zeros(5, np.uint8), "mono8", "has shape"),
        (np.zeros((0, 4), np.uint8), "mono8", "has shape"),
    ],
)
def test_wrong_pictures(picture: np.ndarray, encoding: str, said: str) -> None:
    with pytest.raises(TypeError, match=said):
        BRIDGE.cv2_to_imgmsg(picture, encoding)


def test_wrong_messages() -> None:
    image = message_class("sensor_msgs/Image")
    with pytest.raises(CvBridgeError, match="says 4x4 mono8 with 4 bytes per row, but holds 3"):
        BRIDGE.imgmsg_to_cv2(image(height=4, width=4, encoding="mono8", step=4, data=b"123"))
    with pytest.raises(CvBridgeError, match="has no pixels"):
        BRIDGE.imgmsg_to_cv2(image(encoding="mono8"), "bgr8")
    with pytest.raises(
        CvBridgeError, match="takes a sensor_msgs/Image, not sensor_msgs/Compressed"
    ):
        BRIDGE.imgmsg_to_cv2(message_class("sensor_msgs/CompressedImage")())


def test_compressed_pictures() -> None:
    message = BRIDGE.cv2_to_compressed_imgmsg(PICTURE, "png")
    assert message.format == "png"
    np.testing.assert_array_equal(BRIDGE.compressed_imgmsg_to_cv2(message), PICTURE)
    np.testing.assert_array_equal(
        BRIDGE.compressed_imgmsg_to_cv2(message, "rgb8"), PICTURE[..., ::-1]
    )
    gray = BRIDGE.cv2_to_compressed_imgmsg(GRAY, "png")
    assert BRIDGE.compressed_imgmsg_to_cv2(gray).shape == GRAY.shape
    assert BRIDGE.compressed_imgmsg_to_cv2(gray, "bgr8").shape == PICTURE.shape
    message.data = message.data[:20]
    with pytest.raises(CvBridgeError, match="the 20 bytes of format 'png' are no picture"):
        BRIDGE.compressed_imgmsg_to_cv2(message)
    with pytest.raises(CvBridgeError, match="unknown format 'gif'"):
        BRIDGE.cv2_to_compressed_imgmsg(PICTURE, "gif")
