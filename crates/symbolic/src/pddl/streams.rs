//! Reads streams, in the form of PDDLStream, against a domain and what the program provides.

use super::ast::{Atom, Domain, PredicateId, Stream, TypeId, Types, Variable};
use super::formula::{RESERVED, Reader};
use super::lists::{define, items, properties, section, variables};
use super::names::{Names, Once, given, unknown};
use super::sexpr::{self, Place, Sexpr, Source};
use clearway_files::{FileError, Limits, quoted, read_text};
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// A stream that the program has a procedure for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Provided {
    pub name: &'static str,
    pub inputs: usize,
    pub outputs: usize,
}

const PROPERTIES: [&str; 5] = [":inputs", ":domain", ":fluents", ":outputs", ":certified"];

impl Stream {
    pub fn load_all(path: &Path, domain: &Domain, provided: &[Provided]) -> Result<Vec<Stream>, FileError> {
        Self::read_all(path, &read_text(path, &Limits::DOCUMENT)?, domain, provided)
    }

    /// Reads `text`, of which `path` is the name for messages. Not all that is provided must be used.
    pub fn read_all(path: &Path, text: &str, domain: &Domain, provided: &[Provided]) -> Result<Vec<Stream>, FileError> {
        let source = Source { path };
        let whole = sexpr::read(source, text)?;
        let (_, rest) = define(source, &whole, "stream")?;
        let names = Names::new(source, &domain.types, &domain.predicates, &domain.constants);
        let mut changed = HashMap::new();
        for action in &domain.actions {
            for effect in &action.effects {
                changed.entry(effect.atom.predicate).or_insert(action.name.as_str());
            }
        }
        let derived = domain.derived.iter().map(|d| d.predicate).collect();
        let mut file = File { names: &names, provided, changed, derived, once: Once::new("stream") };
        let streams = rest.iter().map(|at| file.stream(at.place, section(source, at, &[":stream"])?.1));
        streams.collect()
    }
}

struct File<'d, 'n, 't> {
    names: &'n Names<'d>,
    provided: &'n [Provided],
    /// What actions change, and one that does.
    changed: HashMap<PredicateId, &'d str>,
    derived: HashSet<PredicateId>,
    once: Once<'t>,
}

