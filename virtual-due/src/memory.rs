//! The chip's memories as bytes that the CPU engine and the models share. All `unsafe` of the crate is here.
//!
//! The engine's translated code reads and writes memory through raw pointers while models may do the same, so that no
//! reference to these bytes may ever exist: a [`Region`] gives out copies only.
#![expect(unsafe_code, reason = "the engine takes memory as raw pointers")]

use rigless::emulator::Processor;
use std::alloc::{Layout, alloc_zeroed, dealloc, handle_alloc_error};
use std::ptr::NonNull;
use std::rc::Rc;

/// Bytes of a page: the engine's smallest mapping, and its alignment.
const PAGE: usize = 4096;

/// A piece of memory, whole pages of it, zero at first.
#[derive(Debug)]
pub struct Region {
    bytes: NonNull<u8>,
    layout: Layout,
}

impl Region {
    /// A region of `length` bytes, which is a multiple of 4 KiB.
    pub fn new(length: usize) -> Rc<Self> {
        assert!(length > 0 && length.is_multiple_of(PAGE), "whole pages");
        let layout = Layout::from_size_align(length, PAGE).expect("a few hundred KiB in pages");
        // SAFETY: the layout's size is not zero.
        let bytes = unsafe { alloc_zeroed(layout) };
        let bytes = NonNull::new(bytes).unwrap_or_else(|| handle_alloc_error(layout));
        Rc::new(Self { bytes, layout })
    }

    /// Its length in bytes.
    pub fn len(&self) -> usize {
        self.layout.size()
    }

    /// Copies out the bytes at `offset`; does nothing and returns false if they exceed the region.
    pub fn read(&self, offset: usize, to: &mut [u8]) -> bool {
        if !self.holds(offset, to.len()) {
            return false;
        }
        // SAFETY: the range is inside the allocation, `to` is memory of its own as no reference to a region's bytes
        // ever exists, and neither the region nor the engine is Send, so that no other thread writes meanwhile.
        unsafe { self.bytes.as_ptr().add(offset).copy_to_nonoverlapping(to.as_mut_ptr(), to.len()) };
        true
    }

    /// Copies bytes in at `offset`; does nothing and returns false if they exceed the region.
    pub fn write(&self, offset: usize, from: &[u8]) -> bool {
        if !self.holds(offset, from.len()) {
            return false;
        }
        // SAFETY: as for `read`.
        unsafe { self.bytes.as_ptr().add(offset).copy_from_nonoverlapping(from.as_ptr(), from.len()) };
        true
    }

    /// Sets all of it to a byte.
    pub fn fill(&self, byte: u8) {
        // SAFETY: as for `read`.
        unsafe { self.bytes.as_ptr().write_bytes(byte, self.len()) };
    }

    fn holds(&self, offset: usize, length: usize) -> bool {
        offset.checked_add(length).is_some_and(|end| end <= self.len())
    }
}

impl Drop for Region {
    fn drop(&mut self) {
        // SAFETY: allocated in `new` with this layout; the last owner is gone.
        unsafe { dealloc(self.bytes.as_ptr(), self.layout) };
    }
}

/// A processor of the engine, and the memory mapped into it for as long as it lives.
#[derive(Debug)]
pub struct Mapped {
    processor: Box<dyn Processor>,
    // After the processor: dropped later.
    regions: Vec<Rc<Region>>,
}

impl Mapped {
    /// Nothing is mapped yet.
    pub fn new(processor: Box<dyn Processor>) -> Self {
        Self { processor, regions: Vec::new() }
    }

    /// Maps the whole region at `address`, in place of what was there. Stores to a region that is not writable reach
    /// the bus.
    pub fn map(&mut self, address: u32, region: &Rc<Region>, writable: bool) {
        // The engine asserts that the address is a whole number of pages.
        self.regions.push(Rc::clone(region));
        // SAFETY: the region is whole, aligned pages; it does not move, and lives as long as the processor, since
        // `regions` keeps it and is dropped after the processor. No reference to its bytes ever exists. Neither this
        // nor `Region` is Send, so that there is no other thread.
        unsafe {
            self.processor.map(u64::from(address), region.len() as u64, region.bytes.as_ptr(), writable);
        }
    }

    /// The processor.
    pub fn processor(&self) -> &dyn Processor {
        &*self.processor
    }

    /// The processor.
    pub fn processor_mut(&mut self) -> &mut dyn Processor {
        &mut *self.processor
    }
}

#[cfg(test)]
mod tests {
    use super::Region;

    #[test]
    fn access_past_the_end_does_nothing() {
        let region = Region::new(4096);
        assert!(region.write(4092, &[1, 2, 3, 4]));
        assert!(!region.write(4093, &[9; 4]));
        let mut bytes = [0; 4];
        assert!(!region.read(usize::MAX, &mut bytes));
        assert!(region.read(4092, &mut bytes));
        assert_eq!(bytes, [1, 2, 3, 4]);
    }
}
