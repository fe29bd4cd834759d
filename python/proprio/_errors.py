"""Exceptions and warnings of the package."""

import json
import warnings
from typing import Any, Callable


class Error(Exception):
    """A session, table or command that cannot be used, with the text and the remedy of the program `proprio`.

    Attributes:
        message: The file, the place in it and the fault.
        help: The remedy.
    """

    def __init__(self, message: str, help: str) -> None:
        super().__init__(message, help)
        self.message = message
        self.help = help

    def __str__(self) -> str:
        return f"{self.message}\n  help: {self.help}"


class SessionWarning(UserWarning):
    """A defect of a session past which it was used, or a finding of the session check, with the text of the program `proprio`."""


def warn(texts: "list[str]", plain: "Callable[[str], str]" = str) -> None:
    """Warns of defects and findings, at the line that called the package."""
    for text in texts:
        warnings.warn(plain(text), SessionWarning, stacklevel=3)


def decoded(text: str) -> Any:
    """A report of the extension module."""
    return json.loads(text)
