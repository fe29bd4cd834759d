//! Estimates as arrays, one row for each sample.

use calibration_tables::MAX_SEGMENTS;
use estimator_core::{Angle, Condition, Covariance, FusedOps, Method, Shape, VARIANCE_SCALE};
use proprio_analysis::Outcome;

use crate::array::{Arrays, Values};

/// Estimates of an arm of some segments, sample by sample.
#[derive(Debug)]
pub struct Estimates {
    segments: usize,
    time_s: Vec<f64>,
    /// Each of [`Method::ALL`], and the smoothed shape.
    shapes: [Shapes; Method::ALL.len() + 1],
    theta_variance_rad2: Vec<f64>,
    end_covariance_m2: Vec<f64>,
    contact: Vec<bool>,
    degraded: Vec<bool>,
}

/// Shapes by one method.
#[derive(Debug, Default)]
struct Shapes {
    theta_rad: Vec<f64>,
    end_m: Vec<f64>,
}

impl Shapes {
    fn add<S: FusedOps>(&mut self, shape: &Shape<S, MAX_SEGMENTS>) {
        for segment in shape {
            self.theta_rad.push(segment.theta.map_or(f64::NAN, Angle::rad));
            self.end_m.extend(segment.end.as_ref().map_or([f64::NAN; 2], |end| [end.x.to_f64(), end.y.to_f64()]));
        }
    }
}

impl Estimates {
    /// No estimates yet.
    pub fn new(segments: usize) -> Self {
        Self {
            segments,
            time_s: Vec::new(),
            shapes: Default::default(),
            theta_variance_rad2: Vec::new(),
            end_covariance_m2: Vec::new(),
            contact: Vec::new(),
            degraded: Vec::new(),
        }
    }

    /// Adds the outcome of a sample.
    pub fn add<S: FusedOps>(&mut self, outcome: &Outcome<S>) {
        self.time_s.push(outcome.estimate.time_us as f64 / 1e6);
        let smoothed = outcome.smoothed.as_ref().map(|smoothed| &smoothed.shape);
        for (columns, shape) in self.shapes.iter_mut().zip(outcome.shapes.iter().chain(smoothed)) {
            columns.add(shape);
        }
        for i in 0..self.segments {
            let uncertainty = outcome.uncertainties.get(i);
            let theta = uncertainty.and_then(|of| of.theta);
            self.theta_variance_rad2.push(theta.map_or(f64::NAN, |theta| theta.to_f64() / VARIANCE_SCALE));
            let end = uncertainty.and_then(|of| of.end);
            self.end_covariance_m2.extend(end.map_or([f64::NAN; 3], Covariance::square_metres));
            self.contact.push(outcome.contacts.get(i).is_some_and(|contact| contact.in_contact));
            self.degraded.push(outcome.conditions.get(i).copied().is_some_and(Condition::is_degraded));
        }
    }

    /// The arrays; those of the smoothed shape where there is one.
    pub fn into_arrays(self) -> Arrays {
        let mut arrays = Arrays::default();
        let n = self.segments;
        arrays.add("time_s", Values::Float(self.time_s), &[]);
        let names = Method::ALL.map(Method::name).into_iter().chain(["smoothed"]);
        for (name, shapes) in names.zip(self.shapes).filter(|(name, shapes)| *name != "smoothed" || shapes.is_any()) {
            arrays.add(format!("{name}_theta_rad"), Values::Float(shapes.theta_rad), &[n]);
            arrays.add(format!("{name}_end_m"), Values::Float(shapes.end_m), &[n, 2]);
        }
        arrays.add("theta_variance_rad2", Values::Float(self.theta_variance_rad2), &[n]);
        arrays.add("end_covariance_m2", Values::Float(self.end_covariance_m2), &[n, 3]);
        arrays.add("contact", Values::Bool(self.contact), &[n]);
        arrays.add("degraded", Values::Bool(self.degraded), &[n]);
        arrays
    }
}

impl Shapes {
    fn is_any(&self) -> bool {
        !self.theta_rad.is_empty()
    }
}
