//! The columns of a header.

use std::collections::HashMap;

use estimator_core::SENSORS_PER_SEGMENT;
use telemetry::MAX_REGULATORS;

use crate::column_names::{SENSOR_NAMES, TARE, TIME, is_base, is_known, regulator_of, segment_of};
use crate::file_content::FileContent;
use crate::missing_column::MissingColumn;
use crate::{RequiredColumns, SessionProblem};

/// A column and the factor from its unit to m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Column {
    pub index: usize,
    pub factor: f64,
}

/// Columns of one IMU's reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ImuColumn {
    /// One cell.
    Heading(Column),
    /// Four cells: w, x, y, z.
    Quaternion([usize; 4]),
}

/// Columns of one segment's readings.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SegmentColumns {
    pub bend: [Option<usize>; SENSORS_PER_SEGMENT],
    pub imu: ImuColumn,
    pub truth: Option<TruthColumns>,
}

/// Columns of one segment's truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TruthColumns {
    pub x: Column,
    pub y: Column,
    /// Column of the heading, for all segments or for none.
    pub heading: Option<Column>,
}

impl From<[Column; 3]> for TruthColumns {
    fn from([x, y, heading]: [Column; 3]) -> Self {
        Self { x, y, heading: Some(heading) }
    }
}

/// Columns of a session.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Columns {
    pub time: usize,
    /// Number that changes where the estimator is started again.
    pub tare: Option<usize>,
    pub segments: Vec<SegmentColumns>,
}

/// Columns of a camera's file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CameraColumns {
    pub time: usize,
    /// x, y and heading of each segment's end.
    pub ends: Vec<[Column; 3]>,
    /// x, y and heading of the base's marker.
    pub base: Option<[Column; 3]>,
}

/// Columns of a profile of pressures.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PressureColumns {
    pub time: usize,
    /// From the first regulator on.
    pub regulators: Vec<Column>,
}

struct Places<'h> {
    names: &'h [String],
    indices: HashMap<&'h str, usize>,
    /// Content of the file that is read.
    expected: FileContent,
}

impl Columns {
    /// Finds the columns that are needed. Unknown ones are ignored; those of a segment beyond the last are refused.
    pub fn find(names: &[String], needs: &RequiredColumns) -> Result<Self, SessionProblem> {
        let header = Places::of(names, needs.bend.len(), FileContent::Session)?;
        let time = header.required(TIME)?;
        let has_headings = needs.truth || (1..=needs.bend.len()).any(|i| header.truth_heading(i).is_ok());
        let segment = |(i, sensors): (usize, &Option<usize>)| {
            Ok(SegmentColumns {
                bend: header.bend(i + 1, *sensors)?,
                imu: header.imu(i + 1)?,
                truth: if has_headings { Some(header.truth(i + 1)?.into()) } else { header.place(i + 1)? },
            })
        };
        let tare = header.optional(TARE);
        Ok(Self { time, tare, segments: needs.bend.iter().enumerate().map(segment).collect::<Result<_, _>>()? })
    }
}

impl CameraColumns {
    /// Finds the columns of an arm of `segments` segments, all of which are needed, and of the base where it has any.
    pub fn find(names: &[String], segments: usize) -> Result<Self, SessionProblem> {
        let header = Places::of(names, segments, FileContent::Camera)?;
        Ok(Self {
            time: header.required(TIME)?,
            ends: (1..=segments).map(|i| header.truth(i)).collect::<Result<_, _>>()?,
            base: names.iter().any(|name| is_base(name)).then(|| header.pose("base")).transpose()?,
        })
    }
}

impl PressureColumns {
    /// Finds the columns of all regulators, from the first to the last of which there is one.
    pub fn find(names: &[String]) -> Result<Self, SessionProblem> {
        // Columns of sensors are those of a session, which lacks the pressures.
        let header = Places::of(names, usize::MAX, FileContent::Profile)?;
        let time = header.required(TIME)?;
        let last = names.iter().filter_map(|name| regulator_of(name)).max().unwrap_or(0).max(1);
        if last > MAX_REGULATORS {
            return Err(SessionProblem::TooManyRegulators(last));
        }
        let regulator = |i: usize| header.in_unit(&format!("pressure{i}"), [("kpa", 1e3), ("pa", 1.0)]);
        Ok(Self { time, regulators: (1..=last).map(regulator).collect::<Result<_, _>>()? })
    }
}

