//! Memory that the peripheral DMA controller (PDC) shares with the program.
//!
//! A [`Ring`] is a ring buffer. It owns a caller's static memory and has only a pointer to it, so that no Rust reference ever
//! covers bytes that the hardware may change. The hardware's bytes are at most two runs: the current and the next pointer and
//! counter of a PDC channel (datasheet 26.4.2, 26.4.3).

use core::ptr::NonNull;
use core::sync::atomic::{Ordering, fence};

/// The largest buffer: PDC counters have 16 bits (datasheet 26.4.3).
pub(crate) const MAX_CAPACITY: usize = 0xFFFF;

/// Ring buffer of bytes between the program and one direction of a PDC channel.
///
/// The bytes `[start, start + length)`, modulo the capacity, are queued: written by the producer and not yet taken by the
/// consumer.
#[derive(Debug)]
pub(crate) struct Ring {
    memory: NonNull<u8>,
    capacity: usize,
    start: usize,
    length: usize,
}

// SAFETY: the ring is the only owner of its memory, as a `&'static mut [u8]` would be, which is `Send`.
unsafe impl Send for Ring {}

/// Two stretches of a ring as offset and length; the second one starts at offset 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Runs {
    pub(crate) offset: usize,
    pub(crate) first: usize,
    pub(crate) second: usize,
}

/// Splits `length` bytes from `offset` where the ring wraps.
fn runs(capacity: usize, offset: usize, length: usize) -> Runs {
    let first = length.min(capacity - offset);
    Runs { offset, first, second: length - first }
}

impl Ring {
    /// Takes a buffer; bytes beyond [`MAX_CAPACITY`] are not used.
    pub(crate) fn new(memory: &'static mut [u8]) -> Self {
        let capacity = memory.len().min(MAX_CAPACITY);
        let memory = NonNull::from(memory).cast();
        Self { memory, capacity, start: 0, length: 0 }
    }

    /// Bytes queued.
    pub(crate) fn length(&self) -> usize {
        self.length
    }

    /// Bytes that fit.
    pub(crate) fn free(&self) -> usize {
        self.capacity - self.length
    }

    /// Offset after the last queued byte.
    fn end(&self) -> usize {
        let end = self.start + self.length;
        if end < self.capacity { end } else { end - self.capacity }
    }

    /// The queued bytes, which a transmitting PDC reads.
    pub(crate) fn queued_runs(&self) -> Runs {
        runs(self.capacity, self.start, self.length)
    }

    /// The free bytes, which a receiving PDC fills.
    pub(crate) fn free_runs(&self) -> Runs {
        runs(self.capacity, self.end(), self.free())
    }

    /// The bytes after the queued ones are now queued too: the producer filled them.
    pub(crate) fn produced(&mut self, count: usize) {
        self.length += count.min(self.free());
    }

    /// The consumer took the oldest bytes.
    pub(crate) fn consumed(&mut self, count: usize) {
        let count = count.min(self.length);
        self.start += count;
        if self.start >= self.capacity {
            self.start -= self.capacity;
        }
        self.length -= count;
    }

    /// Address of an offset, for a pointer register.
    pub(crate) fn address(&self, offset: usize) -> u32 {
        self.memory.as_ptr().wrapping_add(offset) as u32
    }

    /// Copies `bytes` behind the queued ones; the caller has checked that they fit.
    ///
    /// The transmitting PDC reads queued bytes only, so that the hardware does not see these until [`Self::produced`].
    pub(crate) fn write(&mut self, bytes: &[u8]) {
        let Runs { offset, first, second } = runs(self.capacity, self.end(), bytes.len().min(self.free()));
        // SAFETY: `runs` lie within the buffer, which this ring owns, and the free part of it is not read by the hardware.
        unsafe { self.memory.add(offset).as_ptr().copy_from_nonoverlapping(bytes.as_ptr(), first) };
        // SAFETY: as above; `second` bytes follow the first ones in `bytes`.
        unsafe { self.memory.as_ptr().copy_from_nonoverlapping(bytes.as_ptr().wrapping_add(first), second) };
        // The hardware reads the bytes only after they are in memory.
        fence(Ordering::SeqCst);
        self.produced(bytes.len());
    }

    /// Takes the oldest queued bytes, at most as many as `bytes` holds.
    pub(crate) fn read(&mut self, bytes: &mut [u8]) -> usize {
        // The bytes that the hardware counted are in memory; the program must not read them before.
        fence(Ordering::SeqCst);
        let count = bytes.len().min(self.length);
        let Runs { offset, first, second } = runs(self.capacity, self.start, count);
        // SAFETY: `runs` lie within the buffer, and the receiving PDC writes to the free part of it only.
        unsafe { self.memory.add(offset).as_ptr().copy_to_nonoverlapping(bytes.as_mut_ptr(), first) };
        // SAFETY: as above; `bytes` holds `first + second` bytes.
        unsafe { self.memory.as_ptr().copy_to_nonoverlapping(bytes.as_mut_ptr().wrapping_add(first), second) };
        self.consumed(count);
        count
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::boxed::Box;

    fn ring(capacity: usize) -> Ring {
        Ring::new(Box::leak(std::vec![0; capacity].into_boxed_slice()))
    }

    #[test]
    fn bytes_leave_in_the_order_they_came_across_the_wrap() {
        let mut ring = ring(8);
        let mut out = [0; 8];
        ring.write(&[1, 2, 3, 4, 5, 6]);
        assert_eq!(ring.read(&mut out[..5]), 5);
        ring.write(&[7, 8, 9, 10]);
        assert_eq!(ring.queued_runs(), Runs { offset: 5, first: 3, second: 2 });
        assert_eq!(ring.read(&mut out), 5);
        assert_eq!(out[..5], [6, 7, 8, 9, 10]);
    }

    #[test]
    fn free_and_queued_runs_cover_the_ring_once() {
        for start in 0..8 {
            for length in 0..=8 {
                let mut ring = ring(8);
                ring.produced(start);
                ring.consumed(start);
                ring.produced(length);
                let mut covered = [0; 8];
                for Runs { offset, first, second } in [ring.queued_runs(), ring.free_runs()] {
                    (offset..offset + first).chain(0..second).for_each(|index| covered[index] += 1);
                }
                assert_eq!(covered, [1; 8], "start {start}, length {length}");
            }
        }
    }

    #[test]
    fn an_empty_ring_reads_nothing_and_a_full_one_has_no_room() {
        let mut ring = ring(4);
        assert_eq!(ring.read(&mut [0; 4]), 0);
        ring.write(&[1, 2, 3, 4]);
        assert_eq!(ring.free(), 0);
        assert_eq!(ring.free_runs().first + ring.free_runs().second, 0);
    }
}
