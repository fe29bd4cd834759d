"""Runs the tutorial: its shell and Python blocks, in order, in the current folder. Blocks of other kinds are not run."""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

from test_live import running

ADDRESS = "http://127.0.0.1:8642/"


def blocks(text):
    """The kind, the code and the line of each block."""
    for block in re.finditer(r"^```(\w+)\n(.*?)^```$", text, re.DOTALL | re.MULTILINE):
        yield block[1], block[2], text.count("\n", 0, block.start(2)) + 1


def run(tutorial):
    names = {}
    with tempfile.TemporaryDirectory() as folder, running(folder, "demo") as address:
        for kind, code, line in blocks(tutorial.read_text(encoding="utf-8")):
            if kind == "sh":
                subprocess.run(["bash", "-euc", code], check=True)
            elif kind == "python":
                # Line numbers of errors are those of the tutorial.
                code = "\n" * (line - 1) + code.replace(ADDRESS, address)
                exec(compile(code, str(tutorial), "exec"), names)


if __name__ == "__main__":
    run(Path(sys.argv[1]))
    print(f"{sys.argv[1]}: done")
