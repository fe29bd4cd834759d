//! The cycle counter of the core's watchpoint unit (ARM DDI 0403E C1.8.7 and C1.8.8).

const CTRL: u32 = 0;
const CYCCNTENA: u32 = 1;
/// Four comparators, as the Cortex-M3 has; a program that wants to use one finds that it does nothing.
const NUMCOMP: u32 = 4 << 28;

/// DWT_CTRL and DWT_CYCCNT.
#[derive(Debug, Default)]
pub struct Dwt {
    held: u32,
    /// When the count was `held`, in core cycles; `None`: it is not counting.
    since: Option<u64>,
}

impl Dwt {
    /// A load or store at `offset` of either register, at a time in core cycles.
    pub fn access(&mut self, offset: u32, store: Option<u32>, core_cycles: u64) -> u32 {
        let count = self.count(core_cycles);
        match store {
            None if offset == CTRL => NUMCOMP | u32::from(self.since.is_some()),
            None => count,
            Some(value) if offset == CTRL => {
                self.held = count;
                self.since = (value & CYCCNTENA != 0).then_some(core_cycles);
                value
            }
            Some(value) => {
                self.held = value;
                self.since = self.since.map(|_| core_cycles);
                value
            }
        }
    }

    fn count(&self, core_cycles: u64) -> u32 {
        self.held.wrapping_add(self.since.map_or(0, |since| core_cycles - since) as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::Dwt;

    #[test]
    fn cycles_count_while_enabled_and_wrap() {
        let mut dwt = Dwt::default();
        assert_eq!(dwt.access(4, None, 10), 0);
        dwt.access(0, Some(1), 100);
        assert_eq!(dwt.access(4, None, 150), 50);
        dwt.access(4, Some(u32::MAX), 200);
        assert_eq!(dwt.access(4, None, 202), 1);
        dwt.access(0, Some(0), 210);
        assert_eq!(dwt.access(4, None, 999), 9);
        assert_eq!(dwt.access(0, None, 999), 0x4000_0000);
    }
}
