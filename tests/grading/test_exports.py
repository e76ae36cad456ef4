"""Grades for other programs: every student once, nobody guessed, no formula."""

from __future__ import annotations

import argparse
import csv
import io
import json
import zipfile

import pytest
from demo_class import TESTS, demo_class, hostile, mixed, result

from course_lib.grading import exports, report
from course_lib.grading.results import SubmissionResult, TestResult

CANVAS = """\
Student,ID,SIS User ID,SIS Login ID,Section,Feature matching (77),Quiz (78)
    Points Possible,,,,,20,5
"Jiménez, Carla",4711,s-100,carla@uni.example,A,,4
"Ng, Zoë",4712,s-101,zng@uni.example,A,3,5
"Ng, Bao",4713,s-102,bng@uni.example,B,,
"Smith, Jo",4714,s-103,jo1@uni.example,B,,1
"Smith, Jo",4715,s-104,jo2@uni.example,B,,2
"=Doe, Al",4716,=s-105,al@uni.example,B,,2
"""


def put(out, *made):
    for one in made:
        report.write_student(one, report.student_folder(out, one.student))
    return out


def rows(path):
    return list(csv.reader(io.StringIO(path.read_text("utf-8"), newline="")))


@pytest.fixture
def roster(tmp_path):
    path = tmp_path / "roster.csv"
    path.write_text(CANVAS, "utf-8")
    return path


