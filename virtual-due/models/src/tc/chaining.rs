//! Channels whose clock is TIOA of another channel of the block (datasheet 36.6.3): TC_BMR connects TIOA to XC0…2.
//!
//! A chained counter counts the edges of a source that is advanced from event to event. Its own next event is bounded from
//! below by the source's period; at that instant the bound is found again, until it is the event.

use super::Tc;
use crate::model::{Context, Cycles};

/// TIOA of the channel that TC_BMR's field of a line, XC0…2, selects as 2 and as 3; 0 is the pin TCLK, 1 nothing.
const SOURCES: [[usize; 2]; 3] = [[1, 2], [0, 2], [0, 1]];

/// The bits of TC_BMR of which one is set where TIOA is a line.
const CHAINS: u32 = 0b10_1010;

impl Tc {
    fn is_chained(&self) -> bool {
        self.block_mode & CHAINS != 0
    }

    /// Writes TC_BMR. Edges before are not counted.
    pub(super) fn set_block_mode(&mut self, value: u32) {
        self.block_mode = value;
        self.levels = self.channels.each_ref().map(|channel| channel.tioa);
    }

    /// The channel whose TIOA is the line XC0…2 that a channel is connected to. TC_BMR switches XC0 of channel 0, XC1 of
    /// channel 1 and XC2 of channel 2; the other lines are the pins TCLK0…2 (datasheet, figure 36-2).
    fn source(&self, index: usize, line: usize) -> Option<usize> {
        let selection = (self.block_mode as usize >> (2 * line)) & 3;
        let selected = SOURCES[line].get(selection.checked_sub(2)?).copied();
        selected.filter(|_| line == index)
    }

    /// The channel whose TIOA is a channel's clock.
    fn clock_source(&self, index: usize) -> Option<usize> {
        self.source(index, self.channels[index].mode.external_clock()?)
    }

    /// The channel whose TIOA is a channel's external event.
    fn event_source(&self, index: usize) -> Option<usize> {
        self.source(index, self.channels[index].mode.event_line()?)
    }

    /// The pin TCLK that is a channel's clock while the channel runs. Nothing drives it.
    pub(super) fn missing_clock(&self, index: usize) -> Option<usize> {
        let line = self.channels[index].mode.external_clock()?;
        let is_missing = self.channels[index].runs() && self.source(index, line).is_none();
        is_missing.then_some(3 * self.block + line)
    }

    /// Advances the channels to now.
    pub(super) fn advance_channels(&mut self, context: &Context) {
        if self.is_chained() {
            self.advance_in_order(context.now);
        }
        for channel in &mut self.channels {
            channel.advance(context);
        }
    }

    /// Advances the channels from event to event, in the order of time.
    fn advance_in_order(&mut self, now: Cycles) {
        self.count_edges(now);
        let next = |tc: &Self| {
            let times = (0..3).filter_map(|index| Some((tc.channels[index].next_meeting_time()?, index)));
            times.min().filter(|(at, _)| *at <= now)
        };
        while let Some((at, index)) = next(self) {
            self.channels[index].advance_to_meeting(at);
            self.count_edges(at);
        }
    }

    /// Passes changes of each TIOA to the channels that it clocks. This ends: a channel counts edges of one direction, and
    /// two edges in one direction do not follow each other.
    pub(super) fn count_edges(&mut self, at: Cycles) {
        let changed = |tc: &Self| (0..3).find(|index| tc.channels[*index].tioa != tc.levels[*index]);
        while self.is_chained()
            && let Some(source) = changed(self)
        {
            let level = self.channels[source].tioa;
            self.levels[source] = level;
            for index in 0..3 {
                let counted = level != self.channels[index].mode.counts_falling_edges();
                if counted && self.clock_source(index) == Some(source) {
                    self.channels[index].count_edge(at);
                }
                if self.event_source(index) == Some(source) {
                    self.channels[index].external_event(level, at);
                }
            }
        }
    }

    /// The next instant at which a channel may raise its interrupt, or move a TIOA that may trigger the ADC.
    pub(super) fn next_channel_event(&self, index: usize) -> Option<Cycles> {
        let channel = &self.channels[index];
        let counted = channel.ticks_to_event().and_then(|ticks| self.earliest_time_of(index, ticks, 0));
        let source = self.event_source(index).filter(|_| channel.event_raises());
        let event =
            source.and_then(|source| self.earliest_time_of(source, self.channels[source].ticks_to_edges(1)?, 0));
        counted.into_iter().chain(event).min()
    }

    /// An instant no later than the next value at which a channel's counter changes its outputs.
    pub(super) fn next_meeting(&self, index: usize) -> Option<Cycles> {
        self.earliest_time_of(index, self.channels[index].ticks_to_edges(1)?, 0)
    }

    /// A lower bound of the instant of a channel's later tick, `depth` channels behind the first; `None` if its clock does
    /// not run.
    fn earliest_time_of(&self, index: usize, ticks: u64, depth: usize) -> Option<Cycles> {
        let Some(source) = self.clock_source(index) else { return self.channels[index].time_of(ticks) };
        // A circle of three has no clock.
        let next = depth + 1;
        if next > 2 { None } else { self.earliest_time_of(source, self.channels[source].ticks_to_edges(ticks)?, next) }
    }
}
