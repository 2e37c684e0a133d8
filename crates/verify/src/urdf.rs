//! Reads a URDF's text into a [`Model`]: links with their collision shapes, joints, limits, mimics.
//!
//! Bounded: 32 MB of text, 400 000 XML nodes, 4 000 links. Refused: a tree with cycles, several
//! roots or unknown links; duplicate names; numbers that are not finite; `planar` and `floating` joints.

use crate::error::CannotJudge;
use crate::meshes::Meshes;
use crate::model::{Joint, JointKind, Link, Mimic, Model};
use crate::shapes::{self, Piece};
use parry3d_f64::math::{Pose, Vector};
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::HashMap;

const MOST_BYTES: usize = 32 << 20;
const MOST_NODES: u32 = 400_000;
const MOST_LINKS: usize = 4_000;

type Read<T> = Result<T, CannotJudge>;

fn wrong<T>(what: impl Into<String>) -> Read<T> {
    Err(CannotJudge::Urdf(what.into()))
}

pub(crate) fn read(text: &str, meshes: &mut Meshes) -> Read<Model> {
    if text.len() > MOST_BYTES {
        return wrong(format!("{} bytes; at most {MOST_BYTES} are read", text.len()));
    }
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|e| CannotJudge::Urdf(e.to_string()))?;
    let robot = document.root_element();
    if robot.tag_name().name() != "robot" {
        return wrong(format!("the outermost element is <{}>; expected <robot>", robot.tag_name().name()));
    }
    let mut links = HashMap::new();
    for node in elements(robot, "link") {
        let name = attribute(node, "name")?;
        if links.insert(name, node).is_some() {
            return wrong(format!("two links are called {name:?}"));
        }
    }
    if links.len() > MOST_LINKS {
        return wrong(format!("{} links; at most {MOST_LINKS} are read", links.len()));
    }
    let joints: Vec<Node> = elements(robot, "joint").collect();
    Builder { links, joints }.build(robot, meshes)
}

struct Builder<'a, 'input> {
    links: HashMap<&'a str, Node<'a, 'input>>,
    joints: Vec<Node<'a, 'input>>,
}

impl<'a> Builder<'a, '_> {
    fn build(self, robot: Node<'a, '_>, meshes: &mut Meshes) -> Read<Model> {
        let mut below: HashMap<&str, Vec<usize>> = HashMap::new();
        let mut has_parent: HashMap<&str, usize> = HashMap::new();
        let mut ends = Vec::new();
        for (i, node) in self.joints.iter().enumerate() {
            let parent = attribute(child(*node, "parent")?, "link")?;
            let child = attribute(child(*node, "child")?, "link")?;
            for link in [parent, child] {
                if !self.links.contains_key(link) {
                    return wrong(format!(
                        "joint {:?} names the link {link:?}, which there is not",
                        attribute(*node, "name")?
                    ));
                }
            }
            if has_parent.insert(child, i).is_some() {
                return wrong(format!("link {child:?} has two parents"));
            }
            below.entry(parent).or_default().push(i);
            ends.push((parent, child));
        }
        let mut roots =
            elements(robot, "link").filter_map(|l| l.attribute("name")).filter(|l| !has_parent.contains_key(l));
        let (Some(root), None) = (roots.next(), roots.next()) else {
            return wrong("the links are no single tree: expected exactly one link without a parent");
        };
        let mut model = Model { links: Vec::new(), joints: Vec::new() };
        let mut queue = std::collections::VecDeque::from([(root, None)]);
        while let Some((name, above)) = queue.pop_front() {
            let index = model.links.len();
            let joint = match above {
                None => None,
                Some((parent, node)) => {
                    model.joints.push(read_joint(node, parent, index)?);
                    Some(model.joints.len() - 1)
                }
            };
            model.links.push(Link {
                name: name.to_owned(),
                joint,
                pieces: collision_pieces(self.links[name], name, meshes)?,
            });
            for i in below.get(name).into_iter().flatten() {
                queue.push_back((ends[*i].1, Some((index, self.joints[*i]))));
            }
        }
        if model.links.len() != self.links.len() {
            return wrong("some links hang in a cycle, apart from the root");
        }
        resolve_mimics(&mut model, &self.joints)?;
        Ok(model)
    }
}

