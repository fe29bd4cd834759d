//! The feed to one page, over a WebSocket.
//!
//! A page confirms each batch of rows. While it has many unconfirmed ones, only the newest batch waits for it: a slow page loses
//! batches, and does not fall behind.

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

/// Most batches that a page has not confirmed: those of 0.16 s.
const WINDOW: usize = 16;

/// Unconfirmed batches of a page that is slower than [`SLOW_US`].
const SLOW_WINDOW: usize = 2;

/// Time from a batch's sample to its confirmation from which a page is slow, µs.
const SLOW_US: u64 = 300_000;

/// Report of a page. Times are the [`newest_us`](super::feed::Batch::newest_us) of a batch.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Report {
    /// The batch was received.
    TakenUs(u64),
    /// The batch is on the screen.
    ShownUs(u64),
}

/// Messages that wait for one page, and those that it has not confirmed.
#[derive(Debug, Default)]
struct Outbox {
    /// Times of the batches that are not confirmed.
    unconfirmed_us: VecDeque<u64>,
    rows: Option<(Utf8Bytes, u64)>,
    status: Option<Utf8Bytes>,
    /// Batches that were dropped for newer ones.
    skipped: u64,
}

impl Outbox {
    /// Takes a message of the monitor, in place of an older one that waits.
    fn push(&mut self, message: Published) -> Option<Utf8Bytes> {
        match message {
            Published::Rows(json, newest_us) => {
                self.skipped += u64::from(self.rows.replace((json, newest_us)).is_some());
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

    fn confirm(&mut self, taken_us: u64) {
        while self.unconfirmed_us.front().is_some_and(|newest_us| *newest_us <= taken_us) {
            self.unconfirmed_us.pop_front();
        }
    }

    /// The messages that the page can take now.
    fn take(&mut self, now_us: u64) -> impl Iterator<Item = Utf8Bytes> {
        let is_slow = self.unconfirmed_us.front().is_some_and(|newest_us| now_us.saturating_sub(*newest_us) > SLOW_US);
        let has_room = self.unconfirmed_us.len() < if is_slow { SLOW_WINDOW } else { WINDOW };
        let rows = self.rows.take_if(|_| has_room);
        self.unconfirmed_us.extend(rows.as_ref().map(|(_, newest_us)| *newest_us));
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
    let (mut outbox, mut latency) = (Outbox::default(), Latency::default());
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
                match serde_json::from_str(&report) {
                    Ok(Report::TakenUs(taken_us)) => outbox.confirm(taken_us),
                    Ok(Report::ShownUs(shown_us)) => {
                        latency.push((monitor.clock.now().0 / 1000).saturating_sub(shown_us));
                    }
                    Err(_) => {}
                }
            }
        }
        for json in outbox.take(monitor.clock.now().0 / 1000) {
            socket.send(Message::Text(json)).await?;
        }
    }
}

fn text(message: &Feed) -> Message {
    Message::Text(Utf8Bytes::from(message.json()))
}

#[cfg(test)]
mod tests {
    use super::{Outbox, Published, SLOW_US, WINDOW};

    fn batch(newest_us: u64) -> Published {
        Published::Rows(newest_us.to_string().into(), newest_us)
    }

    /// Takes batches at 10 ms each; returns the times of those that are sent.
    fn send(outbox: &mut Outbox, times_us: impl Iterator<Item = u64>) -> Vec<u64> {
        let mut sent = Vec::new();
        for newest_us in times_us {
            outbox.push(batch(newest_us));
            sent.extend(outbox.take(newest_us).map(|json| json.parse::<u64>().expect("a time")));
        }
        sent
    }

    #[test]
    fn a_page_that_confirms_nothing_gets_the_newest_batch_once_it_does() {
        let mut outbox = Outbox::default();
        let second = (0..100).map(|i| i * 10_000);
        assert_eq!(send(&mut outbox, second).len(), WINDOW);
        assert_eq!(outbox.skipped, 100 - WINDOW as u64 - 1);
        outbox.confirm(150_000);
        assert_eq!(outbox.take(1_000_000).collect::<Vec<_>>(), ["990000"]);
    }

    #[test]
    fn a_page_that_confirms_at_once_gets_every_batch() {
        let mut outbox = Outbox::default();
        for i in 0..1000 {
            assert_eq!(send(&mut outbox, std::iter::once(i * 10_000)).len(), 1);
            outbox.confirm(i * 10_000);
        }
        assert_eq!(outbox.skipped, 0);
    }

    #[test]
    fn a_slow_page_has_few_batches_on_their_way() {
        let mut outbox = Outbox::default();
        send(&mut outbox, [0, 10_000, 20_000].into_iter());
        outbox.confirm(0);
        assert!(send(&mut outbox, std::iter::once(20_000 + SLOW_US)).is_empty());
        outbox.confirm(20_000);
        assert_eq!(outbox.take(30_000 + SLOW_US).count(), 1);
    }
}
