//! The tree of a plan's robot, out of the URDF in it: what hangs from what, and where for which
//! joint value. Shapes, inertias and limits are not read.
//!
//! Metres, radians; a link's frame is its parent joint's, as in URDF. Bounded: 32 MB of text,
//! 400 000 XML nodes, 4 000 joints.

use crate::ExportError;
use clearway_geometry::{Mat3, Pose, Vec3};
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::{HashMap, HashSet};

const MOST_BYTES: usize = 32 << 20;
const MOST_NODES: u32 = 400_000;
const MOST_JOINTS: usize = 4_000;

pub(crate) struct Urdf {
    /// The link that all others hang from.
    pub root: String,
    pub joints: Vec<Joint>,
    /// By link: the joint that it hangs from, as an index into `joints`.
    above: HashMap<String, usize>,
}

pub(crate) struct Joint {
    pub name: String,
    pub parent: String,
    pub child: String,
    /// The child's frame in the parent's, at joint value 0.
    origin: Pose,
    motion: Motion,
    pub mimic: Option<Mimic>,
}

#[derive(Clone, Copy)]
enum Motion {
    Still,
    Turn(Vec3),
    Slide(Vec3),
}

/// The joint's value is `multiplier` · `leader`'s + `offset`.
pub(crate) struct Mimic {
    pub leader: String,
    pub multiplier: f64,
    pub offset: f64,
}

impl Joint {
    pub fn moves(&self) -> bool {
        !matches!(self.motion, Motion::Still)
    }

    pub fn parent_from_child(&self, value: f64) -> Pose {
        self.origin
            * match self.motion {
                Motion::Still => Pose::IDENTITY,
                Motion::Turn(axis) => Pose::new(Mat3::from_axis_angle(axis, value), Vec3::ZERO),
                Motion::Slide(axis) => Pose::from_translation(axis * value),
            }
    }
}

impl Urdf {
    pub fn read(text: &str) -> Result<Self, ExportError> {
        if text.len() > MOST_BYTES {
            return Err(wrong(format!("{} bytes", text.len()), format!("at most {MOST_BYTES}")));
        }
        let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
        let document = Document::parse_with_options(text, options).map_err(|e| wrong(e, "XML"))?;
        let robot = document.root_element();
        if robot.tag_name().name() != "robot" {
            return Err(wrong(format!("<{}> outermost", robot.tag_name().name()), "<robot>"));
        }
        let links: Vec<&str> = children(robot, "link").map(name).collect::<Result<_, _>>()?;
        let joints: Vec<Joint> = children(robot, "joint").map(joint).collect::<Result<_, _>>()?;
        if joints.len() > MOST_JOINTS {
            return Err(wrong(format!("{} joints", joints.len()), format!("at most {MOST_JOINTS}")));
        }
        Self::tree(&links, joints)
    }

    fn tree(links: &[&str], joints: Vec<Joint>) -> Result<Self, ExportError> {
        let known: HashSet<&str> = links.iter().copied().collect();
        let names: HashMap<&str, &Joint> = joints.iter().map(|j| (j.name.as_str(), j)).collect();
        if known.len() < links.len() || names.len() < joints.len() {
            return Err(wrong("two links or two joints of one name", "every name once"));
        }
        let mut above = HashMap::new();
        for (index, joint) in joints.iter().enumerate() {
            for link in [&joint.parent, &joint.child] {
                if !known.contains(link.as_str()) {
                    return Err(wrong(format!("joint `{}` at link `{link}`", joint.name), "a link that there is"));
                }
            }
            if above.insert(joint.child.clone(), index).is_some() {
                return Err(wrong(format!("two joints that carry link `{}`", joint.child), "one"));
            }
            let mut followed = joint;
            for _ in 0..joints.len() {
                let Some(mimic) = &followed.mimic else { break };
                followed = names.get(mimic.leader.as_str()).copied().ok_or_else(|| {
                    wrong(format!("joint `{}` mimicking `{}`", followed.name, mimic.leader), "a joint that there is")
                })?;
            }
            if followed.mimic.is_some() {
                return Err(wrong(format!("joint `{}` mimicking itself", joint.name), "a joint that moves on its own"));
            }
        }
        let roots: Vec<&str> = links.iter().copied().filter(|l| !above.contains_key(*l)).collect();
        let &[root] = roots.as_slice() else {
            return Err(wrong(format!("{} links that hang from none", roots.len()), "one"));
        };
        let urdf = Self { root: root.to_owned(), joints, above };
        match links.iter().find(|link| urdf.chain(link).count() > links.len()) {
            Some(link) => Err(wrong(format!("link `{link}` hanging from itself"), "a tree")),
            None => Ok(urdf),
        }
    }