impl<'t> File<'_, '_, 't> {
    fn stream(&mut self, place: Place, parts: &[Sexpr<'t>]) -> Result<Stream, FileError> {
        let source = self.names.source;
        let [at, rest @ ..] = parts else {
            return Err(source.error(place, "a stream without a name").expected("`(:stream name …)`"));
        };
        let name = given(source, at, "a stream")?;
        self.once.check(source, name, at.place)?;
        let Some(provided) = self.provided.iter().find(|p| p.name == name) else {
            let known = self.provided.iter().map(|p| p.name);
            return Err(unknown(source, at.place, "stream", name, known, "the program has no such stream"));
        };
        let [inputs, domain, fluents, outputs, certified] = properties(source, rest, PROPERTIES)?;
        let mut reader = Reader::new(self.names);
        let domain_atoms = atoms(source, domain)?;
        let certified_atoms = atoms(source, certified)?;
        let inputs_at = inputs.map_or(at.place, |i| i.place);
        let inputs = self.variables(&mut reader, items(source, inputs, "variables")?, &domain_atoms)?;
        self.number(inputs_at, name, "input", inputs.len(), provided.inputs)?;
        // Before the outputs are in scope.
        let domain = domain_atoms.iter().map(|at| atom(&mut reader, at)).collect::<Result<_, _>>()?;
        let outputs_at = outputs.map_or(at.place, |o| o.place);
        let outputs = items(source, outputs, "variables")?;
        for output in outputs {
            if let Some(twice) = output.name().filter(|n| inputs.iter().any(|i| i.name == *n)) {
                let error = source.error(output.place, format!("{} is an input already", quoted(twice)));
                return Err(error.help("give the output another name"));
            }
        }
        let outputs = self.variables(&mut reader, outputs, &certified_atoms)?;
        self.number(outputs_at, name, "output", outputs.len(), provided.outputs)?;
        let certified = certified_atoms.iter().map(|at| self.certified(&mut reader, at)).collect::<Result<_, _>>()?;
        let fluents = self.fluents(items(source, fluents, "predicates")?)?;
        Ok(Stream { name: name.to_owned(), inputs, outputs, domain, certified, fluents })
    }

    fn number(&self, place: Place, name: &str, what: &str, found: usize, expected: usize) -> Result<(), FileError> {
        if found == expected {
            return Ok(());
        }
        let s = if found == 1 { "" } else { "s" };
        let error = self.names.source.error(place, format!("stream {} with {found} {what}{s}", quoted(name)));
        Err(error
            .expected(expected.to_string())
            .help("streams are procedures of the program, which has it in that form"))
    }

    /// Brings variables into scope. One without a type has the narrowest that the atoms ask for.
    fn variables(
        &self,
        reader: &mut Reader<'_, '_, 't>,
        items: &[Sexpr<'t>],
        atoms: &[&Sexpr<'t>],
    ) -> Result<Vec<Variable>, FileError> {
        let narrowest = self.narrowest(atoms);
        let typed = variables(self.names.source, items)?.into_iter().map(|(name, typed)| {
            let of = match typed.of {
                None => narrowest.get(name).copied().unwrap_or(Types::OBJECT),
                of => self.names.type_of(of)?,
            };
            Ok(reader.bind(name, of))
        });
        typed.collect()
    }

    /// Of what type a variable must be, by its name. What is wrong with an atom is told when it is read.
    fn narrowest(&self, atoms: &[&Sexpr<'t>]) -> HashMap<&'t str, TypeId> {
        let mut types = HashMap::new();
        for atom in atoms {
            let Some(id) = atom.head().and_then(|name| self.names.known_predicate(name)) else { continue };
            let arguments = atom.list().into_iter().flatten().skip(1);
            for (argument, &of) in arguments.zip(&self.names.predicates[id.0].parameters) {
                let Some(name) = argument.name() else { continue };
                let narrowest = types.entry(name).or_insert(of);
                if self.names.types.is(of, *narrowest) {
                    *narrowest = of;
                }
            }
        }
        types
    }

    fn certified(&self, reader: &mut Reader<'_, '_, 't>, at: &Sexpr<'t>) -> Result<Atom, FileError> {
        let source = self.names.source;
        let atom = atom(reader, at)?;
        let name = || quoted(&self.names.predicates[atom.predicate.0].name);
        if self.derived.contains(&atom.predicate) {
            let error = source.error(at.place, format!("{} is derived, so no stream can certify it", name()));
            return Err(error.help("certify what it is derived from"));
        }
        if let Some(action) = self.changed.get(&atom.predicate) {
            let error = source.error(at.place, format!("{} is changed by the action {}", name(), quoted(action)));
            return Err(
                error.help("certified predicates must not be changed by actions: what is certified holds for ever")
            );
        }
        Ok(atom)
    }

    fn fluents(&self, all: &[Sexpr<'t>]) -> Result<Vec<PredicateId>, FileError> {
        let source = self.names.source;
        let mut once = Once::new("fluent");
        let fluents = all.iter().map(|at| {
            let Some(name) = at.name() else {
                return Err(source
                    .error(at.place, at.quoted())
                    .expected("the name of a predicate, without parentheses"));
            };
            once.check(source, name, at.place)?;
            self.names.predicate(name, at.place)
        });
        fluents.collect()
    }
}

/// The atoms of `(and …)`, or the one that there is.
fn atoms<'s, 't>(source: Source, value: Option<&'s Sexpr<'t>>) -> Result<Vec<&'s Sexpr<'t>>, FileError> {
    let Some(value) = value else { return Ok(Vec::new()) };
    match value.list() {
        None => Err(source.error(value.place, value.quoted()).expected("an atom, or `(and …)` of atoms")),
        Some([]) => Ok(Vec::new()),
        Some([and, all @ ..]) if and.is("and") => {
            let mut atoms = Vec::with_capacity(all.len());
            for at in all {
                match at.list() {
                    Some(_) => atoms.extend(self::atoms(source, Some(at))?),
                    None => return Err(source.error(at.place, at.quoted()).expected("an atom in parentheses")),
                }
            }
            Ok(atoms)
        }
        Some(_) => Ok(vec![value]),
    }
}

fn atom<'t>(reader: &mut Reader<'_, '_, 't>, at: &Sexpr<'t>) -> Result<Atom, FileError> {
    let head = at.head().unwrap_or_default();
    if let Some(word) = RESERVED.iter().find(|w| head.eq_ignore_ascii_case(w)) {
        let error =
            reader.names.source.error(at.place, format!("{} in what a stream needs or certifies", quoted(word)));
        return Err(error.expected("atoms, joined by `and`").help("make a predicate of it"));
    }
    reader.atom(at)
}
