//! `wayword view map`: draws a storey of a scene from above, as SVG or PNG, with a path if one is chosen.

mod glyphs;
mod layout;
mod paint;
mod sketch;
mod svg;

use super::{Written, file_kind::FileKind, open, picture, scene, unfinished::Unfinished, walk};
use crate::view::args::{ViewMap, Walk};
use layout::Plan;
use std::collections::BTreeSet;
use wayword_core::{Path, SceneId, ViewpointGraph};
use wayword_run::{error::Error, output::Output};

pub(super) fn write(args: &ViewMap, output: &Output) -> Result<Written, Error> {
    let kind = FileKind::among(&[FileKind::Svg, FileKind::Png], &args.out)?;
    kind.check_free(&args.out, args.platform.data.as_deref())?;
    let platform = open(&args.platform)?;
    let path = asks_for_path(&args.walk).then(|| walk::path(&args.walk, &args.platform, &*platform)).transpose()?;
    let scene = match &path {
        Some(path) => path.scene.clone(),
        None => scene(&*platform, args.walk.scan.as_deref())?,
    };
    if let Some(path) = path.as_ref().filter(|path| !path.motion.is_known()) {
        let problem = format!("path {}: it has no poses, so there is no map", path.id);
        return Err(Error::usage(problem, "`wayword view path` shows its frames"));
    }
    let graph = platform.graph(&scene)?;
    let level = level(args.level, &scene, &graph, path.as_ref(), output)?;
    let above = level.map(|level| platform.look_down(&scene, level)).transpose()?.flatten();
    let plan = Plan { graph: &graph, level, above: above.as_ref(), path: path.as_ref() };
    let sketch = layout::sketch(&plan).ok_or_else(|| {
        let problem =
            format!("scene {scene} cannot be drawn as a map: it has no viewpoints, or they are too far apart");
        Error::usage(problem, "choose another --scan")
    })?;
    let (bytes, [width, height]) = if kind == FileKind::Svg {
        let size = sketch.size.map(|side| side.ceil() as u32);
        (svg::svg(&sketch, &title(&scene, level, path.as_ref()))?.into_bytes(), size)
    } else {
        let painted = paint::paint(&sketch)?;
        (picture::png(&painted)?, [painted.width_px(), painted.height_px()])
    };
    Unfinished::whole(&args.out, &bytes)?;
    let islands = platform.islands(&scene)?;
    Ok(Written { scene, files: vec![args.out.clone()], width, height, frames: 1, islands })
}

/// Whether any flag asks for a path.
fn asks_for_path(walk: &Walk) -> bool {
    walk.seed.is_some() || walk.hops.is_some() || walk.metres.is_some() || walk.episodes.is_some()
}

/// The storey that is drawn; `None` if the platform knows no storeys.
fn level(
    asked: Option<u32>,
    scene: &SceneId,
    graph: &ViewpointGraph,
    path: Option<&Path>,
    output: &Output,
) -> Result<Option<u32>, Error> {
    let levels: BTreeSet<u32> = graph.viewpoints().filter_map(|viewpoint| graph.level(viewpoint)).collect();
    let told = levels.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
    match asked {
        Some(level) if levels.contains(&level) => Ok(Some(level)),
        Some(level) if levels.is_empty() => {
            let problem = format!("--level {level}: the platform does not know the storeys of scene {scene}");
            Err(Error::usage(problem, "leave --level out"))
        }
        Some(level) => Err(Error::usage(
            format!("--level {level}: scene {scene} has no storey of that number"),
            format!("there are: {told}"),
        )),
        None => {
            let starts = path.and_then(|path| path.frames.first()?.level).filter(|level| levels.contains(level));
            let level = starts.or_else(|| levels.first().copied());
            if let Some(level) = level.filter(|_| levels.len() > 1) {
                output.say(format_args!(
                    "drawing storey {level} (the scene has storeys {told}); choose another with --level"
                ));
            }
            Ok(level)
        }
    }
}

/// The title of the map: scene, storey and path.
fn title(scene: &SceneId, level: Option<u32>, path: Option<&Path>) -> String {
    let level = level.map_or(String::new(), |level| format!(", storey {level}"));
    let path = path.map_or(String::new(), |path| format!(", path {}", path.id));
    format!("{scene}{level}{path}")
}
