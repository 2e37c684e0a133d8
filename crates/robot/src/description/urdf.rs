//! Reads a URDF's links and joints as they are written. How they hang together is `tree`'s
//! affair, what shapes they have `shapes`'.
//!
//! Strict where a robot would otherwise move wrongly: every number must be finite, movable joints
//! must have an axis, and revolute and prismatic ones limits the right way round. What is of no
//! use here (visuals, inertias, transmissions, simulators' tags) is passed over.

use super::element::{Source, child, children};
use super::model::JointKind;
use clearway_files::{FileError, closest, quoted};
use clearway_geometry::{Pose, Vec3};
use roxmltree::{Document, Node};
use std::collections::HashSet;

/// Links, and joints: some ten times what the largest humanoids have.
const MOST: usize = 2000;

pub struct Urdf<'a> {
    pub name: &'a str,
    pub links: Vec<RawLink<'a>>,
    pub joints: Vec<RawJoint<'a>>,
}

pub struct RawLink<'a> {
    pub name: &'a str,
    pub node: Node<'a, 'a>,
}

pub struct RawJoint<'a> {
    pub name: &'a str,
    pub node: Node<'a, 'a>,
    pub kind: JointKind,
    pub parent: &'a str,
    pub child: &'a str,
    pub parent_from_joint: Pose,
    /// Of unit length.
    pub axis: Vec3,
    pub lower: f64,
    pub upper: f64,
    /// Infinite if not given.
    pub velocity: f64,
    pub mimic: Option<RawMimic<'a>>,
}

pub struct RawMimic<'a> {
    pub node: Node<'a, 'a>,
    pub joint: &'a str,
    pub multiplier: f64,
    pub offset: f64,
}

pub fn read<'a>(source: Source<'a>, document: &'a Document<'a>) -> Result<Urdf<'a>, FileError> {
    let robot = document.root_element();
    if robot.tag_name().name() != "robot" {
        return Err(source
            .wrong(robot, format!("the outermost element is <{}>", robot.tag_name().name()))
            .expected("<robot>")
            .help("is this the right file? A URDF is wanted"));
    }
    if let Some(macros) = robot.descendants().find(|n| n.tag_name().namespace().is_some_and(|s| s.contains("xacro"))) {
        return Err(source
            .wrong(macros, format!("a xacro macro, <{}>", macros.tag_name().name()))
            .expected("plain URDF")
            .help("expand it first: `xacro FILE.urdf.xacro > FILE.urdf`"));
    }
    let links = children(robot, "link").map(|node| Ok(RawLink { name: source.name(node, "name")?, node }));
    let links: Vec<RawLink> = links.collect::<Result<_, FileError>>()?;
    let joints: Vec<RawJoint> = children(robot, "joint").map(|node| joint(source, node)).collect::<Result<_, _>>()?;
    if links.is_empty() {
        return Err(source.wrong(robot, "a robot without links").help("is this the right file?"));
    }
    for (what, count) in [("links", links.len()), ("joints", joints.len())] {
        if count > MOST {
            return Err(source.wrong(robot, format!("{count} {what}")).expected(format!("at most {MOST}")));
        }
    }
    once(source, "link", links.iter().map(|l| (l.name, l.node)))?;
    once(source, "joint", joints.iter().map(|j| (j.name, j.node)))?;
    Ok(Urdf { name: robot.attribute("name").unwrap_or("robot"), links, joints })
}

fn once<'a>(source: Source, what: &str, named: impl Iterator<Item = (&'a str, Node<'a, 'a>)>) -> Result<(), FileError> {
    let mut seen = HashSet::new();
    for (name, node) in named {
        if !seen.insert(name) {
            return Err(source
                .wrong_attribute(node, "name", format!("a second {what} named {}", quoted(name)))
                .help(format!("rename one of the two {what}s")));
        }
    }
    Ok(())
}

fn joint<'a>(source: Source<'a>, node: Node<'a, 'a>) -> Result<RawJoint<'a>, FileError> {
    let name = source.name(node, "name")?;
    let kind = kind(source, node, name)?;
    let end = |which: &str| match child(node, which) {
        Some(end) => source.name(end, "link"),
        None => Err(source
            .wrong(node, format!("joint {} without <{which}>", quoted(name)))
            .help(format!("add `<{which} link=\"…\"/>`"))),
    };
    let (lower, upper, velocity) = limits(source, node, name, kind)?;
    Ok(RawJoint {
        name,
        node,
        kind,
        parent: end("parent")?,
        child: end("child")?,
        parent_from_joint: origin(source, node)?,
        axis: axis(source, node, name, kind)?,
        lower,
        upper,
        velocity,
        mimic: mimic(source, node, kind)?,
    })
}

