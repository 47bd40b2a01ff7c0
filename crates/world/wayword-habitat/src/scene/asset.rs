//! A glTF file's document with its buffers. Every reference is checked when it is followed.

use super::file_kind::{KindFault, check_file_kind};
use crate::file_error::{self, FileError};
use gltf::json::{Index, Root, buffer::View};
use serde::Deserialize;
use std::{
    cell::{Cell, RefCell},
    collections::BTreeMap,
    fs::File,
    io::Read,
    path::{Component, Path, PathBuf},
    rc::Rc,
};
use wayword_core::contain_panics::run_decoder;

/// What to do about a fault in a scene's file.
pub(crate) const EXPORT_HINT: &str = "export the scene again as GLB";
/// Largest file that is read, bytes; a larger one is an error. HM3D's and Matterport3D's are below 1 GB.
const MAX_BYTES: u64 = 4 << 30;
/// Number of bytes before the document in a GLB.
const GLB_HEAD_BYTES: u64 = 20;
/// Extensions that a file may require, by the beginning of their names: those that the reader supports, and those that change
/// nothing in unlit pictures.
const KNOWN_EXTENSIONS: [&str; 14] = [
    "GOOGLE_texture_basis",
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_materials_",
    "ADOBE_materials_",
    "EXT_materials_",
    "KHR_lights_punctual",
    "EXT_lights_",
    "KHR_animation_",
    "KHR_audio",
    "KHR_xmp",
    "KHR_physics_",
    "MSFT_physics",
    "AGI_",
];

/// A document and its bytes.
pub(super) struct GltfAsset {
    pub(super) root: Root,
    /// The bytes of each of its buffers; views are parts of buffers.
    buffers: Vec<Rc<Vec<u8>>>,
    beside: AdjacentFiles,
}

impl GltfAsset {
    pub(super) fn read(file: &Path) -> Result<Self, FileError> {
        let wrong = |reason: String| FileError::new(file, reason, EXPORT_HINT);
        let bytes = file_error::read_bytes(file, MAX_BYTES, "use a GLB or glTF file")?;
        check_file_kind(&bytes).map_err(|KindFault { reason, hint }| FileError::new(file, reason, hint))?;
        // The library's validation rejects GOOGLE_texture_basis, so values are checked here where they are used.
        let gltf = run_decoder(|| gltf::Gltf::from_slice_without_validation(&bytes).map_err(|error| error.to_string()))
            .map_err(&wrong)?;
        let (root, mut blob) = (gltf.document.into_json(), gltf.blob);
        let foreign = |name: &&String| !KNOWN_EXTENSIONS.iter().any(|known| name.starts_with(known));
        if let Some(name) = root.extensions_required.iter().find(foreign) {
            let reason = format!("needs the extension {name:.60}, which cannot be read");
            return Err(FileError::new(file, reason, hint_without_extension(name)));
        }
        let folder = file.parent().unwrap_or(Path::new("")).to_owned();
        let beside = AdjacentFiles { folder, read: RefCell::default(), bytes: Cell::new(bytes.len() as u64) };
        let mut buffers = Vec::with_capacity(root.buffers.len());
        for (index, buffer) in root.buffers.iter().enumerate() {
            let bytes = match &buffer.uri {
                None => Rc::new(blob.take().ok_or_else(|| wrong(format!("buffer {index} has no bytes")))?),
                Some(uri) => beside.read_uri(uri).map_err(|reason| wrong(format!("buffer {index}: {reason}")))?,
            };
            buffers.push(bytes);
        }
        Ok(Self { root, buffers, beside })
    }

    /// Checks that the bytes of every view are there, and every picture that is a file of its own. An incomplete download
    /// lacks some of them.
    pub(super) fn check_views(&self) -> Result<(), String> {
        for number in 0..self.root.buffer_views.len() {
            self.view_bytes(Index::new(u32::try_from(number).unwrap_or(u32::MAX)))?;
        }
        for (number, image) in self.root.images.iter().enumerate() {
            let Some(uri) = image.uri.as_deref().filter(|uri| !uri.starts_with("data:")) else { continue };
            let file = uri_target(uri).map(|target| self.beside.folder.join(target));
            let there = file.and_then(|file| match file.is_file() {
                true => Ok(()),
                false => Err(format!("{} is not there", file.display())),
            });
            there.map_err(|reason| format!("image {number}: {reason}"))?;
        }
        Ok(())
    }

    /// The bytes that a URI refers to.
    pub(super) fn read_adjacent(&self, uri: &str) -> Result<Rc<Vec<u8>>, String> {
        self.beside.read_uri(uri)
    }

    /// Length of the file and of all other files that were read for it so far, bytes. The limits for meshes and textures depend
    /// on it.
    pub(super) fn total_bytes(&self) -> u64 {
        self.beside.bytes.get()
    }

