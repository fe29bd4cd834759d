"""The live page of an emulated board with a simulated arm, from any folder."""

import contextlib
import itertools
import signal
import subprocess
import sys
import time
import unittest
import urllib.request

import numpy as np
import proprio

from common import InFolder

# A tip that moves by so much is no noise.
MOTION_M = 0.02
# Samples within which it does: 30 s of the board's time.
SAMPLES = 3000


@contextlib.contextmanager
def running(folder, *arguments):
    """Runs a command of the program that serves a page; yields the page's address."""
    command = [sys.executable, "-m", "proprio", *arguments, "--listen", "0"]
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True) as program:
        try:
            yield program.stdout.readline().strip()
        finally:
            program.send_signal(signal.SIGINT)
            program.wait(10)


def moves(address):
    """True where the tip of the arm moves."""
    with proprio.open(address) as samples:
        tips = (sample["fusion_end_m"][-1] for sample in itertools.islice(samples, SAMPLES))
        known = (tip for tip in tips if not np.isnan(tip).any())
        first = next(known)
        return any(np.hypot(*(tip - first)) > MOTION_M for tip in known)


class LivePage(InFolder):
    def check(self, *arguments):
        start = time.monotonic()
        with running(self.folder, *arguments) as address:
            with urllib.request.urlopen(address.split("#")[0]) as page:
                self.assertIn("<title>proprio monitor</title>", page.read().decode())
            page_s = time.monotonic() - start
            self.assertTrue(moves(address))
        print(f"proprio {' '.join(arguments)}: page after {page_s:.1f} s, moving arm after {time.monotonic() - start:.1f} s")

    def test_a_demo_shows_an_arm_that_moves(self):
        self.check("demo")

    def test_a_monitor_shows_an_arm_that_moves(self):
        self.check("monitor", "--virtual")

    def test_a_sample_has_the_shapes_of_the_arm(self):
        with running(self.folder, "demo") as address, proprio.open(address) as samples:
            shapes = {name: np.shape(values) for name, values in next(samples).items()}
            self.assertEqual(
                shapes,
                {
                    "time_s": (),
                    "fusion_theta_rad": (6,),
                    "fusion_end_m": (6, 2),
                    "bend_counts": (6, 2),
                    "imu_heading_rad": (6,),
                },
            )

    def test_the_samples_end_with_the_monitor(self):
        with running(self.folder, "demo") as address:
            samples = proprio.open(address)
            next(samples)
        self.assertLess(len(list(samples)), SAMPLES)

    def test_an_address_without_a_monitor_is_named_with_the_remedy(self):
        with self.assertRaisesRegex(proprio.Error, r"^127\.0\.0\.1:9: no monitor answers: .*\n  help: start one"):
            proprio.open("http://127.0.0.1:9/")


if __name__ == "__main__":
    unittest.main()
