//! The parts of an SRDF that planning needs: pairs of links never checked, and named states.
//!
//! The rest (groups, end effectors, virtual joints, spheres) is passed over.

use super::element::{Source, children};
use super::model::{Joint, Link};
use clearway_files::{FileError, closest, quoted, xml};
use roxmltree::Node;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;

#[derive(Debug, Default)]
pub struct Srdf {
    /// Links `(a, b)`, `a < b`.
    pub disabled_pairs: BTreeSet<(usize, usize)>,
    /// Name → joint → value.
    pub named_states: BTreeMap<String, BTreeMap<String, f64>>,
}

pub fn read(path: &Path, text: &str, links: &[Link], joints: &[Joint]) -> Result<Srdf, FileError> {
    let document = xml::parse(path, text)?;
    let source = Source { path };
    let robot = document.root_element();
    if robot.tag_name().name() != "robot" {
        return Err(source
            .wrong(robot, format!("the outermost element is <{}>", robot.tag_name().name()))
            .expected("<robot>")
            .help("is this the right file? An SRDF is wanted"));
    }
    let mut srdf = Srdf::default();
    let number: HashMap<&str, usize> = links.iter().enumerate().map(|(i, l)| (l.name.as_str(), i)).collect();
    for pair in children(robot, "disable_collisions") {
        let link = |attribute: &str| {
            let name = source.name(pair, attribute)?;
            number
                .get(name)
                .copied()
                .ok_or_else(|| unknown(&source, pair, attribute, "link", name, links.iter().map(|l| l.name.as_str())))
        };
        let (a, b) = (link("link1")?, link("link2")?);
        if a == b {
            return Err(source
                .wrong(pair, "a link paired with itself")
                .expected("two links")
                .help("delete the element"));
        }
        srdf.disabled_pairs.insert((a.min(b), a.max(b)));
    }
    // Where the robot stands is the scene's affair, so joints to the world may be named but are not used.
    let virtual_joints: Vec<&str> = children(robot, "virtual_joint").filter_map(|n| n.attribute("name")).collect();
    for state in children(robot, "group_state") {
        let name = source.name(state, "name")?;
        let values = srdf.named_states.entry(name.to_owned()).or_default();
        for node in children(state, "joint") {
            let joint = source.name(node, "name")?;
            if virtual_joints.contains(&joint) {
                continue;
            }
            if !joints.iter().any(|j| j.name == joint) {
                return Err(unknown(&source, node, "name", "joint", joint, joints.iter().map(|j| j.name.as_str())));
            }
            let value = source.number(node, "value")?;
            let value = value.ok_or_else(|| source.wrong(node, "<joint> without `value`").help("add `value=\"…\"`"))?;
            values.insert(joint.to_owned(), value);
        }
    }
    Ok(srdf)
}

fn unknown<'n>(
    source: &Source,
    node: Node,
    attribute: &str,
    what: &str,
    name: &str,
    known: impl Iterator<Item = &'n str>,
) -> FileError {
    let error = source.wrong_attribute(node, attribute, format!("the URDF has no {what} {}", quoted(name)));
    match closest(name, known) {
        Some(near) => error.help(format!("did you mean `{near}`?")),
        None => error.help("correct the name, or delete the element: is this another robot's SRDF?"),
    }
}
