//! A place in the bytes of an OBJ file: blanks, ends of lines, tokens and numbers.

use super::ObjError;
use super::number::read_f32;
use crate::io::excerpt;

/// Walks through the file once. Lines end with LF, CR LF or a lone CR, and go on after a
/// backslash before the end.
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), at: 0, line: 1 }
    }

    /// The line it is in, from 1.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// The part of the file that is read, 0..=1.
    pub(super) fn share(&self) -> f32 {
        (self.place() as f64 / self.bytes.len().max(1) as f64) as f32
    }

    pub(super) fn at_end_of_file(&self) -> bool {
        self.bytes.len() <= self.at
    }

    /// The byte at the cursor; a line feed at the end of the file.
    #[inline]
    pub(super) fn peek(&self) -> u8 {
        self.peek_at(self.at)
    }

    /// Goes one byte on.
    #[inline]
    pub(super) fn bump(&mut self) {
        self.at += 1;
    }

    /// Passes spaces, tabs and line continuations.
    #[inline]
    pub(super) fn skip_blanks(&mut self) {
        loop {
            match self.peek() {
                b' ' | b'\t' | 0x0b | 0x0c => self.at += 1,
                b'\\' if self.continues_at(self.at) => {
                    self.at += 1;
                    self.pass_line_end();
                }
                _ => return,
            }
        }
    }

    /// Whether nothing but a comment is left of the line. Call it at the start of a token.
    #[inline]
    pub(super) fn at_end_of_line(&self) -> bool {
        matches!(self.peek(), b'\n' | b'\r' | b'#')
    }

    /// Passes the rest of the line, which may be continued.
    pub(super) fn skip_line(&mut self) {
        loop {
            match self.peek() {
                b'\n' | b'\r' => return self.pass_line_end(),
                b'#' if self.follows_a_blank() => return self.skip_comment(),
                b'\\' if self.continues_at(self.at) => {
                    self.at += 1;
                    self.pass_line_end();
                }
                _ => self.at += 1,
            }
        }
    }

    /// Passes the rest of the line. A backslash at the end of a comment means nothing: it belongs
    /// to a drawing or a path.
    pub(super) fn skip_comment(&mut self) {
        while !matches!(self.peek(), b'\n' | b'\r') {
            self.at += 1;
        }
        self.pass_line_end();
    }

    /// The rest of the line without blanks around it: a name, which may hold blanks and `#`.
    pub(super) fn rest_of_line(&mut self) -> &'a [u8] {
        let start = self.at;
        while !matches!(self.peek(), b'\n' | b'\r') {
            self.at += 1;
        }
        self.bytes[start..self.at].trim_ascii()
    }

    /// The bytes up to the next blank or end of line, without moving.
    pub(super) fn token(&self) -> &'a [u8] {
        let mut end = self.at;
        while !self.ends_token_at(end) {
            end += 1;
        }
        &self.bytes[self.at..end]
    }

    /// Passes a token that [`Self::token`] has returned.
    pub(super) fn pass(&mut self, token: &[u8]) {
        self.at += token.len();
    }

    /// The next number, correctly rounded and finite.
    #[inline]
    pub(super) fn finite(&mut self) -> Result<f32, ObjError> {
        let fast = self.bytes.get(self.at..).and_then(read_f32);
        if let Some((value, length)) = fast
            && self.ends_token_at(self.at + length)
        {
            self.at += length;
            return Ok(value);
        }
        self.finite_by_std()
    }

    /// Passes the integer at the cursor, if there is one; very long ones stop at the ends of
    /// `i64`, far outside every count.
    #[inline]
    pub(super) fn integer(&mut self) -> Option<i64> {
        let negative = self.peek() == b'-';
        let start = if negative || self.peek() == b'+' { self.at + 1 } else { self.at };
        let mut at = start;
        let mut magnitude = 0_i64;
        loop {
            let digit = self.peek_at(at).wrapping_sub(b'0');
            if digit > 9 {
                break;
            }
            magnitude = magnitude.saturating_mul(10).saturating_add(i64::from(digit));
            at += 1;
        }
        if at == start {
            return None;
        }
        self.at = at;
        Some(if negative { -magnitude } else { magnitude })
    }

    /// Whether the cursor is behind the last byte of a token.
    #[inline]
    pub(super) fn ends_token(&self) -> bool {
        self.ends_token_at(self.at)
    }

    /// Where the cursor is, in bytes.
    #[inline]
    pub(super) fn place(&self) -> usize {
        self.at
    }

    /// Goes back to a place on the same line.
    pub(super) fn go_back(&mut self, place: usize) {
        self.at = place;
    }

    #[cold]
    fn finite_by_std(&mut self) -> Result<f32, ObjError> {
        let token = self.token();
        let line = self.line;
        let parsed = str::from_utf8(token).ok().and_then(|text| text.parse::<f32>().ok());
        match parsed {
            None => Err(ObjError::NotANumber { line, token: excerpt(token) }),
            Some(value) if !value.is_finite() => {
                Err(ObjError::NotFinite { line, token: excerpt(token) })
            }
            Some(value) => {
                self.pass(token);
                Ok(value)
            }
        }
    }

    #[inline]
    fn peek_at(&self, at: usize) -> u8 {
        self.bytes.get(at).copied().unwrap_or(b'\n')
    }

    #[inline]
    fn ends_token_at(&self, at: usize) -> bool {
        match self.peek_at(at) {
            b' ' | b'\t' | 0x0b | 0x0c | b'\n' | b'\r' => true,
            b'\\' => self.continues_at(at),
            _ => false,
        }
    }

    /// Whether the backslash at `at` joins the next line to this one.
    fn continues_at(&self, at: usize) -> bool {
        matches!(self.bytes.get(at + 1), Some(b'\n' | b'\r'))
    }

    fn follows_a_blank(&self) -> bool {
        self.at == 0 || self.ends_token_at(self.at - 1)
    }

    /// Passes LF, CR LF or CR.
    fn pass_line_end(&mut self) {
        if self.peek() == b'\r' && self.bytes.get(self.at + 1) == Some(&b'\n') {
            self.at += 1;
        }
        self.at = (self.at + 1).min(self.bytes.len());
        self.line += 1;
    }
}
