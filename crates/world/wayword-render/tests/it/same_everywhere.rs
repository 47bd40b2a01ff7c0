//! A picture is the same to the bit on every machine: this test compares it with recorded checksums.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use glam::{DMat3, DVec2, DVec3, Vec2, Vec3};
use wayword_render::{
    CubeFace, CubeMap, Mesh, MeshMaterial, PictureBackground, PinholeCamera, RenderScene, RenderedPicture, Texture,
    TextureFilter, render_scene, sample_view, top_down,
};

/// FNV-1a.
fn checksum(bytes: impl IntoIterator<Item = u8>) -> u64 {
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, |sum, byte| (sum ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

fn of_picture(picture: &RenderedPicture) -> u64 {
    let depths = picture.depth_m.iter().flat_map(|depth| depth.to_bits().to_le_bytes());
    let ids = picture.ids.iter().flat_map(|id| id.to_le_bytes());
    checksum(picture.rgb.iter().copied().chain(depths).chain(ids))
}

/// A textured ground of 20 x 20 m in hills of half a metre, seen from eye height.
fn hills(filter: TextureFilter) -> RenderScene {
    let mut ground = Mesh { id: 4, ..Mesh::default() };
    for i in 0..41u32 * 41 {
        let (x, y) = (i % 41, i / 41);
        let height = ((x * x * 7 + y * 13 + x * y) % 17) as f32 / 34.0;
        ground.positions.push(Vec3::new(x as f32 * 0.5 - 10.0, y as f32 * 0.5 - 10.0, height));
        ground.uvs.push(Vec2::new(x as f32 * 0.4, y as f32 * 0.3));
        ground.colours.push([0.5 + height, 1.0, 1.5 - height]);
    }
    for i in (0..40 * 40).map(|i| i / 40 * 41 + i % 40) {
        ground.triangles.extend([[i, i + 1, i + 42], [i, i + 42, i + 41]]);
    }
    let texel = |i: u32| [(i * 37) as u8, (i / 64 * 3) as u8, (i ^ (i >> 5)) as u8, 255];
    let texture = Texture::new(64, 48, (0..64 * 48).map(texel).collect()).unwrap();
    let material = MeshMaterial { texture: Some(0), base_colour: [0.9, 0.8, 0.7, 1.0], double_sided: false };
    let sky = PictureBackground::Sky { zenith: [60, 110, 200], horizon: [220, 230, 240], nadir: [90, 90, 80] };
    RenderScene::new(vec![ground], vec![material], vec![texture]).unwrap().with_filter(filter).with_background(sky)
}

#[test]
fn pictures_have_the_checksums_they_always_had() {
    let position = DVec3::new(0.3, -1.2, 1.7);
    let (heading_rad, elevation_rad, vertical_fov_rad) = (0.7, -0.3, 1.2);
    let camera = PinholeCamera { position, heading_rad, elevation_rad, vertical_fov_rad, width: 200, height: 150 };
    let plain = of_picture(&render_scene(&hills(TextureFilter::Bilinear), &camera).unwrap());
    let calm = of_picture(&render_scene(&hills(TextureFilter::Trilinear), &camera).unwrap());
    let map = top_down(&hills(TextureFilter::Trilinear), DVec2::splat(-9.0), DVec2::new(9.0, 6.0), 0.4, 0.1).unwrap();
    let faces =
        std::array::from_fn(|n| CubeFace { side_px: 32, rgb: (0..3072).map(|i| (i * (n + 3)) as u8).collect() });
    let pose = DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y);
    let cube = sample_view(&CubeMap::new(faces).unwrap(), &pose, 0.7, -0.3, 1.2, 200, 150).unwrap();
    let sums = [plain, calm, of_picture(&map), checksum(cube)].map(|sum| format!("{sum:016x}"));
    assert_eq!(sums, ["7f9efa7cc3a1c48e", "b47470ff7fdcb440", "c9122cf0d4c891cc", "c28cfaeb8ba43e72"]);
}
