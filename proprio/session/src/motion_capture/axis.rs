//! Axes of a capture volume.

/// An axis of a right-handed capture volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// The first.
    X,
    /// The second: vertical in Motive.
    Y,
    /// The third: vertical in Vicon's and Qualisys' programs.
    Z,
}

impl Axis {
    /// Index of the axis, from 0.
    pub(super) const fn index(self) -> usize {
        self as usize
    }

    /// The two other axes in cyclic order, so that they and this one are right-handed.
    pub(super) const fn others(self) -> [usize; 2] {
        match self {
            Self::X => [1, 2],
            Self::Y => [2, 0],
            Self::Z => [0, 1],
        }
    }

    /// Place in the plane that is seen from this axis: to the right, ahead.
    pub(super) const fn in_plane(self, [x, y, z]: [f64; 3]) -> [f64; 2] {
        match self {
            Self::X => [y, z],
            Self::Y => [x, -z],
            Self::Z => [x, y],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Axis;

    /// With y up, z points to the viewer's feet.
    #[test]
    fn a_place_behind_the_origin_of_motive_is_ahead() {
        let is_ahead = |[x, y]: [f64; 2]| (x - 0.1).abs() < 1e-12 && (y - 0.2).abs() < 1e-12;
        assert!(is_ahead(Axis::Y.in_plane([0.1, 5.0, -0.2])) && is_ahead(Axis::Z.in_plane([0.1, 0.2, 5.0])));
    }
}
