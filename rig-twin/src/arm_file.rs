//! Layout of the arm that a file describes.

use calibration_tables::{ArmFile, BoardSegmentToml, SegmentToml, Side};

use crate::constants::SENSORS_PER_SEGMENT;
use crate::layout::{Layout, LayoutError, SegmentLayout};

impl Layout {
    /// Layout of the arm of an arm description or a table. The sensors are those of its `[board]`; without one, each
    /// segment has an IMU and as many bend sensors as the table has maps, two in an arm description.
    ///
    /// # Errors
    /// [`LayoutError`].
    pub fn of_file(file: &ArmFile) -> Result<Self, LayoutError> {
        let wired = |index: usize| file.board.as_ref()?.segments.get(index);
        let segments = file.segments.iter().enumerate().map(|(index, segment)| layout(segment, wired(index)));
        Self::new(&segments.collect::<Vec<_>>())
    }
}

fn layout(segment: &SegmentToml, wired: Option<&BoardSegmentToml>) -> SegmentLayout {
    let maps = segment.bend.as_ref().map_or(SENSORS_PER_SEGMENT, Vec::len);
    let sensors = wired.map_or(maps, |wired| wired.bend.len());
    SegmentLayout {
        curve_m: segment.length_mm / 1000.0,
        connector_m: segment.offset_mm / 1000.0,
        connector_first: segment.offset_at == Side::Start,
        bend: core::array::from_fn(|index| index < sensors),
        imu: wired.is_none_or(|wired| wired.imu.is_some()),
    }
}

#[cfg(test)]
mod tests {
    use calibration_tables::{ArmFile, PLANAR_6_ARM, PLANAR_6_TABLE};

    use super::{Layout, LayoutError, SegmentLayout};

    /// An arm of two unlike segments.
    const TWO: &str = "format = 1\narm = \"two\"\nrate_hz = 10.0\n\
        [[segment]]\nlength_mm = 60.0\noffset_mm = 5.0\noffset_at = \"end\"\n\
        [[segment]]\nlength_mm = 120.0\noffset_mm = 30.0\noffset_at = \"start\"\n";

    fn parse(text: &str) -> ArmFile {
        ArmFile::parse(text).expect("the text is an arm description")
    }

    #[test]
    fn reference_arms_description_and_table_have_the_reference_arms_layout() {
        for text in [PLANAR_6_ARM, PLANAR_6_TABLE] {
            assert_eq!(Layout::of_file(&parse(text)), Ok(Layout::default()));
        }
    }

    #[test]
    fn lengths_and_sides_are_those_of_the_file() {
        let segment =
            SegmentLayout { curve_m: 0.06, connector_m: 0.005, connector_first: false, bend: [true; 2], imu: true };
        let second = SegmentLayout { curve_m: 0.12, connector_m: 0.03, connector_first: true, ..segment };
        assert_eq!(Layout::of_file(&parse(TWO)), Layout::new(&[segment, second]));
    }

    #[test]
    fn sensors_are_those_of_the_board_section() {
        let board = "[[board.segment]]\nbend = [\"A3\"]\n\
            [[board.segment]]\nbend = []\nimu = { channel = 4, address = 0x29 }\n";
        let layout = Layout::of_file(&parse(&format!("{TWO}{board}"))).expect("two segments");
        let sensors: Vec<_> = layout.segments().iter().map(|segment| (segment.bend, segment.imu)).collect();
        assert_eq!(sensors, [([true, false], false), ([false, false], true)]);
    }

    #[test]
    fn arms_of_more_than_eight_segments_are_refused() {
        let mut file = parse(TWO);
        file.segments = vec![file.segments[0].clone(); 9];
        assert_eq!(Layout::of_file(&file), Err(LayoutError::Segments(9)));
    }
}
