import cv2
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scenery import corners_of, other_scene, planar_scene, texture

from course_lib.localize import Detection, TemplateLocator, locate_template

DETECTORS = ["ORB", "SIFT", "AKAZE"]


@pytest.fixture(scope="module")
def planar():
    return planar_scene(3, 0.5)


@pytest.fixture(scope="module")
def template():
    return planar_scene(3, 0.5)[0]


def error(detection, corners):
    return np.abs(detection.corners - corners).max()


@pytest.mark.parametrize("detector", DETECTORS)
def test_finds_the_corners(planar, detector):
    template, scene, corners = planar
    detection = locate_template(template, scene, detector=detector)
    assert detection
    assert detection.found
    assert detection.reason == ""
    assert error(detection, corners) < 3
    assert detection.corners.shape == (4, 2)
    assert detection.corners.dtype == np.float32
    assert detection.homography.dtype == np.float64
    assert np.allclose(corners_of(detection.homography), detection.corners, atol=1e-2)
    assert detection.inliers.shape == (len(detection.matches),)
    assert detection.inliers.dtype == np.bool_
    assert detection.inlier_count >= 7
    assert len(detection.matches) <= 100
    assert "inliers of" in repr(detection)


@pytest.mark.parametrize(
    "method",
    ["RANSAC", "USAC_MAGSAC", "USAC_PROSAC", "USAC_DEFAULT", "LMEDS", "RHO", cv2.USAC_ACCURATE],
)
def test_any_robust_method(planar, method):
    template, scene, corners = planar
    detection = locate_template(template, scene, method=method)
    assert detection
    assert error(detection, corners) < 4


@pytest.mark.parametrize(
    "options",
    [
        {"match_count": None},
        {"match_count": 40},
        {"ratio": 0.8},
        {"ratio": 0.8, "cross_check": False, "match_count": None},
        {"n_features": 400},
        {"ransac_threshold": 3.0},
        {"norm": cv2.NORM_HAMMING},
        {"detector": cv2.ORB.create(1500, WTA_K=4)},
        {"detector": cv2.SIFT.create(500), "norm": cv2.NORM_L1},
        {"seed": 7},
        {"max_iterations": 100, "confidence": 0.9},
    ],
)
def test_options(planar, options):
    template, scene, corners = planar
    detection = locate_template(template, scene, **options)
    assert detection
    assert error(detection, corners) < 5
    count = options.get("match_count", 100)
    assert count is None or len(detection.matches) <= count


def test_all_matches_are_more_than_a_hundred(planar):
    template, scene, _ = planar
    few, every = (locate_template(template, scene, match_count=n) for n in (100, None))
    assert len(every.matches) > len(few.matches) == 100
    distances = [match.distance for match in every.matches]
    assert distances == sorted(distances)


class WithoutAngles:
    """SIFT that withholds its angles: -1 is how OpenCV says that there is none."""

    def __init__(self):
        self.sift = cv2.SIFT.create(600)

    def detectAndCompute(self, image, mask):  # noqa: N802 (OpenCV's name)
        keypoints, descriptors = self.sift.detectAndCompute(image, mask)
        for keypoint in keypoints:
            keypoint.angle = -1
        return keypoints, descriptors


def test_a_detector_of_ones_own_without_angles(planar):
    template, scene, corners = planar
    detection = locate_template(template, scene, detector=WithoutAngles())
    assert detection
    assert error(detection, corners) < 4
    assert not locate_template(template, other_scene(3), detector=WithoutAngles())


def test_recall_is_high_and_not_below_the_usual_loop():
    found = wrong = usual = 0
    for seed in range(40):
        template, scene, corners = planar_scene(seed, 0.5)
        detection = locate_template(template, scene)
        good = bool(detection) and error(detection, corners) < 15
        found += good
        wrong += bool(detection) and not good
        usual += usual_loop_error(template, scene, corners) < 15
    assert found >= 34
    assert found >= usual
    assert wrong == 0


