//! Rotation of a body about the axis that is seen from.

use super::axis::Axis;

/// Columns of a body's rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Rotation {
    /// Unit quaternion x, y, z, w.
    Quaternion([usize; 4]),
    /// Euler angles about the body's own axes in this order, in units of the factor, rad.
    Euler { columns: [usize; 3], order: [Axis; 3], factor: f64 },
    /// Rotation vector x, y, z, whose length is the angle, in units of the factor, rad.
    Vector { columns: [usize; 3], factor: f64 },
    /// Rotation matrix, column by column.
    Matrix([usize; 9]),
}

impl Rotation {
    /// Twist of the body about an axis, rad, counter-clockwise as seen from it; `value` gives a column's number, and `None` of it
    /// is a missing rotation.
    ///
    /// It is the rotation about `up` of the swing-twist decomposition: tilts of the body do not count.
    pub fn twist<E>(&self, up: Axis, mut value: impl FnMut(usize) -> Result<Option<f64>, E>) -> Result<Option<f64>, E> {
        match *self {
            Self::Quaternion(columns) => Ok(values(columns, value)?.map(|quaternion| quaternion_twist(quaternion, up))),
            Self::Euler { columns, order, factor } => {
                let quaternion = |angles| euler(angles, order, factor);
                Ok(values(columns, value)?.map(|angles| quaternion_twist(quaternion(angles), up)))
            }
            Self::Vector { columns, factor } => {
                Ok(values(columns, value)?.map(|vector| quaternion_twist(exponential(vector, factor), up)))
            }
            Self::Matrix(columns) => Ok(values(columns, &mut value)?.map(|matrix| matrix_twist(&matrix, up))),
        }
    }
}

fn values<const K: usize, E>(
    columns: [usize; K],
    mut value: impl FnMut(usize) -> Result<Option<f64>, E>,
) -> Result<Option<[f64; K]>, E> {
    let mut found = [0.0; K];
    for (found, column) in found.iter_mut().zip(columns) {
        match value(column)? {
            Some(value) => *found = value,
            None => return Ok(None),
        }
    }
    Ok(Some(found))
}

fn quaternion_twist(quaternion: [f64; 4], up: Axis) -> f64 {
    2.0 * libm::atan2(quaternion[up.index()], quaternion[3])
}

fn matrix_twist(matrix: &[f64; 9], up: Axis) -> f64 {
    let [a, b] = up.others();
    let at = |row: usize, column: usize| matrix[3 * column + row];
    libm::atan2(at(b, a) - at(a, b), at(a, a) + at(b, b))
}

/// Quaternion of Euler angles: rotations about the body's own axes, one after the other.
fn euler(angles: [f64; 3], order: [Axis; 3], factor: f64) -> [f64; 4] {
    let mut product = [0.0, 0.0, 0.0, 1.0];
    for (angle, axis) in angles.into_iter().zip(order) {
        let half = 0.5 * angle * factor;
        let mut turn = [0.0, 0.0, 0.0, libm::cos(half)];
        turn[axis.index()] = libm::sin(half);
        product = multiply(product, turn);
    }
    product
}

/// Quaternion of a rotation vector.
fn exponential(vector: [f64; 3], factor: f64) -> [f64; 4] {
    let [x, y, z] = vector.map(|part| part * factor);
    let angle = (x * x + y * y + z * z).sqrt();
    let scale = if angle > 0.0 { libm::sin(0.5 * angle) / angle } else { 0.0 };
    [x * scale, y * scale, z * scale, libm::cos(0.5 * angle)]
}

/// Hamilton product of quaternions x, y, z, w.
fn multiply([ax, ay, az, aw]: [f64; 4], [bx, by, bz, bw]: [f64; 4]) -> [f64; 4] {
    [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::{Axis, Rotation, euler};

    fn twist_deg(rotation: Rotation, up: Axis, cells: &[f64]) -> f64 {
        let twist = rotation.twist(up, |column| Ok::<_, Infallible>(Some(cells[column])));
        twist.expect("cells are read").expect("nothing is missing").to_degrees()
    }

    #[test]
    fn a_turn_of_30_degrees_about_the_vertical_axis_is_the_same_in_all_forms() {
        let (sin, cos) = (15_f64.to_radians().sin(), 15_f64.to_radians().cos());
        let degree = 1_f64.to_radians();
        let quaternion = Rotation::Quaternion([0, 1, 2, 3]);
        let order = [Axis::X, Axis::Y, Axis::Z];
        let angles = Rotation::Euler { columns: [0, 1, 2], order, factor: degree };
        let vector = Rotation::Vector { columns: [0, 1, 2], factor: degree };
        let matrix = Rotation::Matrix([0, 1, 2, 3, 4, 5, 6, 7, 8]);
        let columns = [0.866_025_403_784, 0.5, 0.0, -0.5, 0.866_025_403_784, 0.0, 0.0, 0.0, 1.0];
        for found in [
            twist_deg(quaternion, Axis::Z, &[0.0, 0.0, sin, cos]),
            twist_deg(quaternion, Axis::Y, &[0.0, sin, 0.0, cos]),
            twist_deg(angles, Axis::Y, &[0.0, 30.0, 0.0]),
            twist_deg(vector, Axis::Z, &[0.0, 0.0, 30.0]),
            twist_deg(matrix, Axis::Z, &columns),
        ] {
            assert!((found - 30.0).abs() < 1e-6, "{found}");
        }
    }

    /// Row of a real export of Qualisys: yaw 0.12055°, roll −0.78772°, pitch 0.05832°.
    #[test]
    fn a_matrix_of_qualisys_has_its_stated_yaw() {
        let matrix = [1.0, 0.002_09, -0.001_05, -0.002_10, 0.999_90, -0.013_75, 0.001_02, 0.013_75, 0.999_90];
        let found = twist_deg(Rotation::Matrix([0, 1, 2, 3, 4, 5, 6, 7, 8]), Axis::Z, &matrix);
        assert!((found - 0.120_55).abs() < 1e-3, "{found}");
    }

    #[test]
    fn a_tilted_body_has_the_heading_of_a_level_one() {
        let tilted = euler([40.0, 5.0, 0.0], [Axis::Z, Axis::X, Axis::Y], 1_f64.to_radians());
        let found = twist_deg(Rotation::Quaternion([0, 1, 2, 3]), Axis::Z, &tilted);
        assert!((found - 40.0).abs() < 0.1, "{found}");
    }
}
