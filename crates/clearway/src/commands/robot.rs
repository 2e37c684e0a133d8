//! `clearway robot`: checks a robot and says what was found.

use super::output::print;
use crate::cli::RobotArgs;
use crate::exit::{Exit, Failure};
use clearway::Robot;
use clearway_collision::unchecked_pairs;
use clearway_robot::description::describe_urdf;
use clearway_robot::{InverseKinematics, Kinematics, report};
use std::path::Path;

pub fn run(args: &RobotArgs) -> Result<Exit, Failure> {
    let here = Path::new(".");
    if args.model.to_lowercase().ends_with(".urdf") {
        let model = describe_urdf(Path::new(&args.model), &args.package)?;
        if args.urdf {
            let text = clearway_files::read_text(Path::new(&args.model), &clearway_files::Limits::DOCUMENT)?;
            print(text)?;
        } else {
            print(report::report_model(&model))?;
        }
        return Ok(Exit::Done);
    }
    let robot = Robot::load(&args.model, here, &args.package)?;
    if args.urdf {
        print(&robot.urdf_text)?;
        return Ok(Exit::Done);
    }
    let inverse = InverseKinematics::new(&robot, &Kinematics::new(&robot));
    print(report::report(&robot))?;
    print(format!("inverse kinematics: {}\n", inverse.describe()))?;
    let pairs = unchecked_pairs(&robot);
    let list: Vec<String> = pairs.iter().map(|[a, b]| format!("{a} – {b}")).collect();
    print(format!("pairs never checked ({}): {}\n", pairs.len(), list.join(", ")))?;
    Ok(Exit::Done)
}
