//! Mass, friction and clearance: what is not given is filled in, what makes no sense is refused.

use crate::numbers::shown;
use crate::source::Source;
use clearway_files::{FileError, quoted};
use clearway_geometry::Mass;
use clearway_plan::SceneFile;
use clearway_plan::scene_file::{Assumed, Body, DENSITY, FRICTION};
use std::ops::RangeInclusive;

/// Coefficients of friction, from ice on ice to soft rubber.
const FRICTIONS: RangeInclusive<f64> = 0.01..=3.0;
/// Kilograms.
const MASSES: RangeInclusive<f64> = 1e-4..=1000.0;
/// Metres: with more, no arm gets anywhere.
const CLEARANCES: RangeInclusive<f64> = 0.0..=0.2;

/// Checks what the file says.
pub(crate) fn check(source: &Source, file: &SceneFile) -> Result<(), FileError> {
    number(source, "clearance", "the clearance", file.clearance, CLEARANCES, "metres")?;
    number(source, "friction", "the friction", file.friction, FRICTIONS, COEFFICIENT)?;
    for (i, object) in file.objects.iter().enumerate() {
        let id = quoted(&object.id);
        number(
            source,
            &format!("objects.{i}.mass"),
            &format!("the mass of object {id}"),
            object.mass,
            MASSES,
            "kilograms",
        )?;
        let what = format!("the friction of object {id}");
        number(source, &format!("objects.{i}.friction"), &what, object.friction, FRICTIONS, COEFFICIENT)?;
    }
    Ok(())
}

const COEFFICIENT: &str = "as a coefficient of friction";

/// Masses and friction are the objects' own.
pub(crate) fn not_given(source: &Source, keys: &str, body: &Body) -> Result<(), FileError> {
    let given = [("mass", body.mass), ("friction", body.friction)].into_iter().find(|(_, value)| value.is_some());
    given.map_or(Ok(()), |(key, _)| {
        Err(source
            .error(&format!("{keys}.{key}"), format!("{} has the key `{key}`", quoted(&body.id)))
            .expected(format!("no `{key}`: only objects have one"))
            .help("what touches it rubs with its own friction: delete the key"))
    })
}

fn number(
    source: &Source,
    keys: &str,
    what: &str,
    value: Option<f64>,
    range: RangeInclusive<f64>,
    unit: &str,
) -> Result<(), FileError> {
    // Written so that NaN fails too.
    match value.filter(|v| !range.contains(v)) {
        None => Ok(()),
        Some(value) => Err(source
            .error(keys, format!("{what} is {}", shown(value)))
            .expected(format!("a number from {} to {}, {unit}", shown(*range.start()), range.end()))
            .help(match keys {
                "clearance" => "leave the key out for motions that do not touch".to_owned(),
                _ if keys.ends_with("mass") => format!("leave the key out for {DENSITY} kg/m³ of the object's shape"),
                "friction" => format!("leave the key out for {FRICTION}"),
                _ => "leave the key out for the scene's `friction`".to_owned(),
            })),
    }
}

/// Fills in what the file leaves out, and says for which objects; `masses`: at density 1.
pub(crate) fn fill_in(file: &mut SceneFile, masses: impl IntoIterator<Item = Mass>) -> Assumed {
    let without =
        |given: &dyn Fn(&Body) -> bool| file.objects.iter().filter(|o| !given(o)).map(|o| o.id.clone()).collect();
    let assumed = Assumed {
        mass: without(&|o| o.mass.is_some()),
        friction: without(&|o| o.friction.or(file.friction).is_some()),
    };
    let friction = *file.friction.get_or_insert(FRICTION);
    file.clearance.get_or_insert(0.0);
    for (object, mass) in file.objects.iter_mut().zip(masses) {
        object.friction.get_or_insert(friction);
        // To a tenth of a gram, as people write it.
        object.mass.get_or_insert(((DENSITY * mass.volume * 1e4).round() / 1e4).clamp(*MASSES.start(), *MASSES.end()));
    }
    assumed
}