def usual_loop_error(template, scene, corners):
    """The course's own Example 4.5, which always answers."""
    orb = cv2.ORB_create(nfeatures=1000)
    kp0, d0 = orb.detectAndCompute(cv2.cvtColor(template, cv2.COLOR_BGR2GRAY), None)
    kp1, d1 = orb.detectAndCompute(cv2.cvtColor(scene, cv2.COLOR_BGR2GRAY), None)
    matches = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(d0, d1)
    matches = sorted(matches, key=lambda match: match.distance)[:100]
    source = np.float32([kp0[m.queryIdx].pt for m in matches]).reshape(-1, 1, 2)
    target = np.float32([kp1[m.trainIdx].pt for m in matches]).reshape(-1, 1, 2)
    H, _ = cv2.findHomography(source, target, cv2.RANSAC, 5.0)
    return np.inf if H is None else np.abs(corners_of(H) - corners).max()


@pytest.mark.parametrize(
    ("options", "count"),
    [({}, 200), ({"match_count": None}, 60), ({"match_count": 25}, 60), ({"detector": "SIFT"}, 40)],
    ids=str,
)
def test_unrelated_scenes_give_no_detection(options, count):
    templates = [planar_scene(seed)[0] for seed in range(5)]
    locators = [TemplateLocator(template, **options) for template in templates]
    believed = []
    for seed in range(count):
        detection = locators[seed % 5].locate(other_scene(seed))
        assert detection.reason
        if detection:
            believed.append((seed, detection))
    assert believed == []


def test_absent_template_is_a_value(template):
    detection = locate_template(template, other_scene(1))
    assert isinstance(detection, Detection)
    assert not detection
    assert detection.corners is None
    assert detection.homography is None
    assert detection.inliers.shape == (len(detection.matches),)
    assert "not found" in repr(detection)


def test_mirrored_template_is_absent(template):
    assert not locate_template(template, np.ascontiguousarray(template[:, ::-1]))


def test_locator_equals_the_function_on_every_frame(planar):
    template, scene, _ = planar
    stream = TemplateLocator(template)
    once = locate_template(template, scene)
    stream.locate(other_scene(0))
    for _ in range(2):
        again = stream.locate(scene)
        assert np.array_equal(once.corners, again.corners)
        assert np.array_equal(once.inliers, again.inliers)


def test_the_frame_and_the_template_are_left_alone(planar):
    template, scene, _ = (part.copy() for part in planar)
    before = template.copy(), scene.copy()
    locate_template(template, scene)
    assert np.array_equal(template, before[0])
    assert np.array_equal(scene, before[1])


@pytest.mark.parametrize(
    "change",
    [
        lambda image: cv2.cvtColor(image, cv2.COLOR_BGR2GRAY),
        lambda image: cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)[:, :, None],
        lambda image: cv2.cvtColor(image, cv2.COLOR_BGR2BGRA),
        lambda image: image.astype(np.float32) / 255,
        lambda image: image.astype(np.float64),
        np.asfortranarray,
        lambda image: np.repeat(image, 2, axis=1)[:, ::2],
        lambda image: image[:, :, ::-1][:, :, ::-1],
    ],
    ids=["grey", "grey1", "bgra", "float01", "float255", "fortran", "strided", "reversed"],
)
def test_the_same_picture_in_another_form(planar, change):
    template, scene, _ = planar
    plain = locate_template(template, scene)
    assert np.array_equal(plain.corners, locate_template(change(template), scene).corners)
    assert np.array_equal(plain.corners, locate_template(template, change(scene)).corners)


