//! Everything in a scene file that is neither fixture nor object: robot, places, areas, camera.

use crate::numbers;
use crate::source::Source;
use clearway_files::FileError;
use clearway_plan::SceneFile;
use clearway_plan::scene_file::{Camera, Rect, Weights};

pub(crate) fn check(source: &Source, file: &SceneFile) -> Result<(), FileError> {
    if file.robot.model.trim().is_empty() {
        return Err(source
            .error("robot.model", "an empty robot model")
            .expected("a built-in robot's name, or the path of a robot file"));
    }
    for (joint, value) in file.robot.start.iter().flatten() {
        if !value.is_finite() {
            return Err(source
                .error(
                    &format!("robot.start.{joint}"),
                    format!("the start of {} is {value}", clearway_files::quoted(joint)),
                )
                .expected("a finite joint value"));
        }
    }
    rectangle(source, "robot.region", file.robot.region.as_ref())?;
    rectangle(source, "workspace", file.workspace.as_ref())?;
    if let Some(exit) = file.exit {
        numbers::coordinates(source, "exit", "exit", exit)?;
    }
    for (i, place) in file.place.iter().enumerate() {
        for (axis, length) in place.size.iter().enumerate() {
            numbers::size(source, &format!("place.{i}.size.{axis}"), "a place's size", *length)?;
        }
        numbers::coordinates(source, &format!("place.{i}.position"), "position", place.position)?;
    }
    let Weights { removal, base_move, second } = file.weights;
    for (key, weight) in [("removal", removal), ("base_move", base_move), ("second", second)] {
        // Written so that NaN fails too.
        if !(0.0..=1e9).contains(&weight) {
            return Err(source
                .error(&format!("weights.{key}"), format!("the weight `weights.{key}` is {weight}"))
                .expected("a number from 0 to 1e9"));
        }
    }
    file.camera.as_ref().map_or(Ok(()), |camera| check_camera(source, camera))
}

fn rectangle(source: &Source, keys: &str, rect: Option<&Rect>) -> Result<(), FileError> {
    let Some(rect) = rect else { return Ok(()) };
    numbers::coordinates(source, &format!("{keys}.min"), "min", rect.min)?;
    numbers::coordinates(source, &format!("{keys}.max"), "max", rect.max)?;
    for (axis, name) in ["x", "y"].into_iter().enumerate() {
        if rect.min[axis] >= rect.max[axis] {
            return Err(source
                .error(
                    &format!("{keys}.min.{axis}"),
                    format!("min {name} is {}, max {name} is {}", rect.min[axis], rect.max[axis]),
                )
                .expected("min below max"));
        }
    }
    Ok(())
}

fn check_camera(source: &Source, camera: &Camera) -> Result<(), FileError> {
    numbers::coordinates(source, "camera.position", "position", camera.position)?;
    numbers::coordinates(source, "camera.look_at", "look_at", camera.look_at)?;
    let apart: f64 = camera.position.iter().zip(camera.look_at).map(|(p, l)| (p - l).abs()).sum();
    if apart < 1e-6 {
        return Err(source
            .error("camera.look_at", "the camera looks at the point where it stands")
            .expected("a point before it"));
    }
    // Written so that NaN fails too.
    if !(camera.fov > 0.0 && camera.fov < std::f64::consts::PI) {
        return Err(source
            .error("camera.fov", format!("a field of view of {}", camera.fov))
            .expected("an angle between 0 and π radians")
            .help("60 degrees are 1.047 radians"));
    }
    Ok(())
}
