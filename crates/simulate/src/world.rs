//! The physics engine, set up for a robot among household things: millisecond steps, contacts that are stiff and
//! give in by a few hundredths of a millimetre under an object's own weight, Coulomb friction at every point.
//!
//! Two bodies rub with the larger of their coefficients; fixtures and the arm have none of their own.

use crate::bodies::{Object, volume};
use crate::caps::Caps;
use crate::settings::Settings;
use clearway_verify::played::{Played, PlayedBody, PlayedShape};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::{DefaultQueryDispatcher, QueryDispatcher};
use rapier3d_f64::dynamics::{CoefficientCombineRule, MassProperties};
use rapier3d_f64::dynamics::{
    FixedJoint, FrictionModel, ImpulseJointHandle, RigidBodyBuilder, RigidBodyHandle, SpringCoefficients,
};
use rapier3d_f64::geometry::{
    ActiveCollisionTypes, ColliderBuilder, ColliderHandle, ColliderSet, NarrowPhase, SolverFlags,
};
use rapier3d_f64::pipeline::{ActiveHooks, ContactModificationContext, PairFilterContext, PhysicsHooks, PhysicsWorld};
use std::collections::HashSet;

const GRAVITY: f64 = 9.81;
/// Of contacts, hertz. A thing sinks in by some 0.05 mm under its own weight, and by 0.3 mm between pads that press
/// like rubber: stiffer, a pad would hold a slightly tilted cylinder at one end of the line where they touch.
const CONTACT_FREQUENCY: f64 = 60.0;
const CONTACT_DAMPING: f64 = 2.0;
/// Metres.
const SAME_POINT: f64 = 1e-4;

/// Whose shape it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Owner {
    Link(usize),
    Fixture(usize),
    Object(usize),
}

impl Owner {
    fn tag(self) -> u128 {
        match self {
            Self::Link(i) => i as u128,
            Self::Fixture(i) => 1 << 64 | i as u128,
            Self::Object(i) => 2 << 64 | i as u128,
        }
    }

    fn of(colliders: &ColliderSet, handle: ColliderHandle) -> Self {
        let tag = colliders[handle].user_data;
        let index = tag as u64 as usize;
        match tag >> 64 {
            0 => Self::Link(index),
            1 => Self::Fixture(index),
            _ => Self::Object(index),
        }
    }
}

/// Two bodies that touched in the last step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    /// In the order of [`Owner`].
    pub first: Owner,
    pub second: Owner,
    /// Of the contact normals, onto the second, newtons.
    pub push: Vector,
    /// The sum of the normal forces' magnitudes, newtons. 0 between what does not give way.
    pub force: f64,
    /// How deep they are in each other, metres.
    pub depth: f64,
}

pub(crate) struct World {
    physics: PhysicsWorld,
    links: Vec<RigidBodyHandle>,
    objects: Vec<RigidBodyHandle>,
    unwatched: Unwatched,
}

impl World {
    /// `rubber`: links with the settings' friction.
    pub fn new(played: &Played, objects: &[Object], links_at: &[Pose], rubber: &[bool], settings: &Settings) -> Self {
        let narrow_phase = NarrowPhase::with_query_dispatcher(Caps.chain(DefaultQueryDispatcher));
        let mut physics = PhysicsWorld { gravity: Vector::Z * -GRAVITY, narrow_phase, ..PhysicsWorld::default() };
        let softness = SpringCoefficients::new(CONTACT_FREQUENCY, CONTACT_DAMPING);
        let parameters = &mut physics.integration_parameters;
        parameters.dt = 1.0 / settings.rate;
        parameters.contact_softness = softness;
        parameters.static_contact_softness = softness;
        parameters.friction_model = FrictionModel::Coulomb;
        // Without it what is gripped creeps out of the hand, some millimetres in a transfer.
        parameters.friction_in_bias_pass = true;
        parameters.normalized_prediction_distance = 2e-3;
        parameters.normalized_allowed_linear_error = 1e-5;
        // Both spare work at the expense of where exactly things touch.
        parameters.contact_recycling = false;
        parameters.contact_clustering = false;
        parameters.max_ccd_substeps = 0;
        let mut world = Self { physics, links: Vec::new(), objects: Vec::new(), unwatched: Unwatched::new(played) };
        for (i, fixture) in played.fixtures.iter().enumerate() {
            world.insert_fixture(fixture, i);
        }
        for (i, (link, at)) in played.links.iter().zip(links_at).enumerate() {
            let body = world.physics.bodies.insert(RigidBodyBuilder::kinematic_position_based().pose(*at));
            let friction = if rubber[i] { settings.rubber } else { 0.0 };
            for shape in &link.shapes {
                let collider = collider(shape, Owner::Link(i), friction)
                    .active_collision_types(ActiveCollisionTypes::all())
                    .active_hooks(ActiveHooks::FILTER_CONTACT_PAIRS | ActiveHooks::MODIFY_SOLVER_CONTACTS);
                world.physics.insert_collider(collider, Some(body));
            }
            world.links.push(body);
        }
        for (i, object) in objects.iter().enumerate() {
            world.insert_object(object, i);
        }
        world
    }

    fn insert_fixture(&mut self, fixture: &PlayedBody, index: usize) {
        let body = self.physics.bodies.insert(RigidBodyBuilder::fixed().pose(fixture.world_from_body));
        for shape in &fixture.shapes {
            self.physics.insert_collider(collider(shape, Owner::Fixture(index), 0.0), Some(body));
        }
    }

