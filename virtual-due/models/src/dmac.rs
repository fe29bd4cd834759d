//! DMAC: copies from memory to memory, in one buffer or in a list of them (datasheet chapter 22). Transfers from and to
//! peripherals are reported, and end without data.

use crate::model::{Context, Cycles, Peripheral};
use crate::write_protection::WriteProtection;

const GCFG: u32 = 0x00;
const EN: u32 = 0x04;
const EBCIER: u32 = 0x18;
const EBCIDR: u32 = 0x1C;
const EBCIMR: u32 = 0x20;
const EBCISR: u32 = 0x24;
const CHER: u32 = 0x28;
const CHDR: u32 = 0x2C;
const CHSR: u32 = 0x30;
/// Registers of channel 0; those of the others follow.
const CHANNELS: u32 = 0x3C;
const CHANNEL_BYTES: u32 = 0x28;
const CHANNELS_END: u32 = CHANNELS + COUNT as u32 * CHANNEL_BYTES;
const WPMR: u32 = 0x1E4;
const WPSR: u32 = 0x1E8;

const COUNT: usize = 6;
const ALL: u32 = 0x3F;

/// Words of a channel, of which a descriptor in memory holds the first five.
const SADDR: usize = 0;
const DADDR: usize = 1;
const DSCR: usize = 2;
const CTRLA: usize = 3;
const CTRLB: usize = 4;
const CFG: usize = 5;

const DONE: u32 = 1 << 31;
/// FC: 0 is from memory to memory.
const FLOW_CONTROL: u32 = 7 << 21;
const NO_SOURCE_FETCH: u32 = 1 << 16;
const NO_DESTINATION_FETCH: u32 = 1 << 20;
const NO_INTERRUPT: u32 = 1 << 30;

/// A channel: its six registers, and the buffer under way.
#[derive(Debug, Clone, Copy, Default)]
struct Channel {
    words: [u32; 6],
    ends_at: Option<Cycles>,
    /// Address of the descriptor of the buffer.
    descriptor: Option<u32>,
}

impl Channel {
    /// Bytes of a datum of a side: bits 25:24 or 29:28 of CTRLA.
    fn width(&self, shift: u32) -> u32 {
        1 << (self.words[CTRLA] >> shift & 3).min(2)
    }

    fn bytes(&self) -> u32 {
        (self.words[CTRLA] & 0xFFFF) * self.width(24)
    }

    /// Step of an address after a datum: SRC_INCR or DST_INCR of CTRLB.
    fn step(&self, shift: u32, width: u32) -> u32 {
        match self.words[CTRLB] >> shift & 3 {
            0 => width,
            1 => width.wrapping_neg(),
            _ => 0,
        }
    }

    fn is_memory_to_memory(&self) -> bool {
        self.words[CTRLB] & FLOW_CONTROL == 0
    }

    /// Loads the next descriptor of the list: SADDR, DADDR, CTRLA, CTRLB, DSCR. False where there is no memory.
    fn fetch(&mut self, context: &mut Context) -> bool {
        let address = self.words[DSCR] & !3;
        let mut bytes = [0; 20];
        if !context.memory.read(address, &mut bytes) {
            return false;
        }
        let word = |index: usize| u32::from_le_bytes(bytes[4 * index..][..4].try_into().expect("four bytes"));
        if self.words[CTRLB] & NO_SOURCE_FETCH == 0 {
            self.words[SADDR] = word(0);
        }
        if self.words[CTRLB] & NO_DESTINATION_FETCH == 0 {
            self.words[DADDR] = word(1);
        }
        (self.words[CTRLA], self.words[CTRLB], self.words[DSCR]) = (word(2), word(3), word(4));
        self.descriptor = Some(address);
        true
    }

    /// Copies the buffer, datum by datum; false where there is no memory.
    fn copy(&mut self, context: &mut Context) -> bool {
        let mut data = vec![0; self.bytes() as usize];
        let (source, destination) = (self.width(24), self.width(28));
        let steps = [self.step(24, source), self.step(28, destination)];
        for piece in data.chunks_mut(source as usize) {
            if !context.memory.read(self.words[SADDR], piece) {
                return false;
            }
            self.words[SADDR] = self.words[SADDR].wrapping_add(steps[0]);
        }
        for piece in data.chunks(destination as usize) {
            if !context.memory.write(self.words[DADDR], piece) {
                return false;
            }
            self.words[DADDR] = self.words[DADDR].wrapping_add(steps[1]);
        }
        true
    }
}

/// The controller.
#[derive(Debug, Clone)]
pub struct Dmac {
    configuration: u32,
    enabled: bool,
    channels: [Channel; COUNT],
    interrupt_mask: u32,
    /// BTC, CBTC and ERR, a byte each, which reading clears.
    status: u32,
    protection: WriteProtection,
}

impl Dmac {
    /// State after the chip's reset.
    pub fn new() -> Self {
        Self {
            configuration: 0x10,
            enabled: false,
            channels: [Channel::default(); COUNT],
            interrupt_mask: 0,
            status: 0,
            protection: WriteProtection::new(*b"DMA"),
        }
    }