@pytest.fixture
def out(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    return folder


def filled(out, roster, *students, **options):
    put(out, *(result(name) for name in students))
    table = rows(exports.write(out, "canvas", roster, **options))
    return {row[1]: row[5] for row in table[2:]}


def unmatched(out):
    return (out / "unmatched.txt").read_text("utf-8").splitlines()


def test_grades_hold_every_test(out):
    made = demo_class()
    put(out, *made)
    header, *table = rows(exports.write(out, "csv"))
    assert header == ["student", "total", "max", *(number for number, *_ in TESTS)]
    assert {row[0] for row in table} == {one.student for one in made}
    for row in table:
        assert sum(map(float, row[3:])) == pytest.approx(float(row[1]), abs=0.15)
    carla = next(row for row in table if row[0] == "Carla Jiménez")
    assert carla[1] == "12.69"


def test_test_ten_comes_after_test_nine(out):
    tests = [TestResult("t", f"4.1.{i}", 1, 1, "", "passed") for i in (10, 2, 1, 9)]
    put(out, SubmissionResult("zoe", tuple(tests)))
    assert rows(exports.write(out, "csv"))[0][3:] == ["4.1.1", "4.1.2", "4.1.9", "4.1.10"]


def test_nothing_is_a_formula(out):
    put(out, *(hostile(name) for name in ("=1+1", "+1", "-1", "@SUM(A1)", "＝1", " =1", "\t=1")))
    for format_ in ("csv", "moodle"):
        table = rows(exports.write(out, format_))
        assert len(table) == 8
        for cell in (cell for row in table[1:] for cell in row):
            assert not cell.lstrip().startswith(tuple("=+-@＝")), cell


def test_canvas_keeps_its_columns(out, roster):
    put(out, mixed())
    before = list(csv.reader(io.StringIO(CANVAS)))
    after = rows(exports.write(out, "canvas", roster))
    assert [len(row) for row in after] == [len(row) for row in before]
    before[2][5] = "12.69"
    before[7][0] = "'=Doe, Al"
    assert after == before
    assert unmatched(out) == []


@pytest.mark.parametrize(
    "name",
    [
        *("4712", "s-101", "S-101", "zng@uni.example", "zng", "Zoë Ng", "zoe_ng", "Ng, Zoe"),
        *("ngzoe_4712_90210_exercise_4_1", "ngzoe_LATE_4712_90210", "Zoe_Ng-1a2b3c", "ngzoe"),
    ],
)
def test_a_student_is_found_by_any_name_of_theirs(out, roster, name):
    assert filled(out, roster, name) == {
        "4711": "",
        "4712": "20",
        "4713": "",
        "4714": "",
        "4715": "",
        "4716": "",
    }
    assert unmatched(out) == []


@pytest.mark.parametrize(
    ("names", "why"),
    [
        (["Jo Smith"], "fits 2 students"),
        (["nobody"], "not in the roster"),
        (["ng"], "not in the roster"),
        (["Points Possible"], "not in the roster"),
        (["???"], "not in the roster"),
        (["zng", "Zoë Ng"], "fits the same student as another submission"),
    ],
)
def test_nobody_is_guessed(out, roster, names, why):
    grades = filled(out, roster, *names)
    assert set(grades.values()) == {"", "3"}
    assert len(unmatched(out)) == len(names)
    assert all(line.endswith(f": {why}") for line in unmatched(out))


def test_an_assignment_that_canvas_does_not_know_gets_a_column(out, roster):
    put(out, result("jo2"))
    header, possible, *table = rows(exports.write(out, "canvas", roster, assignment="Unit 4"))
    assert header[-1] == "Unit 4"
    assert possible[-1] == "20"
    assert [row[-1] for row in table] == ["", "", "", "", "20", ""]


@pytest.mark.parametrize(
    "encode",
    [
        lambda text: text.encode("utf-8-sig"),
        lambda text: text.encode("utf-16"),
        lambda text: text.encode("cp1252"),
        lambda text: text.replace('"Ng, Zoë"', "Zoë Ng").replace(",", ";").encode(),
    ],
)
def test_whatever_program_saved_the_roster(out, roster, encode):
    roster.write_bytes(encode(CANVAS))
    assert filled(out, roster, "zoe_ng")["4712"] == "20"


@pytest.mark.parametrize("content", [b"", b"\n\n", b"a,b\n1,2\n", b'"' * 200_000])
def test_what_is_no_roster_is_refused(out, roster, content):
    roster.write_bytes(content)
    with pytest.raises(ValueError, match=r"roster\.csv"):
        exports.write(out, "canvas", roster)


def test_moodle_gets_participants_and_comments(out):
    put(out, mixed(), result("Zoë Ng_1234_assignsubmission_file_"))
    header, carla, zoe = rows(exports.write(out, "moodle"))
    assert header == ["Identifier", "Grade", "Feedback comments"]
    assert carla[:2] == ["Carla Jiménez", "12.69"]
    assert "4.1.6 Says so when the mug is not there (0 of 1): Your function returned" in carla[2]
    assert zoe == ["Participant 1234", "20", "Everything is right."]


def test_moodles_own_worksheet_is_filled_in(out, tmp_path):
    worksheet = tmp_path / "worksheet.csv"
    worksheet.write_text(
        "Identifier,Full name,Email address,Status,Grade,Maximum Grade,Feedback comments\n"
        "Participant 1234,Zoë Ng,zng@uni.example,Submitted,,20,\n"
        "Participant 1235,Bao Ng,bng@uni.example,Submitted,,20,\n",
        "utf-8",
    )
    put(out, result("Zoë Ng_1234_assignsubmission_file_"), hostile("bng"))
    _, zoe, bao = rows(exports.write(out, "moodle", worksheet))
    assert (zoe[4], zoe[6]) == ("20", "Everything is right.")
    assert bao[4] == "1.5"
    assert "<script>" not in bao[6]
    assert "&lt;script&gt;" in bao[6]


def test_gradescope_gets_the_results_as_they_are(out):
    made = demo_class()
    put(out, *made, hostile("half a character \udcff"))
    path = exports.write(out, "gradescope")
    with zipfile.ZipFile(path) as archive:
        assert len(archive.namelist()) == len(made) + 1
        inside = archive.read("Carla Jiménez/results.json")
    assert inside == (out / "Carla Jiménez" / "results.json").read_bytes()
    once = path.read_bytes()
    assert exports.write(out, "gradescope").read_bytes() == once


def test_json_holds_what_programs_want(out):
    put(out, mixed())
    (carla,) = json.loads(exports.write(out, "json").read_text())["students"]
    assert carla["score"] == pytest.approx(mixed().score)
    assert carla["tests"][-1]["status"] == "not_checked"


@pytest.mark.parametrize(
    ("format_", "with_roster", "message"),
    [
        ("xlsx", False, "unknown format"),
        ("canvas", False, "--roster"),
        ("csv", True, "roster is for"),
    ],
)
def test_what_cannot_be_written_is_explained(out, roster, format_, with_roster, message):
    with pytest.raises(ValueError, match=message):
        exports.write(out, format_, roster if with_roster else None)


def test_the_command_writes_and_tells(out, roster, capsys):
    parser = argparse.ArgumentParser()
    exports.add_arguments(parser)
    put(out, result("zng"), result("stranger"))
    args = parser.parse_args([str(out), "--format", "canvas", "--roster", str(roster)])
    assert exports.main(args) == 0
    told = capsys.readouterr()
    assert told.out.strip() == str(out / "canvas.csv")
    assert "stranger: not in the roster" in told.err
    assert exports.main(parser.parse_args([str(out), "--format", "canvas"])) == 1
    assert "export the gradebook" in capsys.readouterr().err
    assert exports.main(parser.parse_args([str(out / "nothing")])) == 1
    assert "not a folder" in capsys.readouterr().err
    missing = parser.parse_args([str(out), "--format", "canvas", "--roster", str(out / "none.csv")])
    assert exports.main(missing) == 1
