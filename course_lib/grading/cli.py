"""The command ``course grade``."""

from __future__ import annotations

import argparse
import os
import re
import signal
import sys
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.grading import seed_file

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import FrameType

    from course_lib.grading.nursery import Nursery
    from course_lib.grading.runner import Backend, Options, Outcome

EXERCISES = ("4.1", "4.2")
TESTS = Path(__file__).resolve().parents[2] / "tests" / "hidden"
_USAGE, _INTERRUPTED = 2, 130
_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_ROS_PROCESSES = 192  # and threads: ROS's own are many
_BYTES = {"": 1, "k": 2**10, "m": 2**20, "g": 2**30, "t": 2**40}

_DESCRIPTION = """\
Grade every submission in a folder: a folder or a zip for each student, with exercise_4_1.ipynb,
exercise_4_2.ipynb and unit4/ in it. Students' code runs in a sandbox and cannot harm this machine,
see the hidden tests, or disturb another submission. Everybody gets a result.
"""
_EPILOG = """\
examples:
  course grade submissions --out grades             a class; open grades/index.html
  course grade submissions --out grades             again: grades what is new or changed
  course grade submissions --out g1 --exercise 4.1  one exercise (a folder of its own)
  course grade submissions --out grades --only zoe --fresh -v
  course grade submissions --out grades --scheduler tcp://10.0.0.5:8786

in DIR:
  index.html, grades.csv              the class (also grades.json, moodle.csv; see course export)
  STUDENT/report.html, results.json   for the student; results.json is in Gradescope's format
  _instructor/STUDENT/report.html     with the held-out scenes; not for students

the secret seed:
  Held-out inputs are made from it, so the same seed gives everybody the same ones. Without
  --seed-file one is made for you, once, and its path is printed. Keep it out of git and out of
  everything that you hand out.

exit status:
  0 every submission has a result, whatever its points; 1 some could not be graded because of the
  grader itself (run again, they are tried anew); 2 wrong usage; 130 interrupted: nothing is lost,
  the same command goes on where it was.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what ``course grade`` understands."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    add = parser.add_argument
    add("submissions", type=Path, metavar="SUBMISSIONS", help="the folder of submissions")
    add("--out", type=Path, required=True, metavar="DIR", help="where results go; made if need be")
    add("--exercise", action="append", choices=EXERCISES, help="grade this one only (both)")
    add("--only", nargs="+", default=(), metavar="STUDENT", help="grade these students only")
    add("--fresh", action="store_true", help="grade unchanged submissions too")
    add("--seed-file", type=Path, metavar="F", help="the secret seed, at least 16 bytes")
    add("--tests", type=Path, default=TESTS, metavar="DIR", help="hidden tests (tests/hidden)")
    add("-v", "--verbose", action="store_true", help="show points and events as they come")
    parser.set_defaults(grade=None)  # no option: see `messages.Settings.grade`
    where = parser.add_argument_group("where it runs")
    add = where.add_argument
    add("--workers", type=_count, metavar="N", help="submissions at a time (one per processor)")
    add(
        "--scheduler",
        metavar="tcp://HOST:PORT",
        help="use this Dask cluster instead of this machine",
    )
    add("--sandbox", choices=("bubblewrap", "sandlock"), help="default: the first that works here")
    add(
        "--no-sandbox",
        action="store_true",
        help="only for code that you trust: it can do whatever you can",
    )
    add(
        "--ros",
        action="store_true",
        help="run the ROS packages on real ROS, by roslaunch (needs bubblewrap; slower)",
    )
    limits = parser.add_argument_group("what a submission may use")
    add = limits.add_argument
    add("--timeout", type=_seconds, metavar="S", help="seconds in all (300)")
    add("--cell-timeout", type=_seconds, metavar="S", help="seconds for one cell (60)")
    add("--call-timeout", type=_seconds, metavar="S", help="seconds for one call of a test (20)")
    add("--memory", type=_bytes, metavar="SIZE", help="memory, such as 1.5G or 800M (2G)")


def main(args: argparse.Namespace) -> int:
    """Run ``course grade``; return the exit status."""
    os.umask(os.umask(0) & 0o077)  # who makes a folder must be able to work in it
    with _interruptible():
        nursery = None
        try:
            # Imported late, so that --help is there at once.
            from course_lib.grading.nursery import Nursery  # noqa: PLC0415

            # It warms up while this process does, too.
            if not args.scheduler:
                nursery = Nursery(nodes="4.2" in (args.exercise or EXERCISES))
            return _run(args, nursery)
        except KeyboardInterrupt:
            note = "interrupted; what was graded is kept. Run the same command again to go on"
            return _fail(note, _INTERRUPTED)
        finally:
            _hear_no_more()
            if nursery:
                nursery.close()


def _run(args: argparse.Namespace, nursery: Nursery | None) -> int:
    from course_lib.grading import lean  # noqa: PLC0415

    lean.import_nbformat()
    from course_lib.grading.cluster import ClusterError  # noqa: PLC0415
    from course_lib.grading.process import WorkerError  # noqa: PLC0415
    from course_lib.grading.progress import Shown  # noqa: PLC0415
    from course_lib.grading.runner import UsageError, grade_class  # noqa: PLC0415
    from course_lib.grading.sandbox import NoSandboxError  # noqa: PLC0415

    try:
        options, backend = _prepare(args, nursery)
        outcome = grade_class(options, backend, Shown(verbose=args.verbose))
    except (UsageError, NoSandboxError, seed_file.SeedFileError, ClusterError) as error:
        return _fail(str(error), _USAGE)
    except WorkerError as error:
        return _fail(f"no worker can start: {error}", 1)
    except OSError as error:
        return _fail(f"{error}. What was graded is kept; run the same command again", 1)
    try:
        _report(args.out, outcome)
    except OSError:  # nobody reads it, or it goes to a full disk: all results are written
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what is still to be said at exit goes there
    return outcome.status


def _prepare(args: argparse.Namespace, nursery: Nursery | None) -> tuple[Options, Backend]:
    from course_lib.grading.cluster import Cluster  # noqa: PLC0415
    from course_lib.grading.messages import GRADE, Settings  # noqa: PLC0415
    from course_lib.grading.pool import Pool, usable_cpus  # noqa: PLC0415
    from course_lib.grading.runner import Options  # noqa: PLC0415
    from course_lib.grading.sandbox import Limits, choose  # noqa: PLC0415

    if args.no_sandbox and args.sandbox:
        raise seed_file.SeedFileError("--sandbox and --no-sandbox exclude each other")
    wanted = {
        "wall_s": args.timeout,
        "cell_s": args.cell_timeout,
        "call_s": args.call_timeout,
        "memory_bytes": args.memory,
    }
    if args.ros:
        _must_have_ros(args)
        wanted["processes"] = _ROS_PROCESSES
    limits = Limits(**{name: value for name, value in wanted.items() if value is not None})
    secret = _secret(args)
    sandbox = "none" if args.no_sandbox else args.sandbox or ("bubblewrap" if args.ros else None)
    cluster = Cluster(args.scheduler) if args.scheduler else None
    settings = Settings(
        seed=secret,
        tests=args.tests.resolve(),
        exercises=tuple(sorted(set(args.exercise or EXERCISES))),
        sandbox=cluster.choose(sandbox) if cluster else choose(sandbox),
        limits=limits,
        grade=args.grade or GRADE,
        ros=args.ros,
    )
    if args.no_sandbox:
        print("course grade: WITHOUT A SANDBOX: this code can do whatever you can", file=sys.stderr)  # noqa: T201
    options = Options(
        submissions=args.submissions,
        out=args.out,
        settings=settings,
        only=tuple(args.only),
        fresh=args.fresh,
    )
    if cluster:
        cluster.settings = settings
        return options, cluster
    return options, Pool(settings, args.workers or usable_cpus(), nursery)


def _must_have_ros(args: argparse.Namespace) -> None:
    from course_lib.grading.runner import UsageError  # noqa: PLC0415
    from course_lib.real_ros import complaint  # noqa: PLC0415

    if problem := complaint():
        raise UsageError(f"--ros: {problem}")
    if args.sandbox == "sandlock":
        raise UsageError("--ros needs bubblewrap: sandlock leaves no network that ROS could use")
    if args.scheduler:
        raise UsageError("--ros grades on this machine only, without --scheduler")


def _secret(args: argparse.Namespace) -> bytes:
    forbidden = (args.submissions, args.out)
    path = args.seed_file or seed_file.usual_path()
    if not args.seed_file:
        new = seed_file.make(path, forbidden=forbidden)
        print(f"seed file: {path}{' (made now; keep it)' if new else ''}", file=sys.stderr)  # noqa: T201
    secret = seed_file.read(path, forbidden=forbidden)
    if seed_file.readable_by_others(path):
        note = f"other users can read the seed file: chmod 600 {path}"
        print(f"course grade: {note}", file=sys.stderr)  # noqa: T201
    return secret


def _report(out: Path, outcome: Outcome) -> None:
    from course_lib.grading.summary import line  # noqa: PLC0415

    parts = [f"{len(outcome.graded)} graded"]
    if outcome.unchanged:
        parts.append(f"{len(outcome.unchanged)} unchanged")
    if outcome.failures:
        parts.append(f"{len(outcome.failures)} not: the grader itself failed")
    print(", ".join(parts))  # noqa: T201
    for student, reason in outcome.failures.items():
        print(f"  {line(student)}: {line(reason)}")  # noqa: T201
    for what, names in (
        ("results kept of who is no longer among the submissions", outcome.gone),
        ("taken for nobody's submission", outcome.passed_over),
    ):
        more = f" and {len(names) - 10} more" if len(names) > 10 else ""
        if names:
            print(f"{what}: {', '.join(line(name, 60) for name in names[:10])}{more}")  # noqa: T201
    print(f"class:    {out / 'index.html'}\ngrades:   {out / 'grades.csv'}")  # noqa: T201
    print(f"students: {out / 'STUDENT' / 'report.html'}", flush=True)  # noqa: T201


def _fail(message: str, status: int) -> int:
    with suppress(OSError):  # the terminal may be gone
        print(f"course grade: {message}", file=sys.stderr)  # noqa: T201
    return status


@contextmanager
def _interruptible() -> Iterator[None]:
    """Let Ctrl-C and a request to end interrupt once; ending takes its time undisturbed."""

    def interrupt(_number: int, _frame: FrameType | None) -> None:
        _hear_no_more()
        raise KeyboardInterrupt

    before = {number: signal.signal(number, interrupt) for number in _SIGNALS}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _hear_no_more() -> None:
    for number in _SIGNALS:
        signal.signal(number, signal.SIG_IGN)


def _count(text: str) -> int:
    count = int(text)
    if not 1 <= count <= 1024:
        raise argparse.ArgumentTypeError("give a number from 1 to 1024")
    return count


def _seconds(text: str) -> float:
    seconds = float(text)
    if not 0 < seconds < 86400:
        raise argparse.ArgumentTypeError("give a number of seconds, above 0, below a day")
    return seconds


def _bytes(text: str) -> int:
    found = re.fullmatch(r"([0-9]+(?:\.[0-9]+)?)\s*([kmgt]?)i?b?", text.strip().lower())
    if not found:
        raise argparse.ArgumentTypeError("give a size such as 1.5G or 800M")
    size = int(float(found[1]) * _BYTES[found[2]])
    if size < 128 * 2**20:
        raise argparse.ArgumentTypeError("a kernel with OpenCV alone needs 128M")
    return size
