//! A motion problem's file, checked: planner, surroundings, start and goals.
//!
//! A [`MotionProblem`] that exists can be asked of the planner: its numbers are finite, its start
//! and its goals lie within the limits and are free. What cannot be is a [`FileError`].

use crate::{
    MotionPlanner, MotionSettings, MotionValidator, Obstacle, Posture, RrtSettings, Surroundings, ends, rates,
};
use clearway_files::{FileError, Located, closest, quoted, read_text, yaml};
use clearway_geometry::Pose;
use clearway_plan::MotionFile;
use clearway_plan::motion_file::{Attached, FORMAT};
use clearway_robot::{Group, Robot};
use clearway_scene::Bodies;
use std::path::{Path, PathBuf};

/// A motion problem to plan for.
#[derive(Clone, Debug)]
pub struct MotionProblem {
    pub planner: MotionPlanner,
    pub around: Surroundings,
    pub settings: MotionSettings,
    pub start: Posture,
    /// Those that are free, and their numbers in the file, from 0.
    pub goals: Vec<Posture>,
    pub goal_numbers: Vec<usize>,
    /// In words: why the others were passed over.
    pub passed_over: Vec<String>,
    /// For the trajectory; in words if there are none.
    pub limits: Result<crate::Limits, String>,
}

impl MotionProblem {
    /// Reads a problem (YAML or JSON). Paths in it are relative to it. `packages`: where
    /// `package://NAME` leads, before those that the file declares.
    pub fn load(path: &Path, packages: &[(String, PathBuf)]) -> Result<MotionProblem, FileError> {
        let document: Located<MotionFile> = yaml::from_str(path, &read_text(path, &clearway_files::Limits::PLAN)?)?;
        let directory = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let bodies = Bodies::new(&document, directory);
        let file = &document.value;
        if file.format != FORMAT {
            return Err(bodies
                .error("format", format!("the format {}", quoted(&file.format)))
                .expected(format!("`{FORMAT}`"))
                .help("is this a motion problem of this version?"));
        }
        let settings = settings(&bodies, file)?;
        let (mut group, robot) = load_robot(&document, &bodies, directory, packages)?;
        if let Some(attached) = &file.attached {
            attach(&bodies, attached, &mut group)?;
        }
        let limits = rates::read(&bodies, &group, robot.as_ref(), file.limits.as_ref())?;
        let start = ends::posture(&bodies, "start", "the start", &group, &file.start)?;
        if file.goals.is_empty() {
            return Err(bodies.error("goals", "no goals").expected("at least one"));
        }
        let named = |i: usize| if file.goals.len() == 1 { "the goal".to_owned() } else { format!("goal {}", i + 1) };
        let goals = file.goals.iter().enumerate();
        let goals = goals
            .map(|(i, goal)| ends::posture(&bodies, &format!("goals.{i}"), &named(i), &group, goal))
            .collect::<Result<Vec<_>, _>>()?;

        let root_from_world = bodies.pose("base", &file.base)?.inverse();
        let obstacles = bodies.obstacles("obstacles", &file.obstacles)?.into_iter().map(|fixture| Obstacle {
            root_from_solid: root_from_world * fixture.pose,
            solid: (*fixture.solid).clone(),
            name: fixture.id,
        });
        let mut problem = MotionProblem {
            planner: MotionPlanner::new(group),
            around: Surroundings::new(obstacles.collect()),
            settings,
            start,
            goals: Vec::new(),
            goal_numbers: Vec::new(),
            passed_over: Vec::new(),
            limits,
        };
        if let Some(why) = problem.refusal(&problem.start) {
            return Err(refused(&bodies, "start", format!("the start is {why}")));
        }
        for (i, goal) in goals.into_iter().enumerate() {
            match problem.refusal(&goal) {
                Some(why) => problem.passed_over.push(format!("{} is {why}", named(i))),
                None => {
                    problem.goals.push(goal);
                    problem.goal_numbers.push(i);
                }
            }
        }
        if problem.goals.is_empty() {
            return Err(refused(&bodies, "goals.0", problem.passed_over.join("; ")));
        }
        Ok(problem)
    }

