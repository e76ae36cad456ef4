"""What is written for students, instructor and class, and what must not stand in it."""

from __future__ import annotations

import dataclasses
import json
import os
import re
import time
import tracemalloc
from html.parser import HTMLParser
from urllib.parse import unquote

import numpy as np
import pytest
from demo_class import ABSENT, DIED, INVERSE, demo_class, hostile, mixed, png, result

from course_lib.grading import atomic, report
from course_lib.grading.results import Picture
from course_lib.grading.rubric import Grade
from course_lib.grading.summary import Summary, summaries


class Outline(HTMLParser):
    """A page's elements, and the text of each heading and test."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data):
        self.words.append(data)

    @property
    def text(self):
        return re.sub(r"\s+", " ", "".join(self.words))

    def all(self, tag):
        return [attributes for name, attributes in self.tags if name == tag]


def written(made, out):
    folder = report.student_folder(out, made.student)
    report.write_student(made, folder)
    return folder


def page(folder, name="report.html"):
    return Outline((folder / name).read_text("utf-8"))


@pytest.fixture(scope="module")
def class_folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("class")
    for made in demo_class():
        written(made, out)
    report.write_class(out)
    return out


def test_results_are_in_gradescopes_format(tmp_path):
    made = mixed()
    content = json.loads((written(made, tmp_path) / "results.json").read_text())
    assert content["score"] == pytest.approx(made.score)
    assert content["output_format"] == "text"
    assert content["visibility"] == "visible"
    assert [test["number"] for test in content["tests"]] == [test.number for test in made.tests]
    for told, test in zip(content["tests"], made.tests, strict=True):
        assert (told["name"], told["max_score"], told["output"]) == (
            test.name,
            test.max_score,
            test.output,
        )
        assert told["score"] == pytest.approx(test.score)
        assert told["status"] == ("passed" if test.status == "passed" else "failed")
    assert content["extra_data"]["events"] == list(made.events)
    assert content["extra_data"]["status"] == "partly checked"


def test_a_result_is_read_as_it_was_written(tmp_path):
    made = dataclasses.replace(mixed(), code={"4.1": frozenset({1, 2**32 - 1}), "4.2": frozenset()})
    read = report.read_summary(written(made, tmp_path))
    assert read.student == made.student
    for found, test in zip(read.tests, made.tests, strict=True):
        assert dataclasses.replace(found, score=0) == dataclasses.replace(test, score=0)
        assert found.score == pytest.approx(test.score)
    assert read.score == pytest.approx(made.score)
    assert (read.notes, read.events, read.fingerprint) == (
        made.notes,
        made.events,
        made.fingerprint,
    )
    assert read.code == made.code


def test_the_code_may_be_given_apart(tmp_path):
    folder = report.student_folder(tmp_path, "zoe")
    report.write_student(result("zoe"), folder, code_fingerprint={"4.1": frozenset({5})})
    assert report.read_summary(folder).code == {"4.1": frozenset({5})}


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b"{}", b"[" * 10**5, b'{"extra_data": 3}'])
def test_a_damaged_result_is_said_to_be_so(tmp_path, content):
    folder = written(mixed(), tmp_path)
    (folder / "results.json").write_bytes(content)
    with pytest.raises(ValueError, match=r"results\.json is damaged"):
        report.read_summary(folder)
    written(result("whole"), tmp_path)
    assert [isinstance(found, Summary) for found in summaries(tmp_path)] == [False, True]
    report.write_class(tmp_path)
    assert "grade them again: Carla Jiménez" in page(tmp_path, "index.html").text


def test_no_result_is_file_not_found(tmp_path):
    with pytest.raises(FileNotFoundError):
        report.read_summary(tmp_path / "nobody")


def test_the_costliest_message_comes_first_and_once(tmp_path):
    text = page(written(mixed(), tmp_path)).text
    assert text.count(INVERSE) == 1
    at = [
        text.index(part)
        for part in (INVERSE, ABSENT, "Your pictures are RGB", DIED, "What is right")
    ]
    assert at == sorted(at)
    before = text[: at[0]]
    assert "Finds the mug in the given scene" in before
    assert "Finds the mug in pictures you have not seen" in before
    assert "Well sorted." in text[at[-1] :]
    assert "The notebook was called Exercise_4_1 (2).ipynb." in text


def test_what_could_not_be_checked_comes_first_when_it_costs_most(tmp_path):
    lost = tuple(test.number for test in mixed().tests if test.number.startswith("4.2"))
    text = page(written(result("zoe", {"4.1.1": 0.9}, unchecked=lost), tmp_path)).text
    assert text.index("What could not be checked") < text.index("What to mend")


def test_full_marks_are_praised(tmp_path):
    text = page(written(result(), tmp_path)).text
    assert "Everything that was asked works." in text
    assert "What to mend" not in text


def test_a_students_folder_shows_no_held_out_scene(tmp_path):
    made = mixed()
    folder = written(made, tmp_path)
    assert sorted(path.name for path in folder.iterdir()) == ["report.html", "results.json"]
    everything = b"".join(path.read_bytes() for path in folder.iterdir()).decode()
    shown = page(folder).all("img")
    assert [image["alt"] for image in shown] == [picture.caption for picture in made.pictures]
    theirs = page(tmp_path / "_instructor" / folder.name)
    assert [image["alt"] for image in theirs.all("img")] == [p.caption for p in made.scenes]
    for image in theirs.all("img"):
        assert image["src"] not in everything
        assert image["alt"] not in everything
    assert made.events[0] in theirs.text
    assert made.events[0] not in page(folder).text


def test_a_hidden_test_is_for_the_instructor(tmp_path):
    made = result("zoe", {"4.1.6": 0})
    tests = [dataclasses.replace(t, visibility="hidden", output="secret") for t in made.tests[5:6]]
    made = dataclasses.replace(made, tests=(*made.tests[:5], *tests, *made.tests[6:]))
    folder = written(made, tmp_path)
    assert "secret" not in page(folder).text
    assert "secret" in page(tmp_path / "_instructor" / "zoe").text


@pytest.mark.parametrize(
    "name", ["_instructor", "index.html", "GRADES.csv", ".git", "..", "", "%5F", "é" * 200]
)
def test_every_name_gets_a_folder_of_its_own(tmp_path, name):
    folder = report.student_folder(tmp_path, name)
    assert folder.parent == tmp_path
    assert folder.name.casefold() not in {"_instructor", "index.html", "grades.csv", "..", ""}
    report.write_student(result(name), folder)
    report.write_student(result("another"), report.student_folder(tmp_path, "another"))
    report.write_class(tmp_path)
    assert {one.student for one in summaries(tmp_path)} == {name, "another"}


def test_no_two_names_share_a_folder(tmp_path):
    names = [
        "_a",
        "%5Fa",
        "%255Fa",
        "index.html",
        "%69ndex.html",
        "é" * 200,
        "é" * 201,
        "a/b",
        "%2Fb",
    ]
    assert len({report.student_folder(tmp_path, name) for name in names}) == len(names)


def test_the_instructors_folder_is_never_a_students(tmp_path):
    with pytest.raises(ValueError, match="student_folder"):
        report.write_student(mixed(), tmp_path / "_Instructor")


def test_results_stand_only_when_everything_else_stands(tmp_path, monkeypatch):
    folder = report.student_folder(tmp_path, "zoe")

    def full(path, content):
        if path.parent.parent.name == "_instructor":
            raise OSError(28, "No space left on device")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)

    with monkeypatch.context() as patch:
        patch.setattr(atomic, "write", full)
        with pytest.raises(OSError, match="No space"):
            report.write_student(result("zoe"), folder)
    assert not (folder / "results.json").exists()
    report.write_student(result("zoe"), folder)
    assert report.read_summary(folder).student == "zoe"


def test_a_file_is_replaced_whole_or_not_at_all(tmp_path):
    path = tmp_path / "results.json"
    atomic.write(path, b"old")

    def interrupted():
        with atomic.replacing(path) as file:
            file.write(b"half of the n")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_bytes() == b"old"
    (tmp_path / ".json.part").write_bytes(b"left behind by a killed run, and longer")
    atomic.write(path, b"new")
    assert path.read_bytes() == b"new"
    assert os.listdir(tmp_path) == ["results.json"]  # noqa: PTH208


def test_hostile_text_is_text(tmp_path):
    made = hostile()
    folder = written(made, tmp_path)
    report.write_class(tmp_path)
    pages = {
        "student": folder / "report.html",
        "instructor": tmp_path / "_instructor" / folder.name / "report.html",
        "class": tmp_path / "index.html",
    }
    for name, path in pages.items():
        raw = path.read_text("utf-8")
        found = Outline(raw)
        assert len(found.all("script")) == (name == "class")
        for tag, attributes in found.tags:
            assert tag not in {"iframe", "object", "embed", "form", "base"}
            assert not any(key.startswith("on") for key in attributes), tag
            for key in ("src", "href"):
                assert not (attributes.get(key) or "").lower().startswith(("javascript:", "http"))
        assert not re.search(
            "[\x00-\x08\x0b-\x1f\x7f-\x9f\u200b-\u200f\u202a-\u202e\u2066-\u2069]", raw
        )
        assert "<script>document.title='owned'</script>" in found.text
        assert "{{ 7 * 7 }}" in found.text
        policy = next(m for m in found.all("meta") if m.get("http-equiv"))["content"]
        assert policy.startswith("default-src 'none'; img-src data:;")
        assert "unsafe-eval" not in policy
    # One picture is one; what only begins like a PNG shows nothing but its frame.
    assert all(i["src"].startswith("data:image/png;base64,") for i in page(folder).all("img"))
    assert len(page(folder).all("img")) == 2
    text = page(folder).text
    assert "NaN" not in text
    assert "nan" not in json.loads((folder / "results.json").read_text())["output"]
    # Nonsense in one test takes nothing from the others.
    assert report.read_summary(folder).score == 1.5


def test_a_flood_of_lines_and_letters_is_shortened(tmp_path):
    flood = "x" * 10**6 + "\n" * 10**6
    made = result(
        "zoe", {"4.1.1": 0, "4.1.2": 0}, messages={"4.1.1": flood, "4.1.2": "\n" * 10**6 + "end"}
    )
    made = dataclasses.replace(made, notes=(flood,), events=(flood,))
    folder = written(made, tmp_path)
    assert sum(path.stat().st_size for path in folder.iterdir()) < 100_000


def test_too_many_pictures_are_left_out(tmp_path):
    folder = written(
        dataclasses.replace(result("zoe"), pictures=tuple(Picture("", png(1)) for _ in range(200))),
        tmp_path,
    )
    images = page(folder).all("img")
    assert len(images) == 40
    assert images[0]["alt"] == "Picture 1"


def test_the_class_page_counts_right(class_folder):
    text = page(class_folder, "index.html").text
    made = demo_class()
    assert f"{len(made)} graded" in text
    assert "memory limit of 2 GiB" in text
    assert "Elif Şahin, Kavya Rao, Pedro Alves" in text
    assert "Xaver Huber (not checked)" in text
    bars = page(class_folder, "index.html").all("rect")
    assert len(bars) == 10
    highest = max(float(bar["height"]) for bar in bars)
    assert highest == 150
    shares = [one.score / one.max_score for one in made]
    counts = [int(n) for n in re.findall(r"(\d+) from", text)]
    expected = [sum(min(int(s * 10), 9) == tenth for s in shares) for tenth in range(10)]
    assert counts == expected


def test_the_hardest_test_is_first(class_folder):
    found = json.loads((class_folder / "grades.json").read_text())["students"]
    shares: dict[str, list[float]] = {}
    for student in found:
        for test in student["tests"]:
            if test["status"] != "not_checked":
                shares.setdefault(test["number"], []).append(test["score"] / test["max_score"])
    hardest = sorted(shares, key=lambda number: sum(shares[number]) / len(shares[number]))
    text = page(class_folder, "index.html").text
    told = re.findall(r"4\.[12]\.\d(?=[A-Zae])", text[text.index("Tests, hardest first") :])
    assert told[: len(hardest)] == hardest


def test_every_link_of_the_class_page_leads_somewhere(class_folder):
    links = [a["href"] for a in page(class_folder, "index.html").all("a")]
    assert len(links) >= 2 * len(demo_class())
    for link in links:
        assert (class_folder / unquote(link)).is_file(), link
    theirs = class_folder / "_instructor" / "Carla Jiménez"
    for link in page(theirs).all("a"):
        assert (theirs / unquote(link["href"])).is_file(), link


def test_an_empty_class_has_a_page(tmp_path):
    report.write_class(tmp_path)
    assert "Nothing has been graded yet." in page(tmp_path, "index.html").text


def test_the_class_page_is_the_same_after_a_resume(class_folder, tmp_path):
    for made in reversed(demo_class()):
        written(made, tmp_path)
    written(mixed(), tmp_path)
    report.write_class(tmp_path)
    for name in ("index.html", "grades.csv", "moodle.csv", "grades.json"):
        assert (tmp_path / name).read_bytes() == (class_folder / name).read_bytes()


def test_memory_does_not_grow_with_pictures(tmp_path):
    heavy = tuple(Picture("noise", b"\x89PNG\r\n\x1a\n" + os.urandom(400_000)) for _ in range(4))
    for index in range(30):
        made = result(f"student {index}")
        written(dataclasses.replace(made, pictures=heavy, scenes=heavy), tmp_path)
    report.write_class(tmp_path)  # templates are compiled once
    tracemalloc.start()
    report.write_class(tmp_path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 3 * 1024**2


def test_five_hundred_students(tmp_path):
    for index in range(500):
        made = result(f"student {index:03}", {"4.1.1": (index % 11) / 10})
        written(
            dataclasses.replace(
                made, code={"4.1": frozenset(range(index * 200, index * 200 + 150))}
            ),
            tmp_path,
        )
    started = time.process_time()
    report.write_class(tmp_path)
    assert time.process_time() - started < 15
    assert "500 graded" in page(tmp_path, "index.html").text
    assert (tmp_path / "index.html").stat().st_size < 2_000_000


def test_scenes_that_hidden_tests_keep_are_shown(tmp_path):
    grade = Grade()
    grade.scene("from the side", np.full((40, 60, 3), 90, np.uint8))
    report.write_student(result(scenes=grade.scenes), tmp_path / "one")
    (page,) = tmp_path.glob("_instructor/*/report.html")
    assert page.read_text().count("data:image/jpeg;base64,") == 1
    assert 'width="60"' in page.read_text()
