//! Rigid transforms. `a_from_b` takes coordinates in frame *b* to coordinates in frame *a*.

use glam::{DMat3, DQuat, DVec3, EulerRot};

/// A rigid transform: rotation, then translation (metres).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub rotation: DMat3,
    pub translation: DVec3,
}

impl Pose {
    pub const IDENTITY: Pose = Pose { rotation: DMat3::IDENTITY, translation: DVec3::ZERO };

    pub fn new(rotation: DMat3, translation: DVec3) -> Self {
        Self { rotation, translation }
    }

    pub fn from_translation(translation: DVec3) -> Self {
        Self { rotation: DMat3::IDENTITY, translation }
    }

    /// `quaternion` is `[x, y, z, w]`; it is normalised.
    pub fn from_quaternion(quaternion: [f64; 4], translation: DVec3) -> Self {
        let q = DQuat::from_array(quaternion).normalize();
        Self { rotation: DMat3::from_quat(q), translation }
    }

    /// `rpy` as in URDF: roll about fixed x, then pitch about fixed y, then yaw about fixed z.
    pub fn from_rpy(rpy: [f64; 3], translation: DVec3) -> Self {
        let rotation = DMat3::from_euler(EulerRot::ZYX, rpy[2], rpy[1], rpy[0]);
        Self { rotation, translation }
    }

    /// `[x, y, z, w]`, with `w ≥ 0`.
    pub fn quaternion(&self) -> [f64; 4] {
        let q = DQuat::from_mat3(&self.rotation).normalize();
        let q = if q.w < 0.0 { -q } else { q };
        q.to_array()
    }

    #[inline]
    pub fn inverse(&self) -> Pose {
        let rotation = self.rotation.transpose();
        Pose { rotation, translation: -(rotation * self.translation) }
    }

    /// Takes a point of this pose's inner frame to its outer frame.
    #[inline]
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.rotation * p + self.translation
    }

    /// Takes a point of this pose's outer frame to its inner frame.
    #[inline]
    pub fn inverse_point(&self, p: DVec3) -> DVec3 {
        self.rotation.transpose() * (p - self.translation)
    }

    /// The angle of the rotation from `self` to `other`, radians in `[0, π]`.
    pub fn angle_to(&self, other: &Pose) -> f64 {
        let r = self.rotation.transpose() * other.rotation;
        // Both branches lose precision in the other's range; `atan2` of the two is good everywhere.
        let sin = DVec3::new(r.y_axis.z - r.z_axis.y, r.z_axis.x - r.x_axis.z, r.x_axis.y - r.y_axis.x).length();
        let cos = r.x_axis.x + r.y_axis.y + r.z_axis.z - 1.0;
        sin.atan2(cos)
    }
}

impl std::ops::Mul for Pose {
    type Output = Pose;

    #[inline]
    fn mul(self, inner: Pose) -> Pose {
        Pose { rotation: self.rotation * inner.rotation, translation: self.point(inner.translation) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rpy_is_about_fixed_axes() {
        // Roll a quarter turn takes y to z; yaw a quarter turn afterwards leaves z where it is.
        let pose = Pose::from_rpy([std::f64::consts::FRAC_PI_2, 0.0, std::f64::consts::FRAC_PI_2], DVec3::ZERO);
        assert!((pose.point(DVec3::Y) - DVec3::Z).length() < 1e-12);
        assert!((pose.point(DVec3::X) - DVec3::Y).length() < 1e-12);
    }

    #[test]
    fn inverse_undoes() {
        let a = Pose::from_rpy([0.3, -1.1, 2.0], DVec3::new(1.0, 2.0, 3.0));
        let p = DVec3::new(-0.4, 0.2, 0.9);
        assert!((a.inverse().point(a.point(p)) - p).length() < 1e-12);
        assert!((a.inverse_point(a.point(p)) - p).length() < 1e-12);
        let b = Pose::from_quaternion(a.quaternion(), a.translation);
        assert!(a.angle_to(&b) < 1e-9);
        assert!((a.angle_to(&Pose::IDENTITY) - Pose::IDENTITY.angle_to(&a)).abs() < 1e-12);
    }
}
