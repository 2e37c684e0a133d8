//! What can be said on the command line.

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Which objects must move, in what order, and how, so that the robot can take the one it wants.
///
/// Without a command: plans the built-in demo scene and writes the plan and its page.
#[derive(Debug, Parser)]
#[command(name = "clearway", version, max_term_width = 100)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Plan a scene: from a scene file to a checked, timed, executable plan.
    Plan(PlanArgs),
    /// Judge a plan file with exact shapes and code that shares nothing with the planner's.
    Verify(VerifyArgs),
    /// Say why these objects, in this order; for a failure, what stood in the way.
    Explain(ExplainArgs),
    /// Make a scene.
    Generate(GenerateArgs),
    /// Make one self-contained page: the scene, the robot moving, the roadmap and the graph.
    View(ViewArgs),
    /// Check a robot and say what was found.
    Robot(RobotArgs),
    /// Plan a motion: a robot, obstacles, a start, goals; a path and a trajectory.
    Motion(MotionArgs),
    /// Play a plan in a physics engine: what moved that should not, what was touched, what fell.
    Simulate(SimulateArgs),
    /// Run an experiment; rows as JSON lines, a summary at the end.
    Bench(BenchArgs),
    /// Write a plan for other programs.
    Export(ExportArgs),
    /// Print the JSON Schema of a file.
    Schema(SchemaArgs),
    /// Print the built-in domain, or its streams, to be changed and given to `plan --domain`, `--streams`.
    Pddl(PddlArgs),
}

#[derive(Debug, Args)]
pub struct PlanArgs {
    /// The scene file (YAML or JSON).
    pub scene: PathBuf,
    /// Everything random comes from it.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Seconds of planning before giving up.
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub time_limit: Option<f64>,
    /// Rounds of the planner before giving up; makes runs repeatable on any machine.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub iterations: Option<u64>,
    /// Threads to use at most. The plan is verified on all of them, planning itself takes one; what comes of it does
    /// not depend on them. Default: all cores.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Seconds to spend on fewer removals, then shorter motion, once a plan is found.
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub improve: Option<f64>,
    /// Where to write the plan.
    #[arg(short, long, value_name = "PLAN.json")]
    pub output: Option<PathBuf>,
    /// Where to write the plan's page.
    #[arg(long, value_name = "PAGE.html")]
    pub html: Option<PathBuf>,
    /// Print the summary as one JSON object on stdout.
    #[arg(long)]
    pub json: bool,
    /// Where `package://NAME` in the robot's URDF leads.
    #[arg(long, value_name = "NAME=DIR", value_parser = package)]
    pub package: Vec<(String, PathBuf)>,
    /// Plan as the paper did: greedy search, the roadmap's ways only, its sample counts, picks only unless --prefer-push.
    #[arg(long)]
    pub paper: bool,
    /// The exploration limit of the first round.
    #[arg(long, value_enum, default_value_t = First::One)]
    pub first_limit: First,
    /// Only pick objects, never push them aside.
    #[arg(long, conflicts_with = "prefer_push")]
    pub no_push: bool,
    /// Push objects aside wherever they can be; default: where that takes less time than picking them.
    #[arg(long)]
    pub prefer_push: bool,
    /// How the retrieval graph is searched; default: exact, greedy with --paper.
    #[arg(long, value_enum)]
    pub search: Option<SearchKind>,
    /// A mobile base stays where it starts.
    #[arg(long)]
    pub fixed_base: bool,
    /// For scenes with a camera: behind which object within reach to look while the target is not seen.
    #[arg(long, value_enum, default_value = "expected")]
    pub look: LookKind,
    #[command(flatten, next_help_heading = "Goals in PDDL")]
    pub symbolic: SymbolicArgs,
}

