//! The lines of an OBJ file, one after the other.

use std::collections::HashMap;

use glam::{DVec3, Vec2, Vec3};

use super::cursor::Cursor;
use super::faces::Corner;
use super::polygon::PolygonCutter;
use super::{ObjError, ObjFile};
use crate::io::progress::{Step, Watch};
use crate::io::{excerpt, memory};

/// Entries that any array of a mesh may have: indices stay far from `ABSENT`.
const MAX_ENTRIES: usize = 1 << 30;

/// Triangles that a file of any length may have.
const ALWAYS_TRIANGLES: usize = 1 << 23;

/// Beyond those, a file has one for so many of its bytes. A mesh of that size takes 14 of them and
/// more: its faces have seven digits a corner. Only polygons that use the same corners again and
/// again take fewer, and seconds and gigabytes for a small file.
const BYTES_A_TRIANGLE: usize = 8;

/// Material libraries that are looked for; more are a mistake of the exporter.
const MAX_LIBRARIES: usize = 100;

/// Largest coordinate: what a tracer multiplies in `f32` stays finite.
const MAX_COORDINATE: f32 = 1e12;

/// Names of materials that faces have.
pub(super) const MAX_MATERIALS: usize = 1 << 20;

/// Bytes of the file between two looks at the memory.
const BETWEEN_LOOKS: usize = 4 << 20;

/// Triangles that files of so many bytes may have, one file or all of a scene.
pub fn most_triangles(n_bytes: usize) -> usize {
    ALWAYS_TRIANGLES.max(n_bytes / BYTES_A_TRIANGLE)
}

/// A file half read.
pub(super) struct Reader<'a> {
    pub(super) cursor: Cursor<'a>,
    pub(super) file: ObjFile,
    /// Triangles that it may have.
    pub(super) max_triangles: usize,
    /// Who waits for the mesh.
    pub(super) watch: Watch<'a>,
    /// Where in the file it is told next how far it is, and the memory is looked at.
    next_look: usize,
    /// Slots by the name that faces have.
    pub(super) slot_of_name: HashMap<Option<&'a [u8]>, u32>,
    /// The last `usemtl`.
    pub(super) material: Option<&'a [u8]>,
    /// The slot of `material`, once a face has it.
    pub(super) slot: Option<u32>,
    /// Indices of zero normals, ascending.
    pub(super) zero_normals: Vec<u32>,
    /// Where the first zero normal is.
    zero_normal_line: usize,
    n_unknown_lines: usize,
    /// Where the first unknown keyword is, and what it says.
    unknown: Option<(usize, String)>,
    /// Corners of the face that is being read.
    pub(super) corners: Vec<Corner>,
    pub(super) cutter: PolygonCutter,
}

impl<'a> Reader<'a> {
    pub(super) fn new(bytes: &'a [u8], watch: Watch<'a>) -> Self {
        Self {
            watch,
            next_look: BETWEEN_LOOKS,
            max_triangles: most_triangles(bytes.len()).min(MAX_ENTRIES),
            cursor: Cursor::new(bytes),
            file: ObjFile::default(),
            slot_of_name: HashMap::new(),
            material: None,
            slot: None,
            zero_normals: Vec::new(),
            zero_normal_line: 0,
            n_unknown_lines: 0,
            unknown: None,
            corners: Vec::new(),
            cutter: PolygonCutter::default(),
        }
    }

    pub(super) fn read(mut self) -> Result<ObjFile, ObjError> {
        while !self.cursor.at_end_of_file() {
            self.check_wanted()?;
            self.read_line()?;
            if self.next_look <= self.cursor.place() {
                self.look()?;
            }
        }
        self.finish()
    }

    /// Stops where the mesh is not wanted any more.
    #[inline]
    pub(super) fn check_wanted(&self) -> Result<(), ObjError> {
        if self.watch.is_stopped() { Err(ObjError::Cancelled) } else { Ok(()) }
    }

    /// Stops where the mesh and what is made of it would not fit into memory.
    #[cold]
    fn look(&mut self) -> Result<(), ObjError> {
        self.next_look = self.cursor.place() + BETWEEN_LOOKS;
        self.watch.tell(Step::Reading(self.cursor.share()));
        let line = self.cursor.line();
        memory::check(self.file.bytes_to_come()).map_err(|error| ObjError::NoMemory { line, error })
    }

    #[inline]
    fn read_line(&mut self) -> Result<(), ObjError> {
        self.cursor.skip_blanks();
        if self.cursor.at_end_of_line() {
            self.cursor.skip_comment();
            return Ok(());
        }
        let keyword = self.cursor.token();
        self.cursor.pass(keyword);
        match keyword {
            b"v" => self.read_position(),
            b"f" => self.read_face(),
            b"vt" => self.read_uv(),
            b"vn" => self.read_normal(),
            b"usemtl" => self.read_material(),
            b"mtllib" => self.read_libraries(),
            _ => self.pass_over(keyword),
        }
    }

