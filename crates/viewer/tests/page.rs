//! The page is whole, asks for nothing, and carries the plan as it is, whatever the names in it.

use clearway_plan::PlanFile;
use clearway_viewer::{EmbeddedMesh, page, page_with_meshes};
use serde_json::{Value, json};

fn plan(name: &str) -> PlanFile {
    serde_json::from_value(json!({
        "format": "clearway-plan/1", "status": "solved", "seed": 1, "removed": ["o1"],
        "scene": {"format": "clearway-scene/1", "name": name, "robot": {"model": "x"},
                  "objects": [{"id": "o1", "sphere": {"radius": 0.05}, "position": [0.5, 0.0, 0.3]}], "target": "o1"},
        "robot": {"urdf": "<robot name=\"r\"><link name=\"base\"/></robot>", "joints": ["j"], "tool": "base",
                  "limits": {"velocity": {}, "acceleration": {}},
                  "hand": {"kind": "parallel", "frame": "base", "links": [], "base_radius": 0.05, "finger_thickness": 0.01}},
        "steps": [{"object": "o1", "action": "pick_place", "placed": {"position": [0, 0, 0], "quaternion": [0, 0, 0, 1]},
                   "segments": [{"kind": "transit", "times": [0.0, 0.02], "positions": [[0.123_456_789], [1.0 / 3.0]],
                                 "gripper": {"g": [0.1, 0.2]}, "attached": null}]}],
    }))
    .expect("a plan")
}

/// What the browser finds in the element: JSON up to the first end tag.
fn embedded(html: &str, id: &str) -> Value {
    let open = format!("<script type=\"application/json\" id=\"{id}\">");
    let from = html.find(&open).expect("the element") + open.len();
    let to = from + html[from..].find("</script").expect("its end");
    serde_json::from_str(&html[from..to]).expect("JSON")
}

#[test]
fn carries_the_plan_with_rows_rounded() {
    let html = page(&plan("shelf")).expect("a page");
    let found = embedded(&html, "plan");
    assert_eq!(found["steps"][0]["segments"][0]["positions"], json!([[0.123457], [0.333333]]));
    assert_eq!(found["robot"]["urdf"], plan("shelf").robot.urdf.as_str());
    assert!(html.contains("<title>shelf – Clearway</title>"));
    assert!(!html.contains("{{"), "no mark is left unfilled");
}

#[test]
fn no_name_breaks_out_of_its_element() {
    let name = "</script><!-- <script> & \u{2028} {{script}} </title>";
    let html = page(&plan(name)).expect("a page");
    assert_eq!(embedded(&html, "plan")["scene"]["name"], name);
    assert_eq!(html.matches("</script>").count(), 3, "the plan's, the meshes' and the code's");
    assert_eq!(html.matches("</title>").count(), 1);
}

#[test]
fn allows_itself_no_network() {
    let html = page(&plan("shelf")).expect("a page");
    assert!(html.contains("default-src 'none'"));
    assert!(!html.contains("http://") && !html.contains("https://") && !html.contains(" src="));
}

#[test]
fn embeds_meshes_and_refuses_broken_ones() {
    let mesh = EmbeddedMesh {
        uri: "package://arm/base.stl".into(),
        vertices: vec![[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.05]],
        triangles: vec![[0, 1, 2]],
    };
    let html = page_with_meshes(&plan("shelf"), std::slice::from_ref(&mesh)).expect("a page");
    let found = &embedded(&html, "meshes")[0];
    assert_eq!((&found["uri"], &found["triangles"]), (&json!(mesh.uri), &json!([0, 1, 2])));
    let broken = EmbeddedMesh { triangles: vec![[0, 1, 3]], ..mesh };
    let error = page_with_meshes(&plan("shelf"), &[broken]).expect_err("refused").to_string();
    assert!(error.contains("package://arm/base.stl"), "{error}");
}
