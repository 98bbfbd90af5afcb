//! Shading normals of a mesh, averaged where faces share a vertex. Object space, unit length.
//!
//! Faces share a vertex where their corners have the same index: material, normals and texture
//! coordinates do not matter. Each face weighs as much as its angle at the vertex (G. Thürmer and
//! C. Wüthrich, "Computing Vertex Normals from Polygonal Facets", Journal of Graphics Tools 3(1),
//! 1998), so that how a polygon was cut makes no difference.

use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

use glam::{DVec3, Vec3};

use crate::geometry::Stopped;
use crate::geometry::mesh::ABSENT;
use crate::math::portable;

/// Unit normals, and three indices into them a triangle: the arrays of a
/// [`Mesh`](crate::geometry::mesh::Mesh). Both are empty where the whole mesh is flat.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Normals {
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// Indices into `normals`, or [`ABSENT`].
    pub ids: Vec<[u32; 3]>,
}

/// Faces that meet at one vertex, past which a crease is not looked for: each face is compared
/// with each, and no smooth surface has such a vertex.
const MAX_FACES_AT_CREASE: usize = 4096;

/// Comparisons in a whole mesh, a second or two of them. A surface takes some forty a vertex; where
/// a mesh takes more than this, its most crowded vertices are passed over.
const MAX_COMPARISONS: u64 = 1 << 30;

/// Triangles between two looks at whether the normals are still wanted.
const BETWEEN_LOOKS: usize = 1 << 16;

/// Cosine by which faces may miss the crease angle and still count as within it: the right angles
/// of a box are rarely right to the last bit.
const CREASE_SLACK: f64 = 1e-6;

/// Length below which weighted normals have cancelled, for weights that add up to 1.
const CANCELLED: f64 = 1e-6;

/// Averages at each corner the faces around its vertex whose normals are within `crease_angle`
/// (radians; π takes all) of its own face's. Triangles without area add nothing and have no
/// normals of their own; where normals cancel, the corner has its face's. `stop` is looked at all
/// the time.
///
/// # Errors
/// [`Stopped`].
pub fn smooth(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    crease_angle: f64,
    stop: &AtomicBool,
) -> Result<Normals, Stopped> {
    let faces = faces_of(positions, triangles, stop)?;
    if crease_angle < PI {
        smooth_within(positions.len(), triangles, &faces, crease_angle, stop)
    } else {
        Ok(smooth_all(positions.len(), triangles, &faces))
    }
}

/// Fills in smooth normals where a file has stored none. `stored.ids` may be empty, or [`ABSENT`]
/// at single corners; stored normals stay as they are.
///
/// # Errors
/// As [`smooth`].
pub fn complete(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    stored: Normals,
    crease_angle: f64,
    stop: &AtomicBool,
) -> Result<Normals, Stopped> {
    if stored.ids.is_empty() {
        return smooth(positions, triangles, crease_angle, stop);
    }
    if !stored.ids.as_flattened().contains(&ABSENT) {
        return Ok(stored);
    }
    let averaged = smooth(positions, triangles, crease_angle, stop)?;
    let mut normals = stored;
    let offset = normals.normals.len() as u32;
    normals.normals.extend(averaged.normals);
    for (ids, fillers) in normals.ids.iter_mut().zip(averaged.ids) {
        if !ids.contains(&ABSENT) {
            continue;
        }
        // A triangle is flat as a whole or not at all.
        let is_flat = fillers == [ABSENT; 3];
        for (id, filler) in ids.iter_mut().zip(fillers) {
            if is_flat {
                *id = ABSENT;
            } else if *id == ABSENT {
                *id = filler + offset;
            }
        }
    }
    Ok(normals)
}

/// A triangle as its vertices see it.
#[derive(Clone, Copy, Debug)]
struct Face {
    /// Unit; zero where the triangle has no area.
    normal: DVec3,
    /// Angles at the three corners; zero where the triangle is thinner than its corners are exact.
    angles: [f64; 3],
}

fn faces_of(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    stop: &AtomicBool,
) -> Result<Vec<Face>, Stopped> {
    let mut faces = Vec::with_capacity(triangles.len());
    for part in triangles.chunks(BETWEEN_LOOKS) {
        Stopped::check(stop)?;
        faces.extend(part.iter().map(|ids| face_of(ids.map(|id| positions[id as usize]))));
    }
    Ok(faces)
}

fn face_of(corners: [Vec3; 3]) -> Face {
    let [a, b, c] = corners.map(|corner| corner.as_dvec3());
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let cross = ab.cross(-ca);
    let double_area = cross.length();
    let Some(normal) = cross.try_normalize() else {
        return Face { normal: DVec3::ZERO, angles: [0.0; 3] };
    };
    let longest = ab.length_squared().max(bc.length_squared()).max(ca.length_squared()).sqrt();
    let size = corners[0].abs().max(corners[1].abs()).max(corners[2].abs()).max_element();
    // The height of a needle whose corners lie on a line but for their rounding to f32.
    let rounding = f64::from(f32::EPSILON) * f64::from(size);
    if double_area <= rounding * longest {
        return Face { normal, angles: [0.0; 3] };
    }
    let at_a = portable::atan2_f64(double_area, -ab.dot(ca));
    let at_b = portable::atan2_f64(double_area, -bc.dot(ab));
    Face { normal, angles: [at_a, at_b, (PI - at_a - at_b).max(0.0)] }
}