    pub fn has_link(&self, link: &str) -> bool {
        link == self.root || self.above.contains_key(link)
    }

    /// The joints from a link up to the root. Of a cycle, more than there are links.
    pub fn chain<'a>(&'a self, link: &str) -> impl Iterator<Item = &'a Joint> {
        let joint_above = |link: &str| self.above.get(link).map(|&j| &self.joints[j]);
        let most = self.joints.len() + 2;
        std::iter::successors(joint_above(link), move |joint| joint_above(&joint.parent)).take(most)
    }
}

fn joint(node: Node) -> Result<Joint, ExportError> {
    let name = name(node)?.to_owned();
    let end = |which: &str| {
        let link = child(node, which).and_then(|end| end.attribute("link"));
        link.map(str::to_owned).ok_or_else(|| wrong(format!("joint `{name}` without <{which} link>"), "both its links"))
    };
    let origin = child(node, "origin");
    let [xyz, rpy] = ["xyz", "rpy"].map(|key| origin.map_or(Ok([0.0; 3]), |o| numbers(o, key, [0.0; 3])));
    let axis = || -> Result<Vec3, ExportError> {
        let axis = child(node, "axis").map_or(Ok([1.0, 0.0, 0.0]), |a| numbers(a, "xyz", [1.0, 0.0, 0.0]))?;
        let direction = Vec3::from_array(axis).try_normalize();
        direction.ok_or_else(|| wrong(format!("joint `{name}` with the axis {axis:?}"), "a direction"))
    };
    let motion = match node.attribute("type").unwrap_or_default() {
        "fixed" => Motion::Still,
        "revolute" | "continuous" => Motion::Turn(axis()?),
        "prismatic" => Motion::Slide(axis()?),
        other => {
            return Err(wrong(
                format!("joint `{name}` of type `{other}`"),
                "`fixed`, `revolute`, `continuous` or `prismatic`",
            ));
        }
    };
    let mimic = match child(node, "mimic") {
        None => None,
        Some(mimic) => Some(Mimic {
            leader: mimic.attribute("joint").unwrap_or_default().to_owned(),
            multiplier: numbers(mimic, "multiplier", [1.0])?[0],
            offset: numbers(mimic, "offset", [0.0])?[0],
        }),
    };
    let origin = Pose::from_rpy(rpy?, Vec3::from_array(xyz?));
    Ok(Joint { parent: end("parent")?, child: end("child")?, origin, motion, mimic, name })
}

fn numbers<const N: usize>(node: Node, key: &str, default: [f64; N]) -> Result<[f64; N], ExportError> {
    let Some(text) = node.attribute(key) else { return Ok(default) };
    let values = text.split_whitespace().map(|word| word.parse().ok().filter(|v: &f64| v.is_finite()));
    let values: Option<Vec<f64>> = values.collect();
    let values = values.and_then(|v| <[f64; N]>::try_from(v).ok());
    values.ok_or_else(|| wrong(format!("`{key}=\"{text}\"`"), format!("{N} finite numbers")))
}

fn name<'a>(node: Node<'a, '_>) -> Result<&'a str, ExportError> {
    node.attribute("name").ok_or_else(|| wrong(format!("<{}> without a name", node.tag_name().name()), "a name"))
}

fn children<'a, 'i: 'a>(node: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |n| n.has_tag_name(name))
}

fn child<'a, 'i: 'a>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|n| n.has_tag_name(name))
}

fn wrong(found: impl ToString, expected: impl ToString) -> ExportError {
    ExportError::malformed("robot.urdf", found, expected)
}
