"""What the hidden tests of Exercise 4.2 share: the held-out flight, and the student's own crop."""

from __future__ import annotations

from contextlib import suppress
from functools import cache
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from course_lib import images
from course_lib.grading import published_flight
from course_lib.grading.answers import Answers
from course_lib.grading.crops import Crop, find_crop, judge_crop
from course_lib.grading.geometry import diagnose, expected_outline, well_credit
from course_lib.grading.mistake_texts import MESSAGES
from course_lib.grading.replies import StudentError
from course_lib.grading.thresholds import WELL_ENOUGH
from course_lib.scenes import HeldOutFrame, flight

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from numpy.typing import NDArray

    from course_lib._validate import Image
    from course_lib.grading.rubric import Grade
    from course_lib.grading.seeds import Seeds
    from course_lib.grading.student import Student

    Rect = tuple[int, int, int, int]

MATCH_COUNT = 60
N_FRAMES = 20  # of the flight; of these are
N_JUDGED, N_SEARCHED, N_ABSENT = 8, 3, 3
FINDS = 0.4  # of the credit: who finds less says nothing by saying "not there"
OTHER_TEMPLATE = (
    "Your crop could not serve as the template, so the waterhole of Example 4.5 was used."
)
_LEAST_SIDE = 24  # pixels
_CROPS: WeakKeyDictionary[Student, tuple[Crop, Image]] = WeakKeyDictionary()


class Waterhole:
    """One submission and one held-out flight.

    Parameters
    ----------
    student : Student
        The submission's proxy.
    seeds : Seeds
        Numbers from the instructor's secret.

    Attributes
    ----------
    judged, searched, absent : list of HeldOutFrame
        Frames in which the whole well is, by which answers are judged; others, to choose a match
        count with; frames in which no well is.
    """

    def __init__(self, student: Student, seeds: Seeds) -> None:
        self.student = student
        self.answers = Answers(student)
        frames = flight(seeds("flight"), n_frames=N_FRAMES).frames
        whole = [each for each in frames if each.whole]
        self.judged = _some(whole[::2], N_JUDGED)
        self.searched = _some(whole[1::2], N_SEARCHED)
        self.absent = _some([each for each in frames if each.polygon is None], N_ABSENT)

    @property
    def crop(self) -> Crop:
        """The student's crop, judged; an error of theirs makes it one without credit."""
        return self._crop[0]

    @property
    def template(self) -> Image:
        """The student's crop where it is usable, else Example 4.5's; always the same object."""
        return self._crop[1]

    @property
    def rect(self) -> Rect:
        """Where the template was cut from the published frame."""
        return self.crop.rect if self.crop.usable and self.crop.rect else _published()[1]

    @property
    def _crop(self) -> tuple[Crop, Image]:
        if self.student not in _CROPS:
            frame, silhouette = _there()
            try:
                found = self.answers.ask("crop_waterhole", frame)
                crop = judge_crop(found, frame, silhouette)
            except StudentError as error:
                found, crop = None, Crop(message=str(error))
            own = isinstance(found, np.ndarray) and crop.usable
            _CROPS[self.student] = crop, np.asarray(found) if own else _published()[0]
        return _CROPS[self.student]

    @property
    def drawn_on(self) -> Image:
        """What the student's pictures may show: the crop, be it a good one or not."""
        try:
            found = self.answers.ask("crop_waterhole", _there()[0])
        except StudentError:
            return self.template
        if not isinstance(found, np.ndarray) or found.dtype != np.uint8 or found.ndim != 3:
            return self.template
        fits = found.shape[2] == 3 and min(found.shape[:2]) >= _LEAST_SIDE
        return found if fits and found.shape != _there()[0].shape else self.template

    @property
    def home(self) -> HeldOutFrame:
        """The frame that templates are cut from; there, it is known exactly what is right."""
        frame, silhouette = _there()
        return HeldOutFrame(frame, 0, silhouette.astype(np.float32), 1.0, whole=True)

    def rect_of(self, template: Image) -> Rect | None:
        """Return where a template was cut from the published frame, None if it was not."""
        return find_crop(template, _there()[0])

    def expected(self, frame: HeldOutFrame, rect: Rect | None = None) -> NDArray[np.float64] | None:
        """Return where a template's outline belongs in a frame; None where the well is not."""
        if frame.polygon is None:
            return None
        return expected_outline(rect or self.rect, _there()[1], frame.polygon)

    def locate(self, frame: HeldOutFrame, match_count: int = MATCH_COUNT) -> object:
        """Return what the submission finds in a frame.

        Raises
        ------
        StudentError
            What went wrong in the submission.
        """
        return self.answers.locate_waterhole(self.template, frame.image, match_count)

    def quality(self, match_count: int) -> float:
        """Return the mean credit over the judged frames; an error counts as not found."""
        return float(np.mean([self._credit(frame, match_count) for frame in self.judged]))

    def finds(self) -> bool:
        """Tell whether the submission finds the well where it is, now and then at least."""
        return self.quality(MATCH_COUNT) >= FINDS

    def finds_nothing(self) -> str | None:
        """Say so of a submission that returns None even for the template's own picture.

        There no match can be bad: it is what is done with the result.
        """
        pictures = [*(frame.image for frame in self.judged), self.template]
        with suppress(StudentError):
            find = self.answers.locate_waterhole
            if all(find(self.template, each, MATCH_COUNT) is None for each in pictures):
                return MESSAGES["never"].format(thing="waterhole")
        return None

    def _credit(self, frame: HeldOutFrame, match_count: int) -> float:
        try:
            found = self.locate(frame, match_count)
        except StudentError:
            return 0.0
        return well_credit(found, self.expected(frame))