    fn read_position(&mut self) -> Result<(), ObjError> {
        let mut numbers = [0.0; 8];
        let n = self.read_numbers("v", &mut numbers)?;
        let [x, y, z, w, ..] = numbers;
        let mut position = Vec3::new(x, y, z);
        match n {
            4 if w == 0.0 => return Err(ObjError::ZeroWeight { line: self.cursor.line() }),
            4 => position /= w,
            3 | 6.. => {}
            _ => {
                let expected = "3 numbers, 4 with a weight, or 6 to 8 with a colour";
                return Err(self.wrong_count("v", format!("{n} numbers"), expected));
            }
        }
        self.check_room("vertices", self.file.positions.len())?;
        self.check_range(&position.to_array())?;
        self.file.positions.push(position);
        self.end_line()
    }

    fn read_uv(&mut self) -> Result<(), ObjError> {
        let mut numbers = [0.0; 3];
        let n = self.read_numbers("vt", &mut numbers)?;
        if n == 0 {
            return Err(self.wrong_count("vt", "no number".into(), "1 to 3 numbers"));
        }
        self.check_room("texture coordinates", self.file.uvs.len())?;
        self.check_range(&numbers)?;
        self.file.uvs.push(Vec2::new(numbers[0], numbers[1]));
        self.end_line()
    }

    fn read_normal(&mut self) -> Result<(), ObjError> {
        let mut numbers = [0.0; 3];
        let n = self.read_numbers("vn", &mut numbers)?;
        if n != 3 {
            return Err(self.wrong_count("vn", format!("{n} numbers"), "3 numbers"));
        }
        self.check_room("normals", self.file.normals.len())?;
        // In f64, where the square of every f32 is finite and above 0.
        let unit = Vec3::from_array(numbers).as_dvec3().try_normalize();
        if unit.is_none() {
            if self.zero_normals.is_empty() {
                self.zero_normal_line = self.cursor.line();
            }
            self.zero_normals.push(self.file.normals.len() as u32);
        }
        self.file.normals.push(unit.unwrap_or(DVec3::Z).as_vec3());
        self.end_line()
    }

    fn read_material(&mut self) -> Result<(), ObjError> {
        let name = self.cursor.rest_of_line();
        self.material = if name.is_empty() { None } else { Some(name) };
        self.slot = self.slot_of_name.get(&self.material).copied();
        self.end_line()
    }

    fn read_libraries(&mut self) -> Result<(), ObjError> {
        let names = self.cursor.rest_of_line();
        for name in split_library_names(&String::from_utf8_lossy(names)) {
            let libraries = &mut self.file.libraries;
            if libraries.len() < MAX_LIBRARIES && !libraries.iter().any(|known| known == name) {
                libraries.push(name.to_owned());
            }
        }
        self.end_line()
    }

    /// Passes over a line that means nothing for a picture.
    fn pass_over(&mut self, keyword: &[u8]) -> Result<(), ObjError> {
        let line = self.cursor.line();
        if keyword.iter().any(u8::is_ascii_control) || str::from_utf8(keyword).is_err() {
            return Err(ObjError::NotText { line, token: excerpt(keyword) });
        }
        if !IGNORED_KEYWORDS.contains(&keyword) {
            self.n_unknown_lines += 1;
            self.unknown.get_or_insert_with(|| (line, excerpt(keyword)));
        }
        self.cursor.skip_line();
        Ok(())
    }

    /// Reads numbers to the end of the line; how many there were.
    #[inline]
    fn read_numbers(
        &mut self,
        keyword: &'static str,
        numbers: &mut [f32],
    ) -> Result<usize, ObjError> {
        let mut n = 0;
        loop {
            self.cursor.skip_blanks();
            if self.cursor.at_end_of_line() {
                return Ok(n);
            }
            let Some(number) = numbers.get_mut(n) else {
                let found = format!("more than {n} numbers");
                return Err(self.wrong_count(keyword, found, "fewer"));
            };
            *number = self.cursor.finite()?;
            n += 1;
        }
    }

    #[inline]
    pub(super) fn end_line(&mut self) -> Result<(), ObjError> {
        self.cursor.skip_comment();
        Ok(())
    }

    /// Refuses what squares and products in `f32` could not hold.
    #[inline]
    fn check_range(&self, coordinates: &[f32]) -> Result<(), ObjError> {
        for value in coordinates {
            // Written so that NaN is refused too.
            let in_range = value.abs() <= MAX_COORDINATE;
            if !in_range {
                let (line, token) = (self.cursor.line(), format!("{value:e}"));
                return Err(ObjError::CoordinateTooLarge { line, token });
            }
        }
        Ok(())
    }

