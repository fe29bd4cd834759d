//! The other ends of the serial ports.

use super::line::LineFaults;
use sam3x_models::model::{Cycles, Reception};
use std::collections::VecDeque;

/// Bytes that a port has sent, and bytes on their way to it.
#[derive(Debug, Clone)]
pub struct Port {
    pub faults: LineFaults,
    transmitted: Vec<(Cycles, u8)>,
    /// Bytes to be sent, each not before a time.
    queue: VecDeque<(Cycles, u8)>,
    /// Bytes that a fault sends again, each at its time.
    again: VecDeque<(Cycles, u8)>,
    /// Time at which the first of the queue is complete; `None` until the port first polls.
    due: Option<Cycles>,
}

impl Port {
    /// A line without faults; `seed` is that of faults at random.
    pub fn new(seed: u64) -> Self {
        Self {
            faults: LineFaults::new(seed),
            transmitted: Vec::new(),
            queue: VecDeque::new(),
            again: VecDeque::new(),
            due: None,
        }
    }

    pub fn note_transmitted(&mut self, byte: u8, now: Cycles) {
        self.transmitted.extend(self.faults.pass(byte).map(|byte| (now, byte)));
    }

    pub fn take_transmitted(&mut self) -> Vec<(Cycles, u8)> {
        std::mem::take(&mut self.transmitted)
    }

    pub fn send(&mut self, bytes: &[u8], not_before: Cycles) {
        let bytes = self.faults.reorder(bytes);
        if let Some(later) = self.faults.replay_after() {
            self.again.extend(bytes.iter().map(|byte| (not_before + later, *byte)));
        }
        self.queue.extend(bytes.into_iter().map(|byte| (not_before, byte)));
    }

    /// Takes a byte that is complete. A byte begins at its time or when the one before it is complete, and takes `byte_time`.
    pub fn receive(&mut self, byte_time: Cycles, now: Cycles) -> Reception {
        while let Some(byte) = self.again.pop_front_if(|(at, _)| *at <= now) {
            self.queue.push_back(byte);
        }
        if self.queue.is_empty() {
            self.queue.extend(self.faults.flood().map(|byte| (now, byte)));
        }
        while let Some((not_before, byte)) = self.queue.front().copied() {
            let due = *self.due.get_or_insert(not_before.max(now) + byte_time);
            if due > now {
                return Reception::At(due);
            }
            self.queue.pop_front();
            self.due = self.queue.front().map(|(not_before, _)| due.max(*not_before) + byte_time);
            if let Some(byte) = self.faults.pass(byte) {
                return Reception::Byte(byte);
            }
        }
        self.again.front().map_or(Reception::Idle, |(at, _)| Reception::At(*at))
    }
}

#[cfg(test)]
mod tests {
    use super::{Port, Reception};
    use sam3x_models::model::CYCLES_PER_SECOND;

    #[test]
    fn bytes_arrive_one_byte_time_apart_however_late_the_port_polls() {
        let mut port = Port::new(1);
        assert_eq!(port.receive(10, 0), Reception::Idle);
        port.send(b"ab", 100);
        assert_eq!(port.receive(10, 50), Reception::At(110));
        assert_eq!(port.receive(10, 112), Reception::Byte(b'a'));
        assert_eq!(port.receive(10, 112), Reception::At(120));
        assert_eq!(port.receive(10, 120), Reception::Byte(b'b'));
        assert_eq!(port.receive(10, 120), Reception::Idle);
    }

    #[test]
    fn bytes_of_a_replaying_line_arrive_again() {
        let mut port = Port::new(1);
        port.faults.set("line:replay=1".parse().expect("a fault"), true);
        port.send(b"a", 0);
        assert_eq!(port.receive(10, 0), Reception::At(10));
        assert_eq!(port.receive(10, 10), Reception::Byte(b'a'));
        assert_eq!(port.receive(10, 10), Reception::At(CYCLES_PER_SECOND));
        assert_eq!(port.receive(10, CYCLES_PER_SECOND), Reception::At(CYCLES_PER_SECOND + 10));
        assert_eq!(port.receive(10, CYCLES_PER_SECOND + 10), Reception::Byte(b'a'));
    }
}
