"""Calibration, tuning, alignment and check: those of the program."""

import json
import signal
import tempfile
import threading
import unittest
import warnings
from pathlib import Path

import numpy as np
import proprio

from common import ARM, SESSIONS, TABLE, InFolder
from common import proprio as program


class Calibration(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        program(cls.folder, "simulate", "--scenario", "sweep", "--seconds", "300", "--seed", "1", "-o", "sweep.csv")
        cls.made = proprio.calibrate(cls.folder / "sweep.csv", ARM)

    def test_the_table_is_that_of_the_program(self):
        program(self.folder, "calibrate", "sweep.csv", "--arm", ARM, "-o", "table.toml")
        self.assertEqual(self.made["table"].text, (self.folder / "table.toml").read_text())

    def test_the_reports_are_arrays_of_sensors_and_segments(self):
        sensors, segments = self.made["sensors"], self.made["segments"]
        self.assertEqual(sensors["name"].tolist(), [f"bend{i}{place}" for i in range(1, 7) for place in "ab"])
        self.assertEqual((sensors["volts"].shape, segments["held_back_rmse_deg"].shape), ((12, 2), (6,)))
        self.assertEqual(self.made["held_out"]["tip_rmse_mm"].keys(), {"bend", "imu_o", "imu_c", "fusion"})
        self.assertAlmostEqual(self.made["truth"]["length_scale"][0], 1.0, delta=0.01)

    def test_arrays_are_calibrated_like_their_file(self):
        made = proprio.calibrate([proprio.read(self.folder / "sweep.csv")], ARM)
        for name, values in self.made["sensors"].items():
            np.testing.assert_array_equal(made["sensors"][name], values)

    def test_a_session_without_truth_is_refused(self):
        session = proprio.read(SESSIONS / "scenario-1.csv")
        without = {name: values for name, values in session.items() if not name.startswith("truth")}
        with self.assertRaisesRegex(proprio.Error, r"^arrays-1\.csv, line 1: column truth1_x_mm is missing"):
            proprio.calibrate(without, ARM)


    def test_ctrl_c_ends_it(self):
        sessions = [self.folder / "sweep.csv"] * 8
        threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
        with self.assertRaises(KeyboardInterrupt):
            proprio.calibrate(sessions, ARM)


class Findings(InFolder):
    def setUp(self):
        super().setUp()
        self.session = proprio.read(SESSIONS / "scenario-1.csv")
        self.session["bend_counts"][:, 2, 0] = 2000

    def test_a_replay_warns_of_what_the_check_finds_with_the_remedy(self):
        [finding] = proprio.check(self.session, TABLE)["findings"]
        with self.assertWarns(proprio.SessionWarning) as warned:
            proprio.replay(self.session, TABLE)
        self.assertIn(f"{finding['text']}; {finding['help']}", str(warned.warning))

    def test_nothing_is_warned_of_in_a_good_session(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error", proprio.SessionWarning)
            proprio.replay(SESSIONS / "scenario-1.csv", TABLE)


class Tuning(InFolder):
    def test_the_table_is_that_of_the_program(self):
        sessions = [SESSIONS / "scenario-2.csv", SESSIONS / "scenario-3.csv"]
        tuned = proprio.tune(sessions, TABLE)
        program(self.folder, "tune", *sessions, "--table", TABLE, "-o", "table.toml")
        self.assertEqual(tuned["table"].text, (self.folder / "table.toml").read_text())
        self.assertEqual(tuned["tuning"]["stop_reason"], "converged")


class Check(InFolder):
    def test_the_findings_are_those_of_the_program(self):
        session = proprio.read(SESSIONS / "scenario-1.csv")
        session["bend_counts"][:, 2, 0] = 2000
        checked = proprio.check(session, TABLE)
        proprio.write(self.folder / "session.csv", session)
        output, _ = program(self.folder, "check", "session.csv", "--table", TABLE, "--json", status=1)
        [expected] = json.loads(output)
        self.assertEqual((checked["samples"], checked["findings"]), (expected["samples"], expected["findings"]))
        self.assertEqual([finding["sensor"] for finding in checked["findings"]], ["bend3a"])

    def test_nothing_is_found_in_a_good_session(self):
        self.assertEqual(proprio.check(SESSIONS / "scenario-1.csv", TABLE), {"samples": 600, "findings": []})


class Alignment(InFolder):
    def test_the_session_with_truth_is_that_of_the_program(self):
        program(
            self.folder,
            *("simulate", "--scenario", "1", "--seconds", "120", "--seed", "3"),
            *("--camera", "camera.csv", "-o", "session.csv"),
        )
        aligned = proprio.align(self.folder / "session.csv", self.folder / "camera.csv", ARM)
        program(
            self.folder, "align", "session.csv", "--camera", "camera.csv", "--arm", ARM, "-o", "aligned.csv"
        )
        expected = proprio.read(self.folder / "aligned.csv")
        for name, values in expected.items():
            np.testing.assert_array_equal(aligned["session"][name], values)
        self.assertEqual(aligned["rows"], 1200)
        self.assertLess(aligned["offset_error_ms"], 50)


if __name__ == "__main__":
    unittest.main()
