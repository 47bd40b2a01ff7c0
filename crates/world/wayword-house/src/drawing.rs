//! Turns a house into meshes with materials, textures and baked light, for the renderer and for glTF files.

use super::{
    light::{LightFactors, RoomLight, SurfaceGrain, cut_part},
    model::{FurniturePiece, House},
    objects::shell_id,
    outlook::choose_outlooks,
    shapes::{FurnitureLook, HouseShape, MeshPart, build_shape},
    structure,
    surface::{HouseSurface, SurfacePattern},
    textures,
};
use glam::Vec3;
use std::collections::BTreeMap;
use wayword_render::{Mesh, MeshMaterial, Texture};

/// How finely floors, walls and ceilings are cut: finely, because shadows fall on them.
const SHELL_GRAIN: SurfaceGrain = SurfaceGrain { finest_m: 0.055, widest_m: 0.7 };
/// How finely rugs and mats are cut; shadows fall on them too.
const FLAT_PIECE_GRAIN: SurfaceGrain = SurfaceGrain { finest_m: 0.055, widest_m: 0.25 };
/// How finely everything else is cut.
const THING_GRAIN: SurfaceGrain = SurfaceGrain { finest_m: 0.13, widest_m: 0.7 };
/// How far a door's frame reaches to both sides of the wall's middle, metres.
const FRAME_M: f32 = 0.08;

/// A whole house as a renderer or a file format needs it.
pub(super) struct HouseDrawing {
    pub(super) meshes: Vec<Mesh>,
    pub(super) materials: Vec<MeshMaterial>,
    pub(super) textures: Vec<Texture>,
}

/// The surfaces of everything in a house, world frame, metres, for their geometry alone. They have no light and are not cut
/// where it changes, so they are made in less time than those of a picture, and are far fewer.
#[must_use]
pub fn build_surfaces(house: &House) -> Vec<Mesh> {
    collect_meshes(house, MeshCollector::default()).meshes
}

/// Collects the meshes of everything in a house, lit and cut where the light changes.
pub(super) fn draw_house(house: &House) -> HouseDrawing {
    let drawing = collect_meshes(house, MeshCollector { is_lit: true, ..MeshCollector::default() });
    let textures = drawing.patterns.into_iter().map(textures::texture_for_pattern).collect();
    HouseDrawing { meshes: drawing.meshes, materials: drawing.materials, textures }
}

/// Builds every part of a house, lights it by its room, and adds it to the meshes.
fn collect_meshes(house: &House, mut drawing: MeshCollector) -> MeshCollector {
    let lights: Vec<_> = (0..house.rooms.len()).map(|index| RoomLight::for_room(house, index)).collect();
    for (index, light) in lights.iter().enumerate() {
        let shell = [
            structure::build_floor(house, index),
            structure::build_walls(house, index),
            structure::build_ceiling(house, index),
        ];
        for (part, shape) in shell.into_iter().enumerate() {
            drawing
                .add_shape(shape, shell_id(house, index, part), SHELL_GRAIN, |at, normal| light.on_shell(at, normal));
        }
    }
    for opening in &house.openings {
        let beyond = opening.beyond.unwrap_or(opening.room);
        let along_x = opening.span.along_x;
        let line = opening.span.at as f32 / 100.0;
        let (cx, cy) = house.rooms[opening.room].outline.centre();
        let is_below = (if along_x { cy } else { cx }) as f32 / 100.0 < line;
        drawing.add_shape(structure::build_opening(house, opening), opening.id, THING_GRAIN, |at, normal| {
            // Within the wall, the light of one room passes gradually into that of the other. `past` is 0 at the lower
            // side of the frame and 1 at its upper side.
            let past = ((if along_x { at.y } else { at.x }) - line) / (2.0 * FRAME_M) + 0.5;
            let share = if is_below { past } else { 1.0 - past }.clamp(0.0, 1.0);
            let here = lights[opening.room].on_thing(at, normal, None);
            if share <= 0.0 {
                return here;
            }
            let there = lights[beyond].on_thing(at, normal, None);
            std::array::from_fn(|channel| here[channel] * (1.0 - share) + there[channel] * share)
        });
    }
    let outlooks = choose_outlooks(house);
    for window in &house.windows {
        let light = &lights[window.room];
        drawing.add_shape(structure::build_window(house, window, &outlooks), window.id, THING_GRAIN, |at, normal| {
            light.on_thing(at, normal, None)
        });
    }
    if let Some(stairs) = &house.stairs {
        let light = &lights[stairs.room];
        drawing.add_shape(structure::build_steps(stairs), stairs.id, THING_GRAIN, |at, normal| {
            light.on_thing(at, normal, None)
        });
        drawing.add_shape(structure::build_railing(stairs), stairs.railing_id, THING_GRAIN, |at, normal| {
            light.on_thing(at, normal, None)
        });
    }
    for piece in &house.furniture {
        let light = &lights[piece.room];
        let grain = if piece.kind.is_flat() { FLAT_PIECE_GRAIN } else { THING_GRAIN };
        drawing
            .add_shape(piece_in_place(piece), piece.id, grain, |at, normal| light.on_thing(at, normal, Some(piece.id)));
    }
    drawing
}

