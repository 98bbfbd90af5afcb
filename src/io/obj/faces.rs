//! `f` lines: corners, their indices, and the triangles that a polygon is cut into.

use super::ObjError;
use super::cursor::Cursor;
use super::polygon::Uncut;
use super::reader::{MAX_MATERIALS, Reader};
use crate::geometry::mesh::ABSENT;
use crate::io::excerpt;

/// Indices of one corner of a face, from 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    position: u32,
    uv: u32,
    normal: u32,
}

impl Reader<'_> {
    pub(super) fn read_face(&mut self) -> Result<(), ObjError> {
        self.corners.clear();
        loop {
            self.cursor.skip_blanks();
            if self.cursor.at_end_of_line() {
                break;
            }
            // A face may be the whole file.
            self.check_wanted()?;
            let corner = self.read_corner()?;
            self.corners.push(corner);
        }
        let n_corners = self.corners.len();
        if n_corners < 3 {
            return Err(self.wrong_count("f", format!("{n_corners} corners"), "3 or more"));
        }
        self.check_triangles(n_corners - 2)?;
        self.choose_slot(n_corners - 2)?;
        self.file.n_faces += 1;
        if n_corners == 3 {
            self.push_triangle([0, 1, 2]);
        } else {
            self.push_polygon()?;
        }
        self.end_line()
    }

    fn read_corner(&mut self) -> Result<Corner, ObjError> {
        let start = self.cursor.place();
        let raw = read_indices(&mut self.cursor);
        if raw.is_none() || !self.cursor.ends_token() {
            self.cursor.go_back(start);
            let (line, token) = (self.cursor.line(), excerpt(self.cursor.token()));
            return Err(ObjError::BadCorner { line, token });
        }
        let [position, uv, normal] = raw.unwrap_or_default();
        let resolved = [
            resolve(position, self.file.positions.len()),
            resolve(uv, self.file.uvs.len()),
            resolve(normal, self.file.normals.len()),
        ];
        match resolved {
            [Some(position), Some(uv), Some(mut normal)] => {
                if self.zero_normals.binary_search(&normal).is_ok() {
                    normal = ABSENT;
                }
                Ok(Corner { position, uv, normal })
            }
            _ => Err(self.bad_index(start, [position, uv, normal])),
        }
    }

    #[cold]
    fn bad_index(&mut self, start: usize, raw: [Option<i64>; 3]) -> ObjError {
        self.cursor.go_back(start);
        let (line, token) = (self.cursor.line(), excerpt(self.cursor.token()));
        let file = &self.file;
        let counts = [
            ("vertex", file.positions.len()),
            ("texture coordinate", file.uvs.len()),
            ("normal", file.normals.len()),
        ];
        for (index, (what, count)) in raw.into_iter().zip(counts) {
            if let Some(index) = index.filter(|i| *i != 0)
                && resolve(Some(index), count).is_none()
            {
                return ObjError::IndexOutOfRange { line, token, what, index, count };
            }
        }
        ObjError::IndexZero { line, token }
    }

    /// Prepares the slots for so many triangles of the material in use.
    fn choose_slot(&mut self, n_triangles: usize) -> Result<(), ObjError> {
        let slot = match self.slot {
            Some(slot) => slot,
            None => self.add_slot()?,
        };
        self.slot = Some(slot);
        let file = &mut self.file;
        if slot != 0 && file.slots.is_empty() {
            file.slots.resize(file.triangles.len(), 0);
        }
        if !file.slots.is_empty() {
            file.slots.resize(file.slots.len() + n_triangles, slot);
        }
        Ok(())
    }

    fn add_slot(&mut self) -> Result<u32, ObjError> {
        self.check_count("materials", self.file.slot_names.len(), MAX_MATERIALS)?;
        let slot = self.file.slot_names.len() as u32;
        let name = self.material.map(|name| String::from_utf8_lossy(name).into_owned());
        self.file.slot_names.push(name);
        self.slot_of_name.insert(self.material, slot);
        Ok(slot)
    }

    fn push_polygon(&mut self) -> Result<(), ObjError> {
        let mut cutter = std::mem::take(&mut self.cutter);
        let points = self.corners.iter().map(|c| self.file.positions[c.position as usize]);
        let cut = cutter.cut(points, self.watch);
        if cut.is_ok() {
            for triangle in cutter.triangles() {
                self.push_triangle(*triangle);
            }
        }
        self.cutter = cutter;
        let line = self.cursor.line();
        cut.map_err(|reason| match reason {
            Uncut::TooIntricate => ObjError::TooIntricate { line },
            Uncut::Cancelled => ObjError::Cancelled,
        })
    }

    #[inline]
    fn push_triangle(&mut self, corner_ids: [u32; 3]) {
        let corners = corner_ids.map(|id| self.corners[id as usize]);
        let file = &mut self.file;
        let n_before = file.triangles.len();
        file.triangles.push(corners.map(|c| c.position));
        push_optional(&mut file.uv_ids, corners.map(|c| c.uv), n_before);
        push_optional(&mut file.normal_ids, corners.map(|c| c.normal), n_before);
    }
}

/// Adds a triangle's indices to an array that stays empty until one of them is there.
#[inline]
fn push_optional(array: &mut Vec<[u32; 3]>, ids: [u32; 3], n_before: usize) {
    if array.is_empty() {
        if ids == [ABSENT; 3] {
            return;
        }
        array.resize(n_before, [ABSENT; 3]);
    }
    array.push(ids);
}

/// Passes `a`, `a/b`, `a//c` or `a/b/c`. A part that is left empty is absent.
#[inline]
fn read_indices(cursor: &mut Cursor<'_>) -> Option<[Option<i64>; 3]> {
    let position = Some(cursor.integer()?);
    if cursor.peek() != b'/' {
        return Some([position, None, None]);
    }
    cursor.bump();
    let uv = cursor.integer();
    if cursor.peek() != b'/' {
        return Some([position, uv, None]);
    }
    cursor.bump();
    Some([position, uv, cursor.integer()])
}

/// The index from 0 of something of which there are `count`; [`ABSENT`] stays absent.
#[inline]
fn resolve(index: Option<i64>, count: usize) -> Option<u32> {
    let Some(index) = index else {
        return Some(ABSENT);
    };
    let count = count as i64;
    let from_zero = if index < 0 { count + index } else { index - 1 };
    (0..count).contains(&from_zero).then_some(from_zero as u32)
}