    /// ENA, and EMPT of the channels that are idle.
    fn channel_status(&self) -> u32 {
        let running = (0..COUNT).filter(|index| self.channels[*index].ends_at.is_some());
        let running = running.fold(0, |bits, index| bits | 1 << index);
        running | (ALL & !running) << 16
    }

    fn enable(&mut self, channels: u32, context: &mut Context) {
        for index in (0..COUNT).filter(|index| channels >> index & 1 != 0) {
            if self.enabled && self.channels[index].ends_at.is_none() {
                self.channels[index].descriptor = None;
                self.begin(index, context.now, context);
            }
        }
    }

    /// Begins a buffer, that of the next descriptor where there is one: a read and a write of the bus a datum.
    fn begin(&mut self, index: usize, at: Cycles, context: &mut Context) {
        let channel = &mut self.channels[index];
        if channel.words[DSCR] != 0 && !channel.fetch(context) {
            self.fail(index, context);
            return;
        }
        let channel = &mut self.channels[index];
        let data = u64::from(channel.words[CTRLA] & 0xFFFF);
        channel.ends_at = Some(at + context.master_cycles(2 * data.max(1)).max(1));
    }

    fn fail(&mut self, index: usize, context: &mut Context) {
        let [source, destination] = [SADDR, DADDR].map(|word| self.channels[index].words[word]);
        context.warnings.warn_once(format!(
            "DMAC: channel {index} fails: no memory at {source:#010x}, {destination:#010x} or its descriptor"
        ));
        self.channels[index].ends_at = None;
        self.status |= 1 << (16 + index);
    }

    fn end_buffer(&mut self, index: usize, at: Cycles, context: &mut Context) {
        let channel = &mut self.channels[index];
        channel.ends_at = None;
        if !channel.is_memory_to_memory() {
            let text =
                format!("DMAC: channel {index} serves a peripheral, which is not modelled: no data are transferred");
            context.warnings.warn_once(text);
        } else if !channel.copy(context) {
            self.fail(index, context);
            return;
        }
        let channel = &mut self.channels[index];
        channel.words[CTRLA] = channel.words[CTRLA] & !0xFFFF | DONE;
        if let Some(descriptor) = channel.descriptor {
            context.memory.write(descriptor + 8, &channel.words[CTRLA].to_le_bytes());
        }
        if channel.words[CTRLB] & NO_INTERRUPT == 0 {
            self.status |= 1 << index;
        }
        if self.channels[index].words[DSCR] == 0 {
            self.status |= 1 << (8 + index);
        } else {
            self.begin(index, at, context);
        }
    }

    /// Channel and word of a channel's register.
    fn place(offset: u32) -> Option<(usize, usize)> {
        let place = (CHANNELS..CHANNELS_END).contains(&offset).then(|| offset - CHANNELS)?;
        let word = (place % CHANNEL_BYTES / 4) as usize;
        (word <= CFG).then_some(((place / CHANNEL_BYTES) as usize, word))
    }
}

impl Peripheral for Dmac {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            GCFG => self.configuration,
            EN => self.enabled.into(),
            EBCIMR => self.interrupt_mask,
            EBCISR => std::mem::take(&mut self.status),
            CHSR => self.channel_status(),
            WPMR => self.protection.mode(),
            WPSR => self.protection.take_status(),
            EBCIER | EBCIDR | CHER | CHDR => 0,
            _ => {
                if let Some((channel, word)) = Self::place(offset) {
                    return self.channels[channel].words[word];
                }
                context.warnings.unmodelled("DMAC", offset);
                0
            }
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            WPMR => self.protection.set_mode(value),
            _ if offset != EBCIER && offset != CHER && !self.protection.permits(offset) => {}
            GCFG => self.configuration = value,
            EN => self.enabled = value & 1 != 0,
            EBCIER => self.interrupt_mask |= value & 0x3F_3F3F,
            EBCIDR => self.interrupt_mask &= !value,
            CHER => self.enable(value, context),
            CHDR => {
                for (index, channel) in self.channels.iter_mut().enumerate() {
                    channel.ends_at = channel.ends_at.filter(|_| value >> index & 1 == 0);
                }
            }
            EBCIMR | EBCISR | CHSR | WPSR => {}
            _ => match Self::place(offset) {
                Some((channel, word)) => self.channels[channel].words[word] = value,
                None => context.warnings.unmodelled("DMAC", offset),
            },
        }
    }

    fn advance(&mut self, context: &mut Context) {
        let now = context.now;
        let next = |dmac: &Self| {
            let ends = dmac.channels.iter().enumerate().filter_map(|(index, channel)| Some((channel.ends_at?, index)));
            ends.min().filter(|(at, _)| *at <= now)
        };
        while let Some((at, index)) = next(self) {
            self.end_buffer(index, at, context);
        }
    }

    /// The buffers' ends: memory changes then.
    fn next_event(&self) -> Option<Cycles> {
        self.channels.iter().filter_map(|channel| channel.ends_at).min()
    }

    fn interrupt(&self) -> bool {
        self.status & self.interrupt_mask != 0
    }

    fn reset(&mut self) {
        *self = Self::new();
    }
}