impl<'h> Places<'h> {
    /// Refuses columns that are there twice and those of a segment beyond the last.
    fn of(names: &'h [String], segments: usize, expected: FileContent) -> Result<Self, SessionProblem> {
        let mut indices = HashMap::new();
        for (index, name) in names.iter().enumerate() {
            let segment = segment_of(name);
            if indices.insert(name.as_str(), index).is_some() && is_known(name) {
                return Err(SessionProblem::DuplicateColumn(name.clone()));
            }
            if let Some(segment) = segment.filter(|segment| *segment > segments) {
                return Err(SessionProblem::OtherArm { column: name.clone(), segment, segments });
            }
        }
        Ok(Self { names, indices, expected })
    }

    fn optional(&self, name: &str) -> Option<usize> {
        self.indices.get(name).copied()
    }

    fn required(&self, name: &str) -> Result<usize, SessionProblem> {
        self.optional(name).ok_or_else(|| self.missing(name))
    }

    fn missing(&self, name: &str) -> SessionProblem {
        SessionProblem::MissingColumn(Box::new(MissingColumn::new(name, self.names, self.expected)))
    }

    /// The column `name` in the first of the units that is there.
    fn in_unit(&self, name: &str, units: [(&str, f64); 2]) -> Result<Column, SessionProblem> {
        let found = |(unit, factor): &(&str, f64)| {
            self.optional(&format!("{name}_{unit}")).map(|index| Column { index, factor: *factor })
        };
        let [(first, _), _] = units;
        units.iter().find_map(found).ok_or_else(|| self.missing(&format!("{name}_{first}")))
    }

    fn length(&self, name: &str) -> Result<Column, SessionProblem> {
        self.in_unit(name, [("mm", 1e-3), ("m", 1.0)])
    }

    fn angle(&self, name: &str) -> Result<Column, SessionProblem> {
        self.in_unit(name, [("deg", std::f64::consts::PI / 180.0), ("rad", 1.0)])
    }

    fn bend(
        &self,
        segment: usize,
        sensors: Option<usize>,
    ) -> Result<[Option<usize>; SENSORS_PER_SEGMENT], SessionProblem> {
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
    fn imu(&self, segment: usize) -> Result<ImuColumn, SessionProblem> {
        let part = |part: &str| format!("imu{segment}_q{part}");
        if self.optional(&part("w")).is_none() {
            return Ok(ImuColumn::Heading(self.angle(&format!("imu{segment}"))?));
        }
        let [w, x, y, z] = ["w", "x", "y", "z"].map(|name| self.required(&part(name)));
        Ok(ImuColumn::Quaternion([w?, x?, y?, z?]))
    }

    fn truth_heading(&self, segment: usize) -> Result<Column, SessionProblem> {
        self.angle(&format!("truth{segment}_heading"))
    }

    /// A true place without a heading, where there is one.
    fn place(&self, segment: usize) -> Result<Option<TruthColumns>, SessionProblem> {
        match ["x", "y"].map(|part| self.length(&format!("truth{segment}_{part}"))) {
            [Err(_), Err(_)] => Ok(None),
            [x, y] => Ok(Some(TruthColumns { x: x?, y: y?, heading: None })),
        }
    }

    fn truth(&self, segment: usize) -> Result<[Column; 3], SessionProblem> {
        self.pose(&format!("truth{segment}"))
    }

    fn pose(&self, of: &str) -> Result<[Column; 3], SessionProblem> {
        let name = |part: &str| format!("{of}_{part}");
        Ok([self.length(&name("x"))?, self.length(&name("y"))?, self.angle(&name("heading"))?])
    }
}
