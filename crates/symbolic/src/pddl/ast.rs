//! The nouns of PDDL, names resolved.

/// Which of [`Domain::types`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TypeId(pub usize);

/// Which of [`Domain::predicates`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PredicateId(pub usize);

/// A tree of types; the first is `object`, which all others are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Types {
    pub names: Vec<String>,
    /// `None` for `object` alone.
    pub parents: Vec<Option<TypeId>>,
}

impl Types {
    pub const OBJECT: TypeId = TypeId(0);

    /// Whether whatever is of type `what` is also of type `wanted`.
    pub fn is(&self, what: TypeId, wanted: TypeId) -> bool {
        let mut at = Some(what);
        while let Some(here) = at {
            if here == wanted {
                return true;
            }
            at = self.parents[here.0];
        }
        false
    }

    pub fn named(&self, name: &str) -> Option<TypeId> {
        self.names.iter().position(|n| n == name).map(TypeId)
    }
}

/// Something that a file or a scene names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constant {
    pub name: String,
    pub of: TypeId,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Predicate {
    pub name: String,
    pub parameters: Vec<TypeId>,
}

/// A variable's slot among those of its action, stream or derived predicate, and its type.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Variable {
    pub slot: usize,
    pub of: TypeId,
    /// As written, with its `?`.
    pub name: String,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Term {
    /// The slot of a [`Variable`].
    Variable(usize),
    /// A [`Constant`]'s name.
    Constant(String),
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Atom {
    pub predicate: PredicateId,
    pub terms: Vec<Term>,
}

/// `(imply a b)` is read as `(or (not a) b)`, an empty `(and)` as true, an empty `(or)` as false.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Formula {
    And(Vec<Formula>),
    Or(Vec<Formula>),
    Not(Box<Formula>),
    Forall(Vec<Variable>, Box<Formula>),
    Exists(Vec<Variable>, Box<Formula>),
    Atom(Atom),
    Equal(Term, Term),
}

impl Formula {
    pub const TRUE: Formula = Formula::And(Vec::new());
}

/// `(forall variables (when condition atom))`, or with `(not atom)`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Effect {
    pub variables: Vec<Variable>,
    pub condition: Formula,
    pub atom: Atom,
    /// False for `(not atom)`.
    pub adds: bool,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Action {
    pub name: String,
    /// Slots 0, 1, …
    pub parameters: Vec<Variable>,
    /// How many slots there are, those of quantified variables included.
    pub slots: usize,
    pub precondition: Formula,
    pub effects: Vec<Effect>,
}

/// `(:derived (predicate parameters) body)`: true exactly where the body is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Derived {
    pub predicate: PredicateId,
    /// Slots 0, 1, …
    pub parameters: Vec<Variable>,
    pub slots: usize,
    pub body: Formula,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Domain {
    pub name: String,
    pub types: Types,
    pub constants: Vec<Constant>,
    pub predicates: Vec<Predicate>,
    pub derived: Vec<Derived>,
    pub actions: Vec<Action>,
}

impl Domain {
    pub fn predicate(&self, name: &str) -> Option<PredicateId> {
        self.predicates.iter().position(|p| p.name == name).map(PredicateId)
    }
}

/// A procedure that, given inputs of which its domain holds, finds outputs of which what it certifies holds.
/// Without outputs it is a test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stream {
    pub name: String,
    /// Slots 0, 1, …
    pub inputs: Vec<Variable>,
    /// The slots after those.
    pub outputs: Vec<Variable>,
    /// All of these must hold.
    pub domain: Vec<Atom>,
    pub certified: Vec<Atom>,
    /// What else the answer depends on: the state in which it is asked.
    pub fluents: Vec<PredicateId>,
}

/// A goal: its variables are all quantified inside.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Goal {
    pub slots: usize,
    pub formula: Formula,
    /// As written.
    pub text: String,
}
