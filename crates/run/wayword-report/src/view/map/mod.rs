//! `wayword view map`: draws a storey of a scene from above, as SVG or PNG, with a path if one is chosen.

mod glyphs;
mod layout;
mod paint;
mod sketch;
mod svg;

use super::{WrittenView, choose_scene, file_kind::FileKind, open_platform, picture, platform_of_texts, walk};
use crate::view::args::{ShownPathArgs, ViewMap};
use layout::MapPlan;
use std::collections::BTreeSet;
use wayword_core::{Path, SceneId, ViewpointGraph};
use wayword_run::{error::CommandError, output::CommandOutput, written_files::write_file};

pub(super) fn write_map(args: &ViewMap, output: &CommandOutput) -> Result<WrittenView, CommandError> {
    let kind = FileKind::one_among(&[FileKind::Svg, FileKind::Png], &args.out)?;
    let asked = platform_of_texts(&args.platform, args.walk.episodes.as_deref());
    kind.check_free(&args.out, asked.data.as_deref())?;
    let platform = open_platform(&asked)?;
    let path = asks_for_path(&args.walk).then(|| walk::choose_path(&args.walk, &asked, &*platform)).transpose()?;
    let scene = match &path {
        Some(path) => path.scene.clone(),
        None => choose_scene(&*platform, args.walk.scan.as_deref())?,
    };
    if let Some(path) = path.as_ref().filter(|path| !path.motion.is_known()) {
        let problem = format!("path {}: it has no poses, so there is no map", path.id);
        return Err(CommandError::usage(problem, "`wayword view path` shows its frames"));
    }
    let graph = platform.graph_for_scene(&scene)?;
    let level = choose_level(args.level, &scene, &graph, path.as_ref(), output)?;
    let above = level.map(|level| platform.ground().look_down(&scene, level)).transpose()?.flatten();
    let plan = MapPlan { graph: &graph, level, above: above.as_ref(), path: path.as_ref() };
    let sketch = layout::sketch_plan(&plan).ok_or_else(|| {
        let problem =
            format!("scene {scene} cannot be drawn as a map: it has no viewpoints, or they are too far apart");
        CommandError::usage(problem, "choose another --scan")
    })?;
    let (bytes, [width, height]) = if kind == FileKind::Svg {
        let size = sketch.size.map(|side| side.ceil() as u32);
        (svg::sketch_svg(&sketch, &map_title(&scene, level, path.as_ref()))?.into_bytes(), size)
    } else {
        let painted = paint::paint_sketch(&sketch)?;
        (picture::encode_png(&painted)?, [painted.width_px(), painted.height_px()])
    };
    write_file(&args.out, &bytes)?;
    let islands = platform.ground().ground_islands(&scene)?;
    Ok(WrittenView { scene, files: vec![args.out.clone()], width, height, frames: 1, islands })
}

/// Whether any flag asks for a path.
fn asks_for_path(walk: &ShownPathArgs) -> bool {
    walk.seed.is_some() || walk.hops.is_some() || walk.metres.is_some() || walk.episodes.is_some()
}

/// The storey that is drawn; `None` if the platform knows no storeys.
fn choose_level(
    asked: Option<u32>,
    scene: &SceneId,
    graph: &ViewpointGraph,
    path: Option<&Path>,
    output: &CommandOutput,
) -> Result<Option<u32>, CommandError> {
    let levels: BTreeSet<u32> = graph.viewpoints().filter_map(|viewpoint| graph.level_of(viewpoint)).collect();
    let level_list = levels.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
    match asked {
        Some(level) if levels.contains(&level) => Ok(Some(level)),
        Some(level) if levels.is_empty() => {
            let problem = format!("--level {level}: the platform does not know the storeys of scene {scene}");
            Err(CommandError::usage(problem, "leave --level out"))
        }
        Some(level) => Err(CommandError::usage(
            format!("--level {level}: scene {scene} has no storey of that number"),
            format!("there are: {level_list}"),
        )),
        None => {
            let starts = path.and_then(|path| path.frames.first()?.level).filter(|level| levels.contains(level));
            let level = starts.or_else(|| levels.first().copied());
            if let Some(level) = level.filter(|_| levels.len() > 1) {
                output.say(format_args!(
                    "drawing storey {level} (the scene has storeys {level_list}); choose another with --level"
                ));
            }
            Ok(level)
        }
    }
}

/// The title of the map: scene, storey and path.
fn map_title(scene: &SceneId, level: Option<u32>, path: Option<&Path>) -> String {
    let level = level.map_or(String::new(), |level| format!(", storey {level}"));
    let path = path.map_or(String::new(), |path| format!(", path {}", path.id));
    format!("{scene}{level}{path}")
}
