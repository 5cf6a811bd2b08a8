//! Bytes and numbers of a glTF file: GLB, URIs, buffers and accessors.
//!
//! Differs from the crate `gltf`'s own reader and validation, which panic on short buffers and on
//! indices out of range: every offset is checked here before it is read.

use std::cell::Cell;
use std::path::{Path, PathBuf};

use ::gltf::json;
use json::accessor::{Accessor, ComponentType};
use json::validation::{Checked, USize64};

use crate::scene::load::{LoadError, MAX_BYTES, read, short};

/// Most elements read of all accessors: a few more than the largest scene needs.
const MAX_ELEMENTS: usize = 150_000_000;

/// Most elements of an accessor that has no bytes, only the changes of a sparse one.
const MAX_EMPTY_ELEMENTS: usize = 1_000_000;

/// A glTF document with its buffers.
pub(super) struct Data {
    pub(super) path: PathBuf,
    pub(super) root: json::Root,
    buffers: Vec<Vec<u8>>,
    elements_read: Cell<usize>,
}

/// Where the elements of an accessor lie.
struct Layout<'a> {
    /// None at all: zeros.
    bytes: Option<&'a [u8]>,
    stride: usize,
    size: usize,
}

/// What can be wrong inside a document: a place and a clause.
type Problem = (String, String);

fn problem<T>(place: String, what: impl Into<String>) -> Result<T, Problem> {
    Err((place, what.into()))
}

impl Data {
    /// Takes a `.gltf` or `.glb` file apart and loads its buffers.
    pub(super) fn load(path: &Path) -> Result<Self, LoadError> {
        let bytes = read(path, MAX_BYTES)?;
        let (text, blob) = if bytes.starts_with(b"glTF") {
            split_glb(&bytes).map_err(|problem| LoadError::invalid(path, "GLB container", problem))?
        } else {
            (&bytes[..], None)
        };
        let root: json::Root = json::deserialize::from_slice(text).map_err(|error| {
            LoadError::invalid(path, "", format!("{error}; expected a glTF 2.0 document"))
        })?;
        let version = &root.asset.version;
        if !version.starts_with("2.") {
            let problem = format!("version `{}`; expected glTF 2.0", short(version));
            return Err(LoadError::invalid(path, "asset", problem));
        }
        check_extensions(&root.extensions_required)
            .map_err(|problem| LoadError::invalid(path, "extensionsRequired", problem))?;

        let mut data = Self { path: path.into(), root, buffers: Vec::new(), elements_read: Cell::new(0) };
        let mut total = 0;
        for (index, buffer) in data.root.buffers.iter().enumerate() {
            let place = format!("buffers[{index}]");
            let needed = buffer.byte_length.0;
            let loaded = match (&buffer.uri, blob) {
                (Some(uri), _) => data.resource(uri, &place)?,
                (None, Some(blob)) if index == 0 => blob.to_vec(),
                (None, _) => {
                    let problem = "has no uri; expected one, or the binary chunk of a GLB file";
                    return Err(LoadError::invalid(path, place, problem));
                }
            };
            if (loaded.len() as u64) < needed {
                let problem = format!("{} bytes; expected its byteLength of {needed}", loaded.len());
                return Err(LoadError::invalid(path, place, problem));
            }
            total += loaded.len() as u64;
            if total > MAX_BYTES {
                return Err(LoadError::TooLarge { path: path.into(), limit: MAX_BYTES });
            }
            data.buffers.push(loaded);
        }
        Ok(data)
    }

    /// The bytes of a data URI or of a file beside the document; `place` is where the URI stands.
    pub(super) fn resource(&self, uri: &str, place: &str) -> Result<Vec<u8>, LoadError> {
        let invalid = |problem: String| LoadError::invalid(&self.path, place, problem);
        if let Some(rest) = uri.strip_prefix("data:") {
            let Some((_, text)) = rest.split_once(";base64,") else {
                return Err(invalid("a data URI without base64; expected `data:…;base64,…`".into()));
            };
            return from_base64(text)
                .ok_or_else(|| invalid("can't decode the data URI; expected base64".into()));
        }
        if uri.contains("://") {
            let problem = format!("`{}` is not a file; expected a relative path or a data URI", short(uri));
            return Err(invalid(problem));
        }
        read(&self.path.with_file_name("").join(percent_decoded(uri)), MAX_BYTES)
            .map_err(|error| invalid(error.to_string()))
    }

    /// The bytes of a buffer view.
    pub(super) fn view(&self, index: usize) -> Result<&[u8], Problem> {
        let place = || format!("bufferViews[{index}]");
        let Some(view) = self.root.buffer_views.get(index) else {
            return problem(
                place(),
                format!("does not exist; expected less than {}", self.root.buffer_views.len()),
            );
        };
        let Some(buffer) = self.buffers.get(view.buffer.value()) else {
            return problem(place(), format!("buffer {} does not exist", view.buffer.value()));
        };
        let start = offset(view.byte_offset);
        let end = start.checked_add(view.byte_length.0);
        let range = end.and_then(|end| Some(usize::try_from(start).ok()?..usize::try_from(end).ok()?));
        match range.and_then(|range| buffer.get(range)) {
            Some(bytes) => Ok(bytes),
            None => problem(
                place(),
                format!(
                    "reaches from byte {start} over {} bytes; expected it to end within the {} of its buffer",
                    view.byte_length.0,
                    buffer.len()
                ),
            ),
        }
    }

