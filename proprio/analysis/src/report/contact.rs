//! Contact of the segments over time.

use calibration_tables::{ArmFile, MAX_SEGMENTS};
use estimator_core::FusedOps;
use proprio_session::Row;

use super::downsample::Timeline;
use super::plot::{Axis, Colour, Figure, Marks, Panel, Series, Size, rounded};
use crate::Outcome;

/// Fewest bins of a session.
const BINS: usize = 256;
/// Names of the segments on the axis, by their number.
const NAMES: [&str; MAX_SEGMENTS + 1] =
    ["", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14", "15", "16"];

/// Contact of one session.
pub struct Contacts {
    /// Segments of the arm; 0 where the table has no limits of contact.
    segments: usize,
    /// 100 in contact, else 0.
    percent: Timeline<MAX_SEGMENTS>,
}

impl Contacts {
    pub fn new(table: &ArmFile) -> Self {
        let segments = if table.contact.is_some() { table.segments.len() } else { 0 };
        Self { segments, percent: Timeline::new(BINS) }
    }

    pub fn add<S: FusedOps>(&mut self, row: &Row, outcome: &Outcome<S>) {
        if self.segments > 0 {
            let percent =
                |i: usize| outcome.contacts.get(i).map(|contact| if contact.in_contact { 100.0 } else { 0.0 });
            self.percent.add(row.sample.time_us, std::array::from_fn(percent));
        }
    }

    fn panel(&self, session: &str) -> Option<Panel> {
        let bins = self.percent.bins();
        let [first, .., last] = bins else { return None };
        let points = |i: usize| bins.iter().map(|bin| (rounded(bin.time_s()), bin.mean(i).map(rounded))).collect();
        let series = (0..self.segments).map(|i| Series {
            name: format!("segment {}", i + 1),
            colour: Colour::Of(estimator_core::Method::Fusion),
            marks: Marks::Strip { row: (i + 1) as f64, x: "time_s", y: "contact_percent", points: points(i) },
        });
        let any = |bin: &&super::downsample::Bin<MAX_SEGMENTS>| {
            (0..self.segments).any(|i| bin.mean(i).is_some_and(|percent| percent > 0.0))
        };
        let share = bins.iter().filter(any).count() as f64 / bins.len() as f64 * 100.0;
        let mut y = Axis::new("segment in contact", [0.6, self.segments as f64 + 1.0]);
        y.names = &NAMES[..=self.segments];
        Some(Panel {
            session: Some(session.to_owned()),
            name: String::new(),
            title: format!("{session}: {share:.0} % of the time with a contact"),
            facts: vec![("contact_time_percent", rounded(share))],
            size: Size::Half,
            x: Axis::new("time, s", [first.time_s(), last.time_s()]),
            y,
            series: series.collect(),
        })
    }
}

/// The figure of the sessions' names and contacts.
pub fn figure<'s>(sessions: impl Iterator<Item = (&'s str, &'s Contacts)>) -> Figure {
    let panels: Vec<Panel> = sessions.filter_map(|(name, contacts)| contacts.panel(name)).collect();
    Figure {
        name: "contact",
        title: "Contact",
        caption: "Contacts that the estimator has detected, a row for each segment from the base (1) to the tip: height, share of \
                  the time of a bin in contact. The segment where the arm is bent by a contact is shown, and those beyond it may be, \
                  too."
            .to_owned(),
        is_drawn: !panels.is_empty(),
        panels,
    }
}
