//! The estimator's arithmetic and soft float on random inputs, hashed.

use estimator_core::{Angle, FusedOps, ImuReading, Phase, Q, Scalar, Turns, UnitArc};

use crate::random::Random;

/// A hash of 32-bit words.
struct Hash(u32);

impl Hash {
    fn word(&mut self, word: u32) {
        self.0 = (self.0.rotate_left(5) ^ word).wrapping_mul(0x9E37_79B1);
    }

    fn int(&mut self, value: i32) {
        self.word(value as u32);
    }

    fn long(&mut self, value: i64) {
        self.word(value as u32);
        self.word((value >> 32) as u32);
    }

    fn q(&mut self, value: Q) {
        self.int(value.to_bits());
    }

    // The bits of a NaN are not specified.
    fn f32(&mut self, value: f32) {
        self.word(if value.is_nan() { 0x7FC0_0000 } else { value.to_bits() });
    }

    fn f64(&mut self, value: f64) {
        self.long(if value.is_nan() { 0x7FF8 << 48 } else { value.to_bits() as i64 });
    }
}

/// A part of the arithmetic, on one random input.
type Part = fn(&mut Random, &mut Hash);

const PARTS: [(&str, Part); 5] =
    [("numbers", numbers), ("angles", angles), ("arcs", arcs), ("headings", headings), ("floats", floats)];

/// The name of each part, and the hash of its results on `inputs` random inputs.
pub fn hashes(inputs: u32) -> impl Iterator<Item = (&'static str, u32)> {
    PARTS.into_iter().map(move |(name, part)| {
        let (mut random, mut hash) = (Random::new(0x2545_F491), Hash(0));
        for _ in 0..inputs {
            part(&mut random, &mut hash);
        }
        (name, hash.0)
    })
}

fn q(random: &mut Random) -> Q {
    Q::from_bits(random.number())
}

fn numbers(random: &mut Random, hash: &mut Hash) {
    let [a, b, c] = [q(random), q(random), q(random)];
    for value in [a + b, a - b, a * b, a / b, -a, Q::dot([a, b], [c, a]), Q::dot([a, b, c], [b, c, a])] {
        hash.q(value);
    }
    hash.word(u32::from(a < b) << 1 | u32::from(a == b));
    hash.int(a.round());
    let (int, shift) = (random.number(), random.below(20));
    hash.q(Q::from_int(int));
    hash.q(Q::from_fraction(int, shift));
    hash.q(Q::from_phase(Phase::from_bits(int)));
    let half_turn = Phase::from_bits(random.bits() as i32);
    hash.q(Q::share_of_unwrapped(Q::from_phase(half_turn), int | 1));
    hash.long(a.to_turns().bits());
}

fn angles(random: &mut Random, hash: &mut Hash) {
    let (y, x) = (random.long(), random.long());
    hash.int(Phase::atan2(y, x).map_or(0, Phase::bits));
    let (a, b) = (Turns::from_bits(x), Turns::from_bits(y));
    for turns in [a + b, a - b, -a, a.magnitude(), a.mean_of(random.bits() as u16)] {
        hash.long(turns.bits());
    }
    hash.int(a.whole_turns());
    hash.int((a.phase() - b.phase()).bits());
    hash.q(Angle::<Q>::from(a).value());
}

fn arcs(random: &mut Random, hash: &mut Hash) {
    // Whole turns are rare.
    let turns = if random.below(8) == 0 { random.number() } else { 0 };
    let arc = UnitArc::new(Angle { remainder: q(random), whole_turns: turns });
    for value in [arc.lateral, arc.axial, arc.cos, arc.sin] {
        hash.q(value);
    }
}

fn headings(random: &mut Random, hash: &mut Hash) {
    let [yaw, roll, tilt] = core::array::from_fn(|_| {
        let remainder = Q::from_phase(Phase::from_bits(random.bits() as i32));
        UnitArc::new(Angle { remainder, whole_turns: 0 })
    });
    let quaternion = [tilt.cos * yaw.cos, tilt.sin * roll.cos, tilt.sin * roll.sin, tilt.cos * yaw.sin];
    // Of 26 fractional bits a BNO055 gives 14.
    let of_unit_norm = quaternion.map(|value| (value.to_bits() >> 12) as i16);
    let of_any_norm = core::array::from_fn(|_| random.number() as i16);
    for registers in [of_unit_norm, of_any_norm] {
        hash.int(ImuReading::from_bno055(registers).heading().map_or(1, Phase::bits));
    }
}

fn floats(random: &mut Random, hash: &mut Hash) {
    let [a, b] = core::array::from_fn(|_| single(random));
    for value in [a + b, a - b, a * b, a / b, a as i32 as f32] {
        hash.f32(value);
    }
    let [c, d] = core::array::from_fn(|_| double(random));
    for value in [c + d, c - d, c * d, c / d, f64::from(a), f64::from(random.number())] {
        hash.f64(value);
    }
    hash.f32(c as f32);
    hash.int(c as i32);
    hash.word(u32::from(a < b) << 1 | u32::from(c <= d));
}

/// Any float but a NaN; half of them near 1, where sums round.
fn single(random: &mut Random) -> f32 {
    let bits = random.bits();
    let value = f32::from_bits(if bits & 1 == 0 { bits } else { bits & 0x81FF_FFFF | 0x3E00_0000 });
    if value.is_nan() { 1.0 } else { value }
}

fn double(random: &mut Random) -> f64 {
    let bits = u64::from(random.bits()) << 32 | u64::from(random.bits());
    let value = f64::from_bits(if bits & 1 == 0 { bits } else { bits & 0x801F_FFFF_FFFF_FFFF | 0x3FE0 << 48 });
    if value.is_nan() { 1.0 } else { value }
}
