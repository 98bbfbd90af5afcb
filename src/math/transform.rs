//! Placing an object in the world.

use glam::{DMat3, DVec3, Vec3};

use crate::math::portable;

/// world = translation + linear · object, with its inverse. Held in f64: rays are brought to object
/// space with one rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    linear: DMat3,
    inverse: DMat3,
    translation: DVec3,
    is_identity: bool,
}

impl Transform {
    /// Leaves everything where it is.
    pub const IDENTITY: Self = Self {
        linear: DMat3::IDENTITY,
        inverse: DMat3::IDENTITY,
        translation: DVec3::ZERO,
        is_identity: true,
    };

    /// translate + Rz Ry Rx (scale p); `rotate_deg` about the fixed axes X, then Y, then Z.
    /// No component of `scale` may be 0.
    pub fn new(translate: DVec3, rotate_deg: DVec3, scale: DVec3) -> Self {
        let rotation =
            rotation_z(rotate_deg.z) * rotation_y(rotate_deg.y) * rotation_x(rotate_deg.x);
        let linear = rotation * DMat3::from_diagonal(scale);
        let inverse = DMat3::from_diagonal(scale.recip()) * rotation.transpose();
        let is_identity = linear == DMat3::IDENTITY && translate == DVec3::ZERO;
        Self { linear, inverse, translation: translate, is_identity }
    }

    /// Whether points and directions stay as they are, to the bit.
    pub fn is_identity(&self) -> bool {
        self.is_identity
    }

    /// A point of the object in the world.
    #[inline]
    pub fn world_from_object_point(&self, p: DVec3) -> DVec3 {
        if self.is_identity { p } else { self.moved_point(p) }
    }

    /// [`Transform::world_from_object_point`], also where nothing changes but signs of zeros.
    #[inline(always)]
    pub(crate) fn moved_point(&self, p: DVec3) -> DVec3 {
        self.linear * p + self.translation
    }

    /// A direction of the object in the world; not normalised.
    #[inline]
    pub fn world_from_object_vector(&self, v: DVec3) -> DVec3 {
        if self.is_identity {
            return v;
        }
        self.linear * v
    }

    /// A normal of the object in the world: by the inverse transpose; not normalised.
    #[inline]
    pub fn world_from_object_normal(&self, n: DVec3) -> DVec3 {
        if self.is_identity { n } else { self.moved_normal(n) }
    }

    /// [`Transform::world_from_object_normal`], also where nothing changes but signs of zeros.
    #[inline(always)]
    pub(crate) fn moved_normal(&self, n: DVec3) -> DVec3 {
        self.inverse.transpose() * n
    }

    /// A point of the world as the object sees it.
    #[inline]
    pub fn object_from_world_point(&self, p: DVec3) -> DVec3 {
        if self.is_identity { p } else { self.unmoved_point(p) }
    }

    /// [`Transform::object_from_world_point`], also where nothing changes but signs of zeros.
    #[inline(always)]
    pub(crate) fn unmoved_point(&self, p: DVec3) -> DVec3 {
        self.inverse * (p - self.translation)
    }

    /// A direction of the world as the object sees it; not normalised, so that distances along a
    /// ray keep their parameter.
    #[inline]
    pub fn object_from_world_vector(&self, v: DVec3) -> DVec3 {
        if self.is_identity { v } else { self.unmoved_vector(v) }
    }

    /// [`Transform::object_from_world_vector`], also where nothing changes but signs of zeros.
    #[inline(always)]
    pub(crate) fn unmoved_vector(&self, v: DVec3) -> DVec3 {
        self.inverse * v
    }

    /// Upper bound of the world's displacement, per axis, for a displacement of at most `extent`
    /// along every axis of the object.
    #[inline(always)]
    pub fn spread(&self, extent: f64) -> DVec3 {
        let m = self.linear;
        (m.x_axis.abs() + m.y_axis.abs() + m.z_axis.abs()) * extent
    }

    /// Direction carried to the world by scale and rotation, then normalised; `fallback` where it
    /// vanishes.
    pub fn world_direction(&self, v: Vec3, fallback: Vec3) -> Vec3 {
        (self.linear * v.as_dvec3()).try_normalize().map_or(fallback, |d| d.as_vec3())
    }
}

/// Sine and cosine of degrees, exact at multiples of 90.
fn sin_cos_deg(degrees: f64) -> (f64, f64) {
    let turn = degrees - 360.0 * (degrees / 360.0).floor();
    if turn == 0.0 {
        (0.0, 1.0)
    } else if turn == 90.0 {
        (1.0, 0.0)
    } else if turn == 180.0 {
        (0.0, -1.0)
    } else if turn == 270.0 {
        (-1.0, 0.0)
    } else {
        let radians = turn.to_radians();
        (portable::sin_f64(radians), portable::cos_f64(radians))
    }
}

fn rotation_x(degrees: f64) -> DMat3 {
    let (s, c) = sin_cos_deg(degrees);
    DMat3::from_cols(DVec3::X, DVec3::new(0.0, c, s), DVec3::new(0.0, -s, c))
}

fn rotation_y(degrees: f64) -> DMat3 {
    let (s, c) = sin_cos_deg(degrees);
    DMat3::from_cols(DVec3::new(c, 0.0, -s), DVec3::Y, DVec3::new(s, 0.0, c))
}

fn rotation_z(degrees: f64) -> DMat3 {
    let (s, c) = sin_cos_deg(degrees);
    DMat3::from_cols(DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0), DVec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotates_about_x_then_y_then_z_right_handed() {
        let quarter = Transform::new(DVec3::ZERO, DVec3::new(90.0, 90.0, 0.0), DVec3::ONE);
        // y goes to z about X, then z goes to x about Y.
        assert_eq!(quarter.world_from_object_point(DVec3::Y), DVec3::X, "y ends at x");
    }

    #[test]
    fn the_inverse_undoes_it() {
        let t = Transform::new(
            DVec3::new(1.0, -2.0, 3.0),
            DVec3::new(10.0, 20.0, 30.0),
            DVec3::new(2.0, -0.5, 3.0),
        );
        let p = DVec3::new(0.3, 0.7, -1.1);
        let back = t.object_from_world_point(t.world_from_object_point(p));
        assert!((back - p).length() < 1e-14, "{back} is not {p}");
        let tangent = t.world_from_object_vector(DVec3::X);
        let normal = t.world_from_object_normal(DVec3::Y);
        assert!(tangent.dot(normal).abs() < 1e-14, "normals stay at right angles to tangents");
    }
}
