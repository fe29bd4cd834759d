//! Image of a table: the wiring, and the estimator's configuration in postcard's form, every bit of it.
//!
//! One [`Head`], the rows of the wiring, then each segment from the base. Segments are read one by one, so that a reader
//! needs no second copy.

use estimator_core::{AnchorConfig, ArmConfig, BiasFilterConfig, ContactConfig, Q, SegmentConfig, UncertaintyConfig};
use heapless::{String, Vec};
use serde::{Deserialize, Serialize};

use crate::error::{TableError, WiringError};
use crate::wiring::{MAX_SEGMENTS, Wiring};

/// Room for the name of an arm, bytes.
pub const ARM_NAME_BYTES: usize = 32;

/// All of a table but its wiring and its segments.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Head {
    arm: String<ARM_NAME_BYTES>,
    checksum: u32,
    segments: u8,
    regulators: u8,
    tare_samples: u32,
    anchor: AnchorConfig,
    bias_filter: Option<BiasFilterConfig>,
    contact: Option<ContactConfig>,
    uncertainty: Option<UncertaintyConfig>,
}

/// Writes the image of a table into `out` and returns its length in bytes. `checksum` is the number by which board and
/// host compare their tables; a longer name than [`ARM_NAME_BYTES`] is cut. Without a wiring, the
/// [reference wiring](Wiring::reference) for the number of segments is stored.
///
/// # Errors
/// [`TableError::TooLong`] if it does not fit; [`TableError::Segments`] for no segment or more than [`MAX_SEGMENTS`];
/// [`TableError::Wiring`].
pub fn write_image(
    arm: &str,
    checksum: u32,
    config: &ArmConfig<'_, Q>,
    wiring: Option<&Wiring>,
    out: &mut [u8],
) -> Result<usize, TableError> {
    let segments = config.segments.len();
    if !(1..=MAX_SEGMENTS).contains(&segments) {
        return Err(TableError::Segments);
    }
    let wiring = wiring.cloned().unwrap_or_else(|| Wiring::reference(segments));
    wiring.check().map_err(TableError::Wiring)?;
    if wiring.segments.len() != segments {
        return Err(TableError::Wiring(WiringError::Segments));
    }
    let head = Head {
        arm: cut(arm),
        checksum,
        segments: segments as u8,
        regulators: wiring.regulators.len() as u8,
        tare_samples: config.tare_samples,
        anchor: config.anchor,
        bias_filter: config.bias_filter,
        contact: config.contact,
        uncertainty: config.uncertainty,
    };
    let mut length = append(&head, out, 0)?;
    for row in wiring.rows() {
        length = append(&row, out, length)?;
    }
    for segment in config.segments {
        length = append(segment, out, length)?;
    }
    Ok(length)
}

/// Appends a value after `length` bytes and returns the new length.
fn append<T: Serialize>(value: &T, out: &mut [u8], length: usize) -> Result<usize, TableError> {
    let room = out.get_mut(length..).ok_or(TableError::TooLong)?;
    let used = postcard::to_slice(value, room).map_err(|_| TableError::TooLong)?;
    Ok(length + used.len())
}

/// Cuts a name at the room for it.
fn cut(name: &str) -> String<ARM_NAME_BYTES> {
    let cut = name.get(..name.floor_char_boundary(ARM_NAME_BYTES)).unwrap_or_default();
    String::try_from(cut).unwrap_or_default()
}

/// A table that was read from its image, with room for N segments.
///
/// It is large: make it as a static, and [read](Self::read) it there.
#[derive(Debug, Clone)]
pub struct BoardTable<const N: usize> {
    head: Option<Head>,
    wiring: Wiring,
    segments: Vec<SegmentConfig<Q>, N>,
}

impl<const N: usize> BoardTable<N> {
    /// A table without content.
    pub const fn new() -> Self {
        Self { head: None, wiring: Wiring::new(), segments: Vec::new() }
    }

    /// Reads an image. `window` is the longest window of the anchor that the board's estimator has room for. After an
    /// error the table has no content.
    ///
    /// # Errors
    /// [`TableError::Image`], [`TableError::Segments`], [`TableError::Window`] or [`TableError::Wiring`].
    pub fn read(&mut self, image: &[u8], window: u16) -> Result<(), TableError> {
        self.head = None;
        self.segments.clear();
        let head = read_image(image, N, window, &mut self.wiring, &mut |segment| {
            // `read_image` has compared the number of segments with N.
            let _ = self.segments.push(*segment);
        })?;
        self.head = Some(head);
        Ok(())
    }

    /// Name of the arm; empty without content.
    pub fn arm(&self) -> &str {
        self.head.as_ref().map_or("", |head| &head.arm)
    }

    /// Checksum by which board and host compare their tables; 0 without content.
    pub fn checksum(&self) -> u32 {
        self.head.as_ref().map_or(0, |head| head.checksum)
    }

    /// Wiring of the arm, the reference wiring for a table that has none; `None` without content.
    pub fn wiring(&self) -> Option<&Wiring> {
        self.head.as_ref().map(|_| &self.wiring)
    }

    /// The estimator's configuration; `None` without content.
    pub fn config(&self) -> Option<ArmConfig<'_, Q>> {
        self.head.as_ref().map(|head| ArmConfig {
            segments: &self.segments,
            tare_samples: head.tare_samples,
            anchor: head.anchor,
            bias_filter: head.bias_filter,
            contact: head.contact,
            uncertainty: head.uncertainty,
        })
    }
}

impl<const N: usize> Default for BoardTable<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// Checks that an image can be read by an estimator with room for so many segments and so long a window.
///
/// # Errors
/// As [`BoardTable::read`].
pub(crate) fn check(image: &[u8], segments: usize, window: u16) -> Result<(), TableError> {
    read_image(image, segments, window, &mut Wiring::new(), &mut |_| {}).map(|_| ())
}

fn read_image(
    image: &[u8],
    room: usize,
    window: u16,
    wiring: &mut Wiring,
    visit: &mut dyn FnMut(&SegmentConfig<Q>),
) -> Result<Head, TableError> {
    let (head, rest) = postcard::take_from_bytes::<Head>(image).map_err(|_| TableError::Image)?;
    if head.segments == 0 || usize::from(head.segments) > room {
        return Err(TableError::Segments);
    }
    if head.anchor.window == 0 || head.anchor.window > window {
        return Err(TableError::Window);
    }
    let rows = wiring.read(rest, head.segments.into(), head.regulators.into());
    let mut rest = rows.ok_or(TableError::Image)?;
    wiring.check().map_err(TableError::Wiring)?;
    for _ in 0..head.segments {
        // By reference and without `map_err`: each copy of a segment takes a kilobyte of the board's stack.
        match postcard::take_from_bytes(rest) {
            Ok((segment, after)) => {
                visit(&segment);
                rest = after;
            }
            Err(_) => return Err(TableError::Image),
        }
    }
    rest.is_empty().then_some(head).ok_or(TableError::Image)
}
