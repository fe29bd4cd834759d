//! Bits of TWI_SR (datasheet 33.11.6).

pub const TXCOMP: u32 = 1 << 0;
pub const RXRDY: u32 = 1 << 1;
pub const TXRDY: u32 = 1 << 2;
pub const SVREAD: u32 = 1 << 3;
pub const OVRE: u32 = 1 << 6;
pub const NACK: u32 = 1 << 8;
pub const ARBLST: u32 = 1 << 9;
pub const ENDRX: u32 = 1 << 12;
pub const ENDTX: u32 = 1 << 13;
pub const RXBUFF: u32 = 1 << 14;
pub const TXBUFE: u32 = 1 << 15;
