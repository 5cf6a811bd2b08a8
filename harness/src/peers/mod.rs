//! What a user would otherwise pick.

pub(crate) mod raymarch;
