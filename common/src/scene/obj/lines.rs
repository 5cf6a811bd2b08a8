//! The lines of an OBJ file on their way to `tobj`.
//!
//! A reader that hands over one line at a time, so that where `tobj` stops is where the error is,
//! and rewrites each so that `tobj` can neither panic nor misread it: texture coordinates, groups
//! and all that is not a polygon mesh are left out; corners become `v//vn` with absolute indices,
//! where normal 1 is a zero vector that stands for "none"; concave polygons come as triangles.

use std::collections::BTreeSet;
use std::io::{self, BufRead, Read};

use glam::{DVec3, Vec3};
use tobj::LoadError as TobjError;

use super::polygon;
use crate::scene::load::{MAX_TRIANGLES, short};

/// Most changes of material. Each makes a mesh of its own inside `tobj`.
const MAX_SWITCHES: usize = 1_000_000;

/// See the module.
pub(super) struct Lines<'a> {
    /// What is left of the file.
    rest: &'a [u8],
    /// Number of the line last taken from the file, from 1.
    line: usize,
    /// The rewritten line, and how much of it has been read.
    out: Vec<u8>,
    read: usize,
    positions: Vec<[f32; 3]>,
    normals: usize,
    triangles: usize,
    switches: usize,
    /// The face that refers to the highest vertex: that vertex's number, and the face's line.
    highest: (usize, usize),
    problem: Option<String>,
    lines_and_points: usize,
    missing_normals: usize,
    concave: usize,
    unknown: usize,
    first_unknown: Option<(usize, String)>,
    used: BTreeSet<String>,
}

