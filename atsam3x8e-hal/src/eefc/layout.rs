//! Layout of the flash.

use core::ops::Range;

/// Bytes of a page, the unit of programming (datasheet chapter 18).
pub const PAGE_SIZE: u32 = 256;
/// Bytes of a lock region: 64 pages.
pub const LOCK_REGION_SIZE: u32 = 64 * PAGE_SIZE;
/// Addresses of the two banks, EFC0's and EFC1's, with GPNVM2 as delivered (datasheet chapter 7).
pub const BANKS: [Range<u32>; 2] = [0x0008_0000..0x000C_0000, 0x000C_0000..0x0010_0000];
