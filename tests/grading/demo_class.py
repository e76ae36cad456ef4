"""A made-up class: what reports look like, and the worst that a submission can put into them."""

from __future__ import annotations

import cv2
import numpy as np

from course_lib.grading.results import Picture, SubmissionResult, TestResult

TESTS = [
    ("4.1.1", "Loads both pictures in the right size and colours", 1),
    ("4.1.2", "Finds keypoints, with a descriptor for each", 1),
    ("4.1.3", "Matches are cross-checked, the best first", 1.5),
    ("4.1.4", "Finds the mug in the given scene", 1),
    ("4.1.5", "Finds the mug in pictures you have not seen", 3),
    ("4.1.6", "Says so when the mug is not there", 1),
    ("4.1.7", "Draws the keypoints, the matches and the outline", 1.5),
    ("4.2.1", "The crop holds the waterhole and little else", 1),
    ("4.2.2", "Finds the waterhole in a flight you have not seen", 2),
    ("4.2.3", "Works with few matches and with many", 1),
    ("4.2.4", "Chooses a match count that serves other frames too", 1),
    ("4.2.5", "The package and its launch files are complete", 1.5),
    ("4.2.6", "exercise4_2_1.py saves a picture of the stream", 1),
    ("4.2.7", "exercise4_2_2.py publishes outline and corners", 2.5),
]
NAMES = [
    *("Amara Okafor", "Bao Nguyen", "Carla Jiménez", "Dmitri Volkov", "Elif Şahin", "Finn Larsen"),
    *("Grace Mbeki", "Hiro Tanaka", "Inês Carvalho", "Jonas Weber", "Kavya Rao", "Liam O'Brien"),
    *("Mei Chen", "Noor Haddad", "Olga Nowak", "Pedro Alves", "Qiana Brooks", "Rosa Moretti"),
    *(
        "Sven Lindqvist",
        "Tariq Aziz",
        "Uma Patel",
        "Viktor Horváth",
        "Wanjiru Kamau",
        "Zoë de Vries",
    ),
]
INVERSE = (
    "Your homography goes the wrong way round, from the scene to the template. findHomography "
    "takes the template's points first, then the scene's. With match(template, scene), queryIdx "
    "belongs to the template's keypoints and trainIdx to the scene's."
)
ABSENT = (
    "Your function returned an outline, but the mug is not in this scene. A homography can be "
    "fitted to any four matches: count the inliers in findHomography's mask, and return None when "
    "only a few agree."
)
DIED = "The kernel had died before this could be asked: the notebook used more memory than 2 GiB."
RAISED = "NameError: name 'orb' is not defined\n(your function locate_mug, line 3)"
NEAR = (
    "Your outline is at the right place, but not exactly. Sort the matches by distance before you "
    "take the best, give findHomography cv2.RANSAC and a threshold of about 5 pixels."
)
COLOURS = {"4.1.1": "Your pictures are RGB. Keep what cv2.imread returns, BGR, to the end."}


def png(seed: int, size: tuple[int, int] = (300, 200)) -> bytes:
    """Make a picture that is not flat."""
    rng = np.random.default_rng(seed)
    coarse = rng.integers(60, 230, (6, 8, 3), dtype=np.uint8)
    picture = cv2.resize(coarse, size, interpolation=cv2.INTER_CUBIC)
    corners = np.int32([[60, 40], [70, 160], [210, 150], [200, 50]])
    cv2.polylines(picture, [corners], isClosed=True, color=(0, 200, 0), thickness=3)
    done, encoded = cv2.imencode(".png", picture)
    assert done
    return encoded.tobytes()


def result(
    student: str = "Zoë de Vries",
    shares: dict[str, float] | None = None,
    *,
    unchecked: tuple[str, ...] = (),
    messages: dict[str, str] | None = None,
    **more: object,
) -> SubmissionResult:
    """Make a result; tests that `shares` does not name have all points."""
    tests = []
    for number, name, most in TESTS:
        share = (shares or {}).get(number, 1.0)
        status = "passed" if share == 1 else "partial" if share else "failed"
        said = (messages or {}).get(number, "" if share == 1 else NEAR)
        if number in unchecked:
            share, status, said = 0.0, "not_checked", DIED
        tests.append(TestResult(name, number, share * most, most, said, status, seconds=0.4))
    return SubmissionResult(student, tuple(tests), seconds=1.27, **more)