/// What is planned with symbols and streams.
#[derive(Debug, Args)]
pub struct SymbolicArgs {
    /// What to reach instead of having the target: a formula, `(and (On o7 tray) (InPlace o3))`, or a file with one.
    #[arg(long, value_name = "PDDL")]
    pub goal: Option<String>,
    /// Have the target, planned with symbols and streams.
    #[arg(long, conflicts_with = "goal")]
    pub symbolic: bool,
    /// A domain other than the built-in one, which `clearway pddl domain` prints.
    #[arg(long, value_name = "DOMAIN.pddl")]
    pub domain: Option<PathBuf>,
    /// Streams other than the built-in ones, which `clearway pddl streams` prints.
    #[arg(long, value_name = "STREAMS.pddl")]
    pub streams: Option<PathBuf>,
    /// How streams and symbols take turns; default: focused.
    #[arg(long, value_enum)]
    pub algorithm: Option<AlgorithmKind>,
    /// All objects may be moved from the start, not only those of removal sequences.
    #[arg(long)]
    pub all_movable: bool,
    /// Plan symbols with Fast Downward: its driver script, `fast-downward.py`, to be run by `python3`.
    #[arg(long, value_name = "DRIVER")]
    pub fast_downward: Option<PathBuf>,
}

impl SymbolicArgs {
    pub fn asked(&self) -> bool {
        self.goal.is_some() || self.symbolic
    }

