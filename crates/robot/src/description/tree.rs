//! A URDF's links and joints as one tree, parents before children.

use super::element::Source;
use super::model::{Joint, JointKind, Link, Mimic, Model};
use super::shapes::Shapes;
use super::urdf::{RawJoint, Urdf};
use clearway_files::{FileError, closest, quoted};
use std::collections::HashMap;

/// Checks that the links form one tree, orders them, and reads their collision shapes.
pub fn build<'a>(source: Source<'a>, urdf: &Urdf<'a>, shapes: &mut Shapes<'a>) -> Result<Model, FileError> {
    let number: HashMap<&str, usize> = urdf.links.iter().enumerate().map(|(i, l)| (l.name, i)).collect();
    let mut parent_joint: Vec<Option<usize>> = vec![None; urdf.links.len()];
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); urdf.links.len()];
    for (j, joint) in urdf.joints.iter().enumerate() {
        let parent = end(source, urdf, &number, joint, "parent", joint.parent)?;
        let child = end(source, urdf, &number, joint, "child", joint.child)?;
        if let Some(other) = parent_joint[child] {
            return Err(source
                .wrong(
                    joint.node,
                    format!(
                        "link {} is the child of two joints, {} and {}",
                        quoted(joint.child),
                        quoted(urdf.joints[other].name),
                        quoted(joint.name)
                    ),
                )
                .expected("one parent for each link")
                .help("a URDF is a tree: open the loop, and let joints follow others by <mimic>"));
        }
        parent_joint[child] = Some(j);
        children[parent].push(j);
    }
    let roots: Vec<usize> = (0..urdf.links.len()).filter(|&i| parent_joint[i].is_none()).collect();
    if let [first, second, ..] = roots[..] {
        return Err(source
            .wrong(
                urdf.links[second].node,
                format!(
                    "{} root links, {} and {} among them",
                    roots.len(),
                    quoted(urdf.links[first].name),
                    quoted(urdf.links[second].name)
                ),
            )
            .expected("one")
            .help("connect them by a `fixed` joint, or delete the link that is not used"));
    }

    // Parents before children, children in the order of the file.
    let mut links = Vec::with_capacity(urdf.links.len());
    let mut joints: Vec<Joint> = Vec::with_capacity(urdf.joints.len());
    let mut joint_number: HashMap<&str, usize> = HashMap::new();
    let mut stack: Vec<(usize, Option<(usize, usize)>)> = roots.iter().map(|&root| (root, None)).collect();
    while let Some((link, from)) = stack.pop() {
        let raw = &urdf.links[link];
        let index = links.len();
        let parent_joint = from.map(|(joint, parent)| {
            let raw = &urdf.joints[joint];
            joint_number.insert(raw.name, joints.len());
            joints.push(placed(raw, parent, index));
            joints.len() - 1
        });
        let (collision, collision_kinds) = shapes.of_link(raw.name, raw.node)?;
        links.push(Link { name: raw.name.to_owned(), parent_joint, collision, collision_kinds });
        stack.extend(children[link].iter().rev().filter_map(|&j| {
            let child = number.get(urdf.joints[j].child)?;
            Some((*child, Some((j, index))))
        }));
    }
    if links.len() < urdf.links.len() {
        let lost = urdf.joints.iter().find(|j| !joint_number.contains_key(j.name));
        return Err(match lost {
            Some(joint) => source
                .wrong(
                    joint.node,
                    format!(
                        "joint {} is part of a loop: its link {} is its own ancestor",
                        quoted(joint.name),
                        quoted(joint.child)
                    ),
                )
                .help("a URDF is a tree: open the loop, and let joints follow others by <mimic>"),
            None => FileError::new(source.path, "the links do not form a tree"),
        });
    }
    let mut model = Model { name: urdf.name.to_owned(), links, joints, meshes: Vec::new() };
    follow(source, urdf, &joint_number, &mut model)?;
    Ok(model)
}

fn end(
    source: Source,
    urdf: &Urdf,
    number: &HashMap<&str, usize>,
    joint: &RawJoint,
    which: &str,
    link: &str,
) -> Result<usize, FileError> {
    number.get(link).copied().ok_or_else(|| {
        let at = super::element::child(joint.node, which).unwrap_or(joint.node);
        let error = source.wrong_attribute(
            at,
            "link",
            format!("joint {} names the {which} link {}, which does not exist", quoted(joint.name), quoted(link)),
        );
        match closest(link, urdf.links.iter().map(|l| l.name)) {
            Some(near) => error.help(format!("did you mean `{near}`?")),
            None => error.help("add the link, or correct the name"),
        }
    })
}

fn placed(raw: &RawJoint, parent: usize, child: usize) -> Joint {
    Joint {
        name: raw.name.to_owned(),
        kind: raw.kind,
        parent,
        child,
        parent_from_joint: raw.parent_from_joint,
        axis: raw.axis,
        lower: raw.lower,
        upper: raw.upper,
        velocity: raw.velocity,
        mimic: None,
    }
}

/// Sets who mimics whom, and refuses chains that come back to their start.
fn follow(source: Source, urdf: &Urdf, number: &HashMap<&str, usize>, model: &mut Model) -> Result<(), FileError> {
    for raw in &urdf.joints {
        let (Some(mimic), Some(&own)) = (&raw.mimic, number.get(raw.name)) else { continue };
        let wrong = |found: String| source.wrong_attribute(mimic.node, "joint", found);
        let Some(&leader) = number.get(mimic.joint) else {
            let error =
                wrong(format!("joint {} mimics {}, which does not exist", quoted(raw.name), quoted(mimic.joint)));
            return Err(match closest(mimic.joint, urdf.joints.iter().map(|j| j.name)) {
                Some(near) => error.help(format!("did you mean `{near}`?")),
                None => error.help("add the joint, or correct the name"),
            });
        };
        if model.joints[leader].kind == JointKind::Fixed {
            return Err(wrong(format!("joint {} mimics {}, which is fixed", quoted(raw.name), quoted(mimic.joint)))
                .expected("a joint that moves")
                .help("make this joint `fixed` too"));
        }
        model.joints[own].mimic = Some(Mimic { joint: leader, multiplier: mimic.multiplier, offset: mimic.offset });
    }
    for raw in &urdf.joints {
        let (Some(mimic), Some(&own)) = (&raw.mimic, number.get(raw.name)) else { continue };
        let mut at = own;
        for _ in 0..=model.joints.len() {
            match &model.joints[at].mimic {
                Some(next) => at = next.joint,
                None => break,
            }
        }
        if model.joints[at].mimic.is_some() {
            return Err(source
                .wrong(
                    mimic.node,
                    format!("joint {} mimics itself, by way of {}", quoted(raw.name), quoted(mimic.joint)),
                )
                .help("let one joint of the loop lead: delete its <mimic>"));
        }
    }
    Ok(())
}
