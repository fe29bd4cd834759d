"""Processor time of a child process."""

import os
from pathlib import Path


def cpu_s(process):
    """Time of the processor that a process has taken, s; 0 where the system does not have it there."""
    stat = Path(f"/proc/{process.pid}/stat")
    if not stat.exists():
        return 0
    user, system = stat.read_text().rsplit(")", 1)[1].split()[11:13]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")
