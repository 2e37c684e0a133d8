//! Positions with `rpy` or `quaternion`, as poses.

use crate::numbers;
use crate::source::Source;
use clearway_files::FileError;
use clearway_geometry::{Pose, Vec3};
use clearway_plan::scene_file::PoseKeys;

pub(crate) fn of_keys(source: &Source, keys: &str, pose: &PoseKeys) -> Result<Pose, FileError> {
    read(source, keys, pose.position, pose.rpy, pose.quaternion)
}

/// The pose whose three keys stand in the mapping at `keys`.
pub(crate) fn read(
    source: &Source,
    keys: &str,
    position: [f64; 3],
    rpy: Option<[f64; 3]>,
    quaternion: Option<[f64; 4]>,
) -> Result<Pose, FileError> {
    numbers::coordinates(source, &format!("{keys}.position"), "position", position)?;
    let translation = Vec3::from(position);
    match (rpy, quaternion) {
        (Some(_), Some(_)) => Err(source
            .error(&format!("{keys}.quaternion"), "both `rpy` and `quaternion` are given")
            .expected("one of the two")
            .help("delete one of them")),
        (None, None) => Ok(Pose::from_translation(translation)),
        (Some(rpy), None) => {
            numbers::angles(source, &format!("{keys}.rpy"), "rpy", &rpy)?;
            Ok(Pose::from_rpy(rpy, translation))
        }
        (None, Some(q)) => {
            let keys = format!("{keys}.quaternion");
            numbers::finite(source, &keys, "quaternion", &q)?;
            let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
            // Rounded to two digits is close enough; farther off it is no rotation, but a mistake.
            if !(0.99..=1.01).contains(&length) {
                return Err(source
                    .error(&keys, format!("a quaternion of length {}", numbers::shown(length)))
                    .expected("length 1")
                    .help("the identity is [0, 0, 0, 1]: x, y, z, w"));
            }
            Ok(Pose::from_quaternion(q, translation))
        }
    }
}
