//! A triangle mesh as flat arrays, in object space.
//!
//! Positions keep the identity of the file's `v` lines: corners that share an index share a
//! vertex, whatever material or normal they carry. Shading normals and texture coordinates have
//! index arrays of their own.

use glam::{Vec2, Vec3};

use crate::math::Aabb;

/// Index of an attribute that a corner does not have.
pub const ABSENT: u32 = u32::MAX;

/// Triangles with optional shading normals, texture coordinates and material slots.
///
/// Every index is in range and every number finite: the reader that builds a mesh checks them.
#[derive(Debug, Default)]
pub struct Mesh {
    /// One point a `v` line, used by a face or not.
    pub positions: Vec<Vec3>,
    /// Three indices into `positions` a triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Unit shading normals.
    pub normals: Vec<Vec3>,
    /// Three indices into `normals` a triangle; empty where the whole mesh is flat, [`ABSENT`] at
    /// all three corners where one triangle is.
    pub normal_ids: Vec<[u32; 3]>,
    /// Texture coordinates, u right and v up.
    pub uvs: Vec<Vec2>,
    /// Three indices into `uvs` a triangle; empty or [`ABSENT`] where there are none.
    pub uv_ids: Vec<[u32; 3]>,
    /// Material slot of each triangle; empty: slot 0 throughout.
    pub slots: Vec<u32>,
}

impl Mesh {
    /// The three corners of a triangle.
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|id| self.positions[id as usize])
    }

    /// Box around every position that a face refers to; empty without triangles.
    pub fn bounds(&self) -> Aabb {
        let mut bounds = Aabb::EMPTY;
        for id in self.triangles.iter().flatten() {
            bounds.grow(self.positions[*id as usize]);
        }
        bounds
    }
}
