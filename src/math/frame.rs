//! Orthonormal frames.

use glam::Vec3;

/// Three unit vectors at right angles, right-handed: x × y = z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// First tangent.
    pub x: Vec3,
    /// Second tangent.
    pub y: Vec3,
    /// Normal.
    pub z: Vec3,
}

impl Frame {
    /// A frame around a unit `z` whose `x` is the projection of `tangent`; where that projection
    /// is shorter than 1e-4, [0, 0, 1] takes the tangent's place, then [0, 1, 0].
    #[inline(always)]
    pub fn from_normal_tangent(z: Vec3, tangent: Vec3) -> Self {
        let project = |candidate: Vec3| {
            let projection = candidate - z * candidate.dot(z);
            (projection, projection.length_squared())
        };
        const SHORT: f32 = 1e-8;
        let (x, length_squared) = project(tangent);
        let is_short = length_squared < SHORT;
        let (along_z, along_z_squared) = project(Vec3::Z);
        let (along_y, along_y_squared) = project(Vec3::Y);
        // Never are both of these short.
        let is_along_z = along_z_squared < SHORT;
        let other = if is_along_z { along_y } else { along_z };
        let other_squared = if is_along_z { along_y_squared } else { along_z_squared };
        let x = if is_short { other } else { x };
        let x = x / (if is_short { other_squared } else { length_squared }).sqrt();
        Self { x, y: z.cross(x), z }
    }

    /// Any frame around a unit `z`, without branches that would tear it.
    ///
    /// Source: T. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
    #[inline(always)]
    pub fn from_normal(z: Vec3) -> Self {
        let sign = 1.0_f32.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        Self {
            x: Vec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x),
            y: Vec3::new(b, sign + z.y * z.y * a, -z.y),
            z,
        }
    }

    /// World direction of a direction in this frame.
    #[inline(always)]
    pub fn world_from_local(&self, v: Vec3) -> Vec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    /// A world direction as seen in this frame.
    #[inline(always)]
    pub fn local_from_world(&self, v: Vec3) -> Vec3 {
        Vec3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        let normals =
            [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z, Vec3::new(0.6, -0.48, 0.64)];
        for z in normals {
            for frame in [Frame::from_normal(z), Frame::from_normal_tangent(z, Vec3::X)] {
                assert!(frame.x.dot(frame.y).abs() < 1e-6, "{frame:?}");
                assert!((frame.x.cross(frame.y) - frame.z).length() < 1e-6, "{frame:?}");
                assert!((frame.x.length() - 1.0).abs() < 1e-6, "{frame:?}");
            }
        }
    }

    #[test]
    fn a_tangent_along_the_normal_falls_back_to_z_then_y() {
        assert_eq!(Frame::from_normal_tangent(Vec3::X, Vec3::X).x, Vec3::Z, "x is world z");
        assert_eq!(Frame::from_normal_tangent(Vec3::Z, Vec3::Z).x, Vec3::Y, "x is world y");
    }
}
