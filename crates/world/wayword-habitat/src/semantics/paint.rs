//! The colours of painted semantic meshes, as Habitat looks them up in the list of objects, and how many of them the list has.
//!
//! Habitat takes the vertex colours of a `.glb` for linear light, and converts them to sRGB before it looks them up
//! (`BaseMesh::convertMeshColors`). It looks up the texels of painted textures as they are stored
//! (`ResourceManager::convertRGBToSemanticId`).

use glam::Vec3;
use std::{collections::BTreeMap, path::Path};
use wayword_core::SceneLack;

/// Least share of a mesh's painted triangles that the list has to know. With fewer, objects are missing in views.
const MIN_KNOWN_SHARE: f64 = 0.9;
/// The colour of surfaces without an object: Habitat gives it to none (`ResourceManager::loadTextures`).
const UNPAINTED: [u8; 3] = [0; 3];
const LINEAR_HINT: &str = "Habitat takes vertex colours for linear light and converts them to sRGB before it looks them up, and \
    these were stored without that. Where `wayword house` of an earlier version wrote the files, write them again: `wayword house \
    --seed SEED --paths 0 --out FOLDER`, with the number in the scene's name. In other meshes store each channel as linear light";
const LIST_HINT: &str = "put the list beside the mesh that was made with it: both come from one export or one download";
const PAINT_HINT: &str = "paint its vertices (COLOR_0) or its textures in the colours of the list";

/// The colour of a triangle, and the one that it had if its vertex colour were not converted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TrianglePaint {
    pub(super) colour: [u8; 3],
    unconverted: [u8; 3],
}

impl TrianglePaint {
    /// The paint of a texel.
    pub(super) fn from_texel(texel: [u8; 3]) -> Self {
        Self { colour: texel, unconverted: texel }
    }

    /// The paint of a vertex, from the factors that the file has for it.
    pub(super) fn from_vertex(factors: [f32; 3]) -> Self {
        let bytes = |shares: [f32; 3]| (Vec3::from_array(shares) * 255.0 + 0.5).as_u8vec3().to_array();
        Self { colour: bytes(factors.map(srgb_from_linear)), unconverted: bytes(factors) }
    }
}

/// Linear light as a share of sRGB's range (IEC 61966-2-1).
fn srgb_from_linear(light: f32) -> f32 {
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * libm::powf(light, 1.0 / 2.4) - 0.055 }
}

/// Counts the painted triangles of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct PaintTally {
    painted: usize,
    /// Those with a colour of the list.
    known: usize,
    /// Those whose colour would be in the list if vertex colours were not converted.
    known_unconverted: usize,
}

impl PaintTally {
    /// Counts a triangle. Those that are painted as no object do not count.
    pub(super) fn count(&mut self, paint: TrianglePaint, list: &BTreeMap<[u8; 3], usize>) {
        if paint.colour != UNPAINTED {
            self.painted += 1;
            self.known += usize::from(list.contains_key(&paint.colour));
            self.known_unconverted += usize::from(list.contains_key(&paint.unconverted));
        }
    }

    /// The share of triangles that belong to an object; 0 for a mesh without painted triangles.
    fn known_share(self) -> f64 {
        self.known as f64 / self.painted.max(1) as f64
    }

    /// Whether any object can be seen.
    pub(super) fn knows_any(self) -> bool {
        self.known > 0
    }

    /// Whether so many objects are known that one which is not seen is not there.
    pub(super) fn knows_most(self) -> bool {
        self.known_share() >= MIN_KNOWN_SHARE
    }

    /// The fault in the colours, where too few are in the list.
    pub(super) fn lack(self, mesh: &Path, list: &Path) -> Option<SceneLack> {
        if self.knows_most() {
            return None;
        }
        let name = |file: &Path| file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if self.painted == 0 {
            let what = format!("no triangle in {} is painted, so there are no labels", name(mesh));
            return Some(SceneLack { what, hint: PAINT_HINT.to_owned() });
        }
        let fits_unconverted = self.known_unconverted as f64 >= MIN_KNOWN_SHARE * self.painted as f64;
        Some(SceneLack {
            what: format!(
                "{:.1} % of the painted triangles in {} have a colour of {}, so labels are missing",
                100.0 * self.known_share(),
                name(mesh),
                name(list)
            ),
            hint: if fits_unconverted { LINEAR_HINT } else { LIST_HINT }.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_comes_back_from_linear_light() {
        for channel in 0..=255_u8 {
            let encoded = f64::from(channel) / 255.0;
            let light = if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) };
            assert_eq!(TrianglePaint::from_vertex([light as f32; 3]).colour, [channel; 3]);
            // As in a file with 16 bits for a channel.
            let stored = (light * 65_535.0).round() as f32 / 65_535.0;
            assert_eq!(TrianglePaint::from_vertex([stored; 3]).colour, [channel; 3]);
        }
    }

    #[test]
    fn factors_beyond_the_range_are_cut() {
        assert_eq!(TrianglePaint::from_vertex([-1.0, f32::NAN, 9.0]).colour, [0, 0, 255]);
    }

    #[test]
    fn the_lack_tells_colours_without_conversion_from_another_list() {
        let list = BTreeMap::from([([100, 50, 25], 0)]);
        let lack = |paints: &[TrianglePaint]| {
            let mut tally = PaintTally::default();
            paints.iter().for_each(|paint| tally.count(*paint, &list));
            tally.lack(Path::new("a/x.semantic.glb"), Path::new("a/x.semantic.txt"))
        };
        let stored = TrianglePaint::from_vertex([100.0 / 255.0, 50.0 / 255.0, 25.0 / 255.0]);
        let old = lack(&[stored]).unwrap();
        assert!(
            old.what.starts_with("0.0 % of the painted triangles in x.semantic.glb have a colour of x.semantic.txt")
        );
        assert!(old.hint.contains("wayword house --seed SEED"), "{old:?}");
        let foreign = lack(&[TrianglePaint::from_texel([1, 2, 3])]).unwrap();
        assert_eq!(foreign.hint, LIST_HINT);
        let known = TrianglePaint::from_texel([100, 50, 25]);
        let none = TrianglePaint::from_texel(UNPAINTED);
        assert_eq!(lack(&[known, none, none]), None, "surfaces painted as no object do not count");
        let mostly = [&[known; 9][..], &[TrianglePaint::from_texel([9; 3])]].concat();
        assert_eq!(lack(&mostly), None);
        assert!(lack(&mostly[1..]).unwrap().what.starts_with("88.9 %"));
        assert!(lack(&[none]).unwrap().what.starts_with("no triangle in x.semantic.glb is painted"));
    }
}