PICTURES = st.one_of(
    hnp.arrays(
        st.sampled_from([np.uint8, np.float32, np.float64, np.bool_, np.uint16, np.int64]),
        hnp.array_shapes(min_dims=1, max_dims=4, min_side=0, max_side=40),
    ),
    st.builds(
        lambda side, value: np.full((side, side + 3, 3), value, np.uint8),
        st.integers(1, 90),
        st.integers(0, 255),
    ),
    st.builds(
        lambda seed, h, w: np.random.default_rng(seed).integers(0, 256, (h, w), dtype=np.uint8),
        st.integers(0, 99),
        st.integers(1, 150),
        st.integers(1, 150),
    ),
    st.sampled_from([None, "box.png", [[1, 2], [3, 4]], np.full((40, 40), np.nan)]),
)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(PICTURES, st.booleans(), st.sampled_from(DETECTORS))
def test_any_input_is_an_answer_or_a_clear_error(picture, as_scene, detector):
    known = texture(np.random.default_rng(0), (120, 100))
    template, scene, name = (known, picture, "scene") if as_scene else (picture, known, "template")
    try:
        detection = locate_template(template, scene, detector=detector)
    except (TypeError, ValueError) as problem:
        assert str(problem).startswith(name)  # noqa: PT017 (either outcome is right)
        return
    if detection:
        assert np.isfinite(detection.corners).all()
        assert cv2.isContourConvex(detection.corners)
    else:
        assert detection.reason


@pytest.mark.parametrize("detector", ["ORB", "SIFT"])
def test_a_huge_scene_is_searched_within_bounded_memory(template, detector):
    rng = np.random.default_rng(0)
    scene = np.full((9000, 12000), 120, np.uint8)
    patch = cv2.cvtColor(template, cv2.COLOR_BGR2GRAY)
    patch = cv2.resize(patch, (1600, 1200), interpolation=cv2.INTER_CUBIC)
    scene[3000:4200, 5000:6600] = patch
    scene[100:900, 100:900] = rng.integers(0, 256, (800, 800), dtype=np.uint8)
    # SIFT's own pyramid of the whole picture would take over 10 GB.
    detection = locate_template(template, scene, detector=detector, max_pixels=3_000_000)
    assert detection
    # Corner pixels' centres: the patch's 4 x 4 pixels stand for one of the template's.
    truth = np.array([[5000, 3000], [5000, 4199], [6599, 4199], [6599, 3000]], float)
    truth += [[1.5, 1.5], [1.5, -1.5], [-1.5, -1.5], [-1.5, 1.5]]
    assert error(detection, truth) < 12


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"match_count": 3}, "match_count must be at least 4"),
        ({"match_count": 10.5}, "match_count must be a whole number"),
        ({"detector": "SURF"}, "unknown detector 'SURF'.*ORB, SIFT, AKAZE"),
        ({"detector": 7}, "detector must be one of"),
        ({"method": "MSAC"}, "unknown method 'MSAC'.*RANSAC"),
        ({"method": 9999}, "unknown method 9999"),
        ({"ransac_threshold": 0}, "ransac_threshold must be positive"),
        ({"ransac_threshold": float("nan")}, "ransac_threshold must be positive"),
        ({"confidence": 1}, "confidence must be between"),
        ({"min_inliers": 2}, "min_inliers must be at least 4"),
        ({"n_features": 0}, "n_features must be at least"),
        ({"seed": -1}, "seed must be at least 0"),
        ({"max_iterations": 0}, "max_iterations must be at least"),
        ({"ratio": 1.5}, "ratio must be"),
    ],
)
def test_wrong_options_are_named(planar, options, message):
    template, scene, _ = planar
    with pytest.raises((ValueError, TypeError), match=message):
        locate_template(template, scene, **options)


def test_options_are_keyword_only(planar):
    template, scene, _ = planar
    with pytest.raises(TypeError):
        locate_template(template, scene, 100)


def test_reasons_tell_what_was_missing(template):
    blank = np.full((200, 300, 3), 90, np.uint8)
    assert "the template has 0" in locate_template(blank, template).reason
    assert "the scene has 0" in locate_template(template, blank).reason
    dots = blank.copy()
    for x in (60, 100, 150, 200, 240):
        cv2.circle(dots, (x, 100), 4, (255, 255, 255), -1)
    assert locate_template(template, dots, detector="SIFT").reason.startswith("too few")
