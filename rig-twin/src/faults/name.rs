//! Names of faults: `DEVICE:FAULT` or `DEVICE:FAULT=VALUE`.

use core::fmt;
use core::str::FromStr;

use super::error::FaultError;
use super::fault::{BendPlace, Fault, Hold, SegmentNumber};
use super::forms::{Acts, FORMS, Form, ValueForm};

/// Interrupts of the chip (datasheet 11.1).
const INTERRUPTS: u8 = 45;

/// Number of a device among those of its kind.
#[derive(Clone, Copy)]
enum Number {
    None,
    Bend(BendPlace),
    Segment(SegmentNumber),
    Interrupt(u8),
}

impl FromStr for Fault {
    type Err = FaultError;

    fn from_str(name: &str) -> Result<Self, FaultError> {
        let unknown = || FaultError::Name(name.to_owned());
        let (device, rest) = name.split_once(':').ok_or_else(unknown)?;
        let (fault, value) = rest.split_once('=').map_or((rest, None), |(fault, value)| (fault, Some(value)));
        let (kind, number) = device_of(device).ok_or_else(unknown)?;
        let form = FORMS.iter().find(|form| form.kind == kind && form.fault == fault).ok_or_else(unknown)?;
        let value = match (form.value, value) {
            (None, None) => 0.0,
            (None, Some(_)) => return Err(FaultError::NoValue(name.to_owned())),
            (Some(expected), value) => value.and_then(|text| number_of(text, expected)).ok_or_else(|| {
                let ValueForm { low, high, unit, .. } = expected;
                let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
                FaultError::Value { name: name.to_owned(), low, high, unit, example: form.example() }
            })?,
        };
        make(number, form, value).ok_or_else(unknown)
    }
}

/// Kind and number of a device; `None` if there is no such device.
fn device_of(device: &str) -> Option<(&str, Number)> {
    if let Some(place) = device.strip_prefix("bend") {
        let side = ["a", "b"].iter().position(|side| place.ends_with(side))?;
        let segment: usize = place.get(..place.len() - 1)?.parse().ok()?;
        return Some(("bend", Number::Bend(BendPlace::new(2 * segment.checked_sub(1)? + side)?)));
    }
    if let Some(segment) = device.strip_prefix("imu") {
        let segment: usize = segment.parse().ok()?;
        return Some(("imu", Number::Segment(SegmentNumber::new(segment.checked_sub(1)?)?)));
    }
    if let Some(line) = device.strip_prefix("irq") {
        return Some(("irq", Number::Interrupt(line.parse().ok().filter(|line| *line < INTERRUPTS)?)));
    }
    Some((device, Number::None))
}

/// A value in its range.
fn number_of(text: &str, expected: ValueForm) -> Option<f64> {
    let number = match text.strip_prefix("0x") {
        Some(digits) => f64::from(u32::from_str_radix(digits, 16).ok()?),
        None => text.parse().ok()?,
    };
    let is_valid = (expected.low..=expected.high).contains(&number) && (!expected.is_whole || number.fract() == 0.0);
    is_valid.then_some(number)
}

/// The fault of a form; `None` if its device has no such number.
fn make(number: Number, form: &Form, value: f64) -> Option<Fault> {
    match number {
        Number::Bend(place) => bend(place, form.fault, value),
        Number::Segment(segment) => imu(segment, form.fault, value),
        Number::Interrupt(line) => Some(Fault::IrqMasked(line)),
        Number::None => board((form.kind, form.fault), value),
    }
}

fn bend(place: BendPlace, fault: &str, value: f64) -> Option<Fault> {
    Some(match fault {
        "open" => Fault::BendOpen(place),
        "short" => Fault::BendShort(place),
        "stuck" => Fault::BendStuck(place),
        "intermittent" => Fault::BendIntermittent(place),
        "drift" => Fault::BendDrift(place, value),
        "offset" => Fault::BendOffset(place, value),
        "factor" => Fault::BendFactor(place, value),
        _ => return None,
    })
}

fn imu(segment: SegmentNumber, fault: &str, value: f64) -> Option<Fault> {
    Some(match fault {
        "unplugged" => Fault::ImuUnplugged(segment),
        "reset" => Fault::ImuReset(segment),
        "brown-out" => Fault::ImuBrownOut(segment),
        "frozen" => Fault::ImuFrozen(segment),
        "jump" => Fault::ImuJump(segment, value),
        "random" => Fault::ImuRandom(segment),
        "zeros" => Fault::ImuZeros(segment),
        "norm" => Fault::ImuNorm(segment, value),
        "nack" => Fault::ImuNack(segment, value),
        "stretch" => Fault::ImuStretch(segment, value),
        _ => return None,
    })
}

