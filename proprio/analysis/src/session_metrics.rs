//! The metrics of sessions, as printed by `replay`.

use estimator_core::Method;
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

use crate::agreement::Comparison;
use crate::consistency::ConsistencyMetrics;
use crate::metrics::{ErrorMetrics, Metrics, SmoothedMetrics};

/// The metrics of one or more sessions, in the form of `replay --json`.
#[derive(Debug, Serialize)]
pub struct AllMetrics {
    /// Metrics of each session.
    pub sessions: Vec<SessionMetrics>,
    /// Metrics of all sessions together.
    pub all: ByMethod,
    /// Length of the arm, mm.
    #[serde(skip)]
    pub length_mm: f64,
}

/// The metrics of one session.
#[derive(Debug, Serialize)]
pub struct SessionMetrics {
    /// The file.
    pub path: String,
    /// Number of samples.
    pub samples: u64,
    /// Time from the first sample to the last, s.
    pub seconds: f64,
    /// Time at which a board's recording begins, UTC; `None` where it is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded_at: Option<String>,
    /// Its metrics.
    #[serde(flatten)]
    pub metrics: ByMethod,
    /// Agreement of the board's estimates with the replay, for a recording that is replayed in fixed point.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded: Option<Comparison>,
}

/// Metrics by method.
#[derive(Debug, Serialize)]
pub struct ByMethod {
    /// Metrics of each of [`Method::ALL`].
    #[serde(serialize_with = "by_name")]
    pub methods: [Metrics; Method::ALL.len()],
    /// Consistency of the covariances of fusion, where there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<ConsistencyMetrics>,
    /// Metrics of the smoothed shape, where the session was smoothed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smoothed: Option<SmoothedMetrics>,
}

impl From<&ErrorMetrics> for ByMethod {
    fn from(errors: &ErrorMetrics) -> Self {
        Self { methods: errors.metrics(), uncertainty: errors.consistency(), smoothed: errors.smoothed() }
    }
}

fn by_name<S: Serializer>(metrics: &[Metrics; Method::ALL.len()], serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(metrics.len()))?;
    for (method, metrics) in Method::ALL.iter().zip(metrics) {
        map.serialize_entry(method.name(), metrics)?;
    }
    map.end()
}