    /// Elements of an accessor of three numbers each; integers are normalised where it says so.
    pub(super) fn vectors(&self, index: usize) -> Result<Vec<[f32; 3]>, Problem> {
        let (accessor, kind) = self.accessor(index)?;
        if accessor.type_ != Checked::Valid(json::accessor::Type::Vec3) {
            return problem(format!("accessors[{index}].type"), "expected VEC3");
        }
        let mut values = Vec::new();
        self.each(index, accessor, kind, 3, |at, bytes| {
            let value = match bytes {
                None => [0.0; 3],
                Some(bytes) => [0, 1, 2].map(|i| number(bytes, i, kind, accessor.normalized)),
            };
            match values.get_mut(at) {
                Some(old) => *old = value,
                None => values.push(value),
            }
        })?;
        Ok(values)
    }

    /// Elements of an accessor of indices.
    pub(super) fn indices(&self, index: usize) -> Result<Vec<u32>, Problem> {
        let (accessor, kind) = self.accessor(index)?;
        if accessor.type_ != Checked::Valid(json::accessor::Type::Scalar) {
            return problem(format!("accessors[{index}].type"), "expected SCALAR");
        }
        if !matches!(kind, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) {
            return problem(
                format!("accessors[{index}].componentType"),
                "expected 5121, 5123 or 5125 (an unsigned integer) for indices",
            );
        }
        let mut values = Vec::new();
        self.each(index, accessor, kind, 1, |at, bytes| {
            let value = bytes.map_or(0, |bytes| integer(bytes, kind));
            match values.get_mut(at) {
                Some(old) => *old = value,
                None => values.push(value),
            }
        })?;
        Ok(values)
    }

    fn accessor(&self, index: usize) -> Result<(&Accessor, ComponentType), Problem> {
        let Some(accessor) = self.root.accessors.get(index) else {
            let count = self.root.accessors.len();
            return problem(
                format!("accessors[{index}]"),
                format!("does not exist; expected less than {count}"),
            );
        };
        match accessor.component_type {
            Checked::Valid(kind) => Ok((accessor, kind.0)),
            Checked::Invalid => problem(format!("accessors[{index}].componentType"), "expected 5120 to 5126"),
        }
    }

    /// Calls `each` with index and bytes of every element, in order; then again with those that a
    /// sparse accessor changes.
    fn each(
        &self,
        index: usize,
        accessor: &Accessor,
        kind: ComponentType,
        width: usize,
        mut each: impl FnMut(usize, Option<&[u8]>),
    ) -> Result<(), Problem> {
        let place = format!("accessors[{index}]");
        let size = kind.size() * width;
        let changes = accessor.sparse.as_ref().map_or(0, |sparse| sparse.count.0);
        let count = usize::try_from(accessor.count.0).unwrap_or(usize::MAX);
        let read = self.elements_read.get().saturating_add(count).saturating_add(changes as usize);
        self.elements_read.set(read);
        if read > MAX_ELEMENTS || (accessor.buffer_view.is_none() && count > MAX_EMPTY_ELEMENTS) {
            return problem(
                place,
                format!("{count} elements are more than are read; expected a smaller model"),
            );
        }
        let base = match accessor.buffer_view {
            None => Layout { bytes: None, stride: 0, size },
            Some(view) => self.layout(view.value(), offset(accessor.byte_offset), count, size, &place)?,
        };
        for at in 0..count {
            each(at, base.element(at));
        }

        let Some(sparse) = &accessor.sparse else { return Ok(()) };
        let place = format!("{place}.sparse");
        let Checked::Valid(index_kind) = sparse.indices.component_type else {
            return problem(place, "its indices have an unknown componentType; expected 5121, 5123 or 5125");
        };
        let (index_kind, changes) = (index_kind.0, changes as usize);
        let (at, to) = (&sparse.indices, &sparse.values);
        let at = self.layout(at.buffer_view.value(), at.byte_offset.0, changes, index_kind.size(), &place)?;
        let to = self.layout(to.buffer_view.value(), to.byte_offset.0, changes, size, &place)?;
        for change in 0..changes {
            let target = at.element(change).map_or(0, |bytes| integer(bytes, index_kind)) as usize;
            if target >= count {
                return problem(place, format!("changes element {target} of {count}"));
            }
            each(target, to.element(change));
        }
        Ok(())
    }

