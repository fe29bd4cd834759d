"""Estimates: those of the program, to the bit."""

import unittest

import numpy as np
import proprio

from common import ROOT, SESSIONS, TABLE, InFolder, same
from common import proprio as program

# Of this many rows one is kept in the expected estimates.
KEPT_ROWS = 10
METHODS = ("bend", "imu_o", "imu_c", "fusion")


def lines(estimates):
    """Estimates as `proprio replay --out` writes them."""
    text = []
    for i, time_s in enumerate(estimates["time_s"]):
        cells = [repr(float(time_s)).removesuffix(".0") if time_s.is_integer() else repr(float(time_s))]
        for method in METHODS:
            theta_deg = np.degrees(estimates[f"{method}_theta_rad"][i])
            end_mm = estimates[f"{method}_end_m"][i] * 1e3
            for theta, (x, y) in zip(theta_deg, end_mm):
                cells += ["" if np.isnan(theta) else f"{theta:.6f}"]
                cells += ["", ""] if np.isnan(x) else [f"{x:.5f}", f"{y:.5f}"]
        text.append(",".join(cells))
    return text


class Replay(InFolder):
    def test_estimates_are_those_that_the_project_expects(self):
        for name in ("scenario-1", "scenario-2", "scenario-3", "board-rate"):
            found = lines(proprio.replay(SESSIONS / f"{name}.csv", TABLE))[::KEPT_ROWS]
            expected = (ROOT / "host-tests" / "expected" / f"{name}.csv").read_text().splitlines()[1:]
            self.assertEqual(found, expected, name)

    def test_estimates_are_those_of_the_program(self):
        session = SESSIONS / "scenario-2.csv"
        for options, keywords in (([], {}), (["--float"], {"float": True})):
            program(self.folder, "replay", session, "--table", TABLE, "--out", "estimates.csv", "--force", *options)
            expected = (self.folder / "estimates.csv").read_text().splitlines()[1:]
            self.assertEqual(lines(proprio.replay(session, TABLE, **keywords)), expected)

    def test_arrays_are_replayed_like_their_file(self):
        for name in ("scenario-1", "board-rate"):
            path = SESSIONS / f"{name}.csv"
            expected = proprio.replay(path, TABLE)
            found = proprio.replay(proprio.read(path), TABLE)
            for key in expected.keys() - {"metrics"}:
                self.assertTrue(same(found[key], expected[key]), (name, key))

    def test_smoothed_estimates_are_nearer_to_the_truth(self):
        estimates = proprio.replay(SESSIONS / "scenario-1.csv", TABLE, smooth=True)
        def rmse(method):
            error = estimates[f"{method}_end_m"][:, -1] - estimates["truth_m"][:, -1]
            return np.sqrt(np.nanmean(np.sum(error**2, axis=1)))
        self.assertLess(rmse("smoothed"), rmse("fusion"))

    def test_the_metrics_are_those_of_the_arrays(self):
        estimates = proprio.replay(SESSIONS / "scenario-1.csv", TABLE)
        error = estimates["fusion_end_m"][:, -1] - estimates["truth_m"][:, -1]
        rmse_mm = 1e3 * np.sqrt(np.nanmean(np.sum(error**2, axis=1)))
        self.assertAlmostEqual(estimates["metrics"]["methods"]["fusion"]["tip_rmse_mm"], rmse_mm, places=6)


class Estimator(unittest.TestCase):
    def setUp(self):
        self.session = proprio.read(SESSIONS / "board-rate.csv")
        self.expected = proprio.replay(SESSIONS / "board-rate.csv", TABLE)
        self.estimator = proprio.Estimator(TABLE, 100.0)

    def check(self, found, rows):
        for key, values in found.items():
            self.assertTrue(same(np.asarray(values), self.expected[key][rows]), (key, rows))

    def test_it_processes_arrays_in_one_go(self):
        self.check(self.estimator.run(self.session), slice(None))

    def test_it_processes_arrays_in_parts(self):
        for rows in (slice(0, 1), slice(1, 400), slice(400, None)):
            self.check(self.estimator.run({name: values[rows] for name, values in self.session.items()}), rows)

    def test_it_processes_sample_by_sample(self):
        for i in range(200):
            readings = self.session["bend_counts"][i], self.session["imu_quaternion"][i]
            self.check(self.estimator.update(self.session["time_s"][i], *readings), i)

    def test_it_starts_again(self):
        self.estimator.run(self.session)
        self.estimator.start()
        self.check(self.estimator.run(self.session), slice(None))

    def test_time_does_not_go_backwards(self):
        self.estimator.update(2.0)
        with self.assertRaisesRegex(proprio.Error, "time goes backwards, from 2 s to 1 s"):
            self.estimator.update(1.0)

    def test_readings_of_another_arm_are_refused(self):
        with self.assertRaisesRegex(proprio.Error, "the arrays have 2 segments, the table has 6"):
            self.estimator.update(0.0, np.zeros((2, 2)))


class Table(InFolder):
    def test_a_table_has_the_keys_of_its_file(self):
        table = proprio.Table(TABLE)
        self.assertEqual((table.segments, table.rate_hz, table.data["arm"]), (6, 10.0, "planar-6"))
        self.assertEqual(table.text, TABLE.read_text())
        self.assertEqual(proprio.Table.reference().data, table.data)

    def test_a_bad_value_is_named_with_its_line(self):
        text = proprio.Table.reference().text.replace("rate_hz = 10.0", "rate_hz = -1.0")
        with self.assertRaisesRegex(proprio.Error, r"mine\.toml: line \d+: rate_hz"):
            proprio.Table.parse(text, "mine.toml")

    def test_a_saved_table_replaces_no_file(self):
        path = self.folder / "table.toml"
        proprio.Table.reference().save(path)
        self.assertEqual(proprio.Table(path).data, proprio.Table.reference().data)
        with self.assertRaises(FileExistsError):
            proprio.Table.reference().save(path)


if __name__ == "__main__":
    unittest.main()
