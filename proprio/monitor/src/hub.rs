//! The thread between the link and the pages: events in, batches of rows and the status out.

use std::sync::Arc;
use std::time::{Duration, Instant};

use estimator_core::ArmConfig;
use proprio_check::SessionCheck;
use proprio_link::{EventKind, Link, LinkEvent, ReceivedBytes, Subscription, decoded};
use proprio_session::{HostNs, degradations};

use super::feed::{Batch, Feed, PageStatus};
use super::history::History;
use super::host_replica::HostReplica;
use super::live::{Live, TimedRow};
use super::monitor_state::MonitorState;
use super::page_row;

/// Time from one batch of rows to the next: a tick.
const PERIOD: Duration = Duration::from_millis(10);
/// Time from one status to the next.
const STATUS: Duration = Duration::from_millis(200);
/// Time from one evaluation of the session check to the next.
const CHECK: Duration = Duration::from_secs(1);
/// Number of notes that are kept.
const NOTES: usize = 6;

/// State of the thread.
pub(super) struct Hub<'t> {
    shared: Arc<MonitorState>,
    events: Subscription,
    live: Live<'t>,
    batch: Batch,
    batch_sent: Instant,
    status_sent: Instant,
    notes: Vec<String>,
    /// Findings of the session check, and the time of the check.
    findings: Vec<String>,
    checked: Instant,
}

impl<'t> Hub<'t> {
    pub fn new(
        shared: Arc<MonitorState>,
        events: Subscription,
        table: Option<&'t ArmConfig<'t, estimator_core::Q>>,
        check: Option<SessionCheck>,
    ) -> Self {
        let live = Live::new(table.map(HostReplica::new), check);
        let now = Instant::now();
        Self {
            shared,
            events,
            live,
            batch: Batch::default(),
            batch_sent: now,
            status_sent: now,
            notes: Vec::new(),
            findings: Vec::new(),
            checked: now,
        }
    }

    /// Takes the bytes since the last start of the board's estimator, in place of the rows that the pages have.
    pub fn take_history(&mut self, received: &[ReceivedBytes]) {
        let mut size = self.shared.arm().size;
        let new = |size| History::new(page_row::names(size).len());
        let mut history = new(size);
        decoded(received, |event| {
            let Some(TimedRow { row, .. }) = self.live.take(event) else { return };
            if row.size != size {
                size = row.size;
                history = new(size);
            }
            history.push(&row);
        });
        self.live.restart_rates();
        self.shared.replace(size, history);
    }

    /// Works until `is_over`.
    pub fn run(mut self, link: &Link, is_over: impl Fn() -> bool) {
        while !is_over() {
            let wait = PERIOD.saturating_sub(self.batch_sent.elapsed());
            if let Some(mut event) = self.events.next(wait) {
                // Events that this program was too slow for are a gap, too.
                event.gaps = event.gaps.saturating_add(self.events.dropped() as u32);
                self.take(&event);
            }
            if self.batch_sent.elapsed() >= PERIOD {
                self.batch_sent = Instant::now();
                self.follow_recording();
                self.send_rows();
            }
            if self.checked.elapsed() >= CHECK {
                self.checked = Instant::now();
                self.findings = self.live.findings().iter().map(self.shared.sessions.finding_text).collect();
            }
            if self.status_sent.elapsed() >= STATUS {
                self.status_sent = Instant::now();
                self.send_status(link);
            }
        }
    }

    fn take(&mut self, event: &LinkEvent) {
        // The status has the mismatches.
        if !matches!(event.kind, EventKind::Mismatch(_))
            && let Some(warning) = event.kind.warning()
        {
            self.note(event.at, &warning);
        }
        let row = self.live.take(event);
        let size = if let EventKind::Message(message) = &event.kind { self.live.size(message) } else { None };
        if size.is_some_and(|size| self.shared.set_size(size)) {
            self.batch.rows.clear();
        }
        // The row before another size of the arm has other columns.
        if let Some(TimedRow { row, sampled }) = row
            && self.shared.history().push(&row)
        {
            self.batch.newest_us = sampled.0 / 1000;
            self.batch.rows.push((row.time_s, row.values));
        }
    }

    fn note(&mut self, at: HostNs, text: &str) {
        let of_day = at.0 / 1_000_000_000 % 86_400;
        let (hour, minute, second) = (of_day / 3600, of_day / 60 % 60, of_day % 60);
        if self.notes.len() == NOTES {
            self.notes.remove(0);
        }
        self.notes.push(format!("{hour:02}:{minute:02}:{second:02} UTC: {text}"));
    }

    fn follow_recording(&mut self) {
        let recording = self.shared.recording().filter(|recording| recording.failed.is_none());
        self.live.sweep.record(recording.as_ref().map(|recording| recording.file.as_str()));
    }

    fn send_rows(&mut self) {
        let mut batch = std::mem::take(&mut self.batch);
        if !batch.rows.is_empty() {
            batch.sent_us = self.shared.clock.now().0 / 1000;
            self.shared.publish(&Feed::Rows(batch));
        }
    }

    fn send_status(&mut self, link: &Link) {
        let rates = self.live.rates(self.shared.clock.now());
        let mut status = PageStatus::new(link.state(), rates);
        status.health = self.live.health.as_ref().map(Into::into);
        status.notes.extend(self.live.health.iter().flat_map(degradations));
        status.sensors = self.live.sensors().into_iter().map(Into::into).collect();
        status.dropped_events = self.events.dropped();
        status.clock = self.live.board_time();
        status.least_delay_ms = self.live.min_delay_us().map(|delay_us| f64::from(delay_us) / 1e3);
        status.recording = self.shared.recording();
        status.sweep = self.live.sweep.status(self.live.health.as_ref());
        status.findings.clone_from(&self.findings);
        status.notes.extend(self.notes.iter().rev().cloned());
        self.shared.publish(&Feed::Status(Box::new(status)));
    }
}
