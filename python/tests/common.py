"""Files of the workspace, and runs of the program."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
SESSIONS = ROOT / "host-tests" / "sessions"
TABLE = ROOT / "calibration-tables" / "planar-6.toml"
ARM = ROOT / "calibration-tables" / "arms" / "planar-6.toml"


def proprio(folder, *arguments, status=0):
    """Runs the program of the installed package in a folder; returns its output and its errors."""
    command = [sys.executable, "-m", "proprio", *map(str, arguments)]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert run.returncode == status, (arguments, run.returncode, run.stderr)
    return run.stdout, run.stderr


class InFolder(unittest.TestCase):
    """Tests with a temporary folder of their own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)


def same(found, expected):
    """True for two arrays of the same values to the bit, NaN where the other is."""
    return found.dtype == expected.dtype and np.array_equal(found, expected, equal_nan=found.dtype.kind == "f")