fn kind<'a>(source: Source<'a>, node: Node<'a, 'a>, name: &str) -> Result<JointKind, FileError> {
    const KNOWN: [&str; 4] = ["fixed", "revolute", "continuous", "prismatic"];
    match source.name(node, "type")? {
        "fixed" => Ok(JointKind::Fixed),
        "revolute" => Ok(JointKind::Revolute),
        "continuous" => Ok(JointKind::Continuous),
        "prismatic" => Ok(JointKind::Prismatic),
        other => {
            let error = source
                .wrong_attribute(node, "type", format!("joint {} is of type {}", quoted(name), quoted(other)))
                .expected("`fixed`, `revolute`, `continuous` or `prismatic`");
            Err(match other {
                "planar" => error.help("for a base that drives, delete the joint and say `mobile: {planar: …}` in the robot file; else make it `fixed`"),
                "floating" => error.help("make it `fixed`: the scene file says where the robot stands"),
                _ => match closest(other, KNOWN) {
                    Some(near) => error.help(format!("did you mean `{near}`?")),
                    None => error,
                },
            })
        }
    }
}

/// The pose of an element's `<origin>`; none is the identity.
pub fn origin<'a>(source: Source<'a>, node: Node<'a, 'a>) -> Result<Pose, FileError> {
    let Some(origin) = child(node, "origin") else { return Ok(Pose::IDENTITY) };
    let xyz = source.numbers::<3>(origin, "xyz")?.unwrap_or_default();
    let rpy = source.numbers::<3>(origin, "rpy")?.unwrap_or_default();
    Ok(Pose::from_rpy(rpy, Vec3::from_array(xyz)))
}

fn axis<'a>(source: Source<'a>, node: Node<'a, 'a>, name: &str, kind: JointKind) -> Result<Vec3, FileError> {
    let Some(axis) = child(node, "axis").filter(|_| kind != JointKind::Fixed) else { return Ok(Vec3::X) };
    let direction = Vec3::from_array(source.numbers::<3>(axis, "xyz")?.unwrap_or([1.0, 0.0, 0.0]));
    direction.try_normalize().filter(|_| direction.length() > 1e-6).ok_or_else(|| {
        source
            .wrong_attribute(axis, "xyz", format!("the axis of joint {} has no direction", quoted(name)))
            .expected("three numbers, not all 0")
    })
}

/// Lower, upper, velocity.
fn limits<'a>(
    source: Source<'a>,
    node: Node<'a, 'a>,
    name: &str,
    kind: JointKind,
) -> Result<(f64, f64, f64), FileError> {
    if kind == JointKind::Fixed {
        return Ok((0.0, 0.0, f64::INFINITY));
    }
    let limit = child(node, "limit");
    let velocity = match limit {
        Some(limit) => source.number(limit, "velocity")?,
        None => None,
    };
    if let (Some(limit), Some(velocity)) = (limit, velocity)
        && velocity < 0.0
    {
        return Err(source
            .wrong_attribute(limit, "velocity", format!("the velocity limit of joint {} is {velocity}", quoted(name)))
            .expected("a number greater than 0"));
    }
    let velocity = velocity.unwrap_or(f64::INFINITY);
    if kind == JointKind::Continuous {
        return Ok((f64::NEG_INFINITY, f64::INFINITY, velocity));
    }
    let (lower, upper) = match limit {
        Some(limit) => (source.number(limit, "lower")?, source.number(limit, "upper")?),
        None => (None, None),
    };
    if lower.is_none() && upper.is_none() {
        return Err(source
            .wrong(limit.unwrap_or(node), format!("joint {} has no limits", quoted(name)))
            .expected("`<limit lower=\"…\" upper=\"…\" velocity=\"…\" effort=\"…\"/>`")
            .help("add its limits; if it turns without end, make it `continuous`"));
    }
    // URDF: what is not given is 0.
    let (lower, upper) = (lower.unwrap_or(0.0), upper.unwrap_or(0.0));
    if lower > upper {
        return Err(source
            .wrong(
                limit.unwrap_or(node),
                format!("joint {} has the lower limit {lower} and the upper limit {upper}", quoted(name)),
            )
            .expected("lower ≤ upper")
            .help("swap the two"));
    }
    Ok((lower, upper, velocity))
}

fn mimic<'a>(source: Source<'a>, node: Node<'a, 'a>, kind: JointKind) -> Result<Option<RawMimic<'a>>, FileError> {
    let Some(mimic) = child(node, "mimic").filter(|_| kind != JointKind::Fixed) else { return Ok(None) };
    Ok(Some(RawMimic {
        node: mimic,
        joint: source.name(mimic, "joint")?,
        multiplier: source.number(mimic, "multiplier")?.unwrap_or(1.0),
        offset: source.number(mimic, "offset")?.unwrap_or(0.0),
    }))
}
