//! The figures of sessions, as `replay` prints them.

use estimator_core::Method;
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

use crate::agreement::Comparison;
use crate::consistency::HonestyFigures;
use crate::metrics::{Figures, Score, SmoothedFigures};

/// The figures of one or more sessions, in the form of `replay --json`.
#[derive(Debug, Serialize)]
pub struct AllFigures {
    /// Each session by itself.
    pub sessions: Vec<SessionFigures>,
    /// All of them together.
    pub all: ByMethod,
    /// Length of the arm, mm.
    #[serde(skip)]
    pub length_mm: f64,
}

/// The figures of one session.
#[derive(Debug, Serialize)]
pub struct SessionFigures {
    /// The file.
    pub path: String,
    /// Number of samples.
    pub samples: u64,
    /// From the first sample to the last.
    pub seconds: f64,
    /// Its figures.
    #[serde(flatten)]
    pub figures: ByMethod,
    /// Of a board's recording, replayed in fixed point: whether the board's own estimates are those of the replay.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded: Option<Comparison>,
}

/// Figures by method.
#[derive(Debug, Serialize)]
pub struct ByMethod {
    /// Those of each of [`Method::ALL`].
    #[serde(serialize_with = "by_name")]
    pub methods: [Figures; Method::ALL.len()],
    /// How honest the covariances of fusion are, where there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<HonestyFigures>,
    /// Those of the smoothed shape, where the session was smoothed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smoothed: Option<SmoothedFigures>,
}

impl From<&Score> for ByMethod {
    fn from(score: &Score) -> Self {
        Self { methods: score.figures(), uncertainty: score.honesty(), smoothed: score.smoothed() }
    }
}

fn by_name<S: Serializer>(figures: &[Figures; Method::ALL.len()], serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(figures.len()))?;
    for (method, figures) in Method::ALL.iter().zip(figures) {
        map.serialize_entry(method.name(), figures)?;
    }
    map.end()
}