/// One normal a vertex, used by all its corners.
fn smooth_all(n_vertices: usize, triangles: &[[u32; 3]], faces: &[Face]) -> Normals {
    let mut sums = vec![Sum::default(); n_vertices];
    for (ids, face) in triangles.iter().zip(faces) {
        for (id, angle) in ids.iter().zip(face.angles) {
            sums[*id as usize].add(face.normal, angle);
        }
    }
    let averages: Vec<Option<Vec3>> = sums.iter().map(|sum| sum.average()).collect();
    let mut all = Normals {
        // A vertex without normal keeps its place: then the ids are those of the vertices.
        normals: averages.iter().map(|average| average.unwrap_or(Vec3::Z)).collect(),
        ids: triangles.to_vec(),
    };
    for (ids, face) in all.ids.iter_mut().zip(faces) {
        if face.normal == DVec3::ZERO {
            *ids = [ABSENT; 3];
        } else if ids.iter().any(|id| averages[*id as usize].is_none()) {
            let own = all.normals.len() as u32;
            all.normals.push(face.normal.as_vec3());
            *ids = ids.map(|id| if averages[id as usize].is_some() { id } else { own });
        }
    }
    all
}

fn smooth_within(
    n_vertices: usize,
    triangles: &[[u32; 3]],
    faces: &[Face],
    crease_angle: f64,
    stop: &AtomicBool,
) -> Result<Normals, Stopped> {
    let min_cosine = portable::cos_f64(crease_angle) - CREASE_SLACK;
    let around = CornersAround::new(n_vertices, triangles);
    let max_faces = max_faces_at_crease(n_vertices, &around);
    let mut normals = Vec::with_capacity(n_vertices);
    let mut ids = vec![[ABSENT; 3]; triangles.len()];
    for vertex in 0..n_vertices {
        Stopped::check(stop)?;
        let corners = around.vertex(vertex);
        let first = normals.len();
        for (face_id, corner) in corners.iter().map(split_corner) {
            let face = &faces[face_id];
            if face.normal == DVec3::ZERO {
                continue;
            }
            let mut sum = Sum::default();
            let is_crowded = max_faces < corners.len();
            if !is_crowded {
                for (other_id, other_corner) in corners.iter().map(split_corner) {
                    let other = &faces[other_id];
                    if min_cosine <= face.normal.dot(other.normal) {
                        sum.add(other.normal, other.angles[other_corner]);
                    }
                }
            }
            let normal = sum.average().unwrap_or_else(|| face.normal.as_vec3());
            let from = if is_crowded { first.max(normals.len().saturating_sub(1)) } else { first };
            let known = normals[from..].iter().rposition(|n| *n == normal);
            let id = known.map_or(normals.len(), |i| from + i);
            if known.is_none() {
                normals.push(normal);
            }
            ids[face_id][corner] = id as u32;
        }
    }
    Ok(Normals { normals, ids })
}

/// Faces at a vertex, up to which creases are looked for in this mesh.
fn max_faces_at_crease(n_vertices: usize, around: &CornersAround) -> usize {
    let n_comparisons = |limit: usize| -> u64 {
        let counts = (0..n_vertices).map(|vertex| around.vertex(vertex).len());
        counts.filter(|n| *n <= limit).map(|n| (n * n) as u64).sum()
    };
    let mut limit = MAX_FACES_AT_CREASE;
    while MAX_COMPARISONS < n_comparisons(limit) {
        limit /= 2;
    }
    limit
}

/// Normals weighted by angles.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    normal: DVec3,
    weight: f64,
}

impl Sum {
    fn add(&mut self, normal: DVec3, weight: f64) {
        self.normal += weight * normal;
        self.weight += weight;
    }

    /// `None` where there was nothing to add, or where it has cancelled.
    fn average(&self) -> Option<Vec3> {
        let length = self.normal.length();
        (CANCELLED * self.weight < length).then(|| (self.normal / length).as_vec3())
    }
}

/// The corners at each vertex, in ascending order: 3 × triangle + corner.
struct CornersAround {
    /// Where the corners of each vertex start, and where those of the last end.
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl CornersAround {
    fn new(n_vertices: usize, triangles: &[[u32; 3]]) -> Self {
        let mut starts = vec![0_u32; n_vertices + 1];
        for id in triangles.as_flattened() {
            starts[*id as usize + 1] += 1;
        }
        for i in 0..n_vertices {
            starts[i + 1] += starts[i];
        }
        let mut fill = starts.clone();
        let mut corners = vec![0; 3 * triangles.len()];
        for (corner, id) in triangles.as_flattened().iter().enumerate() {
            let place = &mut fill[*id as usize];
            corners[*place as usize] = corner as u32;
            *place += 1;
        }
        Self { starts, corners }
    }

    fn vertex(&self, vertex: usize) -> &[u32] {
        &self.corners[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}

/// Triangle and corner.
fn split_corner(corner: &u32) -> (usize, usize) {
    ((corner / 3) as usize, (corner % 3) as usize)
}

#[cfg(test)]
mod tests;
