"""Arrays for other tools, where their packages are installed."""

import importlib.util
import unittest

import numpy as np
import proprio

from common import SESSIONS, TABLE, InFolder


def needs(package):
    return unittest.skipUnless(importlib.util.find_spec(package), f"{package} is not installed")


class Export(InFolder):
    @needs("scipy")
    def test_matlab_reads_the_same_values(self):
        from scipy.io import loadmat

        estimates = proprio.replay(SESSIONS / "scenario-1.csv", TABLE)
        proprio.to_mat(self.folder / "estimates.mat", estimates)
        read = loadmat(self.folder / "estimates.mat")
        np.testing.assert_array_equal(read["fusion_end_m"], estimates["fusion_end_m"])
        np.testing.assert_array_equal(read["time_s"].ravel(), estimates["time_s"])
        metrics = read["metrics"]["methods"][0, 0]["fusion"][0, 0]
        self.assertEqual(metrics["tip_rmse_mm"][0, 0].item(), estimates["metrics"]["methods"]["fusion"]["tip_rmse_mm"])

    @needs("pandas")
    def test_a_table_has_a_column_for_each_segment_and_part(self):
        estimates = proprio.replay(SESSIONS / "scenario-1.csv", TABLE)
        frame = proprio.to_pandas(estimates)
        self.assertEqual((len(frame), frame.index.name), (600, "time_s"))
        np.testing.assert_array_equal(frame["fusion_end_m_6_y"], estimates["fusion_end_m"][:, 5, 1])
        session = proprio.to_pandas(proprio.read(SESSIONS / "board-rate.csv"))
        self.assertIn("bend_counts_2_b", session)
        self.assertIn("imu_quaternion_6_w", session)


if __name__ == "__main__":
    unittest.main()
