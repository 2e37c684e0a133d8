//! Sets of objects: Col, EdgeCol, NodeCol, PathCol and O_col of the paper are all of this one type.

use std::fmt;

/// An object's place in the scene's list of objects, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(pub u16);

impl ObjectId {
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

const WORDS: usize = 4;

/// A set of objects of one scene. At most [`ObjectSet::CAPACITY`] objects; copying is cheap.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct ObjectSet([u64; WORDS]);

impl ObjectSet {
    /// How many objects a scene can have.
    pub const CAPACITY: usize = WORDS * 64;
    pub const EMPTY: ObjectSet = ObjectSet([0; WORDS]);

    /// The objects `0..count`.
    pub fn first(count: usize) -> Self {
        (0..count).map(|i| ObjectId(i as u16)).collect()
    }

    pub fn of(id: ObjectId) -> Self {
        Self::EMPTY.with(id)
    }

    #[inline]
    #[must_use]
    pub fn with(mut self, id: ObjectId) -> Self {
        self.insert(id);
        self
    }

    #[inline]
    pub fn insert(&mut self, id: ObjectId) {
        self.0[id.index() / 64] |= 1 << (id.index() % 64);
    }

    #[inline]
    pub fn remove(&mut self, id: ObjectId) {
        self.0[id.index() / 64] &= !(1 << (id.index() % 64));
    }

    #[inline]
    pub fn contains(&self, id: ObjectId) -> bool {
        self.0[id.index() / 64] >> (id.index() % 64) & 1 == 1
    }

    #[inline]
    pub fn len(&self) -> usize {
        self.0.iter().map(|w| w.count_ones() as usize).sum()
    }

    #[inline]
    pub fn is_empty(&self) -> bool {
        self.0 == [0; WORDS]
    }

    #[inline]
    fn zip(self, other: Self, f: impl Fn(u64, u64) -> u64) -> Self {
        let mut words = self.0;
        for (w, o) in words.iter_mut().zip(other.0) {
            *w = f(*w, o);
        }
        Self(words)
    }

    #[inline]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        self.zip(other, |a, b| a | b)
    }

    #[inline]
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        self.zip(other, |a, b| a & b)
    }

    /// What is in `self` but not in `other`.
    #[inline]
    #[must_use]
    pub fn difference(self, other: Self) -> Self {
        self.zip(other, |a, b| a & !b)
    }

    #[inline]
    pub fn intersects(&self, other: &Self) -> bool {
        self.0.iter().zip(other.0).any(|(a, b)| a & b != 0)
    }

    #[inline]
    pub fn is_subset(&self, other: &Self) -> bool {
        self.0.iter().zip(other.0).all(|(a, b)| a & !b == 0)
    }

    /// In ascending order.
    pub fn iter(&self) -> impl Iterator<Item = ObjectId> + use<> {
        let words = self.0;
        (0..WORDS).flat_map(move |i| {
            let mut word = words[i];
            std::iter::from_fn(move || {
                if word == 0 {
                    return None;
                }
                let bit = word.trailing_zeros();
                word &= word - 1;
                Some(ObjectId((i * 64) as u16 + bit as u16))
            })
        })
    }

    /// The members' names, in ascending order.
    pub fn names(&self, names: &[String]) -> Vec<String> {
        self.iter().map(|id| names[id.index()].clone()).collect()
    }

    /// `{o3, o5}`, by the objects' names.
    pub fn display(&self, names: &[String]) -> String {
        format!("{{{}}}", self.names(names).join(", "))
    }

    /// The members of `sets` of which no other member is a subset, without repetition, smallest
    /// first and otherwise in the given order.
    pub fn minimal(mut sets: Vec<ObjectSet>) -> Vec<ObjectSet> {
        sets.sort_by_key(ObjectSet::len);
        let mut minimal: Vec<ObjectSet> = Vec::new();
        for set in sets {
            if !minimal.iter().any(|m| m.is_subset(&set)) {
                minimal.push(set);
            }
        }
        minimal
    }
}

impl FromIterator<ObjectId> for ObjectSet {
    fn from_iter<I: IntoIterator<Item = ObjectId>>(ids: I) -> Self {
        ids.into_iter().fold(Self::EMPTY, Self::with)
    }
}

impl fmt::Debug for ObjectSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_set().entries(self.iter().map(|id| id.0)).finish()
    }
}

/// `{o3, o5} or {o8}, or 2 other sets`: as many of them as `most`.
pub fn one_of(sets: &[impl AsRef<[String]>], most: usize) -> String {
    let shown: Vec<String> = sets.iter().take(most).map(|s| format!("{{{}}}", s.as_ref().join(", "))).collect();
    let more = sets.len() - shown.len();
    let more = if more > 0 { format!(", or {more} other sets") } else { String::new() };
    shown.join(" or ") + &more
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(ids: &[u16]) -> ObjectSet {
        ids.iter().map(|&i| ObjectId(i)).collect()
    }

    #[test]
    fn behaves_like_a_set_across_words() {
        let a = set(&[0, 63, 64, 200]);
        assert_eq!(a.iter().map(|i| i.0).collect::<Vec<_>>(), [0, 63, 64, 200]);
        assert_eq!(a.len(), 4);
        assert_eq!(a.difference(set(&[63, 200])), set(&[0, 64]));
        assert!(set(&[64]).is_subset(&a) && !set(&[65]).is_subset(&a));
        assert_eq!(ObjectSet::first(130).len(), 130);
    }

    #[test]
    fn minimal_is_an_antichain() {
        let sets = vec![set(&[1, 2, 3]), set(&[2]), set(&[1, 3]), set(&[2, 9]), set(&[2])];
        assert_eq!(ObjectSet::minimal(sets), [set(&[2]), set(&[1, 3])]);
    }
}