def judge(
    grade: Grade,
    frames: Sequence[HeldOutFrame],
    find: Callable[[HeldOutFrame], object],
    expected: Callable[[HeldOutFrame], NDArray[np.float64] | None],
    size: Iterable[int],
    *,
    home: HeldOutFrame,
    out_of: float = 1.0,
    nothing: str | None = None,
) -> None:
    """Give credit for outlines in frames that show the well; not every one need be right.

    Parameters
    ----------
    grade : Grade
    frames : sequence of HeldOutFrame
    find : callable
        Gives what was found in a frame, or raises `StudentError`.
    expected : callable
        Gives what is right.
    size : (height, width, …)
        The template's shape.
    home : HeldOutFrame
        The frame that the template was cut from. A mistake is told there, where the well's being
        no plane does not blur it.
    out_of : float, optional
        The weight of it all.
    nothing : str, optional
        What to say instead where nothing is found at all.
    """
    reached, messages = 0.0, []
    for frame in frames:
        right = expected(frame)
        try:
            found = find(frame)
        except StudentError as error:
            messages.append(str(error))
            continue
        fraction = well_credit(found, right)
        reached += fraction
        if fraction < 1:
            messages += _said(found, right, size, frame)
    fraction = min(1.0, reached / len(frames) / WELL_ENOUGH)
    grade.add(fraction, out_of=out_of)
    if fraction < 1:
        with suppress(StudentError):
            at_home = find(home)
            messages = _said(at_home, expected(home), size, home) or messages
            if nothing and at_home is None:
                messages = [nothing]
        for message in messages:
            grade.note(message)


def _said(
    found: object, right: NDArray[np.float64] | None, size: Iterable[int], frame: HeldOutFrame
) -> list[str]:
    said = diagnose(found, right, tuple(size), frame.image.shape, thing="waterhole")
    return [said] if said else []


@cache
def _there() -> tuple[Image, NDArray[np.float64]]:
    """Return the published frame, and the well in it."""
    number = images.truth(published_flight.FLIGHT)["template"]["frame"]
    return published_flight.frame(number), published_flight.silhouette(number)


@cache
def _published() -> tuple[Image, Rect]:
    """Return the waterhole as Example 4.5 cuts it out, and from where."""
    x, y, width, height = images.truth(published_flight.FLIGHT)["template"]["rect"]
    return _there()[0][y : y + height, x : x + width], (x, y, width, height)


def _some(frames: list[HeldOutFrame], count: int) -> list[HeldOutFrame]:
    """Return at most so many frames, spread over all."""
    places = np.linspace(0, len(frames) - 1, min(count, len(frames))).round().astype(int)
    return [frames[place] for place in places]
