//! A table as Rust source, for a firmware that holds it as a constant, and the checksum by which board and host know
//! that they mean the same table.

use std::fmt::Write;

use estimator_core::{
    Alike, BendMap, ContactRule, Hysteresis, Noise, ObserverRule, OffsetAt, Play, Q, Segment, UncertaintyRule,
};

use crate::bake::Baked;

/// CRC-32 as in zip and Ethernet.
const CRC_32: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

impl Baked<Q> {
    /// Rust source of `SEGMENTS` and `TABLE`, bit for bit these parameters.
    ///
    /// A firmware's build script writes it to a file, which the firmware includes:
    ///
    /// ```
    /// use calibration_tables::ArmFile;
    /// use estimator_core::Q;
    ///
    /// let file = ArmFile::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/planar-6.toml")))?;
    /// let source = file.bake::<Q>(100.0)?.to_rust();
    /// assert!(source.contains("pub static TABLE: Table<'static, Q>"));
    /// # Ok::<(), calibration_tables::FileError>(())
    /// ```
    #[must_use]
    pub fn to_rust(&self) -> String {
        let table = self.table();
        let (segments, anchor) = (table.segments, table.anchor);
        let mut source =
            String::from("use estimator_core::{AnchorRule, BendMap, Noise, OffsetAt, Q, Segment, Table, Turns};\n\n");
        let count = segments.len();
        let _ = writeln!(source, "/// The arm's segments, from the base.\nstatic SEGMENTS: [Segment<Q>; {count}] = [");
        for segment in segments {
            source.push_str(&segment_source(segment));
        }
        let _ = writeln!(
            source,
            "];\n\n/// The arm's table.\npub static TABLE: Table<'static, Q> = Table {{\n    segments: &SEGMENTS,\n    tare_samples: {},\n    anchor: AnchorRule {{ window: \
             {}, rate_millihertz: {}, sample_rate_millihertz: {}, threshold: Turns::from_bits({}) }},\n    observer: {},\n    contact: {},\n    uncertainty: {},\n}};",
            table.tare_samples,
            anchor.window,
            anchor.rate_millihertz,
            anchor.sample_rate_millihertz,
            anchor.threshold.bits(),
            option(table.observer.as_ref(), observer_source),
            option(table.contact.as_ref(), contact_source),
            option(table.uncertainty.as_ref(), uncertainty_source)
        );
        source
    }

    /// CRC-32 of the parameters: the same for two tables that make the same estimates.
    ///
    /// It is that of [`to_rust`](Self::to_rust)'s text, which has every bit of them in one fixed form.
    #[must_use]
    pub fn checksum(&self) -> u32 {
        CRC_32.checksum(self.to_rust().as_bytes())
    }
}

fn option<T>(value: Option<T>, source: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| "None".to_owned(), source)
}

fn contact_source(ContactRule { bend, alike }: &ContactRule) -> String {
    let [bend, alike] = [bend, alike].map(|angle| format!("Turns::from_bits({})", angle.bits()));
    format!("Some(estimator_core::ContactRule {{ bend: {bend}, alike: {alike} }})")
}

fn uncertainty_source(rule: &UncertaintyRule<Q>) -> String {
    format!(
        "Some(estimator_core::UncertaintyRule {{ theta: {}, drift: {}, bend: {}, contact: {}, heading: {}, end: {} }})",
        q(rule.theta),
        q(rule.drift),
        q(rule.bend),
        q(rule.contact),
        q(rule.heading),
        q(rule.end)
    )
}

fn alike_source(Alike { segment, ratio }: Alike) -> String {
    format!("Some(estimator_core::Alike {{ segment: {segment}, ratio: {ratio} }})")
}

fn observer_source(rule: &ObserverRule) -> String {
    let ObserverRule { step, prior, growth, gate, patience, jump, still, doubt } = rule;
    let [gate, jump, still] = [gate, jump, still].map(|angle| format!("Turns::from_bits({})", angle.bits()));
    format!(
        "Some(estimator_core::ObserverRule {{ step: {step}, prior: {prior:?}, growth: {growth:?}, gate: {gate}, patience: {patience}, jump: \
         {jump}, still: {still}, doubt: {doubt} }})"
    )
}

fn segment_source(segment: &Segment<Q>) -> String {
    let offset_at = match segment.offset_at {
        OffsetAt::Start => "Start",
        OffsetAt::End => "End",
    };
    let maps = segment.bend.each_ref().map(|map| option(map.as_ref(), map_source));
    format!(
        "    Segment {{\n        length: {},\n        offset: {},\n        offset_at: OffsetAt::{offset_at},\n        bend: \
         [{}],\n        hysteresis: {},\n        alike: {},\n        reference: Turns::from_bits({}),\n        orient: {},\n        coord: {},\n    }},\n",
        q(segment.length),
        q(segment.offset),
        maps.join(", "),
        option(segment.hysteresis.as_ref(), hysteresis_source),
        option(segment.alike, alike_source),
        segment.reference.bits(),
        noise(&segment.orient),
        noise(&segment.coord)
    )
}

fn hysteresis_source(plays: &Hysteresis<Q>) -> String {
    let play = |play: &Play<Q>| {
        format!("estimator_core::Play {{ half_width: {}, weight: {} }}", q(play.half_width), q(play.weight))
    };
    format!("Some([{}])", plays.each_ref().map(play).join(", "))
}

fn map_source(map: &BendMap<Q>) -> String {
    format!(
        "Some(BendMap {{ center: {}, shift: {}, coefficients: [{}], readable: {:?} }})",
        map.center,
        map.shift,
        map.coefficients.map(q).join(", "),
        map.readable
    )
}

fn noise(noise: &Noise<Q>) -> String {
    format!(
        "Noise {{ q: {}, r_imu: {}, r_bend: {}, h_imu: {}, h_bend: {} }}",
        q(noise.q),
        q(noise.r_imu),
        q(noise.r_bend),
        q(noise.h_imu),
        q(noise.h_bend)
    )
}

fn q(value: Q) -> String {
    format!("Q::from_bits({})", value.to_bits())
}
