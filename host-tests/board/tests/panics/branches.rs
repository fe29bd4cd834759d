//! Branches of Thumb-2 code (ARMv7-M Architecture Reference Manual, A7.7.12 and A7.7.18).

/// A branch to an address that the instruction contains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Branch {
    /// Address of the instruction.
    pub at: u32,
    /// Address that it branches to.
    pub target: u32,
}

/// Branches of the code that begins at `start`: calls (BL) and jumps (B), conditional or not.
pub fn branches(start: u32, code: &[u8]) -> Vec<Branch> {
    let (halfwords, _) = code.as_chunks();
    let mut words = halfwords.iter().map(|bytes| u16::from_le_bytes(*bytes)).zip((start..).step_by(2));
    let mut found = Vec::new();
    while let Some((first, at)) = words.next() {
        // A3.1: 0b11101, 0b11110 and 0b11111 begin an instruction of 32 bits.
        let offset = if first >= 0xE800 {
            words.next().and_then(|(second, _)| long_offset(first.into(), second.into()))
        } else {
            short_offset(first.into())
        };
        // Offsets count from the instruction's address plus 4.
        found.extend(offset.map(|offset| Branch { at, target: at.wrapping_add(4).wrapping_add_signed(offset) }));
    }
    found
}

/// Offset of a branch of 16 bits: B, encodings T1 and T2.
fn short_offset(word: u32) -> Option<i32> {
    match word >> 12 {
        0b1101 if word >> 8 & 0xF < 0b1110 => Some(signed(word << 1 & 0x1FF, 9)),
        0b1110 => Some(signed(word << 1 & 0xFFF, 12)),
        _ => None,
    }
}

/// Offset of a branch of 32 bits: BL, and B, encodings T3 and T4.
fn long_offset(first: u32, second: u32) -> Option<i32> {
    if first >> 11 != 0b11110 || second >> 15 == 0 {
        return None;
    }
    let (sign, j1, j2) = (first >> 10 & 1, second >> 13 & 1, second >> 11 & 1);
    let low = second << 1 & 0xFFE;
    if second >> 12 & 1 == 1 {
        let (i1, i2) = (1 ^ j1 ^ sign, 1 ^ j2 ^ sign);
        return Some(signed(sign << 24 | i1 << 23 | i2 << 22 | (first & 0x3FF) << 12 | low, 25));
    }
    let is_conditional = second >> 14 & 1 == 0 && first >> 6 & 0xF < 0b1110;
    is_conditional.then(|| signed(sign << 20 | j2 << 19 | j1 << 18 | (first & 0x3F) << 12 | low, 21))
}

/// Extends the sign of a number of so many bits.
fn signed(bits: u32, width: u32) -> i32 {
    (bits as i32) << (32 - width) >> (32 - width)
}

/// Code, and the branches in it: place and target.
type Case<'c> = (&'c [u8], Vec<(u32, u32)>);

#[test]
fn branches_are_decoded_as_an_assembler_encodes_them() {
    let targets = |code: &[u8]| branches(0x8_0000, code).into_iter().map(|branch| (branch.at, branch.target)).collect();
    let cases: [Case; 7] = [
        // nop; b 0x80000
        (&[0x00, 0xBF, 0xFD, 0xE7], vec![(0x8_0002, 0x8_0000)]),
        // bne 0x80008
        (&[0x02, 0xD1], vec![(0x8_0000, 0x8_0008)]),
        // bl 0x9b75a
        (&[0x1B, 0xF0, 0xAB, 0xFB], vec![(0x8_0000, 0x9_B75A)]),
        // bl 0x7fffc
        (&[0xFF, 0xF7, 0xFC, 0xFF], vec![(0x8_0000, 0x7_FFFC)]),
        // b.w 0x81004
        (&[0x01, 0xF0, 0x00, 0xB8], vec![(0x8_0000, 0x8_1004)]),
        // beq.w 0x80104
        (&[0x00, 0xF0, 0x80, 0x80], vec![(0x8_0000, 0x8_0104)]),
        // movw r0, #0xe7fd; udf #0; svc #0: none of them is a branch
        (&[0x4E, 0xF2, 0xFD, 0x70, 0x00, 0xDE, 0x00, 0xDF], vec![]),
    ];
    for (code, expected) in cases {
        let found: Vec<(u32, u32)> = targets(code);
        assert_eq!(found, expected, "{code:02x?}");
    }
}
