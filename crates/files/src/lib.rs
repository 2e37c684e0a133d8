//! The one layer that reads files which may be wrong, huge or hostile.
//!
//! Everything here is bounded before it starts: how many bytes ([`Limits`], [`MeshBudget`]), how
//! deep and how many elements ([`yaml`], [`xml`]), and which files at all ([`Root`]). Whatever is
//! wrong comes back as one kind of error, [`FileError`], which says the file, the line and column
//! where there is one, what was found, what was expected and what to do. Nothing here panics,
//! waits on a pipe, or reads past its bound.
//!
//! It knows documents, not their meaning: that a radius must be positive is its users' affair;
//! [`yaml::Located`] lets them point at the place.

pub mod error;
pub mod json;
pub mod mesh;
pub mod points;
pub mod read;
pub mod root;
pub mod suggest;
pub mod write;
pub mod xml;
pub mod yaml;

pub use error::{FileError, quoted};
pub use mesh::{Mesh, MeshBudget};
pub use read::{Limits, read_bytes, read_text};
pub use root::Root;
pub use suggest::closest;
pub use write::{check_writable, write_atomic};
pub use yaml::Located;
