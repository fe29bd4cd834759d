//! A table as Rust source, for a firmware that holds it as a constant, and the checksum by which board and host verify that
//! they have the same table.

use estimator_core::Q;

use crate::bake::Baked;

/// CRC-32 as in zip and Ethernet.
const CRC_32: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// Names that the source uses.
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

impl Baked<Q> {
    /// Rust source of `SEGMENTS` and `TABLE`, bit for bit these parameters.
    ///
    /// The configuration's `Debug` form is an expression of Rust but for the two number types, whose constructors are put in.
    /// A firmware's build script writes it to a file, which the firmware includes:
    ///
    /// ```
    /// use calibration_tables::ArmFile;
    /// use estimator_core::Q;
    ///
    /// let file = ArmFile::parse(include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/planar-6.toml")))?;
    /// let source = file.bake::<Q>(100.0)?.to_rust();
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

    /// CRC-32 of the parameters: the same for two tables that make the same estimates.
    ///
    /// It is that of [`to_rust`](Self::to_rust)'s text, which has every bit of them in one fixed form.
    #[must_use]
    pub fn checksum(&self) -> u32 {
        CRC_32.checksum(self.to_rust().as_bytes())
    }
}
