"""Puts in what the substitutions in a launch file's texts stand for, such as `$(find unit4)`."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_lib.grading.launch_eval import NotUnderstoodError, evaluate
from course_lib.grading.launch_values import HOME_FOLDER, PACKAGE_FOLDER
from course_lib.grading.launch_xml import LaunchError

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

_MOST_TEXT = 2000  # of a value: arguments made of arguments could double at every step
_WHOLE_EVAL = re.compile(r"\$\(eval (.*)\)", re.DOTALL)
_SUBSTITUTION = re.compile(r"\$\((\w++)([^()]*+)\)")


class _UnknownError(Exception):
    """A value depends on what is not known here."""


@dataclass(frozen=True)
class Surroundings:
    """What the texts of one launch file may refer to.

    Attributes
    ----------
    args : mapping of str to (str or None)
        Its arguments; None where nobody has given a value.
    folder : str
        Where the file is.
    packages : collection of str
        The names under which `PACKAGE_FOLDER` is found.
    """

    args: Mapping[str, str | None]
    folder: str
    packages: Collection[str]

    def fill(self, text: str) -> str | None:
        """Put in what a text's substitutions stand for.

        Parameters
        ----------
        text : str

        Returns
        -------
        str or None
            None where it depends on what is not known here.

        Raises
        ------
        LaunchError
            When it holds what roslaunch does not take.
        """
        try:
            if found := _WHOLE_EVAL.fullmatch(text):
                return evaluate(found[1], self._meaning)
            whole, end = "", 0
            for match in _SUBSTITUTION.finditer(text):
                whole += text[end : match.start()] + self._meaning(match[1], match[2])
                end = match.end()
                if len(whole) > _MOST_TEXT:
                    return None
        except (_UnknownError, NotUnderstoodError):
            return None
        return whole + text[end:]

    def _meaning(self, kind: str, text: str) -> str:
        words = text.split()
        if kind == "dirname":
            return self.folder
        if kind not in {"arg", "find", "env", "optenv", "anon"}:
            alone = ", but as the whole of a value only" if kind == "eval" else ""
            raise LaunchError(
                f"has $({kind[:20]} …) in a text: roslaunch knows arg, find, env, optenv, anon, "
                f"dirname{' and eval' if alone else ''}{alone}"
            )
        if not words:
            raise _UnknownError
        match kind:
            case "find" if words[0] in self.packages:
                return PACKAGE_FOLDER
            case "arg" if (value := self.args.get(words[0])) is not None:
                return value
            case "env" | "optenv" if words[0] == "HOME":
                return HOME_FOLDER
            case "optenv":
                return " ".join(words[1:])
            case "anon":
                return words[0]
        raise _UnknownError
