//! The ends of a motion: joint values as written, checked, as postures.

use crate::Posture;
use clearway_files::{FileError, closest, quoted};
use clearway_plan::motion_file::JointValues;
use clearway_robot::Group;
use clearway_scene::Bodies;

/// Values past a limit by less than this are at it: limits are often written with fewer digits.
const ROUNDING: f64 = 1e-6;

/// The posture that stands at `keys`, within the joints' limits.
pub fn posture(
    bodies: &Bodies,
    keys: &str,
    what: &str,
    group: &Group,
    values: &JointValues,
) -> Result<Posture, FileError> {
    let names = &group.names;
    let (q, keys): (Posture, Vec<String>) = match values {
        JointValues::InOrder(list) => {
            if list.len() != names.len() {
                return Err(bodies.error(keys, format!("{what} has {} values", list.len())).expected(format!(
                    "{}: one for each of {}",
                    names.len(),
                    listed(names)
                )));
            }
            (list.clone(), (0..list.len()).map(|i| format!("{keys}.{i}")).collect())
        }
        JointValues::ByName(map) => {
            for name in map.keys().filter(|n| !names.contains(n)) {
                let error = bodies
                    .error(&format!("{keys}.{name}"), format!("{what}: joint {} is not planned for", quoted(name)))
                    .expected(format!("values for {}", listed(names)));
                return Err(match closest(name, names.iter().map(String::as_str)) {
                    Some(near) => error.help(format!("did you mean `{near}`?")),
                    None => error.help("joints that stand still get their values under `robot.fixed`"),
                });
            }
            let value = |name: &String| {
                map.get(name).copied().ok_or_else(|| {
                    bodies
                        .error(keys, format!("{what} says nothing of joint {}", quoted(name)))
                        .expected(format!("values for {}", listed(names)))
                })
            };
            (names.iter().map(value).collect::<Result<_, _>>()?, names.iter().map(|n| format!("{keys}.{n}")).collect())
        }
    };
    for (((value, keys), name), (low, high)) in q.iter().zip(&keys).zip(names).zip(group.lower.iter().zip(&group.upper))
    {
        if !value.is_finite() {
            return Err(bodies
                .error(keys, format!("{what} has joint {} at {value}", quoted(name)))
                .expected("a finite number"));
        }
        if !(*low - ROUNDING..=*high + ROUNDING).contains(value) {
            return Err(bodies
                .error(keys, format!("{what} is out of limits: joint {} at {value}", quoted(name)))
                .expected(format!("a value from {low} to {high}"))
                .help("radians, or metres for joints that slide; the limits are the URDF's"));
        }
    }
    Ok(q)
}

fn listed(names: &[String]) -> String {
    format!("`{}`", names.join("`, `"))
}
