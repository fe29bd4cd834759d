//! The feed to one page, over a WebSocket.
//!
//! A page confirms each batch of rows. While it has many unconfirmed ones, only the newest batch waits for it: a slow page loses
//! batches, and does not fall behind. The limit is halved with each late confirmation and grows by one with any other, as the
//! window of TCP does. A client that confirms nothing, such as the Python package, gets all that its line takes.

use std::collections::VecDeque;

use axum::extract::State;
use axum::extract::ws::{Message, Utf8Bytes, WebSocket, WebSocketUpgrade};
use axum::response::Response;
use serde::Deserialize;
use tokio::sync::broadcast::error::RecvError;

use super::app_state::AppState;
use super::feed::{Delivery, Feed};
use super::latency::Latency;
use super::monitor_state::Published;

/// Longest message of a page, bytes.
const LONGEST: usize = 4096;

/// Largest number of batches that a page has not confirmed: those of a second.
const LARGEST: usize = 100;

/// Smallest limit of a slow page.
const SMALLEST: usize = 2;

/// Time from a batch to its confirmation from which that is late, µs.
const LATE_US: u64 = 300_000;

/// Report of a page.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Report {
    /// The batch with this [`sent_us`](super::feed::Batch::sent_us) was received.
    TakenUs(u64),
    /// The batch with this [`newest_us`](super::feed::Batch::newest_us) is on the screen.
    ShownUs(u64),
}

/// Messages that wait for one page, and those that it has not confirmed.
#[derive(Debug)]
struct Outbox {
    /// Times of the batches that are not confirmed, and their largest number.
    unconfirmed_us: VecDeque<u64>,
    limit: usize,
    /// The page has confirmed a batch, and will confirm others.
    confirms: bool,
    rows: Option<(Utf8Bytes, u64)>,
    status: Option<Utf8Bytes>,
    /// Batches that were dropped for newer ones.
    skipped: u64,
}

impl Outbox {
    fn new() -> Self {
        Self { unconfirmed_us: VecDeque::new(), limit: LARGEST, confirms: false, rows: None, status: None, skipped: 0 }
    }

    /// Takes a message of the monitor, in place of an older one that waits.
    fn push(&mut self, message: Published) -> Option<Utf8Bytes> {
        match message {
            Published::Rows(json, sent_us) => {
                self.skipped += u64::from(self.rows.replace((json, sent_us)).is_some());
                None
            }
            Published::Status(json) => {
                self.status = Some(json);
                None
            }
            Published::Arm(json) => {
                // Rows before it have other columns.
                self.rows = None;
                Some(json)
            }
        }
    }

    /// Takes the confirmation of the batches up to this time.
    fn confirm(&mut self, taken_us: u64, now_us: u64) {
        self.confirms = true;
        while let Some(sent_us) = self.unconfirmed_us.pop_front_if(|sent_us| *sent_us <= taken_us) {
            let is_late = now_us.saturating_sub(sent_us) > LATE_US;
            self.limit = if is_late { (self.limit / 2).max(SMALLEST) } else { (self.limit + 1).min(LARGEST) };
        }
    }

    /// The messages that the page can take now.
    fn take(&mut self) -> impl Iterator<Item = Utf8Bytes> {
        let has_room = !self.confirms || self.unconfirmed_us.len() < self.limit;
        let rows = self.rows.take_if(|_| has_room);
        if self.confirms {
            self.unconfirmed_us.extend(rows.as_ref().map(|(_, sent_us)| *sent_us));
        }
        rows.map(|(json, _)| json).into_iter().chain(self.status.take_if(|_| has_room))
    }
}

/// Opens the feed to a page.
pub(super) async fn feed(State(state): State<AppState>, upgrade: WebSocketUpgrade) -> Response {
    upgrade.max_message_size(LONGEST).on_upgrade(|socket| async move {
        // A page that leaves ends its feed.
        let _ = serve(state, socket).await;
    })
}