fn read_joint(node: Node, parent: usize, child_link: usize) -> Read<Joint> {
    let name = attribute(node, "name")?.to_owned();
    let kind = match attribute(node, "type")? {
        "fixed" => JointKind::Fixed,
        "revolute" => JointKind::Revolute,
        "continuous" => JointKind::Continuous,
        "prismatic" => JointKind::Prismatic,
        other => return wrong(format!("joint {name:?} is {other}; expected fixed, revolute, continuous or prismatic")),
    };
    let axis = match elements(node, "axis").next() {
        Some(axis) => Vector::from(numbers::<3>(axis, "xyz")?.unwrap_or([1.0, 0.0, 0.0])),
        None => Vector::X,
    };
    let Some(axis) = axis.try_normalize().or((kind == JointKind::Fixed).then_some(Vector::X)) else {
        return wrong(format!("joint {name:?} has an axis of no length"));
    };
    let limit = elements(node, "limit").next();
    let value = |key: &str| -> Read<Option<f64>> { limit.map_or(Ok(None), |l| Ok(numbers::<1>(l, key)?.map(|[v]| v))) };
    let range = match kind {
        JointKind::Fixed | JointKind::Continuous => None,
        JointKind::Revolute | JointKind::Prismatic => {
            let (lower, upper) = (value("lower")?.unwrap_or(0.0), value("upper")?.unwrap_or(0.0));
            if limit.is_none() || lower > upper {
                return wrong(format!(
                    "joint {name:?} has limits {lower} to {upper}; expected <limit> with lower ≤ upper"
                ));
            }
            Some((lower, upper))
        }
    };
    let velocity = value("velocity")?.filter(|v| *v > 0.0);
    Ok(Joint {
        name,
        kind,
        parent,
        child: child_link,
        parent_from_joint: origin(node)?,
        axis,
        range,
        velocity,
        mimic: None,
    })
}

/// Turns mimics of mimics into mimics of the joint that leads.
fn resolve_mimics(model: &mut Model, nodes: &[Node]) -> Read<()> {
    let mut index: HashMap<String, usize> = HashMap::new();
    for (i, joint) in model.joints.iter().enumerate() {
        if index.insert(joint.name.clone(), i).is_some() {
            return wrong(format!("two joints are called {:?}", joint.name));
        }
    }
    let mut direct: HashMap<usize, Mimic> = HashMap::new();
    for node in nodes {
        let Some(mimic) = elements(*node, "mimic").next() else { continue };
        let (name, leader) = (attribute(*node, "name")?, attribute(mimic, "joint")?);
        let Some(joint) = index.get(leader) else {
            return wrong(format!("joint {name:?} mimics {leader:?}, which there is not"));
        };
        let multiplier = numbers::<1>(mimic, "multiplier")?.map_or(1.0, |[v]| v);
        let offset = numbers::<1>(mimic, "offset")?.map_or(0.0, |[v]| v);
        direct.insert(index[name], Mimic { joint: *joint, multiplier, offset });
    }
    for (&follower, &first) in &direct {
        let mut total = first;
        let mut hops = 0;
        while let Some(next) = direct.get(&total.joint) {
            total = Mimic {
                joint: next.joint,
                multiplier: total.multiplier * next.multiplier,
                offset: total.multiplier * next.offset + total.offset,
            };
            hops += 1;
            if hops > direct.len() {
                return wrong(format!("joint {:?} mimics itself", model.joints[follower].name));
            }
        }
        model.joints[follower].mimic = Some(total);
    }
    Ok(())
}

fn collision_pieces(link: Node, name: &str, meshes: &mut Meshes) -> Read<Vec<Piece>> {
    let mut pieces = Vec::new();
    for collision in elements(link, "collision") {
        let link_from_shape = origin(collision)?;
        let geometry = child(collision, "geometry")?;
        let Some(shape) = geometry.children().find(Node::is_element) else {
            return wrong(format!("link {name:?} has a collision without geometry"));
        };
        let length = |key: &str| -> Read<f64> {
            match numbers::<1>(shape, key)? {
                Some([v]) if v > 0.0 => Ok(v),
                found => wrong(format!("link {name:?}: {key} is {found:?}; expected a positive number of metres")),
            }
        };
        let mut add = |pose: Pose, shape| pieces.push(Piece::new(pose, shape));
        match shape.tag_name().name() {
            "box" => match numbers::<3>(shape, "size")? {
                Some(size) if size.iter().all(|s| *s > 0.0) => add(link_from_shape, shapes::cuboid(size)),
                found => return wrong(format!("link {name:?}: size is {found:?}; expected three positive numbers")),
            },
            "cylinder" => {
                let (turn, shape) = shapes::cylinder_along_z(length("radius")?, length("length")?);
                add(link_from_shape * turn, shape);
            }
            "capsule" => add(link_from_shape, shapes::capsule_along_z(length("radius")?, length("length")?)),
            "sphere" => add(link_from_shape, shapes::sphere(length("radius")?)),
            "mesh" => {
                let uri = attribute(shape, "filename")?;
                let scale = Vector::from(numbers::<3>(shape, "scale")?.unwrap_or([1.0; 3]));
                let triangles = meshes.triangles(uri, &format!("link {name:?}"))?.scaled(scale);
                match shapes::surface(&triangles) {
                    Some(shape) => add(link_from_shape, shape),
                    None => return wrong(format!("link {name:?}: mesh {uri:?} has no usable triangles")),
                }
            }
            other => {
                return wrong(format!(
                    "link {name:?} has a collision <{other}>; expected box, cylinder, sphere, capsule or mesh"
                ));
            }
        }
    }
    Ok(pieces)
}