/// A piece's shape, turned and moved to its place in the house.
fn piece_in_place(piece: &FurniturePiece) -> HouseShape {
    let mut shape = build_shape(piece.kind, &FurnitureLook::for_piece(piece));
    let area = piece.footprint;
    let middle = Vec3::new((area.x0 + area.x1) as f32, (area.y0 + area.y1) as f32, 2.0 * piece.base_cm as f32) / 200.0;
    let turned = |v: Vec3| match piece.quarter_turns % 4 {
        0 => v,
        1 => Vec3::new(-v.y, v.x, v.z),
        2 => Vec3::new(-v.x, -v.y, v.z),
        _ => Vec3::new(v.y, -v.x, v.z),
    };
    for part in &mut shape.parts {
        part.positions.iter_mut().for_each(|position| *position = turned(*position) + middle);
        part.normals.iter_mut().for_each(|normal| *normal = turned(*normal));
    }
    shape
}

/// Gathers meshes, and gives surfaces that look alike the same material.
#[derive(Default)]
struct MeshCollector {
    /// Whether surfaces are lit, and cut where the light changes.
    is_lit: bool,
    meshes: Vec<Mesh>,
    materials: Vec<MeshMaterial>,
    /// The pattern of each texture that some material uses, in order of first use.
    patterns: Vec<SurfacePattern>,
    /// The index of the material for each pattern in each colour.
    known: BTreeMap<(SurfacePattern, [u8; 3]), usize>,
}

impl MeshCollector {
    /// Adds the parts of a shape, under the number `id` of their object. `light` gives the light at a place with a normal.
    fn add_shape(
        &mut self,
        shape: HouseShape,
        id: u32,
        grain: SurfaceGrain,
        light: impl Fn(Vec3, Vec3) -> LightFactors,
    ) {
        for mut part in shape.parts {
            let colours = match (self.is_lit, part.surface.glows) {
                (false, _) => Vec::new(),
                (true, true) => vec![[1.0; 3]; part.positions.len()],
                (true, false) => cut_part(&mut part, grain, &light),
            };
            let MeshPart { surface, positions, uvs, triangles, .. } = part;
            let material = self.material_index(surface);
            self.meshes.push(Mesh { positions, uvs, colours, triangles, material, id });
        }
    }

    /// The index of the material for a surface; the material is made when it is first needed.
    fn material_index(&mut self, HouseSurface { pattern, rgb, .. }: HouseSurface) -> usize {
        let (materials, patterns) = (&mut self.materials, &mut self.patterns);
        *self.known.entry((pattern, rgb)).or_insert_with(|| {
            let texture = (pattern != SurfacePattern::Plain).then(|| {
                let seen = patterns.iter().position(|each| *each == pattern);
                seen.unwrap_or_else(|| {
                    patterns.push(pattern);
                    patterns.len() - 1
                })
            });
            let [r, g, b] = rgb.map(|channel| f32::from(channel) / 255.0);
            materials.push(MeshMaterial { base_colour: [r, g, b, 1.0], texture, double_sided: false });
            materials.len() - 1
        })
    }
}
