"""Exercise 4.2's ROS package: complete, and both nodes do their work on a held-out flight."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from course_lib.grading.drawn import drawn_share
from course_lib.grading.pictures import picture_in
from course_lib.grading.ros_package import FaultError, Package, what_went_wrong
from course_lib.grading.rubric import points
from course_lib.grading.waterhole import FINDS, Waterhole, judge

EXERCISE = "4.2"
FIRST, SECOND = "exercise4_2_1", "exercise4_2_2"
CORNERS, PICTURE = "/waterhole/corners", "/waterhole/image"
POLYGONS = ("geometry_msgs/PolygonStamped", "geometry_msgs/Polygon")
PICTURES = ("sensor_msgs/Image", "sensor_msgs/CompressedImage")
FRAME_NS = 100_000_000
# For a node that lets the drone fly for a while first.
SLOWLY_NS = 500_000_000
# Mean difference in grey levels: between a picture and itself as JPEG under 3; others 20 and more.
SAME_PICTURE = 8.0
OUTLINED = 0.0015  # of the pixels, at least
CROP_FIRST = (
    "The node finds nothing. It looks for what crop_waterhole cut out, which is not the waterhole: "
    "put that right first, and save the template anew."
)

UNREADABLE = (
    f"The pictures on {PICTURE} cannot be read: publish bgr8, with the height and width that its "
    'data have, as bridge.cv2_to_imgmsg(picture, "bgr8") does.'
)


@points(1.5, "4.2.7", "The package is complete: package.xml, CMakeLists.txt, launch files, nodes")
def test_package(student, grade):
    """Parsed, not executed. A launch file's node exists, may be executed, and has a name."""
    package = Package(student)
    _ask(grade, 0.25, package.check_manifest)
    _ask(grade, 0.15, package.check_cmake)
    for stem in (FIRST, SECOND):
        _ask(grade, 0.2, package.check_launch, stem)
        _ask(grade, 0.1, package.check_node, stem)


def _ask(grade, out_of, check, *arguments):
    try:
        check(*arguments)
    except FaultError as fault:
        grade.add(fault.left, out_of=out_of, message=str(fault))
    else:
        grade.add(1.0, out_of=out_of)


# The second node comes first: the other may save its picture over the template.
@points(2.5, "4.2.9", "exercise4_2_2.py finds the waterhole in the stream, and publishes it")
def test_second_node(student, grade, seeds):
    """On a flight it has not seen: the corners, none without a waterhole, the outlined picture."""
    hole, package = Waterhole(student, seeds), Package(student)
    frames = sorted([*hole.judged, *hole.absent], key=lambda frame: frame.stamp_ns)
    home = replace(hole.home, stamp_ns=frames[-1].stamp_ns + FRAME_NS)
    frames.append(home)
    run = _run(
        grade, package, SECOND, [(frame.stamp_ns, frame.image) for frame in frames], _has_corners
    )
    if not run.counts.get(CORNERS) and not run.counts.get(PICTURE):
        _fail_as_silent(grade, package, run)
    template, rect = _template(package, hole)
    published = _by_frame(run.topics.get(CORNERS, []), frames)
    _say_what_is_published(grade, run, CORNERS, POLYGONS)
    judge(
        grade,
        hole.judged,
        lambda frame: published.get(frame.stamp_ns),
        lambda frame: hole.expected(frame, rect),
        template.shape,
        home=home,
        out_of=1.5,
        nothing=hole.finds_nothing() if hole.crop.usable else CROP_FIRST,
    )
    finds = grade.fraction >= FINDS
    silent = [published.get(frame.stamp_ns) is None for frame in hole.absent]
    grade.add(
        float(np.mean(silent)) if finds else 0.0,
        out_of=0.5,
        message=None
        if all(silent) or not finds
        else "Corners are published for frames without a waterhole. Publish a polygon without "
        "points there, or nothing.",
    )
    pictures = _by_frame(run.topics.get(PICTURE, []), frames)
    _say_what_is_published(grade, run, PICTURE, PICTURES)
    _judge_pictures(grade, pictures, {f.stamp_ns: f.image for f in frames}, published)
    error = what_went_wrong(run)
    if error:  # in a callback, it may cost nothing but this picture
        grade.note(f"{SECOND}.py: {error}")


@points(1, "4.2.8", "exercise4_2_1.py takes a picture from the stream and saves it")
def test_first_node(student, grade, seeds):
    """The picture is one of the frames that came."""
    hole, package = Waterhole(student, seeds), Package(student)
    frames = [
        (hole.judged[0].stamp_ns + number * SLOWLY_NS, frame.image)
        for number, frame in enumerate(hole.judged)
    ]
    run = _run(grade, package, FIRST, frames, lambda run: bool(run.files))
    error = what_went_wrong(run)
    if not run.files:
        for sentence in package.why_silent(FIRST):
            grade.note(sentence)
    grade.check(
        run.files,
        f"{FIRST}.py saved no picture"
        + (f": {error}" if error else ". Wait for one message, convert it, cv2.imwrite it. Is the ")
        + ("" if error else "file's folder one that exists wherever the node runs?"),
    )
    saved = [picture for data in run.files.values() for picture in picture_in(data)]
    faults = [_not_a_frame(picture, [frame for _, frame in frames]) for picture in saved]
    if not saved or None not in faults:
        grade.fail(next(iter(faults), "The file that was saved is no picture."))
    grade.add(1.0 if not run.error else 0.75, message=f"{FIRST}.py: {error}" if run.error else None)


