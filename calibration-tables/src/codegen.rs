//! Rust source of a table, for a firmware that holds it as a constant, and the checksum by which board and host compare
//! their tables.

use estimator_core::Q;

use crate::compile::CompiledTable;

/// CRC-32 as in zip and Ethernet.
const CRC_32: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// Imports of the generated source.
const IMPORTS: &str = "#[allow(unused_imports)] // A table uses some of them.
use estimator_core::BendMap::{Curve, Quadratic};
#[allow(unused_imports)]
use estimator_core::OffsetAt::{End, Start};
#[allow(unused_imports)]
use estimator_core::{
    AnchorConfig, ArmConfig, BendErrorConfig, BendSensorConfig, BiasFilterConfig, ChangeLimit, ContactConfig,
    ContactLimits, CoupledSegment, Coupling, CurveMap, KalmanParams, Lag, MemoryConfig, Play, Q, QuadraticMap, Response, SegmentConfig, Turns, UncertaintyConfig,
};
";

impl CompiledTable<Q> {
    /// Rust source of `SEGMENTS` and `TABLE`, bit for bit these parameters.
    ///
    /// The configuration's `Debug` form is a Rust expression once the constructors of the two number types are
    /// inserted. A firmware's build script writes it to a file, which the firmware includes (see the [crate's
    /// docs](crate)):
    ///
    /// ```
    /// use calibration_tables::ArmFile;
    /// use estimator_core::Q;
    ///
    /// let file = ArmFile::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/planar-6.toml")))?;
    /// let source = file.compile::<Q>(100.0)?.to_rust();
    /// assert!(source.contains("pub static TABLE: ArmConfig<'static, Q>"));
    /// # Ok::<(), calibration_tables::FileError>(())
    /// ```
    #[must_use]
    pub fn to_rust(&self) -> String {
        let config = self.config();
        let expression = |text: String| {
            text.replace(" Q(", " Q::from_bits(")
                .replace("[Q(", "[Q::from_bits(")
                .replace(" Turns(", " Turns::from_bits(")
                .replace("Some(Q(", "Some(Q::from_bits(")
        };
        let segments = expression(format!("{:#?}", config.segments));
        let arm = estimator_core::ArmConfig { segments: &[], ..config };
        let arm = expression(format!("{arm:?}")).replace("segments: []", "segments: &SEGMENTS");
        let count = config.segments.len();
        format!(
            "{IMPORTS}\n/// The arm's segments, from the base.\nstatic SEGMENTS: [SegmentConfig<Q>; {count}] = {segments};\n\n/// The arm's \
             table.\npub static TABLE: ArmConfig<'static, Q> = {arm};\n"
        )
    }

    /// CRC-32 of the parameters, equal for tables with the same parameters.
    ///
    /// It is computed over the text of [`to_rust`](Self::to_rust), which contains every bit of the parameters in a
    /// fixed form, and of the wiring where the table has one.
    #[must_use]
    pub fn checksum(&self) -> u32 {
        let mut digest = CRC_32.digest();
        digest.update(self.to_rust().as_bytes());
        if let Some(wiring) = &self.wiring {
            digest.update(format!("{wiring:?}").as_bytes());
        }
        digest.finalize()
    }
}
