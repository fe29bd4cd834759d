//! Remedies of errors of arm descriptions and tables.

use calibration_tables::FileError;

use super::Help;

impl Help for FileError {
    fn help(&self) -> String {
        let help = match self {
            Self::Read(_) => "check the name and that you may read it; it must be a text file in UTF-8",
            Self::Size => "name the .toml file of the arm",
            Self::Syntax { .. } => "correct the line; the keys are listed in docs/reference/table.md",
            Self::Format(_) => "use a version of proprio that reads this format",
            Self::Value { key, .. } if key.ends_with("_mm") => "correct the value, which is in mm",
            Self::Value { .. } => "correct the value; docs/reference/table.md has the keys and their units",
            Self::NotCalibrated(_) => "make a table of it with `proprio calibrate`, or write bend = [] if it has none",
        };
        help.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use calibration_tables::{ArmFile, PLANAR_6_ARM};

    use super::Help;

    #[test]
    fn an_arm_description_in_place_of_a_table_is_answered_with_calibrate() {
        let arm = ArmFile::parse(PLANAR_6_ARM).expect("the description is valid");
        let error = arm.bend_sensors().expect_err("it is no table");
        assert!(error.help().contains("proprio calibrate"), "{}", error.help());
    }
}
