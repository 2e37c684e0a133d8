//! The page, put together.

use crate::embed::{fill, script_safe, text_safe};
use crate::mesh::EmbeddedMesh;
use clearway_plan::PlanFile;
use clearway_plan::plan_file::GripperValue;
use thiserror::Error;

const TEMPLATE: &str = include_str!("../page/page.html");
const STYLE: &str = include_str!("../page/style.css");

/// In order: each may use what stands before it.
const SCRIPTS: [&str; 18] = [
    include_str!("../page/math.js"),
    include_str!("../page/urdf.js"),
    include_str!("../page/kinematics.js"),
    include_str!("../page/push.js"),
    include_str!("../page/timeline.js"),
    include_str!("../page/words.js"),
    include_str!("../page/theme.js"),
    include_str!("../page/shapes.js"),
    include_str!("../page/shaders.js"),
    include_str!("../page/gl.js"),
    include_str!("../page/camera.js"),
    include_str!("../page/bodies.js"),
    include_str!("../page/stage.js"),
    include_str!("../page/labels.js"),
    include_str!("../page/topview.js"),
    include_str!("../page/panel.js"),
    include_str!("../page/controls.js"),
    include_str!("../page/main.js"),
];

/// Why a page could not be made.
#[derive(Debug, Error)]
pub enum PageError {
    #[error("the plan cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    #[error(
        "the mesh `{uri}` has a coordinate that is not finite or a triangle without its vertices; \
         repair the file, or make the page without it"
    )]
    Mesh { uri: String },
}

/// The plan as one HTML page. Links whose only shape is a mesh are drawn as bones; to have them
/// whole, see [`page_with_meshes`].
///
/// Joint rows are rounded to 1e-6 rad (or m), times to 1 µs.
pub fn page(plan: &PlanFile) -> Result<String, PageError> {
    page_with_meshes(plan, &[])
}

/// The plan as one HTML page with these meshes in it, for the robot's links and the scene's bodies.
pub fn page_with_meshes(plan: &PlanFile, meshes: &[EmbeddedMesh]) -> Result<String, PageError> {
    let packed = meshes
        .iter()
        .map(|mesh| mesh.packed().ok_or_else(|| PageError::Mesh { uri: mesh.uri.clone() }))
        .collect::<Result<Vec<_>, _>>()?;
    let title = match plan.scene.name.as_str() {
        "" => "Clearway plan".to_owned(),
        name => format!("{} – Clearway", text_safe(name)),
    };
    let script = format!("(() => {{\n'use strict';\n{}}})();", SCRIPTS.join("\n"));
    Ok(fill(
        TEMPLATE,
        &[
            ("title", &title),
            ("style", STYLE),
            ("plan", &script_safe(&serde_json::to_string(&rounded(plan))?)),
            ("meshes", &script_safe(&serde_json::to_string(&packed)?)),
            ("script", &script),
        ],
    ))
}

/// The plan with rows short enough to embed.
fn rounded(plan: &PlanFile) -> PlanFile {
    let round = |value: &mut f64| *value = (*value * 1e6).round() / 1e6;
    let mut plan = plan.clone();
    for segment in plan.steps.iter_mut().flat_map(|step| &mut step.segments) {
        segment.times.iter_mut().for_each(round);
        segment.positions.iter_mut().flatten().for_each(round);
        for value in segment.gripper.values_mut() {
            match value {
                GripperValue::Held(value) => round(value),
                GripperValue::Rows(rows) => rows.iter_mut().for_each(round),
            }
        }
    }
    plan
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_code_is_small_and_cannot_end_its_own_element() {
        let code: usize = SCRIPTS.iter().map(|s| s.len()).sum::<usize>() + STYLE.len() + TEMPLATE.len();
        assert!(code < 150_000, "{code} bytes");
        for script in SCRIPTS {
            assert!(!script.contains("</script") && !script.contains("<!--"));
        }
    }

    #[test]
    fn the_page_names_no_address() {
        for text in SCRIPTS.iter().chain([&STYLE, &TEMPLATE]) {
            assert!(!text.contains("http://") && !text.contains("https://") && !text.contains("@import"));
        }
    }
}
