//! The header: which column holds what.

use std::collections::HashMap;

use estimator_core::SENSORS_PER_SEGMENT;

use super::{Needs, Problem};

/// A column and the factor from its unit to m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Column {
    pub index: usize,
    pub factor: f64,
}

/// Where one IMU's reading stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ImuColumn {
    /// One cell.
    Heading(Column),
    /// Four cells: w, x, y, z.
    Quaternion([usize; 4]),
}

/// Where the readings of one segment stand.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SegmentColumns {
    pub bend: [Option<usize>; SENSORS_PER_SEGMENT],
    pub imu: ImuColumn,
    /// x, y and heading.
    pub truth: Option<[Column; 3]>,
}

/// Where everything stands.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Columns {
    pub time: usize,
    /// Number that changes where the estimator starts anew.
    pub tare: Option<usize>,
    pub segments: Vec<SegmentColumns>,
}

/// Names of the sensors of a segment.
pub(crate) const SENSOR_NAMES: [char; SENSORS_PER_SEGMENT] = ['a', 'b'];

/// The column of the tare's number.
pub(crate) const TARE: &str = "tare";

struct Places<'h> {
    places: HashMap<&'h str, usize>,
}

impl Columns {
    /// Finds the columns that are needed. Unknown ones are ignored; those of a segment beyond the last are refused.
    pub fn find(names: &[String], needs: &Needs) -> Result<Self, Problem> {
        let mut places = HashMap::new();
        for (index, name) in names.iter().enumerate() {
            if places.insert(name.as_str(), index).is_some() && segment_of(name).is_some() {
                return Err(Problem::DuplicateColumn(name.clone()));
            }
            let segments = needs.bend.len();
            if let Some(segment) = segment_of(name).filter(|segment| *segment > segments) {
                return Err(Problem::OtherArm { column: name.clone(), segment, segments });
            }
        }
        let header = Places { places };
        let time = header.required("time_s")?;
        let has_truth = needs.truth || (1..=needs.bend.len()).any(|i| header.truth(i).is_ok());
        let segment = |(i, sensors): (usize, &Option<usize>)| {
            Ok(SegmentColumns {
                bend: header.bend(i + 1, *sensors)?,
                imu: header.imu(i + 1)?,
                truth: if has_truth { Some(header.truth(i + 1)?) } else { None },
            })
        };
        let tare = header.optional(TARE);
        Ok(Self { time, tare, segments: needs.bend.iter().enumerate().map(segment).collect::<Result<_, _>>()? })
    }
}

impl Places<'_> {
    fn optional(&self, name: &str) -> Option<usize> {
        self.places.get(name).copied()
    }

    fn required(&self, name: &str) -> Result<usize, Problem> {
        self.optional(name).ok_or_else(|| Problem::MissingColumn(name.to_owned()))
    }

    /// The column `name` in the first of the units that is there.
    fn in_unit(&self, name: &str, units: [(&str, f64); 2]) -> Result<Column, Problem> {
        let found = |(unit, factor): &(&str, f64)| {
            self.optional(&format!("{name}_{unit}")).map(|index| Column { index, factor: *factor })
        };
        let [(first, _), _] = units;
        units.iter().find_map(found).ok_or_else(|| Problem::MissingColumn(format!("{name}_{first}")))
    }

    fn length(&self, name: &str) -> Result<Column, Problem> {
        self.in_unit(name, [("mm", 1e-3), ("m", 1.0)])
    }

    fn angle(&self, name: &str) -> Result<Column, Problem> {
        self.in_unit(name, [("deg", std::f64::consts::PI / 180.0), ("rad", 1.0)])
    }

    fn bend(&self, segment: usize, sensors: Option<usize>) -> Result<[Option<usize>; SENSORS_PER_SEGMENT], Problem> {
        let mut columns = [None; SENSORS_PER_SEGMENT];
        for (j, (column, sensor)) in columns.iter_mut().zip(SENSOR_NAMES).enumerate() {
            let name = format!("bend{segment}{sensor}_adc");
            *column = match sensors {
                None => self.optional(&name),
                Some(number) if j < number => Some(self.required(&name)?),
                Some(_) => None,
            };
        }
        Ok(columns)
    }

    /// The quaternion where there is one, as it is the finer reading.
    fn imu(&self, segment: usize) -> Result<ImuColumn, Problem> {
        let part = |part: &str| format!("imu{segment}_q{part}");
        if self.optional(&part("w")).is_none() {
            return Ok(ImuColumn::Heading(self.angle(&format!("imu{segment}"))?));
        }
        let [w, x, y, z] = ["w", "x", "y", "z"].map(|name| self.required(&part(name)));
        Ok(ImuColumn::Quaternion([w?, x?, y?, z?]))
    }

    fn truth(&self, segment: usize) -> Result<[Column; 3], Problem> {
        let name = |part: &str| format!("truth{segment}_{part}");
        Ok([self.length(&name("x"))?, self.length(&name("y"))?, self.angle(&name("heading"))?])
    }
}

/// The segment that a known column belongs to; 0 for those of the whole arm, `None` for a column that is none of ours.
pub(super) fn segment_of(name: &str) -> Option<usize> {
    if name == "time_s" || name == TARE {
        return Some(0);
    }
    let (stem, rest) = name.split_once('_')?;
    let (digits, known): (&str, &[&str]) = if let Some(digits) = stem.strip_prefix("bend") {
        (digits.strip_suffix(SENSOR_NAMES)?, &["adc"])
    } else if let Some(digits) = stem.strip_prefix("imu") {
        (digits, &["deg", "rad", "qw", "qx", "qy", "qz"])
    } else {
        (stem.strip_prefix("truth")?, &["x_mm", "x_m", "y_mm", "y_m", "heading_deg", "heading_rad"])
    };
    digits.parse().ok().filter(|_| known.contains(&rest))
}
