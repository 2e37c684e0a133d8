//! Formulas and atoms, in the scope of their variables.

use super::ast::{Atom, Formula, Term, TypeId, Variable};
use super::lists::{variables, wrong_number};
use super::names::{Names, unknown};
use super::sexpr::{Place, Sexpr};
use clearway_files::{FileError, closest, quoted};
use std::collections::HashMap;

/// What no predicate can be called.
pub(super) const RESERVED: [&str; 9] = ["and", "or", "not", "imply", "forall", "exists", "when", "either", "="];

/// Reads what belongs to one action, stream, derived predicate or goal.
pub(super) struct Reader<'d, 'n, 't> {
    pub names: &'n Names<'d>,
    /// What each variable in scope stands for, the innermost last.
    scope: HashMap<&'t str, Vec<(usize, TypeId)>>,
    /// How many there were so far.
    pub slots: usize,
    /// Where the atoms and equations stand, in the order of [`leaves`].
    pub places: Vec<Place>,
}

impl<'d, 'n, 't> Reader<'d, 'n, 't> {
    pub fn new(names: &'n Names<'d>) -> Self {
        Self { names, scope: HashMap::new(), slots: 0, places: Vec::new() }
    }

    /// Variables of the types that are written, brought into scope.
    pub fn variables(&mut self, items: &[Sexpr<'t>]) -> Result<Vec<Variable>, FileError> {
        let typed = variables(self.names.source, items)?;
        typed.into_iter().map(|(name, typed)| Ok(self.bind(name, self.names.type_of(typed.of)?))).collect()
    }

    pub fn bind(&mut self, name: &'t str, of: TypeId) -> Variable {
        let slot = self.slots;
        self.slots += 1;
        self.scope.entry(name).or_default().push((slot, of));
        Variable { slot, of, name: name.to_owned() }
    }

    /// Takes the variables out of scope.
    pub fn release(&mut self, variables: &[Variable]) {
        for variable in variables {
            if let Some(meant) = self.scope.get_mut(variable.name.as_str()) {
                meant.pop();
            }
        }
    }

    pub fn formula(&mut self, at: &Sexpr<'t>) -> Result<Formula, FileError> {
        let source = self.names.source;
        let (head, rest) = match at.list() {
            Some([]) => return Ok(Formula::TRUE),
            Some([head, rest @ ..]) => (head, rest),
            None => return Err(self.no_list(at, "a formula")),
        };
        Ok(match (head.name().map(str::to_ascii_lowercase).as_deref(), rest) {
            (Some("and"), _) => Formula::And(self.formulas(rest)?),
            (Some("or"), _) => Formula::Or(self.formulas(rest)?),
            (Some("not"), [inner]) => Formula::Not(Box::new(self.formula(inner)?)),
            (Some("imply"), [if_this, then]) => {
                let not = Formula::Not(Box::new(self.formula(if_this)?));
                Formula::Or(vec![not, self.formula(then)?])
            }
            (Some("forall"), [variables, body]) => {
                let (variables, body) = self.quantified(variables, body)?;
                Formula::Forall(variables, body)
            }
            (Some("exists"), [variables, body]) => {
                let (variables, body) = self.quantified(variables, body)?;
                Formula::Exists(variables, body)
            }
            (Some("="), [a, b]) => {
                let equal = Formula::Equal(self.term(a)?.0, self.term(b)?.0);
                self.places.push(at.place);
                equal
            }
            (Some(word @ "not"), _) => return Err(wrong_number(source, at.place, &quoted(word), rest.len(), 1)),
            (Some(word @ ("imply" | "=")), _) => {
                return Err(wrong_number(source, at.place, &quoted(word), rest.len(), 2));
            }
            (Some(word @ ("forall" | "exists")), _) => {
                let error = source.error(at.place, format!("{} of {} parts", quoted(word), rest.len()));
                return Err(error.expected(format!("`({word} (?a ?b - type …) formula)`")));
            }
            (Some("when"), _) => {
                let error = source.error(head.place, "`when` is no formula").expected("a formula");
                return Err(error.help("`(when condition effect)` is an effect; in formulas it is `(imply a b)`"));
            }
            _ => Formula::Atom(self.atom(at)?),
        })
    }

    fn formulas(&mut self, all: &[Sexpr<'t>]) -> Result<Vec<Formula>, FileError> {
        all.iter().map(|at| self.formula(at)).collect()
    }

    /// Brings variables into scope that are written in parentheses.
    pub fn quantify(&mut self, variables: &Sexpr<'t>) -> Result<Vec<Variable>, FileError> {
        let Some(items) = variables.list() else {
            let error = self.names.source.error(variables.place, variables.quoted());
            return Err(error.expected("variables in parentheses, `(?a ?b - type …)`"));
        };
        self.variables(items)
    }

    fn quantified(
        &mut self,
        variables: &Sexpr<'t>,
        body: &Sexpr<'t>,
    ) -> Result<(Vec<Variable>, Box<Formula>), FileError> {
        let variables = self.quantify(variables)?;
        let body = Box::new(self.formula(body)?);
        self.release(&variables);
        Ok((variables, body))
    }

    pub fn atom(&mut self, at: &Sexpr<'t>) -> Result<Atom, FileError> {
        let source = self.names.source;
        let Some([head, arguments @ ..]) = at.list() else { return Err(self.no_list(at, "an atom")) };
        let Some(name) = head.name() else {
            let error = source.error(head.place, head.quoted()).expected("the name of a predicate");
            return Err(error.help("is there a parenthesis too many? Several formulas are joined by `(and …)`"));
        };
        if name.starts_with(':') {
            let error = source.error(head.place, format!("{} within a formula", quoted(name)));
            return Err(error.expected("a predicate").help("is a `)` missing before it?"));
        }
        let id = self.names.predicate(name, head.place)?;
        let predicate = &self.names.predicates[id.0];
        if arguments.len() != predicate.parameters.len() {
            return Err(wrong_number(source, at.place, &quoted(name), arguments.len(), predicate.parameters.len()));
        }
        let mut terms = Vec::with_capacity(arguments.len());
        for (i, (argument, &wanted)) in arguments.iter().zip(&predicate.parameters).enumerate() {
            let (term, of) = self.term(argument)?;
            if !self.names.fit(of, wanted) {
                let (of, wanted) = (quoted(self.names.type_name(of)), quoted(self.names.type_name(wanted)));
                let error = source.error(argument.place, format!("{} is of type {of}", argument.quoted()));
                let error = error.expected(format!("one of type {wanted}, as argument {} of {}", i + 1, quoted(name)));
                return Err(error.help(format!("nothing is of type {of} and of type {wanted}")));
            }
            terms.push(term);
        }
        self.places.push(at.place);
        Ok(Atom { predicate: id, terms })
    }

    fn term(&self, at: &Sexpr<'t>) -> Result<(Term, TypeId), FileError> {
        let source = self.names.source;
        let Some(name) = at.name() else {
            let error = source.error(at.place, at.quoted()).expected("a variable or a constant");
            return Err(error.help("functions are not supported"));
        };
        if name.starts_with('?') {
            return match self.scope.get(name).and_then(|meant| meant.last()) {
                Some(&(slot, of)) => Ok((Term::Variable(slot), of)),
                None => {
                    let known = self.in_scope().into_iter();
                    Err(unknown(source, at.place, "variable", name, known, "none of that name is in scope here"))
                }
            };
        }
        if let Some(id) = self.names.thing(name) {
            return Ok((Term::Constant(name.to_owned()), self.names.things[id].of));
        }
        let error = unknown(
            source,
            at.place,
            "name",
            name,
            self.names.things.iter().map(|c| c.name.as_str()),
            "a variable begins with `?`; a constant is declared in `(:constants …)` of the domain",
        );
        match closest(&format!("?{name}"), self.in_scope()) {
            Some(near) if near[1..] == *name => Err(error.help(format!("did you mean {}?", quoted(near)))),
            _ => Err(error),
        }
    }

    fn in_scope(&self) -> Vec<&'t str> {
        let mut all: Vec<&str> =
            self.scope.iter().filter(|(_, meant)| !meant.is_empty()).map(|(&name, _)| name).collect();
        all.sort_unstable();
        all
    }

    /// An error where something is no list that should be one.
    pub fn no_list(&self, at: &Sexpr, expected: &str) -> FileError {
        let error = self.names.source.error(at.place, at.quoted()).expected(format!("{expected} in parentheses"));
        match at.name() {
            Some(name) if self.names.known_predicate(name).is_some() => {
                error.help(format!("did you mean {}?", quoted(&format!("({name})"))))
            }
            _ => error,
        }
    }
}

/// How many atoms and equations a formula holds.
pub(super) fn leaves(formula: &Formula) -> usize {
    match formula {
        Formula::And(parts) | Formula::Or(parts) => parts.iter().map(leaves).sum(),
        Formula::Not(body) | Formula::Forall(_, body) | Formula::Exists(_, body) => leaves(body),
        Formula::Atom(_) | Formula::Equal(..) => 1,
    }
}