def _run(grade, package, stem, frames, did):
    try:
        return package.run(stem, frames, did)
    except FaultError as fault:
        return grade.fail(str(fault))


def _has_corners(run):
    return any(_outline(value) is not None for _, value in run.topics.get(CORNERS, []))


def _by_frame(messages, frames):
    """Return what was published for each frame, by the frame's stamp; the last counts."""
    stamps = np.array([frame.stamp_ns for frame in frames])
    found = {}
    for stamp, value in messages:
        nearest = int(np.argmin([abs(int(each) - stamp) for each in stamps]))
        if abs(int(stamps[nearest]) - stamp) < FRAME_NS // 2:
            found[int(stamps[nearest])] = _outline(value)
    if not found and len(messages) == len(frames):  # without stamps, but one for each
        found = {int(s): _outline(v) for s, (_, v) in zip(stamps, messages, strict=True)}
    return found


def _outline(value):
    """Return None for a polygon without points; a closed one without its last point."""
    if isinstance(value, np.ndarray) and value.size == 0:
        return None
    if isinstance(value, np.ndarray) and value.shape == (5, 2) and np.allclose(value[0], value[4]):
        return value[:4]
    return value


def _fail_as_silent(grade, package, run):
    error = what_went_wrong(run)
    for sentence in package.why_silent(SECOND):
        grade.note(sentence)
    if error:
        grade.note(f"{SECOND}.py: {error}")
    elif said := run.log.strip().splitlines():
        grade.note(f"The last that {SECOND}.py said: {said[-1][:300]}")
    grade.fail(f"{SECOND}.py published nothing on {CORNERS} and {PICTURE}{_instead(run)}.")


def _say_what_is_published(grade, run, topic, kinds):
    if not run.counts.get(topic):
        grade.note(f"{SECOND}.py published nothing on {topic}{_instead(run)}.")
    elif (kind := run.types.get(topic)) not in kinds:
        grade.note(f"On {topic}, publish {kinds[0]}, not {kind}.")
    elif topic == CORNERS and topic in run.unstamped:
        grade.note(
            f"The messages on {topic} have no stamp. Give them the frame's own header: whoever "
            "listens wants to know when the waterhole was there."
        )


def _instead(run):
    known = {"/rosout", CORNERS, PICTURE}
    others = sorted(name for name, count in run.counts.items() if count and name not in known)
    return f", but on {', '.join(others)}" if others else ""


def _template(package, hole):
    """Return the picture that the node looks for, and where in the published frame it is."""
    for data in package.pictures():
        for picture in picture_in(data):
            rect = hole.rect_of(picture)
            if rect and rect[2:] != (640, 480):
                return picture, rect
    return hole.template, hole.rect


def _judge_pictures(grade, pictures, frames, corners):
    outlined = {stamp: picture for stamp, picture in pictures.items() if picture is not None}
    shown = [stamp for stamp in outlined if corners.get(stamp) is not None]
    if not shown:
        grade.add(0.0, out_of=0.5, message=UNREADABLE if pictures and not outlined else None)
        return
    faults = [_not_outlined(outlined[stamp], frames[stamp]) for stamp in shown]
    grade.add(faults.count(None) / len(faults), out_of=0.5, message=max(faults, key=bool))


def _not_outlined(picture, frame):
    if not isinstance(picture, np.ndarray) or picture.dtype != np.uint8:
        return f"On {PICTURE}, publish sensor_msgs/Image, bgr8."
    if picture.shape != frame.shape:
        return f"The picture on {PICTURE} should have the frame's size, in colour."
    height, width = frame.shape[:2]
    # drawn_share allows for red and blue exchanged; here it matters.
    if _difference(picture, frame) > 2 * SAME_PICTURE:
        return f"The picture on {PICTURE} is not the frame. Are red and blue exchanged?"
    if drawn_share(picture, (0, 0, width, height), frame) < OUTLINED:
        return f"There is no outline in the picture on {PICTURE}."
    return None


def _not_a_frame(picture, frames):
    if picture.shape != frames[0].shape:
        return "The saved picture should be as large as the camera's, in colour."
    if min(_difference(picture, frame) for frame in frames) <= SAME_PICTURE:
        return None
    if min(_difference(picture[..., ::-1], frame) for frame in frames) <= SAME_PICTURE:
        return "Red and blue are exchanged in the saved picture: convert the message to bgr8."
    if np.ptp(picture.astype(np.int16), axis=2).max() <= 2:
        return "The saved picture is grey. Convert the message to bgr8."
    return "The saved picture is none of those that came on the camera's topic."


def _difference(a, b):
    return float(np.abs(a.astype(np.int16) - b).mean())