impl<'a> Lines<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self {
            rest: bytes,
            line: 0,
            out: b"vn 0 0 0\n".to_vec(),
            read: 0,
            positions: Vec::new(),
            normals: 0,
            triangles: 0,
            switches: 0,
            highest: (0, 0),
            problem: None,
            lines_and_points: 0,
            missing_normals: 0,
            concave: 0,
            unknown: 0,
            first_unknown: None,
            used: BTreeSet::new(),
        }
    }

    /// Names of the materials that were asked for.
    pub(super) fn used_materials(&self) -> &BTreeSet<String> {
        &self.used
    }

    /// The line, and a clause that says what is wrong there, after `tobj` stopped with `error`.
    pub(super) fn problem(&self, error: TobjError) -> (usize, String) {
        if let Some(problem) = &self.problem {
            return (self.line, problem.clone());
        }
        let what = match error {
            TobjError::FaceVertexOutOfBounds => {
                let (vertex, line) = self.highest;
                let count = self.positions.len();
                return (line, format!("face with vertex {vertex}, but the file has {count} so far"));
            }
            TobjError::PositionParseError | TobjError::ColorParseError => {
                "can't read the vertex; expected `v x y z` with three numbers"
            }
            TobjError::ScalingByZeroError => "vertex with w = 0; expected w to be another number",
            TobjError::NormalParseError => "can't read the normal; expected `vn x y z` with three numbers",
            TobjError::FaceParseError => {
                "can't read the face; expected `f` and corners like 1, 1/2, 1//3 or 1/2/3"
            }
            _ => return (self.line, format!("{error}; expected an OBJ model")),
        };
        (self.line, what.into())
    }

    /// Says what was left out or made up.
    pub(super) fn say(&self, file: &str, notes: &mut Vec<String>) {
        let mut note = |count: usize, text: &str| {
            if count > 0 {
                notes.push(format!("{file}: {count} {text}"));
            }
        };
        note(self.lines_and_points, "lines and points were dropped");
        note(
            self.missing_normals,
            "corners name normals that the file has not, and use their triangle's own",
        );
        note(self.concave, "concave polygons were cut into triangles");
        if let Some((line, text)) = &self.first_unknown {
            note(self.unknown, &format!("unknown lines were passed over, first line {line}: `{text}`"));
        }
    }

    /// Takes the next line from the file, with the lines that it is continued on.
    fn take(&mut self) -> Option<String> {
        let mut whole = Vec::new();
        loop {
            if self.rest.is_empty() {
                break if whole.is_empty() { None } else { Some(()) };
            }
            let end = self.rest.iter().position(|&b| b == b'\n');
            let (line, rest) = self.rest.split_at(end.map_or(self.rest.len(), |end| end + 1));
            self.rest = rest;
            self.line += 1;
            let line = line.trim_ascii_end();
            match line.strip_suffix(b"\\") {
                Some(line) => {
                    whole.extend_from_slice(line);
                    whole.push(b' ');
                }
                None => {
                    whole.extend_from_slice(line);
                    break Some(());
                }
            }
        }?;
        Some(String::from_utf8_lossy(&whole).into_owned())
    }

    /// Rewrites a line into `out`, or says what is wrong with it.
    fn rewrite(&mut self, line: &str) -> Result<(), String> {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        // A comment begins at a word; `1.#IND` is how some C libraries write NaN.
        let comment = rest.match_indices('#').find(|(at, _)| !rest[..*at].ends_with(['.', '-']));
        let values = comment.map_or(rest, |(at, _)| &rest[..at]);
        match keyword {
            "v" => {
                let numbers: Vec<&str> = values.split_whitespace().take(5).map(plain_nan).collect();
                // x y z w; any more are colours, which are not used.
                let kept = if numbers.len() == 4 { 4 } else { 3 };
                let value = |i: usize| numbers.get(i).and_then(|x| x.parse().ok()).unwrap_or(f32::NAN);
                let w = if kept == 4 { value(3) } else { 1.0 };
                self.positions.push([value(0) / w, value(1) / w, value(2) / w]);
                self.emit("v ", numbers.iter().take(kept).copied());
            }
            "vn" => {
                self.normals += 1;
                self.emit("vn ", values.split_whitespace().map(plain_nan));
            }
            "f" => self.face(values)?,
            "l" | "p" => self.lines_and_points += 1,
            "usemtl" if !rest.is_empty() => {
                self.switches += 1;
                if self.switches > MAX_SWITCHES {
                    return Err(format!("more than {MAX_SWITCHES} changes of material; expected fewer"));
                }
                self.used.insert(rest.into());
                self.emit("usemtl ", [rest]);
            }
            "mtllib" => self.emit("mtllib ", [rest]),
            // Known, and of no use here.
            "" | "#" | "usemtl" | "vt" | "vp" | "vw" | "g" | "o" | "s" | "mg" | "lod" | "bevel"
            | "c_interp" | "d_interp" | "shadow_obj" | "trace_obj" | "usemap" | "maplib" => {}
            _ if keyword.starts_with('#') => {}
            _ => {
                self.unknown += 1;
                if self.first_unknown.is_none() {
                    self.first_unknown = Some((self.line, short(line)));
                }
            }
        }
        Ok(())
    }

    fn emit<'s>(&mut self, keyword: &str, values: impl IntoIterator<Item = &'s str>) {
        self.out.extend_from_slice(keyword.as_bytes());
        for value in values {
            self.out.extend_from_slice(value.as_bytes());
            self.out.push(b' ');
        }
        self.out.push(b'\n');
    }

    fn emit_face(&mut self, corners: impl IntoIterator<Item = (usize, usize)>) {
        let text: Vec<String> = corners.into_iter().map(|(v, n)| format!("{v}//{n}")).collect();
        self.emit("f ", text.iter().map(String::as_str));
    }

    /// Rewrites the corners of a face.
    fn face(&mut self, values: &str) -> Result<(), String> {
        let mut corners = Vec::new();
        for corner in values.split_whitespace() {
            corners.push(self.corner(corner)?);
        }
        if corners.len() < 3 {
            self.lines_and_points += 1;
            return Ok(());
        }
        self.triangles += corners.len() - 2;
        if self.triangles > MAX_TRIANGLES {
            return Err(format!("more than {MAX_TRIANGLES} triangles; expected a smaller model"));
        }
        // Cut a concave polygon here: `tobj` cuts all into fans.
        let points: Option<Vec<DVec3>> = corners
            .iter()
            .map(|(vertex, _)| self.positions.get(vertex - 1).map(|p| Vec3::from_array(*p).as_dvec3()))
            .collect();
        match points.as_deref().and_then(polygon::cut_concave) {
            None => self.emit_face(corners.iter().copied()),
            Some(triangles) => {
                triangles.iter().for_each(|triangle| self.emit_face(triangle.map(|i| corners[i])));
                self.concave += 1;
            }
        }
        Ok(())
    }

    /// Numbers of a corner's vertex and normal, from 1, as they go to `tobj`.
    fn corner(&mut self, text: &str) -> Result<(usize, usize), String> {
        let mut parts = text.split('/');
        let (vertex, _, normal) = (parts.next().unwrap_or_default(), parts.next(), parts.next());
        let number = |text: &str| {
            text.parse::<i64>().map_err(|_| {
                format!("corner `{}`; expected integers like 1, 1/2, 1//3 or 1/2/3", short(text))
            })
        };
        // Negative numbers count back from the last.
        let absolute = |number: i64, count: usize| {
            let from_one = if number < 0 { count as i64 + 1 + number } else { number };
            usize::try_from(from_one).unwrap_or(0)
        };
        let given = number(vertex)?;
        let vertex = absolute(given, self.positions.len());
        if vertex == 0 || vertex >= u32::MAX as usize {
            let count = self.positions.len();
            return Err(format!(
                "face with vertex {given}, but the file has {count} so far (counted from 1)"
            ));
        }
        if vertex > self.highest.0 {
            self.highest = (vertex, self.line);
        }
        let normal = match normal.filter(|text| !text.is_empty()) {
            None => 0,
            Some(text) => {
                let normal = absolute(number(text)?, self.normals);
                if normal == 0 || normal > self.normals {
                    self.missing_normals += 1;
                }
                if normal > self.normals { 0 } else { normal }
            }
        };
        Ok((vertex, normal + 1))
    }
}

/// The word, or `nan` where it is one of the ways in which C libraries write NaN and infinity.
fn plain_nan(word: &str) -> &str {
    let lower = word.trim_start_matches(['-', '+']).to_ascii_lowercase();
    if lower.starts_with("nan") || lower.starts_with("1.#") { "nan" } else { word }
}

impl BufRead for Lines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        while self.read >= self.out.len() {
            self.out.clear();
            self.read = 0;
            let Some(line) = self.take() else { break };
            if let Err(problem) = self.rewrite(&line) {
                self.problem = Some(problem);
                return Err(io::Error::other("see `problem`"));
            }
        }
        Ok(&self.out[self.read..])
    }

    fn consume(&mut self, amount: usize) {
        self.read += amount;
    }
}

impl Read for Lines<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let amount = self.fill_buf()?.read(buffer)?;
        self.consume(amount);
        Ok(amount)
    }
}
