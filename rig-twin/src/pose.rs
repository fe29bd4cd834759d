//! World pose of a segment's end.

/// World position and heading of a segment's end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EndPose {
    /// Across the base's axis, to the right, m.
    pub x_m: f64,
    /// Along the base's axis, m.
    pub y_m: f64,
    /// Direction of the tangent, clockwise from the base's y axis, rad, not wrapped.
    pub heading_rad: f64,
}

impl EndPose {
    /// This pose moved along its tangent.
    pub(crate) fn ahead(self, distance_m: f64) -> Self {
        let (sin, cos) = libm::sincos(self.heading_rad);
        Self { x_m: self.x_m + distance_m * sin, y_m: self.y_m + distance_m * cos, ..self }
    }
}
