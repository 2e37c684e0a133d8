//! The built-in domain and streams, and what is said of domains that lack something.
#![allow(clippy::unwrap_used)]

use clearway_symbolic::pddl::{Domain, Stream, TypeId};
use clearway_symbolic::telling::check;
use clearway_symbolic::{DOMAIN, STREAMS, arm, domain, streams};
use std::path::Path;

#[test]
fn the_built_in_domain_and_streams_are_read() {
    let domain = domain();
    let streams = streams(&domain).unwrap();
    assert_eq!(domain, Domain::read(Path::new("again"), DOMAIN).unwrap());
    assert_eq!(domain.actions.iter().map(|a| a.name.as_str()).collect::<Vec<_>>(), ["pick", "place"]);
    assert_eq!(check(&domain, &streams), Ok(()));
}

#[test]
fn every_stream_that_is_provided_is_declared() {
    let streams = streams(&domain()).unwrap();
    assert_eq!(streams.len(), arm::PROVIDED.len());
    for provided in &arm::PROVIDED {
        let stream = streams.iter().find(|s| s.name == provided.name).unwrap();
        assert_eq!(
            (stream.inputs.len(), stream.outputs.len()),
            (provided.inputs, provided.outputs),
            "{}",
            provided.name
        );
    }
}

#[test]
fn what_streams_certify_is_of_what_actions_need_and_no_action_changes_it() {
    let domain = domain();
    let mut certified: Vec<&str> = Vec::new();
    for stream in streams(&domain).unwrap() {
        assert!(!stream.certified.is_empty(), "{}", stream.name);
        certified.extend(stream.certified.iter().map(|a| domain.predicates[a.predicate.0].name.as_str()));
    }
    certified.sort_unstable();
    certified.dedup();
    assert_eq!(certified, ["CFreePose", "CFreeWay", "Grasp", "Kin", "Motion", "Pose", "Rests", "Supported"]);
}

/// What is said of the built-in domain changed in some way.
fn said(change: impl FnOnce(&mut Domain)) -> String {
    let mut changed = domain();
    let streams = streams(&changed).unwrap();
    change(&mut changed);
    check(&changed, &streams).unwrap_err()
}

#[test]
fn a_missing_predicate_is_named() {
    for name in ["Home", "Pose", "Supported", "Rests", "Surface", "Stackable", "AtPose", "On", "HandEmpty"] {
        let id = domain().predicate(name).unwrap().0;
        let missing = said(|d| d.predicates[id].name = "Other".to_owned());
        assert!(missing.contains(&format!("`{name}`")), "{missing}");
        let other = said(|d| d.predicates[id].parameters.push(TypeId(0)));
        assert!(other.contains(&format!("`{name}`")), "{other}");
    }
}

#[test]
fn a_missing_type_is_named() {
    for name in ["item", "place", "shelf", "pose"] {
        let id = domain().types.named(name).unwrap().0;
        let missing = said(|d| d.types.names[id] = "other".to_owned());
        assert!(missing.contains(&format!("`{name}`")), "{missing}");
    }
}

#[test]
fn streams_about_what_a_domain_lacks_are_refused_by_name() {
    for (name, lacking) in
        [("Surface", DOMAIN.replace("(Surface ?s - support)", "")), ("CFreePose", DOMAIN.replace("CFreePose", "Apart"))]
    {
        let lacking = Domain::read(Path::new("lacking"), &lacking).unwrap();
        let error = streams(&lacking).unwrap_err().to_string();
        assert!(error.contains(&format!("`{name}`")), "{error}");
    }
}

#[test]
fn a_motion_is_planned_in_a_state_and_nothing_else_is() {
    let domain = domain();
    let read = |text: &str| Stream::read_all(Path::new("changed"), text, &domain, &arm::PROVIDED).unwrap();
    let without = read(&STREAMS.replace(":fluents (AtPose)", ""));
    assert!(check(&domain, &without).unwrap_err().contains("`plan-motion`"));
    let more = read(&STREAMS.replace(":outputs (?g - grasp)", ":fluents (AtPose) :outputs (?g - grasp)"));
    assert!(check(&domain, &more).unwrap_err().contains("`sample-grasp`"));
}

#[test]
fn what_streams_find_must_be_asked_for_plainly() {
    let needs = "(Kin ?o ?p ?g ?w) (AtPose ?o ?p)";
    assert!(DOMAIN.contains(needs));
    let other = "(or (Kin ?o ?p ?g ?w) (HandEmpty)) (AtPose ?o ?p)";
    let domain = Domain::read(Path::new("hidden"), &DOMAIN.replace(needs, other)).unwrap();
    let told = check(&domain, &streams(&domain).unwrap()).unwrap_err();
    assert!(told.contains("`Kin`") && told.contains("`pick`"), "{told}");
}