fn elements<'a, 'input>(node: Node<'a, 'input>, name: &'static str) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children().filter(move |n| n.is_element() && n.tag_name().name() == name)
}

fn child<'a, 'input>(node: Node<'a, 'input>, name: &'static str) -> Read<Node<'a, 'input>> {
    match elements(node, name).next() {
        Some(found) => Ok(found),
        None => {
            wrong(format!("<{}> {:?} has no <{name}>", node.tag_name().name(), node.attribute("name").unwrap_or("")))
        }
    }
}

fn attribute<'a>(node: Node<'a, '_>, name: &str) -> Read<&'a str> {
    match node.attribute(name) {
        Some(value) => Ok(value),
        None => wrong(format!("<{}> has no {name}", node.tag_name().name())),
    }
}

fn origin(node: Node) -> Read<Pose> {
    let Some(origin) = elements(node, "origin").next() else { return Ok(Pose::IDENTITY) };
    let position = numbers::<3>(origin, "xyz")?.unwrap_or_default();
    let rpy = numbers::<3>(origin, "rpy")?.unwrap_or_default();
    Ok(Pose::from_parts(Vector::from(position), shapes::rotation_from_rpy(rpy)))
}

/// `None` if the attribute is not there; otherwise exactly `N` finite numbers.
fn numbers<const N: usize>(node: Node, name: &str) -> Read<Option<[f64; N]>> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    let parsed: Option<Vec<f64>> =
        text.split_whitespace().map(|s| s.parse().ok().filter(|v: &f64| v.is_finite())).collect();
    match parsed.and_then(|v| <[f64; N]>::try_from(v).ok()) {
        Some(values) => Ok(Some(values)),
        None => wrong(format!("<{} {name}={text:?}>: expected {N} finite numbers", node.tag_name().name())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn try_read(text: &str) -> Result<Model, CannotJudge> {
        read(text, &mut Meshes::new(&[], Path::new("")))
    }

    fn robot(inside: &str) -> String {
        format!(
            "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='revolute'><parent link='a'/><child link='b'/>{inside}</joint></robot>"
        )
    }

    #[test]
    fn broken_robots_are_refused() {
        let fine = "<limit lower='0' upper='1'/>";
        assert!(try_read(&robot(fine)).is_ok());
        for (broken, why) in [
            (String::new(), "no document"),
            ("<robot><link name='a'/>".into(), "cut off"),
            ("<model/>".into(), "no robot"),
            ("<robot/>".into(), "no links"),
            (robot(""), "no limits"),
            (robot("<limit lower='2' upper='1'/>"), "limits the wrong way round"),
            (robot("<limit lower='NaN' upper='1'/>"), "not finite"),
            (robot(&format!("{fine}<axis xyz='0 0 0'/>")), "no axis"),
            (robot(&format!("{fine}<axis xyz='0 1'/>")), "two numbers"),
            (robot(&format!("{fine}<origin xyz='0 1 inf'/>")), "not finite"),
            (robot(&format!("{fine}<mimic joint='j'/>")), "mimics itself"),
            (robot(&format!("{fine}<mimic joint='k'/>")), "mimics nothing"),
            (robot(fine).replace("child link='b'", "child link='c'"), "no such link"),
            (robot(fine).replace("child link='b'", "child link='a'"), "a cycle"),
            (robot(fine).replace("revolute", "floating"), "floating"),
            (robot(fine).replace("name='b'/>", "name='a'/>"), "a name twice"),
            (
                robot(fine).replace(
                    "<link name='b'/>",
                    "<link name='b'><collision><geometry><sphere radius='-1'/></geometry></collision></link>",
                ),
                "negative",
            ),
            (
                robot(fine).replace(
                    "<link name='b'/>",
                    "<link name='b'><collision><geometry><mesh filename='m.stl'/></geometry></collision></link>",
                ),
                "not listed",
            ),
            ("<robot name='r'>".to_owned() + &"<a>".repeat(300_000), "deep"),
        ] {
            assert!(try_read(&broken).is_err(), "{why}");
        }
    }

    #[test]
    fn mimics_of_mimics_lead_to_one_joint() {
        let joint = |name: &str, child: &str, mimic: &str| {
            format!(
                "<joint name='{name}' type='revolute'><parent link='a'/><child link='{child}'/><limit lower='0' upper='1'/>{mimic}</joint>"
            )
        };
        let text = format!(
            "<robot name='r'><link name='a'/><link name='b'/><link name='c'/><link name='d'/>{}{}{}</robot>",
            joint("j", "b", ""),
            joint("k", "c", "<mimic joint='j' multiplier='2' offset='1'/>"),
            joint("l", "d", "<mimic joint='k' multiplier='3' offset='-1'/>"),
        );
        let model = try_read(&text).expect("a URDF");
        let mut posture = vec![0.0; 3];
        posture[model.joint("j").expect("j")] = 0.5;
        model.follow(&mut posture);
        assert_eq!(posture[model.joint("l").expect("l")], 3.0 * (2.0 * 0.5 + 1.0) - 1.0);
    }
}
