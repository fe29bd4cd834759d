//! A board's messages on their channels: the same for a recording and for a live stream.

use telemetry::{Estimate, Event, Hello, Message, Sample};

use super::channel::{CONTACT, Channel, DIAGNOSTICS, JOINT_STATES, SAMPLES, SHAPE, UNCERTAINTY};
use super::messages;
use crate::{ClockSync, HostNs};

/// Number and times of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MessageInfo {
    /// Number of its tick, or of the message on its channel.
    pub sequence: u32,
    /// Time of its arrival.
    pub at: HostNs,
    /// Time of its tick on the host's clock.
    pub stamp: HostNs,
}

/// Destination of messages: a file, or the clients of a live stream.
pub trait MessageSink {
    /// Reason why a message cannot be taken.
    type Error;

    /// Takes a message; `encode` returns it in CDR, and is called only where somebody receives it.
    ///
    /// # Errors
    /// Those of the sink.
    fn message(
        &mut self,
        channel: &'static Channel,
        info: MessageInfo,
        encode: impl FnOnce() -> Vec<u8>,
    ) -> Result<(), Self::Error>;
}

/// State between a board's messages: its clock, its arm and its `Hello`.
#[derive(Debug, Default)]
pub struct BoardMessages {
    clock: ClockSync,
    hello: Option<Hello>,
    /// Tick and time of the last sample, which its estimate follows at once.
    sample: Option<(u32, HostNs)>,
    /// Segments of the board's arm.
    segments: usize,
}

impl BoardMessages {
    /// Before a board's first message.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Passes a message of the board, which has arrived at `at`, to the channels that have it.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn message<S: MessageSink>(&mut self, at: HostNs, message: &Message, sink: &mut S) -> Result<(), S::Error> {
        match message {
            Message::Hello(hello) => {
                if self.hello.as_ref() != Some(hello) {
                    self.hello = Some(hello.clone());
                }
                Ok(())
            }
            Message::Sample(sample) => self.sample(at, sample, sink),
            Message::Estimate(estimate) => self.estimate(at, estimate, sink),
            Message::Health(health) => {
                let info = self.info(health.tick, at);
                sink.message(&DIAGNOSTICS, info, || messages::diagnostics(info.stamp, health, self.hello.as_ref()))
            }
            Message::Uncertainty(of) => {
                let info = self.info(of.tick, at);
                sink.message(&UNCERTAINTY, info, || messages::uncertainty(info.stamp, of))
            }
            Message::Event(Event::Contact(tick, touched)) => {
                let info = self.info(*tick, at);
                sink.message(&CONTACT, info, || messages::contact(info.stamp, *touched, self.segments))
            }
            Message::Event(_) | Message::Reply(_) | Message::Table(_) | Message::TableData(_) | Message::Tare(_) => {
                Ok(())
            }
        }
    }

    /// The board's last `Hello`.
    #[must_use]
    pub fn hello(&self) -> Option<&Hello> {
        self.hello.as_ref()
    }

    /// Number and times of a message of this tick; its time is that of its arrival where the tick's sample was lost.
    #[must_use]
    pub fn info(&self, tick: u32, at: HostNs) -> MessageInfo {
        let stamp = self.sample.filter(|(last, _)| *last == tick).map_or(at, |(_, stamp)| stamp);
        MessageInfo { sequence: tick, at, stamp }
    }

    fn sample<S: MessageSink>(&mut self, at: HostNs, sample: &Sample, sink: &mut S) -> Result<(), S::Error> {
        let stamp = self.clock.host_ns(at, sample.time_us);
        self.sample = Some((sample.tick, stamp));
        self.segments = sample.imu.len();
        let info = MessageInfo { sequence: sample.tick, at, stamp };
        sink.message(&SAMPLES, info, || messages::sample(stamp, sample))
    }

    fn estimate<S: MessageSink>(&mut self, at: HostNs, estimate: &Estimate, sink: &mut S) -> Result<(), S::Error> {
        let info = self.info(estimate.tick, at);
        sink.message(&JOINT_STATES, info, || messages::joint_state(info.stamp, estimate))?;
        sink.message(&SHAPE, info, || messages::pose_array(info.stamp, estimate))
    }
}
