//! A plan as one self-contained page: the scene, the robot moving, a time slider, the roadmap and
//! the retrieval graph.
//!
//! The page needs no network and opens from `file://`. Its code is hand-written WebGL 2 under
//! `page/`, one file per idea, put together here in order; the plan goes in as JSON that no browser
//! takes for markup. Metres, radians, seconds.
//!
//! Costs a copy of the plan and its text; about 90 kB of code beside the plan's own size.

mod embed;
mod mesh;
mod page;

pub use mesh::EmbeddedMesh;
pub use page::{PageError, page, page_with_meshes};