    #[inline]
    pub(super) fn check_room(&self, what: &'static str, n: usize) -> Result<(), ObjError> {
        self.check_count(what, n, MAX_ENTRIES)
    }

    /// Refuses the entry after the first `n` where there may be `limit`.
    #[inline]
    pub(super) fn check_count(
        &self,
        what: &'static str,
        n: usize,
        limit: usize,
    ) -> Result<(), ObjError> {
        if limit <= n {
            return Err(ObjError::TooMany { line: self.cursor.line(), what, limit });
        }
        Ok(())
    }

    /// Refuses more triangles than a file of its length has.
    #[inline]
    pub(super) fn check_triangles(&self, n_more: usize) -> Result<(), ObjError> {
        let what = "triangles in a file of its length";
        self.check_count(what, self.file.triangles.len() + n_more - 1, self.max_triangles)
    }

    #[cold]
    pub(super) fn wrong_count(
        &self,
        keyword: &'static str,
        found: String,
        expected: &'static str,
    ) -> ObjError {
        ObjError::WrongCount { line: self.cursor.line(), keyword, found, expected }
    }

    fn finish(mut self) -> Result<ObjFile, ObjError> {
        if self.file.triangles.is_empty() {
            let hint = self.unknown.map_or_else(String::new, |(line, keyword)| {
                format!(" (line {line} starts with `{keyword}`: is this a Wavefront OBJ file?)")
            });
            return Err(ObjError::NoTriangles { hint });
        }
        self.warn();
        Ok(self.file)
    }

    fn warn(&mut self) {
        let n_flat = count_without_area(&self.file);
        let n_libraries = self.file.libraries.len();
        let warnings = &mut self.file.warnings;
        if let Some((line, keyword)) = &self.unknown {
            let n = self.n_unknown_lines;
            warnings.push(format!("line {line}: `{keyword}` is not known; lines passed over: {n}"));
        }
        if n_libraries == MAX_LIBRARIES {
            warnings.push(format!("only the first {MAX_LIBRARIES} material libraries are read"));
        }
        if !self.zero_normals.is_empty() {
            let (line, n) = (self.zero_normal_line, self.zero_normals.len());
            warnings.push(format!("line {line}: `vn` has no direction; normals left out: {n}"));
        }
        if n_flat > 0 {
            let n = self.file.triangles.len();
            warnings.push(format!("{n_flat} of {n} triangles have no area and cannot be seen"));
        }
    }
}

/// Keywords of the format that mean nothing here.
const IGNORED_KEYWORDS: [&[u8]; 34] = [
    b"g",
    b"o",
    b"s",
    b"l",
    b"p",
    b"mg",
    b"vp",
    b"cstype",
    b"deg",
    b"bmat",
    b"step",
    b"curv",
    b"curv2",
    b"surf",
    b"parm",
    b"trim",
    b"hole",
    b"scrv",
    b"sp",
    b"end",
    b"con",
    b"bevel",
    b"c_interp",
    b"d_interp",
    b"lod",
    b"shadow_obj",
    b"trace_obj",
    b"ctech",
    b"stech",
    b"maplib",
    b"usemap",
    b"call",
    b"csh",
    b"res",
];

/// The names after `mtllib`: several are separated by blanks, but one may also hold blanks. A name
/// ends with `.mtl`, or at the end of the line.
fn split_library_names(names: &str) -> impl Iterator<Item = &str> {
    const ENDING: &str = ".mtl";
    let is_ending = move |at: usize| {
        let (ending, rest) = names.as_bytes()[at..].split_at(ENDING.len());
        ending.eq_ignore_ascii_case(ENDING.as_bytes()) && matches!(rest.first(), Some(b' ' | b'\t'))
    };
    let mut start = 0;
    std::iter::from_fn(move || {
        start += names[start..].len() - names[start..].trim_start().len();
        let last = names.len().saturating_sub(ENDING.len());
        let end = (start..last).find(|at| is_ending(*at));
        let end = end.map_or(names.len(), |at| at + ENDING.len());
        let name = &names[start..end];
        start = end;
        (!name.is_empty()).then_some(name)
    })
}

fn count_without_area(file: &ObjFile) -> usize {
    let has_no_area = |ids: &&[u32; 3]| {
        let [a, b, c] = ids.map(|id| file.positions[id as usize].as_dvec3());
        (b - a).cross(c - a) == DVec3::ZERO
    };
    file.triangles.iter().filter(has_no_area).count()
}
