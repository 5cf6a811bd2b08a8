//! Material libraries, cleaned before `tobj` reads them: it panics on a colour of one number and
//! gives up on a whole library for one bad line.

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use tobj::MTLLoadResult;

use crate::scene::load::{read, short, some_of};

/// Largest library that is read \[bytes\].
const MAX_BYTES: u64 = 64 << 20;

/// Most materials of all libraries of a file.
const MAX_MATERIALS: usize = 100_000;

/// Most libraries of a file.
const MAX_LIBRARIES: usize = 100;

/// The material libraries of an OBJ file.
pub(super) struct Library {
    obj: PathBuf,
    /// The library file and the number of its first material, in order.
    files: Vec<(PathBuf, usize)>,
    materials: usize,
    known: BTreeSet<String>,
    notes: Vec<String>,
}

impl Library {
    pub(super) fn new(obj: &Path) -> Self {
        Self { obj: obj.into(), files: Vec::new(), materials: 0, known: BTreeSet::new(), notes: Vec::new() }
    }

    /// The library file that material `id` comes from.
    pub(super) fn folder_of(&self, id: usize) -> Option<&Path> {
        let after = self.files.partition_point(|(_, first)| *first <= id);
        after.checked_sub(1).map(|index| self.files[index].0.as_path())
    }

    /// Loads what an `mtllib` line names: one file, or several between spaces. Never fails: what
    /// can't be had becomes a note.
    pub(super) fn load(&mut self, name: &Path) -> MTLLoadResult {
        let name = name.to_string_lossy();
        let folder = self.obj.with_file_name("");
        let whole = folder.join(name.replace('\\', "/"));
        let names: Vec<String> = if whole.is_file() { vec![name.replace('\\', "/")] } else { words(&name) };
        let (mut materials, mut index_of, mut missing) = (Vec::new(), HashMap::new(), Vec::new());
        for name in &names {
            let path = folder.join(name);
            if self.files.len() >= MAX_LIBRARIES || self.files.iter().any(|(file, _)| *file == path) {
                continue;
            }
            self.files.push((path.clone(), self.materials));
            let text = match read(&path, MAX_BYTES) {
                Ok(bytes) => self.clean(name, &String::from_utf8_lossy(&bytes)),
                Err(error) => {
                    missing.push((name.clone(), error));
                    continue;
                }
            };
            match tobj::load_mtl_buf(&mut text.as_bytes()) {
                Ok((loaded, map)) => {
                    index_of.extend(map.into_iter().map(|(name, index)| (name, index + materials.len())));
                    self.materials += loaded.len();
                    materials.extend(loaded);
                }
                Err(error) => self.notes.push(format!("material library {}: {error}", path.display())),
            }
        }
        if let Some((_, error)) = missing.first() {
            let names: Vec<String> = missing.iter().map(|(name, _)| name.clone()).collect();
            self.notes.push(format!("no material library {} ({error})", some_of(&names)));
        }
        self.known.extend(index_of.keys().cloned());
        Ok((materials, index_of))
    }

    /// Keeps the lines that are used and well-formed, in the form that `tobj` reads safely.
    fn clean(&mut self, name: &str, text: &str) -> String {
        let mut out = String::new();
        let (mut bad, mut count) = (Vec::new(), self.materials);
        for (index, line) in text.lines().enumerate() {
            let line = line.trim();
            let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            let rest = rest.trim();
            let numbers: Option<Vec<f32>> = rest
                .split_whitespace()
                .take_while(|word| !word.starts_with('#'))
                .map(|word| word.parse().ok().filter(|x: &f32| x.is_finite()))
                .collect();
            let well_formed = match (keyword, numbers.as_deref()) {
                ("newmtl", _) if !rest.is_empty() => {
                    count += 1;
                    if count > MAX_MATERIALS {
                        self.notes.push(format!(
                            "material library {name}: only the first {MAX_MATERIALS} materials were read"
                        ));
                        break;
                    }
                    out.push_str(&format!("newmtl {rest}\n"));
                    true
                }
                // One number stands for three.
                ("Kd" | "Ks" | "Ke", Some(&[x])) => {
                    out.push_str(&format!("{keyword} {x} {x} {x}\n"));
                    true
                }
                ("Kd" | "Ks" | "Ke", Some(&[x, y, z, ..])) => {
                    out.push_str(&format!("{keyword} {x} {y} {z}\n"));
                    true
                }
                ("Ns" | "d", Some(&[x, ..])) => {
                    out.push_str(&format!("{keyword} {x}\n"));
                    true
                }
                ("Tr", Some(&[x, ..])) => {
                    out.push_str(&format!("d {}\n", 1.0 - x));
                    true
                }
                ("illum", Some(&[x, ..])) if (0.0..=10.0).contains(&x) => {
                    out.push_str(&format!("illum {}\n", x as u8));
                    true
                }
                ("map_Kd" | "map_d", _) if !rest.is_empty() => {
                    out.push_str(&format!("{keyword} {rest}\n"));
                    true
                }
                ("newmtl" | "Kd" | "Ks" | "Ke" | "Ns" | "d" | "Tr" | "illum" | "map_Kd", _) => false,
                _ => true,
            };
            if !well_formed {
                bad.push(format!("line {}: {line}", index + 1));
            }
        }
        if !bad.is_empty() {
            self.notes.push(format!("material library {name}: passed over bad lines ({})", some_of(&bad)));
        }
        out
    }

    /// Says what could not be had; `used` are the materials that were asked for.
    pub(super) fn say(&self, used: &BTreeSet<String>, notes: &mut Vec<String>) {
        notes.extend(self.notes.iter().cloned());
        let missing: Vec<String> = used.difference(&self.known).cloned().collect();
        if !missing.is_empty() {
            notes.push(format!(
                "{}: no library has material {}; grey stands in",
                self.obj.file_name().unwrap_or(self.obj.as_os_str()).to_string_lossy(),
                some_of(&missing)
            ));
        }
    }
}

/// The words of a list of file names; a space within a name has a backslash before it.
fn words(list: &str) -> Vec<String> {
    const SPACE: &str = "\u{0}";
    let joined = list.replace("\\ ", SPACE);
    joined.split_whitespace().map(|word| word.replace(SPACE, " ").replace('\\', "/")).collect()
}

/// The file name in a `map_Kd` value, behind its options.
pub(super) fn texture_name(value: &str) -> String {
    let mut words = value.split_whitespace().peekable();
    while let Some(option) = words.next_if(|word| word.starts_with('-')) {
        let (least, most) = match option {
            "-o" | "-s" | "-t" => (1, 3),
            "-mm" => (2, 2),
            _ => (1, 1),
        };
        for index in 0..most {
            // Further numbers are optional.
            let is_number = words.peek().is_some_and(|word| word.parse::<f32>().is_ok());
            if index >= least && !is_number {
                break;
            }
            words.next();
        }
    }
    let name: Vec<&str> = words.collect();
    short(&name.join(" ").replace('\\', "/"))
}
