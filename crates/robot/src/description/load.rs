//! From a name or a path to a [`Robot`].

use super::arm::Chain;
use super::builtin::{self, NAMES};
use super::element::Source;
use super::limits::PerArmJoint;
use super::model::Model;
use super::roots::Roots;
use super::shapes::Shapes;
use super::urdf::Urdf;
use super::{Robot, grasps, hand, planar_base, srdf, tree, urdf};
use clearway_files::{FileError, Limits, Located, closest, quoted, read_text, xml, yaml};
use clearway_plan::RobotFile;
use clearway_plan::robot_file::FORMAT;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A document and the name it goes by in messages.
struct Text {
    path: PathBuf,
    text: String,
}

/// What the checks of a robot file need to look at.
pub struct Context<'a> {
    pub file: &'a Located<RobotFile>,
    pub source: Source<'a>,
    pub urdf: &'a Urdf<'a>,
    pub model: &'a Model,
}

impl Robot {
    /// `model` is a built-in robot's name, or the path of a robot file, relative to `directory`.
    /// `packages` are where `package://` in the URDF leads, before those that the file declares.
    pub fn load(model: &str, directory: &Path, packages: &[(String, PathBuf)]) -> Result<Robot, FileError> {
        if let Some(built_in) = builtin::find(model) {
            let named =
                |name: &str, text: &str| Text { path: Path::new(built_in.directory).join(name), text: text.to_owned() };
            let file = named("robot.yaml", built_in.file);
            let file = read_robot_file(&file)?;
            let urdf = named(&file.value.urdf, built_in.urdf);
            let srdf = file.value.srdf.as_ref().map(|name| named(name, built_in.srdf));
            return assemble(file, urdf, srdf, &Roots::new(None, packages)?);
        }
        let path = directory.join(model);
        if !path.exists() && Path::new(model).extension().is_none() && !model.contains('/') {
            let error = FileError::new(&path, format!("no built-in robot is called {}", quoted(model)))
                .expected(format!("one of `{}`, or the path of a robot file", NAMES.join("`, `")));
            return Err(match closest(model, NAMES) {
                Some(near) => error.help(format!("did you mean `{near}`?")),
                None => error,
            });
        }
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("urdf")) {
            return Err(FileError::new(&path, "a URDF")
                .expected("a robot file, which names the URDF, the arm and the hand")
                .help("write one beside it: `clearway schema robot` says what goes in, robots/ur10_ag95/robot.yaml shows it"));
        }
        let file = read_robot_file(&Text { text: read_text(&path, &Limits::DOCUMENT)?, path: path.clone() })?;
        let mut roots = Roots::new(Some(parent(&path)), packages)?;
        roots.declare(&file)?;
        let base = absolute(parent(&path))?;
        let read = |name: &str, key: &str| {
            let here = |error: FileError| error.referenced_from(&path, file.position(&[key]));
            let found = roots.resolve(name, &base).map_err(here)?;
            Ok(Text { text: read_text(&found, &Limits::DOCUMENT).map_err(here)?, path: found })
        };
        let urdf = read(&file.value.urdf, "urdf")?;
        let srdf = file.value.srdf.as_deref().map(|name| read(name, "srdf")).transpose()?;
        assemble(file, urdf, srdf, &roots)
    }
}

/// A URDF alone: links, joints and shapes, checked as for planning, without arm and hand.
pub fn describe_urdf(path: &Path, packages: &[(String, PathBuf)]) -> Result<Model, FileError> {
    let text = read_text(path, &Limits::DOCUMENT)?;
    let roots = Roots::new(Some(parent(path)), packages)?;
    let base = absolute(parent(path))?;
    let document = xml::parse(path, &text)?;
    let source = Source { path };
    model_of(source, &urdf::read(source, &document)?, &roots, &base)
}

/// The links `(a, b)`, `a < b`, that an SRDF says need not be checked against each other.
pub fn disabled_pairs(path: &Path, model: &Model) -> Result<BTreeSet<(usize, usize)>, FileError> {
    let text = read_text(path, &Limits::DOCUMENT)?;
    Ok(srdf::read(path, &text, &model.links, &model.joints)?.disabled_pairs)
}

fn parent(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn absolute(directory: &Path) -> Result<PathBuf, FileError> {
    directory.canonicalize().map_err(|e| FileError::new(directory, format!("cannot be entered: {e}")))
}

fn read_robot_file(text: &Text) -> Result<Located<RobotFile>, FileError> {
    let file: Located<RobotFile> = yaml::from_str(&text.path, &text.text)?;
    if file.value.format != FORMAT {
        return Err(file
            .error(&["format"], format!("the format {}", quoted(&file.value.format)))
            .expected(format!("`{FORMAT}`"))
            .help("is this a robot file? If it was written for another version, see CHANGELOG.md"));
    }
    Ok(file)
}

fn model_of<'a>(source: Source<'a>, urdf: &Urdf<'a>, roots: &'a Roots, base: &'a Path) -> Result<Model, FileError> {
    let mut shapes = Shapes::new(source, roots, base);
    let mut model = tree::build(source, urdf, &mut shapes)?;
    model.meshes = shapes.meshes;
    Ok(model)
}

fn assemble(file: Located<RobotFile>, urdf: Text, srdf: Option<Text>, roots: &Roots) -> Result<Robot, FileError> {
    let source = Source { path: &urdf.path };
    let urdf_text = planar_base::with_joints(&file, source, &urdf.text)?;
    let document = xml::parse(&urdf.path, &urdf_text)?;
    let raw = urdf::read(source, &document)?;
    let model = model_of(source, &raw, roots, parent(&urdf.path))?;
    let context = Context { file: &file, source, urdf: &raw, model: &model };

    let Chain { base, tip, arm, planar_base } = Chain::find(&context)?;
    let hand = hand::check(&context, &arm)?;
    let per_joint = PerArmJoint::check(&context, &arm)?;
    let fixed = context.fixed(&arm, hand.joint)?;
    let grasps = grasps::check(&file)?;
    let srdf = srdf.map(|t| srdf::read(&t.path, &t.text, &model.links, &model.joints)).transpose()?.unwrap_or_default();
    let PerArmJoint { home, acceleration, jerk, velocity, lower, upper } = per_joint;
    let Model { name, links, joints, meshes } = model;
    Ok(Robot {
        name,
        urdf_text,
        links,
        joints,
        arm,
        base,
        tip,
        planar_base,
        fixed,
        home,
        acceleration,
        jerk,
        velocity,
        lower,
        upper,
        hand,
        grasps,
        disabled_pairs: srdf.disabled_pairs,
        named_states: srdf.named_states,
        meshes,
        file: file.value,
    })
}
