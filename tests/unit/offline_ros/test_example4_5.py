"""Example 4.5's node on a flat object whose corners are known."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from rosbags.rosbag1 import Writer
from synthetic_bag import START_NS

from course_lib.offline_ros import NodeError, run_node
from course_lib.offline_ros.messages import STORE, message_class
from course_lib.offline_ros.modules.cv_bridge import CvBridge
from course_lib.offline_ros.wire import serialize

NODE = Path(__file__).parents[3] / "solutions" / "unit4" / "src" / "example4_5.py"
SIZE = (640, 480)


def texture(height: int, width: int, seed: int) -> np.ndarray:
    """Overlapping rectangles: many corners, none like another."""
    rng = np.random.default_rng(seed)
    picture = np.full((height, width, 3), 128, np.uint8)
    for _ in range(500):
        x, y, s = rng.integers(0, width), rng.integers(0, height), rng.integers(4, 26)
        colour = [int(c) for c in rng.integers(0, 256, 3)]
        cv2.rectangle(picture, (int(x), int(y)), (int(x + s), int(y + s // 2)), colour, -1)
    return picture


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path, list[np.ndarray | None]]:
    """A bag, a template, and per frame the object's corners (None: not there)."""
    folder = tmp_path_factory.mktemp("example")
    template, background = texture(200, 240, 1), texture(SIZE[1], SIZE[0], 2)
    cv2.imwrite(str(folder / "object.png"), template)
    outline = np.float32([[0, 0], [0, 199], [239, 199], [239, 0]])
    frames: list[np.ndarray] = []
    truth: list[np.ndarray | None] = []
    for angle in (0.0, 0.3, 0.6):
        c, s = 1.1 * np.cos(angle), 1.1 * np.sin(angle)
        homography = np.array([[c, -s, 250], [s, c, 120], [2e-4, 1e-4, 1]])
        mask = cv2.warpPerspective(np.full((200, 240), 255, np.uint8), homography, SIZE)
        picture = background.copy()
        picture[mask > 127] = cv2.warpPerspective(template, homography, SIZE)[mask > 127]
        frames.append(picture)
        truth.append(cv2.perspectiveTransform(outline[:, None], homography)[:, 0])
    frames += [background, np.full((SIZE[1], SIZE[0], 3), 200, np.uint8)]  # absent; nothing at all
    truth += [None, None]
    with Writer(folder / "scene.bag") as writer:
        connection = writer.add_connection(
            "/camera/rgb/image_raw/compressed", "sensor_msgs/msg/CompressedImage", typestore=STORE
        )
        for index, picture in enumerate(frames):
            stamp = START_NS + index * 50_000_000
            message = message_class("sensor_msgs/CompressedImage")(
                format="rgb8; jpeg compressed bgr8", data=cv2.imencode(".jpg", picture)[1].tobytes()
            )
            message.header.stamp.set(*divmod(stamp, 10**9))
            message.header.frame_id = "camera"
            writer.write(connection, stamp, serialize(message))
    return folder / "scene.bag", folder / "object.png", truth


def test_finds_the_object_and_says_when_it_is_not_there(
    scene: tuple[Path, Path, list[np.ndarray | None]],
) -> None:
    bag, template, truth = scene
    recording = run_node(NODE, bag=bag, params={"template": str(template)})
    corners, images = recording["/object/corners"], recording["/object/image"]
    inliers = [message.data for _, message in recording["/object/inliers"]]
    assert len(corners) == len(images) == len(inliers) == len(truth)
    assert [count >= 10 for count in inliers] == [expected is not None for expected in truth]
    for (stamp, polygon), (_, image), expected in zip(corners, images, truth, strict=True):
        assert polygon.header.stamp.to_nsec() == stamp == image.header.stamp.to_nsec()
        assert polygon.header.frame_id == "camera"
        found = np.array([(p.x, p.y) for p in polygon.polygon.points])
        green = (CvBridge().imgmsg_to_cv2(image, "bgr8") == (0, 255, 0)).all(axis=2)
        if expected is None:
            assert len(found) == 0
            assert green.sum() < 50
        else:
            np.testing.assert_allclose(found, expected, atol=2.0)
            assert all(green[y, x] for x, y in np.rint(found).astype(int))


def test_match_count_is_obeyed(scene: tuple[Path, Path, list[np.ndarray | None]]) -> None:
    bag, template, _ = scene
    recording = run_node(NODE, bag=bag, params={"template": str(template), "match_count": 6})
    # Ten points must agree on the homography: six never do.
    assert all(not m.polygon.points for _, m in recording["/object/corners"])


def test_template_beside_the_working_folder(
    scene: tuple[Path, Path, list[np.ndarray | None]], monkeypatch: pytest.MonkeyPatch
) -> None:
    bag, template, _ = scene
    monkeypatch.chdir(template.parent)
    recording = run_node(NODE, bag=bag, params={"template": template.name}, max_frames=1)
    assert len(recording["/object/corners"][0][1].polygon.points) == 4
    with pytest.raises(NodeError, match=r"no file 'none\.png'"):
        run_node(NODE, bag=bag, params={"template": "none.png"})


def test_needs_nothing_of_ours() -> None:
    assert "course_lib" not in NODE.read_text()
    assert NODE.stat().st_mode & 0o111
