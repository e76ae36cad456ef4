"""`rospkg`: finds the package that the node belongs to."""

from __future__ import annotations

import sys
from pathlib import Path
from xml.etree import ElementTree as ET


class ResourceNotFound(Exception):  # noqa: N818  (rospkg's name)
    """There is no such package here."""


class RosPack:
    """Finds packages: the one the node's file is in, and those beside it."""

    def get_path(self, name: str) -> str:
        """Give the folder of a package.

        Parameters
        ----------
        name : str
            As its `package.xml` says.

        Returns
        -------
        str
            The folder with the `package.xml`.

        Raises
        ------
        ResourceNotFound
            When it is neither the node's package nor beside it.
        """
        for folder in Path(sys.argv[0]).resolve().parents:
            for manifest in (folder / "package.xml", folder / name / "package.xml"):
                if manifest.is_file() and _name(manifest) == name:
                    return str(manifest.parent)
        msg = f"{name}: no package.xml of that name around {sys.argv[0]}"
        raise ResourceNotFound(msg)


def _name(manifest: Path) -> str | None:
    try:
        return ET.parse(manifest).getroot().findtext("name")  # noqa: S314  (the student's file)
    except ET.ParseError:
        return None


def get_path(name: str) -> str:
    """Give the folder of a package (see `RosPack.get_path`)."""
    return RosPack().get_path(name)