async fn serve(AppState { monitor, .. }: AppState, mut socket: WebSocket) -> Result<(), axum::Error> {
    let mut feed = monitor.feed.subscribe();
    let (mut outbox, mut latency) = (Outbox::new(), Latency::default());
    let arm = text(&Feed::Arm(&monitor.arm()));
    socket.send(arm).await?;
    loop {
        tokio::select! {
            message = feed.recv() => match message {
                Ok(message) => {
                    if matches!(message, Published::Status(_)) {
                        let delivery = Delivery { latency: latency.percentiles(), skipped: outbox.skipped };
                        socket.send(text(&Feed::Delivery(delivery))).await?;
                    }
                    if let Some(json) = outbox.push(message) {
                        socket.send(Message::Text(json)).await?;
                    }
                }
                Err(RecvError::Lagged(messages)) => outbox.skipped += messages,
                Err(RecvError::Closed) => return Ok(()),
            },
            report = socket.recv() => {
                let Some(report) = report.transpose()? else { return Ok(()) };
                let Message::Text(report) = report else { continue };
                let now_us = monitor.clock.now().0 / 1000;
                match serde_json::from_str(&report) {
                    Ok(Report::TakenUs(taken_us)) => outbox.confirm(taken_us, now_us),
                    Ok(Report::ShownUs(shown_us)) => latency.push(now_us.saturating_sub(shown_us)),
                    Err(_) => {}
                }
            }
        }
        for json in outbox.take() {
            socket.send(Message::Text(json)).await?;
        }
    }
}

fn text(message: &Feed) -> Message {
    Message::Text(Utf8Bytes::from(message.json()))
}

#[cfg(test)]
mod tests {
    use super::{LARGEST, LATE_US, Outbox, Published};

    /// Time from one batch to the next, µs.
    const BATCH_US: u64 = 10_000;

    /// Pushes the batch of this time; returns the times of the batches that are sent.
    fn send(outbox: &mut Outbox, sent_us: u64) -> Vec<u64> {
        outbox.push(Published::Rows(sent_us.to_string().into(), sent_us));
        outbox.take().map(|json| json.parse().expect("a time")).collect()
    }

    #[test]
    fn a_client_that_confirms_nothing_gets_every_batch() {
        let mut outbox = Outbox::new();
        assert_eq!((0..300).flat_map(|i| send(&mut outbox, i * BATCH_US)).count(), 300);
        assert!(outbox.unconfirmed_us.is_empty());
    }

    #[test]
    fn a_page_that_confirms_no_more_gets_the_newest_batch_once_it_does() {
        let mut outbox = Outbox::new();
        outbox.confirm(0, 0);
        let sent: Vec<u64> = (0..300).flat_map(|i| send(&mut outbox, i * BATCH_US)).collect();
        assert_eq!((sent.len(), outbox.skipped), (LARGEST, 300 - LARGEST as u64 - 1));
        outbox.confirm(sent[LARGEST - 1], 300 * BATCH_US);
        assert_eq!(outbox.take().collect::<Vec<_>>(), [(299 * BATCH_US).to_string()]);
    }

    #[test]
    fn a_page_that_confirms_at_once_gets_every_batch() {
        let mut outbox = Outbox::new();
        for i in 0..1000 {
            assert_eq!(send(&mut outbox, i * BATCH_US).len(), 1);
            outbox.confirm(i * BATCH_US, i * BATCH_US + LATE_US);
        }
        assert_eq!(outbox.skipped, 0);
    }

    /// A page that takes one batch in the time of ten.
    #[test]
    fn a_page_that_stays_slow_is_soon_less_than_a_second_behind() {
        let (mut outbox, mut on_their_way) = (Outbox::new(), std::collections::VecDeque::new());
        outbox.confirm(0, 0);
        let mut behind_us = 0;
        for i in 0..3000 {
            let now_us = i * BATCH_US;
            on_their_way.extend(send(&mut outbox, now_us));
            if i % 10 == 0
                && let Some(taken_us) = on_their_way.pop_front()
            {
                outbox.confirm(taken_us, now_us);
                behind_us = now_us - taken_us;
            }
            assert!(i < 1500 || behind_us < 1_000_000, "{behind_us} at {now_us}");
        }
    }
}