    /// An option that is given in vain.
    pub fn unused(&self) -> Option<&'static str> {
        let given = [
            ("--domain", self.domain.is_some()),
            ("--streams", self.streams.is_some()),
            ("--algorithm", self.algorithm.is_some()),
            ("--all-movable", self.all_movable),
            ("--fast-downward", self.fast_downward.is_some()),
        ];
        given.into_iter().find(|(_, given)| *given && !self.asked()).map(|(option, _)| option)
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum AlgorithmKind {
    /// A plan with values not found yet, then the streams that it needs.
    Focused,
    /// All streams, then a plan with what they found.
    Incremental,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum First {
    /// 1: fewest removals.
    One,
    /// The fewest objects in the way of grasping the target directly, plus one for the target.
    Grasp,
    /// All objects: every sequence is allowed from the start.
    All,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum LookKind {
    /// The one that most places where the target could be ask for.
    Expected,
    /// The one farthest from the robot: the paper's rule.
    Farthest,
    /// The one that hides the largest volume: the rule of Nam et al.
    Largest,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum SearchKind {
    Exact,
    Greedy,
}

#[derive(Debug, Args)]
pub struct VerifyArgs {
    pub plan: PathBuf,
    /// Print the report as one JSON object on stdout.
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct ExplainArgs {
    pub plan: PathBuf,
}

#[derive(Debug, Args)]
pub struct GenerateArgs {
    #[arg(value_enum)]
    pub kind: Kind,
    /// Default: 12, 100 for `large`, 20 for `table`, 8 for `stacked`.
    #[arg(long)]
    pub objects: Option<usize>,
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Reject scenes in which fewer objects suffice, the target counted. Default: 2, 10 for `large`, 1 for
    /// `table`; for `stacked` the one on top, one below it and the target.
    #[arg(long, value_name = "N")]
    pub least_removals: Option<usize>,
    /// For `table`: only scenes in which driving helps: two or more have to be removed besides the target from
    /// where the base starts, one from another side.
    #[arg(long)]
    pub contrast: bool,
    /// Where to write the scene; default: stdout.
    #[arg(short, long, value_name = "SCENE")]
    pub output: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Kind {
    /// Cylinders in an open-fronted cabinet before a UR10.
    Shelf,
    /// Many slender cylinders in a wide cabinet.
    Large,
    /// Cylinders on a table, the target in their middle, a PR2 at one side.
    Table,
    /// A shelf whose objects hide each other and the target from a camera; a UR10 with a suction cup.
    Occluded,
    /// A shelf with an object on top of two others that stand before the target.
    Stacked,
}

#[derive(Debug, Args)]
pub struct ViewArgs {
    pub plan: PathBuf,
    /// Default: the plan's name with `.html`.
    #[arg(short, long, value_name = "PAGE.html")]
    pub output: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct RobotArgs {
    /// A built-in robot's name, a robot file, or a URDF.
    #[arg(value_name = "NAME-or-FILE")]
    pub model: String,
    /// Where `package://NAME` in the URDF leads.
    #[arg(long, value_name = "NAME=DIR", value_parser = package)]
    pub package: Vec<(String, PathBuf)>,
    /// Print the URDF that is planned for.
    #[arg(long)]
    pub urdf: bool,
}

#[derive(Debug, Args)]
pub struct ExportArgs {
    pub plan: PathBuf,
    #[arg(long, value_enum)]
    pub to: Format,
    /// Joints whose names begin with OLD begin with NEW instead (`panda_=fer_`); an empty OLD puts NEW before all.
    /// Not for MCAP, where names are the URDF's.
    #[arg(long, value_name = "OLD=NEW", value_parser = renaming)]
    pub rename: Vec<(String, String)>,
    /// Default: stdout.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Format {
    /// Shaped like ROS 2's trajectory_msgs/JointTrajectory, with the gripper's commands in between.
    JointTrajectory,
    /// A recording of the robot moving in the scene: opens in Foxglove, and is a ROS 2 bag.
    Mcap,
    /// One row per sample.
    Csv,
}

#[derive(Debug, Args)]
pub struct MotionArgs {
    /// The motion problem (YAML or JSON): see `clearway schema motion`.
    pub problem: PathBuf,
    /// Where the samples begin: another seed is another attempt.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Seconds of planning before giving up.
    #[arg(long, value_name = "S", default_value_t = 10.0, value_parser = seconds)]
    pub time_limit: f64,
    /// Where to write the answer; without a path it says why.
    #[arg(short, long, value_name = "PATH.json")]
    pub output: Option<PathBuf>,
    /// Print the answer as one JSON object on stdout.
    #[arg(long)]
    pub json: bool,
    /// Where `package://NAME` in the robot's URDF leads.
    #[arg(long, value_name = "NAME=DIR", value_parser = package)]
    pub package: Vec<(String, PathBuf)>,
}

#[derive(Debug, Args)]
pub struct SimulateArgs {
    pub plan: PathBuf,
    /// Print the report as one JSON object on stdout.
    #[arg(long)]
    pub json: bool,
    /// Objects stand elsewhere than the scene says: uniform in a horizontal disc of this radius.
    #[arg(long, value_name = "METRES", default_value_t = 0.0, allow_negative_numbers = true)]
    pub noise: f64,
    /// Friction differs: uniform, up to this fraction more or less.
    #[arg(long, value_name = "FRACTION", default_value_t = 0.0, allow_negative_numbers = true)]
    pub noise_friction: f64,
    /// Radii differ: uniform, up to this much more or less.
    #[arg(long, value_name = "METRES", default_value_t = 0.0, allow_negative_numbers = true)]
    pub noise_radius: f64,
    /// Play it so many times, each with noise of its own.
    #[arg(long, value_name = "N")]
    pub trials: Option<usize>,
    /// Where the noise comes from.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads to use at most for trials; the report does not depend on it. Default: all cores.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Each pad of a closed hand presses with this force.
    #[arg(long, value_name = "NEWTONS", allow_negative_numbers = true)]
    pub grip: Option<f64>,
    /// Coefficient of friction of fingers and cups.
    #[arg(long, value_name = "COEFFICIENT", allow_negative_numbers = true)]
    pub rubber: Option<f64>,
    /// Time constant of the joints' controllers.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub lag: Option<f64>,
    /// Steps of the physics per second.
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub rate: Option<f64>,
    /// What the plan moved may end so far from its place.
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    pub tolerance: Option<f64>,
}

#[derive(Debug, Args)]
pub struct BenchArgs {
    #[command(subcommand)]
    pub experiment: Experiment,
}

#[derive(Debug, Subcommand)]
pub enum Experiment {
    /// Plain motion planning, on problems as MotionBenchMaker's sets are handed on.
    ///
    /// RRT-Connect and simplification, one thread; per problem the least times of the repeats. A
    /// cylinder counts as VAMP's scripts take it, so that figures compare: as a capsule of the
    /// cylinder's length with caps beyond it, in the set `box` as the cuboid round it.
    Motion(BenchMotionArgs),
    /// Table I and Fig. 12: 12, 16 and 20 objects, 20 scenes of each, 20 runs, three first limits.
    Known(BenchRetrievalArgs),
    /// Figs. 13 and 14: how the roadmap and the retrieval graph grow, with the paper's settings.
    Graphs(BenchRetrievalArgs),
    /// Fig. 15: against the traversability graph of [3], and clearing the shortest path.
    Peers(BenchRetrievalArgs),
    /// Table V: 100 objects, at least 10 to remove.
    Large(BenchRetrievalArgs),
    /// Table VI: 16 objects, against the fewest removals and brute force.
    Optimal(BenchRetrievalArgs),
    /// Hidden objects (Table II): rules where to look, and the same scenes with all objects known.
    Occlusion(BenchRetrievalArgs),
    /// Table III and Fig. 9: 20 objects on a table, a base that drives against the same base fixed.
    Mobile(BenchRetrievalArgs),
    /// Table IV and Fig. 10: an object on two others before the target; streams, streams with removal sequences, and
    /// the retrieval graph alone.
    Stacked(BenchRetrievalArgs),
    /// Make tables (Markdown, CSV) and figures (SVG) from the rows in a directory, beside them.
    Report(BenchReportArgs),
}

#[derive(Debug, Args)]
pub struct BenchRetrievalArgs {
    /// Rows go to DIR/EXPERIMENT.jsonl, each synced as it is there; default: stdout.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Go on where an earlier run in DIR ended, however it ended.
    #[arg(long, requires = "out")]
    pub resume: bool,
    /// A small cut, in under a minute.
    #[arg(long)]
    pub quick: bool,
    /// Runs at a time; more than one disturb each other's times.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub jobs: u32,
    /// Seconds for one run; default: 10, 60 for `large` and `optimal`, 2 with --quick.
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub time_limit: Option<f64>,
}

#[derive(Debug, Args)]
pub struct BenchReportArgs {
    /// Where EXPERIMENT.jsonl files are.
    #[arg(value_name = "DIR")]
    pub directory: PathBuf,
}

#[derive(Debug, Args)]
pub struct BenchMotionArgs {
    /// The robot's URDF; the joints planned for are those that the problems name.
    #[arg(long, value_name = "URDF")]
    pub robot: PathBuf,
    /// Pairs of links never checked. Without it: neighbours, and pairs that always touch.
    #[arg(long, value_name = "SRDF")]
    pub srdf: Option<PathBuf>,
    /// `{joints, problems: {set: [{index, start, goals, sphere, box, cylinder}]}}`, JSON.
    #[arg(long, value_name = "FILE")]
    pub problems: PathBuf,
    /// Longest new motion of the search, radians of joint distance.
    #[arg(long, value_name = "R", default_value_t = 1.0)]
    pub range: f64,
    /// Samples per radian of joint distance, at least; what lies between them is checked as well.
    #[arg(long, value_name = "N", default_value_t = 32.0)]
    pub checks_per_rad: f64,
    /// How often each problem is planned; the least times are kept.
    #[arg(long, value_name = "N", default_value_t = 9, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub repeats: u32,
    /// Where `package://NAME` in the URDF leads.
    #[arg(long, value_name = "NAME=DIR", value_parser = package)]
    pub package: Vec<(String, PathBuf)>,
    /// Take cylinders as cylinders.
    #[arg(long)]
    pub true_cylinders: bool,
    /// Seconds for one attempt before giving a problem up.
    #[arg(long, value_name = "S", default_value_t = 10.0, value_parser = seconds)]
    pub time_limit: f64,
    /// Rows go to DIR/motion.jsonl, the summary to DIR/summary.json; default: stdout.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Another planner's rows on the same problems, to compare with.
    #[arg(long, value_name = "FILE")]
    pub peer: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct SchemaArgs {
    #[arg(value_enum)]
    pub file: Document,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Document {
    Scene,
    Robot,
    Plan,
    Motion,
}

#[derive(Debug, Args)]
pub struct PddlArgs {
    #[arg(value_enum)]
    pub file: PddlFile,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum PddlFile {
    Domain,
    Streams,
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(s) if s > 0.0 && s <= 1e9 => Ok(s),
        Ok(_) => Err("must be more than 0 seconds, and finite".to_owned()),
        Err(_) => Err("is no number of seconds".to_owned()),
    }
}

fn renaming(text: &str) -> Result<(String, String), String> {
    let (old, new) = text.split_once('=').ok_or("must be OLD=NEW")?;
    Ok((old.to_owned(), new.to_owned()))
}

fn package(text: &str) -> Result<(String, PathBuf), String> {
    match text.split_once('=') {
        Some((name, directory)) if !name.is_empty() && !directory.is_empty() => Ok((name.to_owned(), directory.into())),
        _ => Err("must be NAME=DIR".to_owned()),
    }
}
