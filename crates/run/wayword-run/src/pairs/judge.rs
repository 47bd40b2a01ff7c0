//! Judges a film with all texts about it.

use super::{
    args::AskedMotion,
    film::{filmed_walk, walk_by_motion},
    records::{FilmRecord, PairRecord},
    texts::{FilmTexts, NamedText},
};
use crate::{
    check::detecting::named_things,
    error::CommandError,
    lookout::DetectorLookout,
    parallel::make_in_parallel,
    pictures::{MOST_PICTURES, WrittenPicture, evenly_chosen, write_small_picture},
    pipeline::path_panoramas,
    platforms::RememberingPlatform,
    team::RoleTeam,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
};
use wayword_checks::Evidence;
use wayword_core::{
    CameraMotion, Caption, ModelError, MotionSource, Path, PathMotion, Platform, PlatformError, ViewGaze,
};
use wayword_follower::{
    alignment::PartedText,
    pair::{FilmedWalk, JudgedPair, PairEye, PairWeights},
};
use wayword_language::{Language, reading::read_instruction};
use wayword_synthesis::{
    detection::{seek_along_path, seek_claims},
    observe::{PlannedView, caption_view, observe_path_with},
    walk::{FrameSelection, ObservedWalk},
};

/// Who sees, and what counts.
pub(super) struct PairJudge<'a> {
    pub(super) platform: &'a dyn Platform,
    /// The players of the roles; none where only a detector looks.
    pub(super) team: Option<&'a RoleTeam>,
    pub(super) lookout: Option<&'a DetectorLookout>,
    pub(super) motion: AskedMotion,
    pub(super) base_rate: f64,
    /// Where the pictures go.
    pub(super) pictures: Option<PathBuf>,
    /// How many views are described at the same time.
    pub(super) threads: usize,
}

