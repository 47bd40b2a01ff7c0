//! Turns a house into meshes with materials, textures and baked light, for the renderer and for glTF files.

use super::{
    light::{Factors, Grain, RoomLight, cut},
    model::{Furniture, House},
    objects::shell_id,
    outlook::outlooks,
    shapes::{Look, Part, Shape, shape},
    structure,
    surface::{Pattern, Surface},
    textures,
};
use glam::Vec3;
use std::collections::BTreeMap;
use wayword_render::{Material, Mesh, Texture};

/// How finely floors, walls and ceilings are cut: finely, because shadows fall on them.
const SHELL: Grain = Grain { finest_m: 0.055, widest_m: 0.7 };
/// How finely rugs and mats are cut; shadows fall on them too.
const FLAT: Grain = Grain { finest_m: 0.055, widest_m: 0.25 };
/// How finely everything else is cut.
const THING: Grain = Grain { finest_m: 0.13, widest_m: 0.7 };
/// How far a door's frame reaches to both sides of the wall's middle, metres.
const FRAME_M: f32 = 0.08;

/// A whole house as a renderer or a file format needs it.
pub(super) struct Drawing {
    pub(super) meshes: Vec<Mesh>,
    pub(super) materials: Vec<Material>,
    pub(super) textures: Vec<Texture>,
}

/// The surfaces of everything in a house, world frame, metres, for their geometry alone. They are not cut where the light
/// changes, so there are fewer triangles than for a picture.
#[must_use]
pub fn surfaces(house: &House) -> Vec<Mesh> {
    collect(house, Collector::default()).meshes
}

/// Collects the meshes of everything in a house, cut where the light changes.
pub(super) fn draw(house: &House) -> Drawing {
    collect(house, Collector { cuts: true, ..Collector::default() })
}

/// Builds every part of a house, lights it by its room, and adds it to the meshes.
fn collect(house: &House, mut drawing: Collector) -> Drawing {
    let lights: Vec<_> = (0..house.rooms.len()).map(|index| RoomLight::of(house, index)).collect();
    for (index, light) in lights.iter().enumerate() {
        let shell = [structure::floor(house, index), structure::walls(house, index), structure::ceiling(house, index)];
        for (part, shape) in shell.into_iter().enumerate() {
            drawing.add(shape, shell_id(house, index, part), SHELL, |at, normal| light.on_shell(at, normal));
        }
    }
    for opening in &house.openings {
        let beyond = opening.beyond.unwrap_or(opening.room);
        let along_x = opening.span.along_x;
        let line = opening.span.at as f32 / 100.0;
        let (cx, cy) = house.rooms[opening.room].outline.centre();
        let is_below = (if along_x { cy } else { cx }) as f32 / 100.0 < line;
        drawing.add(structure::opening(house, opening), opening.id, THING, |at, normal| {
            // Across the wall, the light of one room passes into that of the other.
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
    let outlooks = outlooks(house);
    for window in &house.windows {
        let light = &lights[window.room];
        drawing.add(structure::window(house, window, &outlooks), window.id, THING, |at, normal| {
            light.on_thing(at, normal, None)
        });
    }
    if let Some(stairs) = &house.stairs {
        let light = &lights[stairs.room];
        drawing.add(structure::steps(stairs), stairs.id, THING, |at, normal| light.on_thing(at, normal, None));
        drawing
            .add(structure::railing(stairs), stairs.railing_id, THING, |at, normal| light.on_thing(at, normal, None));
    }
    for piece in &house.furniture {
        let light = &lights[piece.room];
        let grain = if piece.kind.is_flat() { FLAT } else { THING };
        drawing.add(standing(piece), piece.id, grain, |at, normal| light.on_thing(at, normal, Some(piece.id)));
    }
    drawing.finish()
}

/// A piece's shape, turned and moved to its place in the house.
fn standing(piece: &Furniture) -> Shape {
    let mut shape = shape(piece.kind, &Look::of(piece));
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
struct Collector {
    /// Whether surfaces are cut where the light changes.
    cuts: bool,
    meshes: Vec<Mesh>,
    materials: Vec<Material>,
    /// The pattern of each texture that some material uses, in order of first use.
    patterns: Vec<Pattern>,
    known: BTreeMap<(Pattern, [u8; 3]), usize>,
}

impl Collector {
    fn add(&mut self, shape: Shape, id: u32, grain: Grain, light: impl Fn(Vec3, Vec3) -> Factors) {
        for mut part in shape.parts {
            let colours = if part.surface.glows {
                vec![[1.0; 3]; part.positions.len()]
            } else if self.cuts {
                cut(&mut part, grain, &light)
            } else {
                part.positions.iter().zip(&part.normals).map(|(at, normal)| light(*at, *normal)).collect()
            };
            let Part { surface, positions, uvs, triangles, .. } = part;
            let material = self.material(surface);
            self.meshes.push(Mesh { positions, uvs, colours, triangles, material, id });
        }
    }

    fn material(&mut self, Surface { pattern, rgb, .. }: Surface) -> usize {
        let (materials, patterns) = (&mut self.materials, &mut self.patterns);
        *self.known.entry((pattern, rgb)).or_insert_with(|| {
            let texture = (pattern != Pattern::Plain).then(|| {
                let seen = patterns.iter().position(|each| *each == pattern);
                seen.unwrap_or_else(|| {
                    patterns.push(pattern);
                    patterns.len() - 1
                })
            });
            let [r, g, b] = rgb.map(|channel| f32::from(channel) / 255.0);
            materials.push(Material { base_colour: [r, g, b, 1.0], texture, double_sided: false });
            materials.len() - 1
        })
    }

    fn finish(self) -> Drawing {
        let textures = self.patterns.into_iter().map(textures::of).collect();
        Drawing { meshes: self.meshes, materials: self.materials, textures }
    }
}
