//! What the kernel's spheres touch, and may be no touch of the shapes.

/// Two things that may touch: a link and the owner of an obstacle, or two links.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Suspect {
    pub link: usize,
    pub other: usize,
    /// In which of the sixteen configurations.
    pub lanes: u16,
    /// In which of them they touch without doubt: not the spheres alone, the shapes, too.
    pub sure: u16,
}

/// All that the spheres of some configurations touch. Nothing else is touched by the links.
#[derive(Clone, Debug, Default)]
pub struct Suspects {
    pub obstacles: Vec<Suspect>,
    pub pairs: Vec<Suspect>,
}

impl Suspects {
    pub fn is_empty(&self) -> bool {
        self.obstacles.is_empty() && self.pairs.is_empty()
    }

    /// Whether any two touch without doubt.
    pub fn any_sure(&self) -> bool {
        self.all().any(|s| s.sure != 0)
    }

    /// Whether there are any in one of the sixteen configurations.
    pub fn any_in(&self, lane: usize) -> bool {
        self.all().any(|s| s.lanes >> lane & 1 == 1)
    }

    fn all(&self) -> impl Iterator<Item = &Suspect> {
        self.obstacles.iter().chain(&self.pairs)
    }

    pub(super) fn clear(&mut self) {
        self.obstacles.clear();
        self.pairs.clear();
    }
}

pub(super) fn note(suspects: &mut Vec<Suspect>, (link, other): (usize, usize), (lanes, sure): (u32, u32)) {
    let (lanes, sure) = (lanes as u16, sure as u16);
    match suspects.iter_mut().find(|s| s.link == link && s.other == other) {
        Some(known) => {
            known.lanes |= lanes;
            known.sure |= sure;
        }
        None => suspects.push(Suspect { link, other, lanes, sure }),
    }
}
