//! The terms of light transport that a picture may be made of.

use std::fmt;
use std::str::FromStr;

/// One term of the radiance at the eye.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Term {
    /// Direct light on surfaces, attenuated on both ways.
    Surface,
    /// Direct single scattering, with shadows.
    Airlight,
    /// Light that is scattered once and then lights the surface that is seen.
    IndirectAirlight,
    /// All other light that the medium has scattered or emitted: two and more scatterings, what surfaces
    /// have reflected on its way, and emission. Light of surfaces among themselves that the medium never
    /// scatters belongs to no term. The sky, which only a cloud sees, counts as a light: scattered once it
    /// is airlight.
    Multiple,
}

impl Term {
    /// All terms, in the order in which they are shown.
    pub const ALL: [Self; 4] = [Self::Surface, Self::Airlight, Self::IndirectAirlight, Self::Multiple];

    /// As records and the command line spell it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Surface => "surface",
            Self::Airlight => "airlight",
            Self::IndirectAirlight => "indirect_airlight",
            Self::Multiple => "multiple",
        }
    }
}

impl fmt::Display for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A set of terms; written `airlight,surface`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Terms(u8);

/// A name that is no term.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no term of light transport; there are: surface, airlight, indirect_airlight, multiple")]
pub struct UnknownTerm(
    /// The name as it was given.
    pub String,
);

impl Terms {
    /// No term.
    pub const NONE: Self = Self(0);
    /// Every term.
    pub const ALL: Self = Self((1 << Term::ALL.len()) - 1);
    /// Surface and airlight: what a picture is made of unless it is said otherwise.
    pub const DIRECT: Self = Self(1 << Term::Surface as u8 | 1 << Term::Airlight as u8);

    /// Whether `term` is in the set.
    pub fn contains(self, term: Term) -> bool {
        self.0 & (1 << term as u8) != 0
    }

    /// The set and `term`.
    #[must_use]
    pub fn with(self, term: Term) -> Self {
        Self(self.0 | 1 << term as u8)
    }

    /// Whether there is no term in the set.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The terms of the set, in the order of [`Term::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Term> {
        Term::ALL.into_iter().filter(move |term| self.contains(*term))
    }
}

impl From<Term> for Terms {
    fn from(term: Term) -> Self {
        Self::NONE.with(term)
    }
}

impl FromIterator<Term> for Terms {
    fn from_iter<I: IntoIterator<Item = Term>>(terms: I) -> Self {
        terms.into_iter().fold(Self::NONE, Self::with)
    }
}

impl FromStr for Terms {
    type Err = UnknownTerm;

    fn from_str(text: &str) -> Result<Self, UnknownTerm> {
        text.split(',')
            .map(str::trim)
            .filter(|name| !name.is_empty())
            .map(|name| {
                let known = Term::ALL.into_iter().find(|term| term.name() == name);
                known.ok_or_else(|| UnknownTerm(name.into()))
            })
            .collect()
    }
}

impl fmt::Display for Terms {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, term) in self.iter().enumerate() {
            write!(f, "{}{term}", if index == 0 { "" } else { "," })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn written_and_read_back() {
        for terms in
            [Terms::NONE, Terms::ALL, Terms::DIRECT, Term::Surface.into(), Term::IndirectAirlight.into()]
        {
            assert_eq!(terms.to_string().parse(), Ok(terms));
        }
        assert_eq!(" airlight, surface,airlight".parse(), Ok(Terms::DIRECT));
        assert_eq!("multiple,indirect_airlight,surface,airlight".parse(), Ok(Terms::ALL));
        assert_eq!("airlight".parse::<Terms>().unwrap().iter().collect::<Vec<_>>(), [Term::Airlight]);
        let error = "airlight,fog".parse::<Terms>().unwrap_err();
        assert!(error.to_string().contains("`fog`"), "{error}");
    }
}