    /// Why a posture cannot be an end.
    fn refusal(&self, q: &[f64]) -> Option<String> {
        let found = self.planner.refusal(q, &self.around, self.settings.margin);
        // The planner's own arithmetic is shorter, and keeps a little more.
        found.or_else(|| {
            let free = self.planner.space(&self.around, &self.settings).state_free(q);
            (!free).then(|| "in collision: within 0.02 mm of the margin of something".to_owned())
        })
    }
}

fn refused(bodies: &Bodies, keys: &str, why: String) -> FileError {
    bodies
        .error(keys, why)
        .help("give a free posture, or move what it touches; links count as the spheres that cover them")
}

fn settings(bodies: &Bodies, file: &MotionFile) -> Result<MotionSettings, FileError> {
    let inside = |key: &str, value: f64, range: std::ops::RangeInclusive<f64>| {
        if range.contains(&value) {
            return Ok(value);
        }
        Err(bodies.error(key, format!("the {key} is {value}")).expected(format!(
            "a number from {} to {}",
            range.start(),
            range.end()
        )))
    };
    let usual = MotionSettings::default();
    Ok(MotionSettings {
        rrt: RrtSettings { range: inside("range", file.range, 1e-3..=1e3)?, ..usual.rrt },
        checks_per_rad: inside("checks_per_rad", file.checks_per_rad, 1.0..=1e4)?,
        margin: inside("margin", file.margin, 0.0..=10.0)?,
        ..usual
    })
}

/// The joints planned for; and the robot, where a robot file describes it.
fn load_robot(
    document: &Located<MotionFile>,
    bodies: &Bodies,
    directory: &Path,
    packages: &[(String, PathBuf)],
) -> Result<(Group, Option<Robot>), FileError> {
    let robot = &document.value.robot;
    let seen = |key: &str, error: FileError| error.referenced_from(document.path(), document.position(&["robot", key]));
    let mut all = packages.to_vec();
    all.extend(robot.packages.iter().map(|(name, to)| (name.clone(), directory.join(to))));
    match (&robot.model, &robot.urdf) {
        (Some(_), Some(_)) => Err(bodies
            .error("robot.urdf", "both `model` and `urdf` are given")
            .expected("one of the two")
            .help("a robot file names its URDF itself")),
        (None, None) => Err(bodies
            .error("robot", "no robot")
            .expected("`urdf`, or `model`: a built-in robot's name or the path of a robot file")),
        (Some(model), None) => {
            for (key, given) in
                [("srdf", robot.srdf.is_some()), ("joints", robot.joints.is_some()), ("fixed", !robot.fixed.is_empty())]
            {
                if given {
                    return Err(bodies
                        .error(&format!("robot.{key}"), format!("both `model` and `{key}` are given"))
                        .help(format!("delete `{key}`: the robot file says that")));
                }
            }
            let robot = Robot::load(model, directory, &all).map_err(|e| seen("model", e))?;
            let group = Group::from(&robot);
            if group.links.iter().all(|l| l.collision.parts.is_empty()) {
                return Err(bodies
                    .error("robot.model", "a robot without a single collision shape")
                    .help("use a URDF with collision geometry: an arm without it would pass through everything"));
            }
            Ok((group, Some(robot)))
        }
        (None, Some(urdf)) => {
            let srdf = robot.srdf.as_ref().map(|s| directory.join(s));
            let group =
                Group::load(&directory.join(urdf), srdf.as_deref(), robot.joints.as_deref(), &robot.fixed, &all);
            Ok((group.map_err(|e| seen("urdf", e))?, None))
        }
    }
}

fn attach(bodies: &Bodies, attached: &Attached, group: &mut Group) -> Result<(), FileError> {
    let link = |keys: &str, name: &str| {
        let names = || group.links.iter().map(|l| l.name.as_str());
        names().position(|n| n == name).ok_or_else(|| {
            let error = bodies.error(keys, format!("the URDF has no link {}", quoted(name)));
            match closest(name, names()) {
                Some(near) => error.help(format!("did you mean `{near}`?")),
                None => error.help("name a link as the URDF does"),
            }
        })
    };
    let holder = link("attached.link", &attached.link)?;
    let touching = attached.touch_links.iter().enumerate();
    let touching =
        touching.map(|(i, name)| link(&format!("attached.touch_links.{i}"), name)).collect::<Result<Vec<_>, _>>()?;
    let (solid, pose): (_, Pose) = bodies.held("attached", &attached.body())?;
    group.attach(&attached.id, holder, &solid, pose, &touching);
    Ok(())
}
