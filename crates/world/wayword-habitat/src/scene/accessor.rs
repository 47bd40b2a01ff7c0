//! Reads the numbers in a glTF file through its accessors (glTF 2.0, section 3.6.2). An accessor is a list of entries, such as
//! positions; each entry has one to four components.

use super::asset::GltfAsset;
use gltf::json::{
    Index,
    accessor::{Accessor, ComponentType, Type},
    validation::Checked,
};

/// The entries of an accessor, each of `N` floats; normalised integers become fractions.
pub(super) fn read_floats<const N: usize>(asset: &GltfAsset, index: Index<Accessor>) -> Result<Vec<[f32; N]>, String> {
    let entries = AccessorEntries::from_accessor(asset, index)?;
    let given = entries.components;
    // Colours come with or without alpha: only the first `N` numbers are used.
    if given < N {
        return Err(format!("accessor {} has entries of length {given}, expected {N}", index.value()));
    }
    let mut all = Vec::with_capacity(entries.count);
    for entry in 0..entries.count {
        all.push(std::array::from_fn(|at| entries.float_at(entry, at)));
    }
    Ok(all)
}

/// The entries of an accessor of whole numbers, one each.
pub(super) fn read_indices(asset: &GltfAsset, index: Index<Accessor>) -> Result<Vec<u32>, String> {
    let entries = AccessorEntries::from_accessor(asset, index)?;
    let whole = matches!(entries.kind, ComponentType::U8 | ComponentType::U16 | ComponentType::U32);
    if !whole || entries.components != 1 {
        return Err(format!("accessor {} does not hold indices", index.value()));
    }
    Ok((0..entries.count).map(|entry| entries.index_at(entry)).collect())
}

/// The entries of an accessor; all of them lie within `bytes`.
struct AccessorEntries<'a> {
    bytes: &'a [u8],
    /// Distance from one entry to the next, bytes.
    stride: usize,
    count: usize,
    /// Numbers of an entry.
    components: usize,
    kind: ComponentType,
    is_normalised: bool,
}

impl<'a> AccessorEntries<'a> {
    fn from_accessor(asset: &'a GltfAsset, index: Index<Accessor>) -> Result<Self, String> {
        let number = index.value();
        let wrong = |reason: &str| format!("accessor {number} {reason}");
        let accessor = asset.root.accessors.get(number).ok_or_else(|| wrong("does not exist"))?;
        if accessor.sparse.is_some() {
            return Err(wrong("is sparse, which Habitat does not read either"));
        }
        let view = accessor.buffer_view.ok_or_else(|| wrong("has no bytes"))?;
        let (view, bytes) = asset.view_bytes(view).map_err(|reason| wrong(&reason))?;
        let Checked::Valid(component) = accessor.component_type else { return Err(wrong("has an unknown type")) };
        let Checked::Valid(shape) = accessor.type_ else { return Err(wrong("has an unknown shape")) };
        let components = match shape {
            Type::Scalar => 1,
            Type::Vec2 => 2,
            Type::Vec3 => 3,
            Type::Vec4 => 4,
            Type::Mat2 | Type::Mat3 | Type::Mat4 => return Err(wrong("holds matrices")),
        };
        let size = components * component.0.size();
        let stride = view.byte_stride.map_or(size, |stride| stride.0.max(1));
        let entry_bytes = || {
            let start = usize::try_from(accessor.byte_offset.map_or(0, |offset| offset.0)).ok()?;
            let count = usize::try_from(accessor.count.0).ok()?;
            let end = match count.checked_sub(1) {
                None => start,
                Some(before) => start.checked_add(before.checked_mul(stride)?)?.checked_add(size)?,
            };
            Some((bytes.get(start..end)?, count))
        };
        let (bytes, count) = entry_bytes().ok_or_else(|| wrong("lies outside its view"))?;
        // Without this check a file with overlapping entries could have far more entries than bytes.
        if stride < component.0.size() || count > bytes.len() {
            return Err(wrong("has entries that overlap"));
        }
        Ok(Self { bytes, stride, count, components, kind: component.0, is_normalised: accessor.normalized })
    }

    fn component_bytes<const N: usize>(&self, entry: usize, component: usize) -> [u8; N] {
        let start = entry * self.stride + component * N;
        // The bytes are there, because every entry lies within them.
        self.bytes.get(start..).and_then(|rest| rest.first_chunk()).copied().unwrap_or([0; N])
    }

    fn float_at(&self, entry: usize, component: usize) -> f32 {
        let (value, max_value) = match self.kind {
            ComponentType::F32 => return f32::from_le_bytes(self.component_bytes(entry, component)),
            ComponentType::U8 => (f32::from(u8::from_le_bytes(self.component_bytes(entry, component))), 255.0),
            ComponentType::I8 => (f32::from(i8::from_le_bytes(self.component_bytes(entry, component))), 127.0),
            ComponentType::U16 => (f32::from(u16::from_le_bytes(self.component_bytes(entry, component))), 65_535.0),
            ComponentType::I16 => (f32::from(i16::from_le_bytes(self.component_bytes(entry, component))), 32_767.0),
            // glTF does not normalise these.
            ComponentType::U32 => (u32::from_le_bytes(self.component_bytes(entry, component)) as f32, 1.0),
        };
        if self.is_normalised { (value / max_value).max(-1.0) } else { value }
    }

    fn index_at(&self, entry: usize) -> u32 {
        match self.kind {
            ComponentType::U8 => u32::from(u8::from_le_bytes(self.component_bytes(entry, 0))),
            ComponentType::U16 => u32::from(u16::from_le_bytes(self.component_bytes(entry, 0))),
            _ => u32::from_le_bytes(self.component_bytes(entry, 0)),
        }
    }
}
