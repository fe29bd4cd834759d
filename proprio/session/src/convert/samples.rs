//! Rows as a board's samples.

use estimator_core::ImuReading;
use telemetry::{Encoder, MAX_FRAME, Message, Sample};

use crate::Row;

/// Name of the work in its progress.
pub const WORK: &str = "converting";

/// Units of 2⁻³⁰ in one of a BNO055.
const UNIT: i32 = 1 << 16;

/// Encoder of samples, numbered as ticks, and their frames.
pub struct SampleEncoder {
    segments: usize,
    encoder: Encoder,
    tick: u32,
    tare: u8,
    headings: u64,
    rounded: u64,
}

impl SampleEncoder {
    /// For an arm of so many segments.
    pub fn new(segments: usize) -> Self {
        Self { segments, encoder: Encoder::new(), tick: 0, tare: 0, headings: 0, rounded: 0 }
    }

    /// The frame of a row's sample, and the sample. A board's sample keeps its number and time.
    pub fn encode(&mut self, row: &Row) -> (Vec<u8>, Sample) {
        if row.starts && self.tick > 0 {
            self.tare = self.tare.wrapping_add(1);
        }
        let bend = row.sample.bend.iter().take(self.segments).flatten().copied().collect();
        let readings = row.sample.imu.iter().take(self.segments);
        let imu = readings.map(|reading| reading.map(|reading| self.quaternion(reading))).collect();
        let (tick, time_us) =
            row.board.as_ref().map_or((self.tick, row.sample.time_us), |board| (board.tick, board.time_us));
        let sample = Sample { tick, time_us, tare_epoch: self.tare, bend, imu };
        self.tick += 1;
        let mut buffer = [0; MAX_FRAME];
        let frame =
            self.encoder.encode(&Message::Sample(sample.clone()), &mut buffer).expect("every sample fits a frame");
        (frame.to_vec(), sample)
    }

    /// A reading in the units of a BNO055.
    fn quaternion(&mut self, reading: ImuReading) -> [i16; 4] {
        match reading {
            ImuReading::Quaternion(parts) => {
                self.rounded += u64::from(parts.iter().any(|part| part % UNIT != 0));
                parts.map(|part| ((f64::from(part) / f64::from(UNIT)).round()) as i16)
            }
            ImuReading::Heading(heading) => {
                self.headings += 1;
                let (sin, cos) = (heading.rad() / 2.0).sin_cos();
                [cos, 0.0, 0.0, -sin].map(|part| (part * 16_384.0).round() as i16)
            }
        }
    }

    /// Notes about values that were rounded.
    pub fn rounded(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.headings > 0 {
            notes.push("headings became quaternions, rounded to the 0.007 deg of an IMU".to_owned());
        }
        if self.rounded > 0 {
            notes.push(format!("{} quaternions were rounded to the units of an IMU, 2^-14", self.rounded));
        }
        notes
    }
}