impl PairJudge<'_> {
    /// Judges a film. Faults of its files are told in the record; a model that gives no answer is an error.
    ///
    /// # Errors
    /// When a role does not answer, or a picture cannot be written.
    pub(super) fn judge_film(&self, at: usize, film: &FilmTexts) -> Result<FilmRecord, CommandError> {
        match self.judge_readable(at, film) {
            Err(CommandError::Platform(error)) => Ok(FilmRecord {
                at,
                scene: film.scene().to_string(),
                walk: FilmedWalk::default(),
                pictures: BTreeMap::new(),
                pairs: film.texts.iter().map(|text| unjudged(text, film, "its film cannot be read")).collect(),
                failed: Some(error.to_string()),
            }),
            judged => judged,
        }
    }

    fn judge_readable(&self, at: usize, film: &FilmTexts) -> Result<FilmRecord, CommandError> {
        let path = film.find_path(self.platform)?;
        let path = match self.motion {
            AskedMotion::Auto => path,
            AskedMotion::Pictures | AskedMotion::None => Path { motion: PathMotion::Unknown, ..path },
        };
        let world = RememberingPlatform::new(self.platform);
        let evidence = self.see_path(&world, &path, film)?;
        let motion = self.film_motion(&path)?;
        let by_motion = motion.and_then(|motion| walk_by_motion(&path, &evidence, &motion));
        let walk = by_motion.unwrap_or_else(|| filmed_walk(&path, &evidence));
        let eye = match self.team.is_some_and(RoleTeam::sees_labels) {
            true => PairEye::Labels,
            false => PairEye::Pictures,
        };
        let weights = PairWeights::for_eye(eye);
        let pairs = film.texts.iter().map(|text| match read_text(text, &walk) {
            Ok(judged) => {
                let chance = weights.chance_wrong(&judged, self.base_rate);
                PairRecord::new(&text.name, path.scene.as_str(), &text.words, Ok((&judged, &walk, chance)))
            }
            Err(why) => unjudged(text, film, why),
        });
        let pairs = pairs.collect();
        let pictures = self.write_pictures(at, &world, &path)?;
        Ok(FilmRecord { at, scene: path.scene.to_string(), walk, pictures, pairs, failed: None })
    }

    /// How the camera moves over the whole film: by poses, or by the pictures. `None` where the path is all that is known.
    fn film_motion(&self, path: &Path) -> Result<Option<CameraMotion>, PlatformError> {
        let source = match self.motion {
            AskedMotion::Auto if path.motion.is_known() => MotionSource::Poses,
            AskedMotion::Auto | AskedMotion::Pictures => MotionSource::Pictures,
            AskedMotion::None => return Ok(None),
        };
        self.platform.film_motion(&path.scene, source)
    }

    /// The evidence of whoever looks along a path.
    fn see_path(&self, world: &dyn Platform, path: &Path, film: &FilmTexts) -> Result<Evidence, CommandError> {
        let nothing = || Evidence::for_path_alone(path);
        let Some(team) = self.team else {
            let Some(lookout) = self.lookout else { return Ok(nothing()) };
            let names: BTreeSet<String> = film.texts.iter().flat_map(|text| named_things(&text.words)).collect();
            let seen = seek_claims(world, path, &names, lookout.to_seeker())?;
            return Ok(Evidence::from_detector(path, &seen).unwrap_or_else(nothing));
        };
        if team.sees_labels() {
            return Ok(Evidence::from_labels(path, &path_panoramas(world, path)?).unwrap_or_else(nothing));
        }
        let observers = team.observers();
        let talk = |views: &[PlannedView]| -> Result<Vec<_>, ModelError> {
            let ends = |caption: &Result<_, ModelError>| caption.as_ref().is_err_and(ModelError::ends_run);
            // A frame whose camera looked away from the path has no picture.
            let caption = |planned: &PlannedView| match planned.view.is_blank() {
                true => Ok(Caption::default()),
                false => caption_view(&planned.view, observers),
            };
            make_in_parallel(views, self.threads, caption, ends).into_iter().collect()
        };
        let mut seen = observe_path_with(world, path, FrameSelection::Central, observers, &talk)?;
        if let Some(lookout) = self.lookout {
            seek_along_path(world, path, &mut seen, lookout.to_seeker())?;
        }
        Ok(ObservedWalk::new(path.clone(), seen).evidence().unwrap_or_else(nothing))
    }

    /// Writes the pictures that a page shows, at equal distances along a film.
    fn write_pictures(
        &self,
        at: usize,
        world: &dyn Platform,
        path: &Path,
    ) -> Result<BTreeMap<usize, WrittenPicture>, CommandError> {
        let Some(folder) = &self.pictures else { return Ok(BTreeMap::new()) };
        let mut written = BTreeMap::new();
        for number in evenly_chosen(path.frames.len(), MOST_PICTURES) {
            let frame = &path.frames[number];
            let view = world.look_from(&path.scene, frame, ViewGaze::quarter_view(frame.pose.heading))?;
            if let Some(picture) = write_small_picture(folder, format!("{at}_{number}.jpg"), &view)? {
                written.insert(number, picture);
            }
        }
        Ok(written)
    }
}

/// Judges a text; an error, with the reason, for a text that cannot be judged.
fn read_text(text: &NamedText, walk: &FilmedWalk) -> Result<JudgedPair, &'static str> {
    let reading = read_instruction(&text.words, &BTreeSet::new());
    if matches!(reading.language.or_tagged(text.tag.as_deref()), Language::Other(_)) {
        return Err("the text is in another language than English, which `pairs` does not read");
    }
    if walk.places.len() < 2 {
        return Err("its film has fewer than two frames");
    }
    let reading = reading.into_claims();
    let parted = PartedText::from_reading(&text.words, &reading);
    JudgedPair::new(&parted, walk).ok_or("the text tells no step of a way")
}

fn unjudged(text: &NamedText, film: &FilmTexts, why: &str) -> PairRecord {
    PairRecord::new(&text.name, film.scene().as_str(), &text.words, Err(why))
}