#[cfg(test)]
mod tests {
    use super::{CHDR, CHER, CHSR, Dmac, EBCIER, EBCISR, EN};
    use crate::model::Peripheral;
    use crate::test_support::Bench;

    const CHANNEL_2: u32 = 0x3C + 2 * 0x28;
    const WORDS: u32 = 2 << 24 | 2 << 28;
    const SINGLE: u32 = 1 << 16 | 1 << 20;
    const RAM: u32 = 0x2007_0000;

    /// Channel 2 with these registers SADDR, DADDR, DSCR, CTRLA, CTRLB and some bytes in RAM.
    fn bench(words: [u32; 5]) -> Bench<Dmac> {
        let mut bench = Bench::new(Dmac::new());
        for (index, byte) in (1..=16).enumerate() {
            bench.memory.bytes[index] = byte;
        }
        bench.write(EN, 1);
        for (offset, word) in (CHANNEL_2..).step_by(4).zip(words) {
            bench.write(offset, word);
        }
        bench
    }

    #[test]
    fn buffer_of_words_is_copied_and_its_end_interrupts() {
        let mut bench = bench([RAM, RAM + 0x100, 0, 4 | WORDS, SINGLE]);
        bench.write(EBCIER, 1 << 10);
        bench.write(CHER, 1 << 2);
        assert_eq!((bench.read(CHSR) & 4, bench.model.next_event()), (4, Some(8)));
        bench.run(7);
        assert!(!bench.model.interrupt() && bench.memory.bytes[0x100] == 0);
        bench.run(1);
        assert!(bench.model.interrupt());
        assert_eq!(bench.memory.bytes[0x100..0x110], bench.memory.bytes[..0x10]);
        assert_eq!((bench.read(CHSR) & 4, bench.read(EBCISR)), (0, 1 << 2 | 1 << 10));
        assert_eq!((bench.read(EBCISR), bench.read(CHANNEL_2) - RAM), (0, 16));
    }

    #[test]
    fn fixed_source_fills_and_a_falling_destination_reverses() {
        let mut fill = bench([RAM, RAM + 0x100, 0, 4, SINGLE | 2 << 24]);
        fill.write(CHER, 1 << 2);
        fill.run(8);
        assert_eq!(fill.memory.bytes[0x100..0x105], [1, 1, 1, 1, 0]);
        let mut reverse = bench([RAM, RAM + 0x103, 0, 4, SINGLE | 1 << 28]);
        reverse.write(CHER, 1 << 2);
        reverse.run(8);
        assert_eq!(reverse.memory.bytes[0x100..0x104], [4, 3, 2, 1]);
    }

    #[test]
    fn list_of_descriptors_gathers_buffers() {
        let mut bench = bench([0, 0, RAM + 0x200, 0, 0]);
        let list = [RAM, RAM + 0x100, 4, 0, RAM + 0x220, 0, 0, 0, RAM + 8, RAM + 0x104, 2, 0, 0];
        for (index, word) in list.into_iter().enumerate() {
            bench.memory.bytes[0x200 + 4 * index..][..4].copy_from_slice(&u32::to_le_bytes(word));
        }
        bench.write(CHER, 1 << 2);
        bench.run(8 + 4);
        assert_eq!(bench.memory.bytes[0x100..0x107], [1, 2, 3, 4, 9, 10, 0]);
        assert_eq!(bench.read(EBCISR), 1 << 2 | 1 << 10);
        assert_eq!(bench.memory.bytes[0x20B], 0x80, "DONE is written back");
    }

    #[test]
    fn disabled_channel_copies_nothing() {
        let mut bench = bench([RAM, RAM + 0x100, 0, 4, SINGLE]);
        bench.write(CHER, 1 << 2);
        bench.write(CHDR, 1 << 2);
        bench.run(100);
        assert_eq!((bench.memory.bytes[0x100], bench.read(EBCISR)), (0, 0));
    }

    #[test]
    fn address_without_memory_is_an_error_and_reported() {
        let mut bench = bench([RAM, 0x6000_0000, 0, 4, SINGLE]);
        bench.write(CHER, 1 << 2);
        bench.run(8);
        assert_eq!(bench.read(EBCISR), 1 << 18);
        let report = "DMAC: channel 2 fails: no memory at 0x20070004, 0x60000000 or its descriptor";
        assert_eq!(bench.reports(), [report]);
    }

    #[test]
    fn transfer_to_a_peripheral_is_reported_and_ends() {
        let mut bench = bench([RAM, 0x4000_800C, 0, 4, SINGLE | 1 << 21]);
        bench.write(CHER, 1 << 2);
        bench.run(8);
        assert_eq!((bench.read(EBCISR), bench.reports().len()), (1 << 2 | 1 << 10, 1));
    }
}
