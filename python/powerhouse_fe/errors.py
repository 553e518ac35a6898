"""Exceptions. Their texts are those of the command ``powerhouse``, without the leading ``error:``."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .results import Results


class Error(Exception):
    """Error of scene, run or files.

    ``results`` are the results until the error, if there are any.
    """

    results: Results | None = None


class SceneError(Error):
    """Fault of a scene, with its place in the text of the scene.

    The text of the exception shows the line concerned, the permitted names and the nearest match.
    """

    #: What is wrong, in one line.
    problem: str = ""
    #: Path of the scene file, or that under which its text was given.
    path: str = ""
    #: Line of the fault, from 1.
    line: int = 0
    #: Column of the fault in characters, from 1.
    column: int = 0


class InputError(Error):
    """Input that is refused: a file that cannot be read, a body or mesh that does not fit, a case that does not exist."""


class RunError(Error):
    """Run that failed or was refused: divergence, a failed element, an unstable step, no static equilibrium.

    ``results`` are those until the failure, ``unwritten`` the exception of files that could not be written besides.
    """

    unwritten: Exception | None = None


class FolderError(Error):
    """Results folder that is in use by another run, has one that was interrupted, cannot hold the files of a run, or lost
    them."""


class Interrupted(KeyboardInterrupt):
    """Run that was stopped by Ctrl-C.

    ``results`` are complete up to then, as are the files in the folder; ``None`` if the dynamic run had not begun.
    """

    results: Results | None = None


__all__ = ["Error", "FolderError", "InputError", "Interrupted", "RunError", "SceneError"]
