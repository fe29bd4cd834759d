//! Bend readings outside the voltages of the calibration: a 10-bit ADC, a 5 V reference, an open or shorted strip, the table of
//! another arm.

use calibration_tables::{ArmFile, MAX_SEGMENTS};
use estimator_core::VOLTS_PER_COUNT;

use super::finding::{Finding, Kind, Rows, Source, is_exchanged};
use super::frame::Frame;

/// Width outside the range that an arm in use reaches, as a share of the range.
const MARGIN: f64 = 0.25;
/// Least share of readings outside, %.
const SHARE: f64 = 10.0;
/// Readings at either end of the ADC, counts.
const RAILS: [u16; 2] = [10, 4085];
/// Largest reading of an ADC of 10 bits.
const TEN_BITS: u16 = 1023;
/// Least number of rows of a finding.
const ROWS: u64 = 5;

/// Range and readings of one sensor.
#[derive(Debug, Clone, Copy, Default)]
struct Sensor {
    limits: Option<[f64; 2]>,
    read: u64,
    largest: u16,
    outside: Rows,
    rail: Rows,
    all: Rows,
}

/// The rule.
#[derive(Debug, Clone)]
pub(super) struct BendRange([[Sensor; 2]; MAX_SEGMENTS]);

impl BendRange {
    pub fn new(table: &ArmFile) -> Self {
        let mut sensors = [[Sensor::default(); 2]; MAX_SEGMENTS];
        for (segment, sensors) in table.segments.iter().zip(&mut sensors) {
            for (bend, sensor) in segment.bend.iter().flatten().zip(sensors) {
                sensor.limits = bend.volts.map(|[lo, hi]| {
                    let margin = MARGIN * (hi - lo);
                    [(lo - margin) / VOLTS_PER_COUNT, (hi + margin) / VOLTS_PER_COUNT]
                });
            }
        }
        Self(sensors)
    }

    pub fn update(&mut self, frame: &Frame) {
        for (sensors, counts) in self.0.iter_mut().zip(&frame.counts) {
            for (sensor, counts) in sensors.iter_mut().zip(counts) {
                let Some(counts) = *counts else { continue };
                sensor.read += 1;
                sensor.largest = sensor.largest.max(counts);
                sensor.all.add(frame);
                let counts_f = f64::from(counts);
                if counts <= RAILS[0] || counts >= RAILS[1] {
                    sensor.rail.add(frame);
                } else if sensor.limits.is_some_and(|[lo, hi]| counts_f < lo || counts_f > hi) {
                    sensor.outside.add(frame);
                }
            }
        }
    }

    pub fn finish(&self, findings: &mut Vec<Finding>) {
        if findings.iter().any(|finding| finding.sensor == Source::AllBend) {
            return;
        }
        let sensors = || self.0.iter().flatten().filter(|sensor| sensor.limits.is_some() && sensor.read > 0);
        let largest = sensors().map(|sensor| sensor.largest).max().unwrap_or(0);
        if let Some(first) = sensors().next().filter(|_| sensors().count() > 1 && largest <= TEN_BITS) {
            let is_outside = sensors().all(|sensor| sensor.outside.count * 2 > sensor.read);
            if is_outside {
                let figure = f64::from(largest);
                findings.push(Finding { sensor: Source::AllBend, rows: first.all, kind: Kind::TenBits, figure });
                return;
            }
        }
        for (i, sensors) in self.0.iter().enumerate() {
            for (place, sensor) in sensors.iter().enumerate() {
                let source = Source::Bend { segment: i + 1, place };
                if is_exchanged(findings, source) {
                    continue;
                }
                if sensor.rail.count >= ROWS {
                    // A sensor at an end of the ADC repeats its value there.
                    findings.retain(|finding| finding.sensor != source);
                }
                let mut push = |rows: Rows, kind: Kind, least: f64| {
                    let figure = 100.0 * rows.count as f64 / sensor.read as f64;
                    if rows.count >= ROWS && figure > least {
                        findings.push(Finding { sensor: source, rows, kind, figure });
                    }
                };
                push(sensor.rail, Kind::Rail, 0.0);
                push(sensor.outside, Kind::OutsideMap, SHARE);
            }
        }
    }
}
