//! Why a file is not a mesh.

use crate::io::memory::NoMemory;

/// Why a Wavefront OBJ file could not be turned into a mesh. Lines count from 1; texts taken from
/// the file are already escaped and shortened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ObjError {
    /// A byte that no text file has where a keyword should be.
    #[error("line {line}: `{token}` is not text; is this a Wavefront OBJ file?")]
    NotText {
        /// Where.
        line: usize,
        /// What stands there.
        token: String,
    },

    /// Something else where a number should be.
    #[error("line {line}: `{token}` is not a number")]
    NotANumber {
        /// Where.
        line: usize,
        /// What stands there.
        token: String,
    },

    /// NaN, an infinity, or a number too large for one.
    #[error("line {line}: `{token}` is not a finite number")]
    NotFinite {
        /// Where.
        line: usize,
        /// What stands there.
        token: String,
    },

    /// Finite, but squares and products of it would not be.
    #[error("line {line}: coordinate `{token}` is out of range; they stay within ±1e12")]
    CoordinateTooLarge {
        /// Where.
        line: usize,
        /// The coordinate.
        token: String,
    },

    /// A line that ends too early or goes on too long.
    #[error("line {line}: `{keyword}` has {found}; expected {expected}")]
    WrongCount {
        /// Where.
        line: usize,
        /// `v`, `vt`, `vn` or `f`.
        keyword: &'static str,
        /// How many there are, and of what.
        found: String,
        /// How many there should be.
        expected: &'static str,
    },

    /// A point at infinity.
    #[error("line {line}: the fourth number of `v`, its weight, is 0; a point has another weight")]
    ZeroWeight {
        /// Where.
        line: usize,
    },

    /// A corner that is not one to three integers.
    #[error("line {line}: `{token}` is not a corner of a face; expected 1, 1/2, 1//3 or 1/2/3")]
    BadCorner {
        /// Where.
        line: usize,
        /// What stands there.
        token: String,
    },

    /// Index 0, which stands for nothing.
    #[error("line {line}: `{token}` has index 0; they count from 1, or from -1 backwards")]
    IndexZero {
        /// Where.
        line: usize,
        /// The whole corner.
        token: String,
    },

    /// An index past what is defined above the face.
    #[error("line {line}: `{token}` uses {what} {index}, but only {count} are defined above it")]
    IndexOutOfRange {
        /// Where.
        line: usize,
        /// The whole corner.
        token: String,
        /// `vertex`, `texture coordinate` or `normal`.
        what: &'static str,
        /// The index as written.
        index: i64,
        /// How many there are.
        count: usize,
    },

    /// More of something than the renderer can count or hold.
    #[error("line {line}: more than {limit} {what}; a mesh of that size is not supported")]
    TooMany {
        /// Where the limit was passed.
        line: usize,
        /// Vertices, triangles, …
        what: &'static str,
        /// The limit.
        limit: usize,
    },

    /// More triangles than meshes of that length have, all meshes of a scene together.
    #[error(
        "more than {limit} triangles in the meshes up to this one, once for each crease angle; \
         that many are not supported in files of their length"
    )]
    TooManyTogether {
        /// The limit.
        limit: usize,
    },

    /// Faces that would take minutes to cut into triangles.
    #[error(
        "line {line}: the faces up to here are too intricate to be cut into triangles; save the \
         mesh as triangles"
    )]
    TooIntricate {
        /// The face at which it was given up.
        line: usize,
    },

    /// More than the machine can hold.
    #[error("line {line}: the mesh up to here {error}")]
    NoMemory {
        /// How far it was read.
        line: usize,
        /// How much is needed, and how much there is.
        error: NoMemory,
    },

    /// A mesh that is there already, and more than the machine can hold with other normals too.
    #[error("the mesh once more, for another crease angle, {0}")]
    NoMemoryForCopy(NoMemory),

    /// Nobody wants the mesh any more.
    #[error("cancelled")]
    Cancelled,

    /// Nothing to show.
    #[error("no triangles: the file has no `f` lines{hint}")]
    NoTriangles {
        /// Empty, or what makes the file look like something else.
        hint: String,
    },
}