    /// Checks that `count` elements of `size` bytes from `start` on lie within a buffer view.
    fn layout(
        &self,
        view: usize,
        start: u64,
        count: usize,
        size: usize,
        place: &str,
    ) -> Result<Layout<'_>, Problem> {
        let bytes = self.view(view)?;
        let stride = self.root.buffer_views[view].byte_stride.map_or(0, |stride| stride.0);
        let stride = if stride == 0 { size } else { stride };
        let start = usize::try_from(start).unwrap_or(usize::MAX);
        let needed = match count.checked_sub(1) {
            None => Some(start.min(bytes.len())),
            Some(last) => {
                last.checked_mul(stride).and_then(|n| n.checked_add(size)).and_then(|n| n.checked_add(start))
            }
        };
        match needed.filter(|&needed| needed <= bytes.len()) {
            Some(_) => {
                let bytes = bytes.get(start..).unwrap_or_default();
                Ok(Layout { bytes: Some(bytes), stride, size })
            }
            None => problem(
                place.into(),
                format!(
                    "{count} elements from byte {start} on, {stride} apart, do not fit into the {} bytes of bufferViews[{view}]",
                    bytes.len()
                ),
            ),
        }
    }
}

impl Layout<'_> {
    fn element(&self, index: usize) -> Option<&[u8]> {
        let start = index.checked_mul(self.stride)?;
        self.bytes?.get(start..start.checked_add(self.size)?)
    }
}

fn offset(offset: Option<USize64>) -> u64 {
    offset.map_or(0, |offset| offset.0)
}

/// Component `i` of an element; zero where there are no such bytes.
fn number(bytes: &[u8], i: usize, kind: ComponentType, normalized: bool) -> f32 {
    let at = |n: usize| bytes.get(i * kind.size() + n).copied().unwrap_or(0);
    let half = [at(0), at(1)];
    let word = [at(0), at(1), at(2), at(3)];
    let (value, most) = match kind {
        ComponentType::I8 => (f32::from(at(0) as i8), 127.0),
        ComponentType::U8 => (f32::from(at(0)), 255.0),
        ComponentType::I16 => (f32::from(i16::from_le_bytes(half)), 32_767.0),
        ComponentType::U16 => (f32::from(u16::from_le_bytes(half)), 65_535.0),
        ComponentType::U32 => (u32::from_le_bytes(word) as f32, u32::MAX as f32),
        ComponentType::F32 => return f32::from_le_bytes(word),
    };
    if normalized { (value / most).max(-1.0) } else { value }
}

fn integer(bytes: &[u8], kind: ComponentType) -> u32 {
    let mut word = [0; 4];
    for (to, from) in word.iter_mut().zip(bytes.iter().take(kind.size())) {
        *to = *from;
    }
    u32::from_le_bytes(word)
}

/// The JSON and the binary chunk of a GLB file.
fn split_glb(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    let word = |at: usize| {
        let word = bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
        word.ok_or_else(|| format!("ends at byte {}; expected more", bytes.len()))
    };
    let (version, length) = (word(4)?, word(8)? as usize);
    if version != 2 {
        return Err(format!("version {version}; expected 2"));
    }
    if length > bytes.len() {
        return Err(format!("{} bytes; expected the {length} that its header says", bytes.len()));
    }
    let chunk = |at: usize| -> Result<(&[u8], &[u8]), String> {
        let size = word(at)? as usize;
        let kind = bytes.get(at + 4..at + 8).unwrap_or_default();
        let body = bytes.get(at + 8..).and_then(|rest| rest.get(..size));
        body.map(|body| (kind, body)).ok_or_else(|| {
            format!("a chunk of {size} bytes at byte {at} of {}; expected it to fit", bytes.len())
        })
    };
    let (kind, text) = chunk(12)?;
    if kind != b"JSON" {
        return Err("does not begin with a JSON chunk; expected one".into());
    }
    let next = (20 + text.len()).next_multiple_of(4);
    let blob = if next + 8 <= length { Some(chunk(next)?) } else { None };
    Ok((text, blob.filter(|(kind, _)| *kind == b"BIN\0").map(|(_, body)| body)))
}

/// Extensions that are known here, or of no matter to meshes and mean colours.
pub(super) const KNOWN: [&str; 3] = ["KHR_lights_punctual", "KHR_mesh_quantization", "KHR_texture_transform"];

/// Refuses extensions without which the file would be misread.
fn check_extensions(required: &[String]) -> Result<(), String> {
    let is_fine = |name: &String| KNOWN.contains(&name.as_str()) || name.starts_with("KHR_materials_");
    match required.iter().find(|name| !is_fine(name)) {
        None => Ok(()),
        Some(name) => Err(format!("{} is not supported; expected a file exported without it", short(name))),
    }
}

fn from_base64(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count) = (0u32, 0);
    for c in text.trim_end_matches('=').bytes() {
        let value = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    Some(bytes)
}

/// A URI's path with its `%20` and the like resolved.
fn percent_decoded(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let code = after.get(..2).and_then(|hex| std::str::from_utf8(hex).ok());
        match code.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(byte) if first == b'%' => {
                bytes.push(byte);
                rest = &after[2..];
            }
            _ => {
                bytes.push(first);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
