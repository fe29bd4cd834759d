"""Sessions as arrays."""

import unittest

import numpy as np
import proprio

from common import SESSIONS, InFolder, same
from common import proprio as program


class Sessions(InFolder):
    def test_a_session_has_a_row_for_each_sample_and_a_column_for_each_segment(self):
        session = proprio.read(SESSIONS / "scenario-1.csv")
        shapes = {name: values.shape for name, values in session.items()}
        self.assertEqual(
            shapes,
            {
                "time_s": (600,),
                "start": (600,),
                "bend_counts": (600, 6, 2),
                "bend_sensors": (6, 2),
                "imu_heading_rad": (600, 6),
                "truth_m": (600, 6, 2),
                "truth_heading_rad": (600, 6),
            },
        )
        self.assertEqual(np.flatnonzero(session["start"]).tolist(), [0])

    def test_arrays_can_be_changed(self):
        session = proprio.read(SESSIONS / "scenario-1.csv")
        session["bend_counts"][:, 0, 0] = np.nan
        self.assertTrue(np.isnan(session["bend_counts"][3, 0, 0]))

    def test_written_arrays_come_back_to_the_bit(self):
        for name in ("scenario-1", "board-rate"):
            session = proprio.read(SESSIONS / f"{name}.csv")
            session["start"][5] = True
            session["bend_counts"][7, 2, 1] = np.nan
            session["truth_m"][9, :] = np.nan
            session["truth_heading_rad"][9, :] = np.nan
            path = self.folder / f"{name}.csv"
            proprio.write(path, session)
            again = proprio.read(path)
            self.assertEqual(again.keys(), session.keys())
            for key in session:
                self.assertTrue(same(again[key], session[key]), (name, key))

    def test_a_bend_sensor_that_is_never_read_keeps_its_column(self):
        session = proprio.read(SESSIONS / "scenario-1.csv")
        session["bend_counts"][:, 2, 0] = np.nan
        estimates = proprio.replay(session, proprio.Table.reference())
        self.assertFalse(np.isnan(estimates["fusion_theta_rad"][-1]).any())

    def test_a_file_is_replaced_only_when_asked(self):
        session = proprio.read(SESSIONS / "scenario-1.csv")
        path = self.folder / "session.csv"
        proprio.write(path, session)
        with self.assertRaisesRegex(proprio.Error, "is there already and is not replaced"):
            proprio.write(path, session)
        proprio.write(path, session, replace=True)

    def test_a_recording_has_the_boards_estimates(self):
        program(self.folder, "record", "--virtual", "--seconds", "12", "-o", "session.mcap")
        session = proprio.read(self.folder / "session.mcap")
        self.assertGreater(len(session["time_s"]), 100)
        known = ~np.isnan(session["board_theta_rad"][:, 0])
        estimates = proprio.replay(self.folder / "session.mcap", proprio.Table.reference())
        self.assertTrue(known.any())
        # The line carries 2^-26 rad.
        difference = session["board_theta_rad"] - estimates["fusion_theta_rad"]
        self.assertLess(np.nanmax(np.abs(difference[known])), 2**-25)
        recorded = estimates["metrics"]["recorded"]
        self.assertEqual(recorded["equal"], recorded["estimates"] - recorded["not_compared"])
        self.assertGreater(recorded["equal"], 100)


class Errors(InFolder):
    def test_an_error_has_the_text_and_the_remedy_of_the_program(self):
        (self.folder / "session.csv").write_text("time_s,bend1a_adc\n0,7000\n")
        (self.folder / "table.toml").write_text(proprio.Table.reference().text)
        with self.assertRaises(proprio.Error) as raised:
            proprio.replay(self.folder / "session.csv", self.folder / "table.toml")
        _, errors = program(self.folder, "replay", self.folder / "session.csv", "--table", self.folder / "table.toml", status=2)
        self.assertEqual(f"error: {raised.exception}", errors.strip())

    def test_arrays_are_named_with_the_row_and_the_sensor(self):
        session = proprio.read(SESSIONS / "scenario-1.csv")
        session["bend_counts"][3, 1, 1] = 4096
        with self.assertRaises(proprio.Error) as raised:
            proprio.replay(session, proprio.Table.reference())
        self.assertEqual(
            raised.exception.message,
            "session arrays, row 3, bend2b: 4096 counts, expected a whole number from 0 to 4095",
        )

    def test_an_array_of_another_shape_is_named(self):
        session = proprio.read(SESSIONS / "scenario-1.csv")
        session["truth_m"] = session["truth_m"][:-1]
        with self.assertRaisesRegex(ValueError, r"truth_m has the shape \(599, 6, 2\), expected \(600, 6, 2\)"):
            proprio.write(self.folder / "session.csv", session)

    def test_a_defect_of_a_file_is_a_warning(self):
        (self.folder / "session.csv").write_bytes((SESSIONS / "scenario-1.csv").read_bytes().rstrip())
        with self.assertWarnsRegex(proprio.SessionWarning, "the last line has no end"):
            proprio.read(self.folder / "session.csv")


if __name__ == "__main__":
    unittest.main()
