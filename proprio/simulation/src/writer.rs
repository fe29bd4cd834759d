//! Writes samples and their truth as a session, and the frames of a camera as a file of its own.

use std::io::{self, Write};

use estimator_core::ImuReading;
use proprio_session::SENSOR_NAMES;
use rig_twin::{EndPose, Frame, Layout};

use crate::simulation::Recorded;

/// Columns of the IMU readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImuColumns {
    /// The heading, imuK_deg.
    Deg,
    /// The quaternion as the BNO055 gives it, imuK_qw to imuK_qz.
    Quaternion,
}

/// Writer of a session.
pub struct SessionWriter<W> {
    sink: W,
    layout: Layout,
    imu: ImuColumns,
    truth: bool,
}

impl<W: Write> SessionWriter<W> {
    /// Begins a session of an arm with its header. A sensor that the arm does not have has no column.
    ///
    /// # Errors
    /// Errors of `sink`.
    pub fn new(sink: W, layout: &Layout, imu: ImuColumns) -> io::Result<Self> {
        Self::begin(sink, layout, imu, true)
    }

    /// Begins a session without truth.
    ///
    /// # Errors
    /// Errors of `sink`.
    pub fn without_truth(sink: W, layout: &Layout, imu: ImuColumns) -> io::Result<Self> {
        Self::begin(sink, layout, imu, false)
    }

    fn begin(mut sink: W, layout: &Layout, imu: ImuColumns, truth: bool) -> io::Result<Self> {
        let segments = || (1..).zip(layout.segments());
        write!(sink, "time_s")?;
        for (i, segment) in segments() {
            for (sensor, _) in SENSOR_NAMES.iter().zip(segment.bend).filter(|(_, has)| *has) {
                write!(sink, ",bend{i}{sensor}_adc")?;
            }
        }
        // An IMU that is not there has its columns, with empty cells.
        for (i, _) in segments() {
            match imu {
                ImuColumns::Deg => write!(sink, ",imu{i}_deg")?,
                ImuColumns::Quaternion => write!(sink, ",imu{i}_qw,imu{i}_qx,imu{i}_qy,imu{i}_qz")?,
            }
        }
        for (i, _) in segments().take_while(|_| truth) {
            write!(sink, ",truth{i}_x_mm,truth{i}_y_mm,truth{i}_heading_deg")?;
        }
        writeln!(sink)?;
        Ok(Self { sink, layout: layout.clone(), imu, truth })
    }

    /// Writes one sample.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn write(&mut self, sample: &Recorded) -> io::Result<()> {
        write!(self.sink, "{}", sample.time_us as f64 / 1e6)?;
        let places = self.layout.segments().iter().flat_map(|segment| segment.bend);
        for (counts, _) in sample.counts.iter().zip(places).filter(|(_, has)| *has) {
            write!(self.sink, ",")?;
            if let Some(counts) = counts {
                write!(self.sink, "{counts}")?;
            }
        }
        for (segment, quaternion) in self.layout.segments().iter().zip(&sample.quaternions) {
            let quaternion = quaternion.filter(|_| segment.imu);
            match self.imu {
                ImuColumns::Deg => write!(self.sink, ",{}", quaternion.map(heading_deg).unwrap_or_default())?,
                ImuColumns::Quaternion => write_quaternion(&mut self.sink, quaternion)?,
            }
        }
        for end in sample.truth.iter().take_while(|_| self.truth) {
            write_pose(&mut self.sink, end)?;
        }
        writeln!(self.sink)
    }

    /// The sink, when all samples are written.
    pub fn into_inner(self) -> W {
        self.sink
    }
}

/// Writer of a camera's file.
pub struct CameraWriter<W> {
    sink: W,
}

impl<W: Write> CameraWriter<W> {
    /// Begins the file of an arm of `segments` segments with its header.
    ///
    /// # Errors
    /// Errors of `sink`.
    pub fn new(mut sink: W, segments: usize) -> io::Result<Self> {
        write!(sink, "time_s,base_x_mm,base_y_mm,base_heading_deg")?;
        for i in 1..=segments {
            write!(sink, ",truth{i}_x_mm,truth{i}_y_mm,truth{i}_heading_deg")?;
        }
        writeln!(sink)?;
        Ok(Self { sink })
    }

    /// Writes one frame; the cells of a marker that was not found stay empty.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn write(&mut self, frame: &Frame) -> io::Result<()> {
        write!(self.sink, "{:.6}", frame.time_s)?;
        for pose in std::iter::once(&frame.base).chain(&frame.ends) {
            match pose {
                Some(pose) => write_pose(&mut self.sink, pose)?,
                None => write!(self.sink, ",,,")?,
            }
        }
        writeln!(self.sink)
    }

    /// The sink, when all frames are written.
    pub fn into_inner(self) -> W {
        self.sink
    }
}

fn write_quaternion(sink: &mut impl Write, quaternion: Option<[i16; 4]>) -> io::Result<()> {
    let Some(parts) = quaternion else { return write!(sink, ",,,,") };
    for part in parts {
        // 2⁻¹⁴ has a finite decimal form, so that the reading comes back to the bit.
        write!(sink, ",{}", f64::from(part) / 16_384.0)?;
    }
    Ok(())
}

fn write_pose(sink: &mut impl Write, pose: &EndPose) -> io::Result<()> {
    let (x_mm, y_mm) = (pose.x_m * 1e3, pose.y_m * 1e3);
    write!(sink, ",{x_mm:.4},{y_mm:.4},{:.4}", pose.heading_rad.to_degrees())
}

/// The heading in [0, 360) with five decimals; empty where the quaternion is no orientation.
fn heading_deg(quaternion: [i16; 4]) -> String {
    let Some(heading) = ImuReading::from_bno055(quaternion).heading() else { return String::new() };
    let text = format!("{:.5}", heading.rad().to_degrees().rem_euclid(360.0));
    if text == "360.00000" { "0.00000".to_owned() } else { text }
}
