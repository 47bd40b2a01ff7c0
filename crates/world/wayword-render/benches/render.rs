//! How long drawing takes at 640x480: scan-like meshes of half a million and of 1.1 million triangles, and a cube map.

#![allow(clippy::expect_used, clippy::print_stdout, missing_docs, reason = "a benchmark may fail and print")]

use criterion::{Criterion, criterion_group, criterion_main};
use glam::{DMat3, DVec3, Vec2, Vec3};
use std::hint::black_box;
use std::time::Instant;
use wayword_render::{
    CubeFace, CubeMap, Mesh, MeshMaterial, PinholeCamera, RenderScene, Texture, TextureFilter, render_scene,
    sample_view,
};

/// How many poses pictures are taken from, all over the scan.
const POSES: u32 = 100;

/// How fine the mesh of a scan is.
struct Grain {
    name: &'static str,
    /// Squares along a metre of wall, two triangles each.
    per_metre: f32,
    /// Squares around and along a column.
    column: [u32; 2],
}

const HALF_A_MILLION: Grain = Grain { name: "500k", per_metre: 24.0, column: [60, 30] };
const A_MILLION: Grain = Grain { name: "1.1M", per_metre: 34.5, column: [86, 43] };

/// A bumpy box of 12 x 9 x 3 m seen from inside, with 40 bumpy columns in it: triangles of 3 or 4 cm, as scanners give.
/// Each surface has its own part of the texture: a quarter of its side for a wall, an eighth for a column.
fn scan(grain: &Grain) -> Mesh {
    let mut mesh = Mesh { id: 1, ..Mesh::default() };
    let (a, b, c) = (12.0, 9.0, 3.0);
    let walls: [[Vec3; 3]; 6] = [
        [Vec3::ZERO, Vec3::X * a, Vec3::Y * b],
        [Vec3::Z * c, Vec3::Y * b, Vec3::X * a],
        [Vec3::ZERO, Vec3::Z * c, Vec3::X * a],
        [Vec3::Y * b, Vec3::X * a, Vec3::Z * c],
        [Vec3::ZERO, Vec3::Y * b, Vec3::Z * c],
        [Vec3::X * a, Vec3::Z * c, Vec3::Y * b],
    ];
    for (n, [origin, across, up]) in walls.into_iter().enumerate() {
        let size = [across, up].map(|side| (side.length() * grain.per_metre) as u32);
        grid(&mut mesh, size, part(n as u32, 4), |s, t| origin + across * s + up * t);
    }
    for column in 0..40 {
        let (x, y) = (0.9 + (column % 8) as f32 * 1.45, 0.9 + (column / 8) as f32 * 1.75);
        grid(&mut mesh, grain.column, part(column + 24, 8), |s, t| {
            let (sin, cos) = (s * std::f32::consts::TAU).sin_cos();
            Vec3::new(x + 0.35 * cos, y + 0.35 * sin, 1.2 * t)
        });
    }
    mesh
}

/// Corner and side of the `n`th of `side` x `side` squares of the texture.
fn part(n: u32, side: u32) -> [f32; 3] {
    [(n % side) as f32, (n / side) as f32, 1.0].map(|v| v / side as f32)
}

fn grid(mesh: &mut Mesh, [columns, rows]: [u32; 2], [u, v, side]: [f32; 3], place: impl Fn(f32, f32) -> Vec3) {
    let first = mesh.positions.len() as u32;
    for row in 0..=rows {
        for column in 0..=columns {
            let (s, t) = (column as f32 / columns as f32, row as f32 / rows as f32);
            let point = place(s, t);
            let bump = (point.x * 23.0 + point.z * 31.0).sin() * (point.y * 19.0 + point.z * 17.0).cos() * 0.01;
            mesh.positions.push(point + bump);
            mesh.uvs.push(Vec2::new(u + side * s, v + side * t));
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let corner = first + row * (columns + 1) + column;
            let above = corner + columns + 1;
            mesh.triangles.extend([[corner, corner + 1, above + 1], [corner, above + 1, above]]);
        }
    }
}

fn scene(grain: &Grain) -> RenderScene {
    let texel = |i: u32| {
        let (x, y) = (i % 4096, i / 4096);
        [(x ^ y) as u8, (x >> 4) as u8, (y >> 4) as u8, 255]
    };
    let texture = Texture::new(4096, 4096, (0..4096 * 4096).map(texel).collect()).expect("sizes agree");
    let material = MeshMaterial { texture: Some(0), ..MeshMaterial::default() };
    let mesh = scan(grain);
    println!("{}: {} triangles", grain.name, mesh.triangles.len());
    RenderScene::new(vec![mesh], vec![material], vec![texture]).expect("the mesh is sound")
}

fn pose(step: u32) -> PinholeCamera {
    let position = DVec3::new(1.65 + 1.45 * f64::from(step % 7), 1.8 + 1.75 * f64::from(step % 4), 1.5);
    let vertical_fov_rad = 60f64.to_radians();
    PinholeCamera {
        position,
        heading_rad: f64::from(step),
        elevation_rad: -0.2,
        vertical_fov_rad,
        width: 640,
        height: 480,
    }
}

/// Draws one view after another. Criterion's figure is the mean over the poses; the printed figure is the median.
fn views(criterion: &mut Criterion) {
    for grain in [HALF_A_MILLION, A_MILLION] {
        let mut scene = scene(&grain);
        for (filter, named) in [(TextureFilter::Bilinear, "bilinear"), (TextureFilter::Trilinear, "trilinear")] {
            scene = scene.with_filter(filter);
            let name = format!("view 640x480 of {} triangles, 4096 texture, {named}", grain.name);
            print_times(&name, |step| render_scene(&scene, &pose(step)).expect("the camera is sound"));
            let mut step = 0;
            criterion.bench_function(&name, |bencher| {
                bencher.iter(|| {
                    step = (step + 1) % POSES;
                    render_scene(&scene, &pose(step))
                });
            });
        }
    }
}

/// Prints the times of one pose after another. On a busy machine the least time is a better figure than criterion's mean.
fn print_times<P>(name: &str, draw: impl Fn(u32) -> P) {
    let each_ms = |step| {
        let start = Instant::now();
        black_box(draw(step));
        start.elapsed().as_secs_f64() * 1e3
    };
    let mut each_ms: Vec<f64> = (0..POSES).map(each_ms).collect();
    each_ms.sort_by(f64::total_cmp);
    let quantile = |percent: usize| each_ms[percent * (each_ms.len() - 1) / 100];
    let [least, median, most, slowest] = [0, 50, 90, 100].map(quantile);
    println!(
        "{name}: median of {POSES} poses {median:.1} ms, from {least:.1} to {slowest:.1}, nine of ten up to {most:.1}"
    );
}

fn cube(criterion: &mut Criterion) {
    let face =
        |n: u32| CubeFace { side_px: 512, rgb: (0..512 * 512 * 3).map(|i| ((i * (n + 3)) >> 5) as u8).collect() };
    let cube = CubeMap::new(std::array::from_fn(|n| face(n as u32))).expect("the faces are square");
    let name = "cube map to view 640x480";
    let view = |step: u32| {
        let heading = 0.1 * f64::from(step);
        sample_view(&cube, &DMat3::IDENTITY, heading, 0.1, 60f64.to_radians(), 640, 480).expect("the camera is sound")
    };
    print_times(name, view);
    let mut step = 0;
    criterion.bench_function(name, |bencher| {
        bencher.iter(|| {
            step += 1;
            view(step)
        });
    });
}

criterion_group!(benches, views, cube);
criterion_main!(benches);
