//! Polygons under construction, the checks they must pass, and their text as OBJ.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use glam::{DVec2, DVec3, dvec3};

/// Faces over shared points. Corners run counter-clockwise seen from outside.
#[derive(Clone, Debug)]
pub(crate) struct Mesh {
    points: Vec<DVec3>,
    normals: Vec<DVec3>,
    uvs: Vec<DVec2>,
    faces: Vec<Vec<u32>>,
    decimals: usize,
}

impl Mesh {
    /// Nothing yet. Coordinates will be written with that many decimals.
    pub(crate) fn new(decimals: usize) -> Self {
        Self { points: vec![], normals: vec![], uvs: vec![], faces: vec![], decimals }
    }

    /// Adds a point; its index is the answer.
    pub(crate) fn point(&mut self, point: DVec3) -> u32 {
        self.points.push(point);
        self.points.len() as u32 - 1
    }

    /// Adds a point with a normal and a texture coordinate of its own; all points or none have them.
    pub(crate) fn point_with(&mut self, point: DVec3, normal: DVec3, uv: DVec2) -> u32 {
        self.normals.push(normal);
        self.uvs.push(uv);
        self.point(point)
    }

    /// Adds a face. Corners that repeat the one before are left out; fewer than three are no face.
    pub(crate) fn face(&mut self, corners: &[u32]) {
        let mut face = corners.to_vec();
        face.dedup();
        while 1 < face.len() && face.first() == face.last() {
            face.pop();
        }
        if 3 <= face.len() {
            self.faces.push(face);
        }
    }

    /// Adds quads between rows of points; a row of one point is a pole. Seen from outside, points
    /// of a row run to the right and rows upwards. `wrap` joins the ends of each row.
    pub(crate) fn skin(&mut self, rows: &[Vec<u32>], wrap: bool) {
        for pair in rows.windows(2) {
            let n = pair[0].len().max(pair[1].len());
            let at = |row: &[u32], i: usize| row[if row.len() == 1 { 0 } else { i % n }];
            for i in 0..if wrap { n } else { n - 1 } {
                let (low, high) = (&pair[0], &pair[1]);
                self.face(&[at(low, i), at(low, i + 1), at(high, i + 1), at(high, i)]);
            }
        }
    }

    /// Adds another mesh beside this one.
    pub(crate) fn append(&mut self, other: &Self) {
        let offset = self.points.len() as u32;
        self.points.extend(&other.points);
        let faces = other.faces.iter().map(|face| face.iter().map(|id| id + offset).collect());
        self.faces.extend(faces);
    }

    /// The same mesh with every point moved by a function that keeps inside and outside apart.
    pub(crate) fn map(mut self, moved: impl Fn(DVec3) -> DVec3) -> Self {
        for point in &mut self.points {
            *point = moved(*point);
        }
        self
    }

    /// The same mesh, shifted so that it stands on y = 0 with its box centred on x and z.
    pub(crate) fn stand_centred(self) -> Self {
        let low = self.points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = self.points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let foot = dvec3(0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z));
        self.map(|p| p - foot)
    }

    /// Joins points that the file would write alike, so that smooth shading crosses seams.
    pub(crate) fn weld(mut self) -> Self {
        let steps = 10_f64.powi(self.decimals as i32);
        let mut seen: BTreeMap<[i64; 3], u32> = BTreeMap::new();
        let mut points = vec![];
        let ids: Vec<u32> = (self.points.iter())
            .map(|point| {
                let key = (*point * steps).to_array().map(|x| (x + 0.5).floor() as i64);
                *seen.entry(key).or_insert_with(|| {
                    points.push(*point);
                    points.len() as u32 - 1
                })
            })
            .collect();
        let faces = std::mem::take(&mut self.faces);
        self.points = points;
        for face in faces {
            let corners: Vec<u32> = face.iter().map(|id| ids[*id as usize]).collect();
            self.face(&corners);
        }
        self
    }

    /// The mesh itself, after checking that it bounds a solid: every edge is met once in each
    /// direction, and the outside is outside.
    pub(crate) fn closed(self) -> Self {
        let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
        for face in &self.faces {
            for i in 0..face.len() {
                let (a, b) = (face[i], face[(i + 1) % face.len()]);
                *edges.entry((a, b)).or_insert(0) += 1;
            }
        }
        for ((a, b), n) in &edges {
            let back = edges.get(&(*b, *a)).copied().unwrap_or(0);
            assert!(*n == 1 && back == 1, "edge {a} {b} is met {n} times, {back} times backwards");
        }
        let volume = self.volume();
        assert!(0.0 < volume, "a solid is inside out: volume {volume}");
        self
    }

    /// Number of polygons.
    pub(crate) fn n_faces(&self) -> usize {
        self.faces.len()
    }

    /// The text of an OBJ file that begins with a comment.
    pub(crate) fn to_obj(&self, about: &str) -> String {
        let mut text = format!("# {about}. Made by examples/make_assets.\n");
        for p in &self.points {
            self.line(&mut text, "v", &p.to_array(), self.decimals);
        }
        for uv in &self.uvs {
            self.line(&mut text, "vt", &uv.to_array(), 3);
        }
        for n in &self.normals {
            self.line(&mut text, "vn", &n.to_array(), 4);
        }
        for face in &self.faces {
            text.push('f');
            for id in face.iter().map(|id| id + 1) {
                let written = if self.normals.is_empty() {
                    write!(text, " {id}")
                } else {
                    write!(text, " {id}/{id}/{id}")
                };
                written.expect("a String takes every text");
            }
            text.push('\n');
        }
        text
    }

    fn line(&self, text: &mut String, keyword: &str, numbers: &[f64], decimals: usize) {
        text.push_str(keyword);
        for number in numbers {
            let digits = format!("{number:.decimals$}");
            let short = if digits.contains('.') {
                digits.trim_end_matches('0').trim_end_matches('.')
            } else {
                &digits
            };
            text.push(' ');
            text.push_str(if short == "-0" { "0" } else { short });
        }
        text.push('\n');
    }

    fn volume(&self) -> f64 {
        let mut sixfold = 0.0;
        for face in &self.faces {
            let corner = |i: usize| self.points[face[i] as usize];
            for i in 1..face.len() - 1 {
                sixfold += corner(0).dot(corner(i).cross(corner(i + 1)));
            }
        }
        sixfold / 6.0
    }
}