fn board(name: (&str, &str), value: f64) -> Option<Fault> {
    Some(match name {
        ("sda", "held") => Fault::SdaHeld(Hold::UntilCleared),
        ("sda", "held-clocks") => Fault::SdaHeld(Hold::Clocks(value as u32)),
        ("sda", "held-until-reset") => Fault::SdaHeld(Hold::UntilMuxReset),
        ("scl", "held") => Fault::SclHeld(Hold::UntilCleared),
        ("scl", "held-clocks") => Fault::SclHeld(Hold::Clocks(value as u32)),
        ("scl", "held-until-reset") => Fault::SclHeld(Hold::UntilMuxReset),
        ("mux", "silent") => Fault::MuxSilent,
        ("mux", "stuck") => Fault::MuxStuck,
        ("mux", "wrong") => Fault::MuxWrong(value as u8),
        ("mux", "lying") => Fault::MuxLying(value as u8),
        ("adc", "stopped") => Fault::AdcStopped,
        ("adc", "tags") => Fault::AdcTags,
        ("adc", "tags-every-other") => Fault::AdcTagsEveryOther,
        ("line", "noise") => Fault::LineNoise(value),
        ("line", "flood") => Fault::LineFlood,
        ("line", "cut") => Fault::LineCut,
        ("line", "replay") => Fault::LineReplay(value),
        ("line", "reorder") => Fault::LineReorder,
        ("flash", "flip") => Fault::FlashFlip(value as u32),
        ("power", "cut") => Fault::PowerCut,
        ("stack", "overflow") => Fault::StackOverflow,
        _ => return None,
    })
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(sensor) = self.bend_sensor() {
            write!(f, "bend{}{}:", sensor / 2 + 1, if sensor.is_multiple_of(2) { 'a' } else { 'b' })?;
        }
        if let Some(segment) = self.imu() {
            write!(f, "imu{}:", segment + 1)?;
        }
        match *self {
            Self::BendOpen(_) => f.write_str("open"),
            Self::BendShort(_) => f.write_str("short"),
            Self::BendStuck(_) => f.write_str("stuck"),
            Self::BendIntermittent(_) => f.write_str("intermittent"),
            Self::BendDrift(_, counts_per_s) => write!(f, "drift={counts_per_s}"),
            Self::BendOffset(_, counts) => write!(f, "offset={counts}"),
            Self::BendFactor(_, factor) => write!(f, "factor={factor}"),
            Self::ImuUnplugged(_) => f.write_str("unplugged"),
            Self::ImuReset(_) => f.write_str("reset"),
            Self::ImuBrownOut(_) => f.write_str("brown-out"),
            Self::ImuFrozen(_) => f.write_str("frozen"),
            Self::ImuJump(_, degrees) => write!(f, "jump={degrees}"),
            Self::ImuRandom(_) => f.write_str("random"),
            Self::ImuZeros(_) => f.write_str("zeros"),
            Self::ImuNorm(_, norm) => write!(f, "norm={norm}"),
            Self::ImuNack(_, share) => write!(f, "nack={share}"),
            Self::ImuStretch(_, ms) => write!(f, "stretch={ms}"),
            Self::SdaHeld(hold) => write!(f, "sda:{hold}"),
            Self::SclHeld(hold) => write!(f, "scl:{hold}"),
            Self::MuxSilent => f.write_str("mux:silent"),
            Self::MuxStuck => f.write_str("mux:stuck"),
            Self::MuxWrong(channels) => write!(f, "mux:wrong={channels}"),
            Self::MuxLying(channels) => write!(f, "mux:lying={channels}"),
            Self::AdcStopped => f.write_str("adc:stopped"),
            Self::AdcTags => f.write_str("adc:tags"),
            Self::AdcTagsEveryOther => f.write_str("adc:tags-every-other"),
            Self::LineNoise(share) => write!(f, "line:noise={share}"),
            Self::LineFlood => f.write_str("line:flood"),
            Self::LineCut => f.write_str("line:cut"),
            Self::LineReplay(seconds) => write!(f, "line:replay={seconds}"),
            Self::LineReorder => f.write_str("line:reorder"),
            Self::FlashFlip(address) => write!(f, "flash:flip={address:#010x}"),
            Self::PowerCut => f.write_str("power:cut"),
            Self::IrqMasked(line) => write!(f, "irq{line}:masked"),
            Self::StackOverflow => f.write_str("stack:overflow"),
        }
    }
}

impl fmt::Display for Hold {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UntilCleared => f.write_str("held"),
            Self::Clocks(clocks) => write!(f, "held-clocks={clocks}"),
            Self::UntilMuxReset => f.write_str("held-until-reset"),
        }
    }
}

impl Fault {
    /// True if it changes the readings of the simulated sensors, so that it has a meaning for a session.
    pub fn acts_on_readings(self) -> bool {
        let name = self.to_string();
        let is_of = |form: &&Form| {
            let (device, fault) = name.split_once(':').unwrap_or_default();
            device.starts_with(form.kind) && fault.split('=').next() == Some(form.fault)
        };
        FORMS.iter().find(is_of).is_some_and(|form| form.acts == Acts::Sensor)
    }
}

#[cfg(test)]
mod tests {
    use super::{FORMS, Fault, FaultError, Form};

    #[test]
    fn every_name_of_the_reference_is_parsed_and_printed_the_same() {
        for name in FORMS.iter().map(Form::example) {
            assert_eq!(name.parse::<Fault>().map(|fault| fault.to_string()), Ok(name));
        }
    }

    #[test]
    fn devices_and_faults_that_do_not_exist_are_refused() {
        for name in
            ["", "imu", "imu3", "imu0:reset", "imu9:reset", "bend2c:open", "bend0a:open", "imu3:open", "irq45:masked"]
        {
            assert_eq!(name.parse::<Fault>(), Err(FaultError::Name(name.to_owned())));
        }
    }

    #[test]
    fn values_that_are_missing_or_out_of_range_are_refused_with_an_example() {
        for name in ["imu3:norm", "imu3:norm=", "imu3:norm=x", "imu3:norm=5", "imu3:norm=NaN", "mux:wrong=1.5"] {
            let error = name.parse::<Fault>().expect_err(name);
            assert!(matches!(error, FaultError::Value { .. }), "{error}");
        }
        assert_eq!("imu3:reset=1".parse::<Fault>(), Err(FaultError::NoValue("imu3:reset=1".to_owned())));
    }
}