    /// The bytes of a view.
    pub(super) fn view_bytes(&self, index: Index<View>) -> Result<(&View, &[u8]), String> {
        let number = index.value();
        let view = self.root.buffer_views.get(number).ok_or_else(|| format!("view {number} does not exist"))?;
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        let range = || {
            let end = start.checked_add(view.byte_length.0)?;
            let buffer = self.buffers.get(view.buffer.value())?;
            buffer.get(usize::try_from(start).ok()?..usize::try_from(end).ok()?)
        };
        range().map(|bytes| (view, bytes)).ok_or_else(|| format!("view {number} lies outside its buffer"))
    }
}

/// How to write a scene without an extension that it requires.
fn hint_without_extension(name: &str) -> &'static str {
    match name {
        name if name.contains("texture") => "write its pictures as PNG or JPEG when you export it",
        name if name.contains("compression") => "export it without geometry compression",
        name if name.contains("instancing") => "export each of its instances as a node of its own",
        _ => "export it without this extension",
    }
}

/// The files in a file's folder to which it refers. Each is read once, however often and in whatever spelling it is named.
struct AdjacentFiles {
    folder: PathBuf,
    /// The files that were read, by their paths in the folder.
    read: RefCell<BTreeMap<PathBuf, Rc<Vec<u8>>>>,
    /// Length of the main file and of these files.
    bytes: Cell<u64>,
}

impl AdjacentFiles {
    /// The bytes that a relative URI refers to: a file in the folder, or data within the URI itself.
    fn read_uri(&self, uri: &str) -> Result<Rc<Vec<u8>>, String> {
        if let Some(data) = uri.strip_prefix("data:") {
            let (_, text) = data.split_once(";base64,").ok_or("a data URI without base64")?;
            let decoded = base64::Engine::decode(&base64::engine::general_purpose::STANDARD, text);
            return decoded.map(Rc::new).map_err(|error| error.to_string());
        }
        let target = uri_target(uri)?;
        if let Some(known) = self.read.borrow().get(&target) {
            return Ok(known.clone());
        }
        let bytes = file_error::read_bytes(&self.folder.join(&target), MAX_BYTES, EXPORT_HINT)
            .map_err(|error| error.to_string())?;
        self.bytes.set(self.bytes.get().saturating_add(bytes.len() as u64));
        let bytes = Rc::new(bytes);
        self.read.borrow_mut().insert(target, bytes.clone());
        Ok(bytes)
    }
}

/// The file that a relative URI names, relative to the folder of the file that contains the URI.
fn uri_target(uri: &str) -> Result<PathBuf, String> {
    let name = uri.replace("%20", " ");
    let mut target = PathBuf::new();
    for part in Path::new(&name).components() {
        match part {
            Component::Normal(part) if !name.contains(':') => target.push(part),
            Component::CurDir => {}
            _ => return Err(format!("{uri:.80?} is not a file beside the scene")),
        }
    }
    Ok(target)
}

/// The parts of a document that name other files.
#[derive(Default, Deserialize)]
#[serde(default)]
struct GltfAddresses {
    buffers: Vec<GltfAddress>,
    images: Vec<GltfAddress>,
}

#[derive(Deserialize)]
struct GltfAddress {
    uri: Option<String>,
}

/// The existing files to which a GLB or glTF file refers. Errors in the file are ignored here, because [`GltfAsset::read`]
/// reports them.
pub(crate) fn files_beside(file: &Path) -> Vec<PathBuf> {
    let addresses: Option<GltfAddresses> = read_document(file).and_then(|text| serde_json::from_slice(&text).ok());
    let GltfAddresses { buffers, images } = addresses.unwrap_or_default();
    let targets = buffers.into_iter().chain(images).filter_map(|address| uri_target(&address.uri?).ok());
    let folder = file.parent().unwrap_or(Path::new(""));
    targets.map(|target| folder.join(target)).filter(|file| file.is_file()).collect()
}

/// The document of a glTF or GLB file.
fn read_document(file: &Path) -> Option<Vec<u8>> {
    // Opening a pipe would block until another process writes into it.
    if !file.is_file() {
        return None;
    }
    let mut opened = File::open(file).ok()?;
    let mut text = Vec::new();
    opened.by_ref().take(GLB_HEAD_BYTES).read_to_end(&mut text).ok()?;
    // After "glTF" a GLB has its version and length, and then the length and kind of its document.
    let length = text.strip_prefix(b"glTF").and_then(|rest| rest.get(8..)?.first_chunk::<4>());
    let length = length.map(|bytes| u32::from_le_bytes(*bytes));
    if length.is_some() {
        text.clear();
    }
    opened.take(length.map_or(MAX_BYTES, u64::from)).read_to_end(&mut text).ok()?;
    Some(text)
}
