"""Tables and arm descriptions."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, Union

from . import _proprio

FILES = Path(__file__).parent / "files"


class Table:
    """A table of an arm, or its description: a checked TOML file.

    Attributes:
        path: Path of its file, which errors name.
        data: Its keys and values as in the file: lengths in mm, angles in degrees, times in s.
    """

    path: Path
    data: dict[str, Any]

    def __init__(self, path: Union[str, os.PathLike[str]]) -> None:
        """Reads and checks the file at `path`. Raises `Error`."""
        self.path = Path(path)
        self._text, data = _proprio.load_table(self.path)
        self.data = json.loads(data)

    @classmethod
    def parse(cls, text: str, path: Union[str, os.PathLike[str]] = "table.toml") -> Table:
        """A table from the text of its file; `path` is a name for errors. Raises `Error`."""
        table = cls.__new__(cls)
        table.path = Path(path)
        table.data = json.loads(_proprio.parse_table(text, table.path))
        table._text = text
        return table

    @classmethod
    def reference(cls) -> Table:
        """The table of the reference arm: six segments, twelve bend sensors, six IMUs."""
        return cls.parse(_proprio.reference_table(), "planar-6.toml")

    @classmethod
    def reference_arm(cls) -> Table:
        """The description of the reference arm: its geometry, which a calibration starts from."""
        return cls.parse(_proprio.reference_arm(), "planar-6.toml")

    @property
    def text(self) -> str:
        """The text of the file."""
        return self._text

    @property
    def segments(self) -> int:
        """Number of segments of the arm."""
        return len(self.data["segment"])

    @property
    def rate_hz(self) -> float:
        """Sample rate of the arm, Hz."""
        return self.data["rate_hz"]

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes the file; raises `FileExistsError` where there is one of this name."""
        with open(path, "x", encoding="utf-8") as file:
            file.write(self._text)

    def __repr__(self) -> str:
        return f"<proprio.Table {self.data['arm']!r}, {self.segments} segments, {str(self.path)!r}>"


def as_table(table: Union[Table, str, os.PathLike[str]]) -> Table:
    """A table, read where its path is given."""
    return table if isinstance(table, Table) else Table(table)