def mixed() -> SubmissionResult:
    """Make the result of an honest student with some mistakes."""
    swapped = dict.fromkeys(("4.1.4", "4.1.5"), INVERSE)
    captions = ("Keypoints of the mug", "Matches between mug and scene", "The mug in the scene")
    return result(
        "Carla Jiménez",
        {"4.1.1": 0.5, "4.1.4": 0, "4.1.5": 0.35, "4.1.6": 0, "4.2.2": 0.82},
        unchecked=("4.2.7",),
        messages={**COLOURS, **swapped, "4.1.6": ABSENT, "4.1.3": "Well sorted."},
        notes=(
            "The notebook was called Exercise_4_1 (2).ipynb.",
            "A cell stood twice; the last was used.",
        ),
        events=("Tried to open a network connection to 192.0.2.7 port 443.",),
        pictures=tuple(Picture(caption, png(i)) for i, caption in enumerate(captions)),
        scenes=tuple(
            Picture(f"{kind}: found outline off by {off} px", png(50 + i))
            for i, (kind, off) in enumerate({"rotation": 3.1, "tilt": 84.0, "cover": 5.9}.items())
        ),
        fingerprint="6f1ac09b52d847e3",
    )


def demo_class() -> list[SubmissionResult]:
    """Make a class of 25, of every kind."""
    rng = np.random.default_rng(7)
    hard = {"4.1.5": 0.55, "4.1.6": 0.4, "4.2.2": 0.5, "4.2.4": 0.6, "4.2.7": 0.45}
    copied = frozenset(range(1000, 1100))
    made = [mixed()]
    for index, name in enumerate(n for n in NAMES if n != "Carla Jiménez"):
        skill = rng.beta(4, 1.6)
        shares = {
            number: float(
                np.clip(
                    round(rng.normal(skill + 0.35 - 0.5 * hard.get(number, 0.1), 0.25), 2), 0, 1
                )
            )
            for number, *_ in TESTS
        }
        own = frozenset(rng.integers(10_000, 2**32, 100).tolist())
        more: dict[str, object] = {
            "fingerprint": f"{index:016x}",
            "code": {"4.1": copied if index in {3, 9, 14} else own, "4.2": frozenset(own)},
            "scenes": (Picture("rotation: off by 2 px", png(index)),),
        }
        unchecked: tuple[str, ...] = ()
        if name == "Jonas Weber":
            more["events"] = ("memory limit of 2 GiB", "200 processes were left behind and ended")
            unchecked = tuple(number for number, *_ in TESTS if number.startswith("4.2"))
        if name == "Tariq Aziz":
            more["events"] = ("The zip held a symbolic link; it was left out.",)
            more["notes"] = ("The notebook lay two folders deep.",)
        if name == "Uma Patel":
            shares = {}
        made.append(result(name, shares, unchecked=unchecked, **more))
    empty = "There is no exercise_4_1.ipynb in this submission, nor any notebook like it."
    nothing = [
        TestResult(name, number, 0, most, empty, "not_checked") for number, name, most in TESTS
    ]
    made.append(SubmissionResult("Xaver Huber", tuple(nothing), seconds=0.01))
    return made


ATTACK = (
    "</p></title></style></script><script>document.title='owned'</script>"
    "<img src=x onerror=\"document.title='owned'\"><svg onload=alert(1)>"
    "{{ 7 * 7 }}{% raw %} javascript:alert(1) \x1b[31mred\x1b[0m \x1b]0;title\x07"
    "\u202egnp.exe\u202c \u200b\x00\x08\u2066 &lt;b&gt; ]]> --> \ud800 'quoted' \"double\""
)


def hostile(student: str = "") -> SubmissionResult:
    """Make a result in which a submission has written whatever it could."""
    evil = student or "<script>document.title='owned'<\x2fscript>".replace("/", "")
    tests = (
        TestResult(ATTACK, "4.1.1", 0, 1, ATTACK * 5, "failed"),
        TestResult("n", ATTACK[:60], 0.5, 1, "`" * 50 + "\n" * 5000 + "e\u0301" * 4000, "partial"),
        TestResult("praised", "4.1.3", 1, 1, ATTACK, "passed"),
        TestResult("never reached", "4.2.1", 0, 1, ATTACK, "not_checked"),
        TestResult("nonsense", "4.2.2", float("nan"), 1, ATTACK, "partial"),
    )
    caption = '" onerror="document.title=\'owned\'" x="' + ATTACK
    fake = b"\x89PNG\r\n\x1a\n" + b"<script>document.title='owned'</script>" * 3
    pictures = (Picture(caption, png(1)), Picture(caption, fake), Picture("not one", b"<svg/>"))
    return SubmissionResult(
        evil,
        tests,
        notes=(ATTACK,),
        events=(ATTACK, "=HYPERLINK(1)"),
        pictures=pictures,
        scenes=pictures,
        code={"4.1": frozenset(range(50))},
        fingerprint=ATTACK,
        seconds=float("inf"),
    )