    fn insert_object(&mut self, object: &Object, index: usize) {
        let volume = volume(&object.shapes);
        let mut builder = RigidBodyBuilder::dynamic().pose(object.world_from_object);
        if volume <= 0.0 {
            // A surface without a volume: as if a ball as large.
            let radius =
                object.shapes.iter().map(|s| s.shape.compute_local_bounding_sphere().radius).fold(1e-3, f64::max);
            let inertia = Vector::splat(0.4 * object.mass * radius * radius);
            builder = builder.additional_mass_properties(MassProperties::new(Vector::ZERO, object.mass, inertia));
        }
        let body = self.physics.bodies.insert(builder);
        let activation = self.physics.bodies[body].activation_mut();
        activation.normalized_linear_threshold = 2e-3;
        activation.angular_threshold = 2e-2;
        for shape in &object.shapes {
            let density = if volume > 0.0 { object.mass / volume } else { 0.0 };
            let collider = collider(shape, Owner::Object(index), object.friction).density(density);
            self.physics.insert_collider(collider, Some(body));
        }
        self.objects.push(body);
    }

    /// Where the links are to be after the next step.
    pub fn drive(&mut self, links_at: &[Pose]) {
        for (body, at) in self.links.iter().zip(links_at) {
            self.physics.bodies[*body].set_next_kinematic_position(*at);
        }
    }

    pub fn step(&mut self) {
        self.physics.step_with_events(&self.unwatched, &());
    }

    /// Objects that lie still are left out of the physics; this one not, for now.
    pub fn keep_awake(&mut self, object: usize) {
        self.physics.bodies[self.objects[object]].wake_up(true);
    }

    pub fn object(&self, object: usize) -> Pose {
        *self.physics.bodies[self.objects[object]].position()
    }

    pub fn link(&self, link: usize) -> Pose {
        *self.physics.bodies[self.links[link]].position()
    }

    /// Fixes an object to a link, where it is.
    pub fn weld(&mut self, link: usize, object: usize) -> ImpulseJointHandle {
        let link_from_object = self.link(link).inverse() * self.object(object);
        let mut joint = FixedJoint::new();
        joint.set_local_frame1(link_from_object).set_contacts_enabled(false);
        self.physics.impulse_joints.insert(self.links[link], self.objects[object], joint, true)
    }

    pub fn part(&mut self, weld: ImpulseJointHandle) {
        self.physics.impulse_joints.remove(weld, true);
    }

    /// What touched in the last step, an entry per pair of shapes.
    pub fn contacts(&self) -> impl Iterator<Item = Contact> {
        let (colliders, rate) = (&self.physics.colliders, self.physics.integration_parameters.inv_dt());
        self.physics.narrow_phase.contact_pairs().filter_map(move |pair| {
            let (mut push, mut force, mut depth) = (Vector::ZERO, 0.0, 0.0_f64);
            for manifold in pair.solver_manifolds() {
                // Points that were not solved for keep the impulses of earlier steps.
                for solved in &manifold.data.solver_contacts {
                    let Some(point) = manifold.points.get(solved.contact_indices()[0] as usize) else { continue };
                    push += manifold.data.normal * (point.data.impulse * rate);
                    force += point.data.impulse * rate;
                }
                depth = manifold.points.iter().map(|p| -p.dist).fold(depth, f64::max);
            }
            if force <= 0.0 && depth <= 0.0 {
                return None;
            }
            let (a, b) = (Owner::of(colliders, pair.collider1), Owner::of(colliders, pair.collider2));
            let (first, second, push) = if a <= b { (a, b, push) } else { (b, a, -push) };
            Some(Contact { first, second, push, force, depth })
        })
    }
}

fn collider(shape: &PlayedShape, owner: Owner, friction: f64) -> ColliderBuilder {
    ColliderBuilder::new(shape.shape.clone())
        .position(shape.owner_from_shape)
        .friction(friction)
        .friction_combine_rule(CoefficientCombineRule::Max)
        .user_data(owner.tag())
}

/// Pairs that are not looked at: links the plan leaves unchecked, and the mounted root against fixtures.
struct Unwatched {
    links: HashSet<(usize, usize)>,
    mounted: Vec<bool>,
}

impl Unwatched {
    fn new(played: &Played) -> Self {
        let count = played.links.len();
        let pairs = (0..count).flat_map(|a| (a..count).map(move |b| (a, b)));
        Self {
            links: pairs.filter(|(a, b)| played.unchecked(*a, *b)).collect(),
            mounted: played.links.iter().map(|l| l.mounted).collect(),
        }
    }
}

impl PhysicsHooks for Unwatched {
    fn filter_contact_pair(&self, context: &PairFilterContext) -> Option<SolverFlags> {
        let owner = |handle| Owner::of(context.colliders, handle);
        let unwatched = match (owner(context.collider1), owner(context.collider2)) {
            (Owner::Link(a), Owner::Link(b)) => self.links.contains(&(a.min(b), a.max(b))),
            (Owner::Link(link), Owner::Fixture(_)) | (Owner::Fixture(_), Owner::Link(link)) => self.mounted[link],
            _ => false,
        };
        (!unwatched).then(SolverFlags::default)
    }

    /// A cylinder against a pad touches along a line, whose ends come several times over: solved one after the
    /// other, their friction would pull against itself.
    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        let Some(manifold) = context.rigid_mut() else { return };
        let contacts = &mut manifold.solver_contacts;
        let mut i = 0;
        while i < contacts.len() {
            let again = (0..i).any(|j| (contacts[j].anchor1 - contacts[i].anchor1).length() < SAME_POINT);
            if again {
                contacts.remove(i);
            } else {
                i += 1;
            }
        }
    }
}
