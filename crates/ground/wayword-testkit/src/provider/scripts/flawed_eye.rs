//! A scripted vision model with flaws. It looks up the true contents of a picture in the gallery and answers questions about
//! it, but hallucinates some objects, misses others and contradicts itself, with shares that the test sets and a seed.

use crate::provider::{GalleryThing, ModelScript, PictureGallery, PictureScenery, ScriptRequest, barcode};
use rand::{Rng, SeedableRng, seq::SliceRandom};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

/// Answers questions about the pictures of a gallery, with mistakes now and then. The same question about the same
/// picture gets the same answer.
#[derive(Debug, Clone)]
pub struct FlawedEye {
    /// The true contents of the pictures.
    pub gallery: PictureGallery,
    /// Seed of all draws.
    pub seed: u64,
    /// Share of the objects in a free description that are not there, on average.
    pub hallucinated_share: f64,
    /// Share of the true objects that a free description leaves out.
    pub miss_share: f64,
    /// How often it answers no, and so contradicts itself, when it is asked whether one of its hallucinated objects is there.
    /// A question exposes a hallucination with this probability.
    pub contradiction_share: f64,
    /// How often it denies an object that is there, when it is asked about it.
    pub blindness_share: f64,
    /// How often it marks an object that is there as uncertain, if the request asks how sure it is.
    pub hedge_share: f64,
    /// How often it marks a hallucinated object as uncertain. Real models are less sure of those.
    pub doubt_share: f64,
    /// Share of the views for which its structured answer does not have the form that was asked for.
    pub misshapen_share: f64,
}

impl FlawedEye {
    /// An eye that hallucinates this share of the objects that it names, and denies 70 % of these when asked about them. It
    /// misses a tenth of the true objects and denies 3 % of them. In structured answers it is uncertain of a tenth of the true
    /// objects and of 45 % of the hallucinated ones, and 2 % of these answers do not have the right form.
    #[must_use]
    pub fn new(gallery: PictureGallery, seed: u64, hallucinated_share: f64) -> Self {
        Self {
            gallery,
            seed,
            hallucinated_share,
            miss_share: 0.1,
            contradiction_share: 0.7,
            blindness_share: 0.03,
            hedge_share: 0.1,
            doubt_share: 0.45,
            misshapen_share: 0.02,
        }
    }
}

/// The objects that it can hallucinate.
const HALLUCINATED_NAMES: [&str; 16] = [
    "piano",
    "treadmill",
    "fireplace",
    "refrigerator",
    "washing machine",
    "bathtub",
    "guitar",
    "bicycle",
    "clock",
    "vase",
    "fan",
    "microwave",
    "suitcase",
    "bookshelf",
    "sofa",
    "chandelier",
];
/// How many true objects a description names at most. Further ones are left out.
const MAX_NAMED_OBJECTS: usize = 9;

impl ModelScript for FlawedEye {
    fn reply(&self, request: &ScriptRequest) -> String {
        let Some(picture) = request.pictures.first() else { return "I see no picture.".to_owned() };
        let known = barcode::read_number(picture).and_then(|id| Some((id, self.gallery.find_scenery(id)?)));
        let (id, scenery) = known.unwrap_or_else(|| invent_scenery(picture));
        let text = request.prompt();
        if text.contains("as JSON") {
            let again = text.contains("could not be read");
            return PictureLook { eye: self, id, scenery: &scenery }.structured_reply(again);
        }
        let question = text.rsplit("Question:").next().unwrap_or(text).replace("Answer:", "");
        let question = question.rsplit("sentence:").next().unwrap_or_default().trim().to_lowercase();
        PictureLook { eye: self, id, scenery: &scenery }.answer_question(&question)
    }
}

/// Invents the contents of a picture that is not in the gallery. They are drawn from its bytes, so the same picture always gets
/// the same contents.
fn invent_scenery(picture: &[u8]) -> (u64, PictureScenery) {
    const INVENTED_NAMES: [&str; 12] =
        ["sofa", "lamp", "table", "chair", "bed", "mirror", "plant", "desk", "cabinet", "picture", "rug", "sink"];
    const INVENTED_ROOMS: [&str; 4] = ["bedroom", "kitchen", "hallway", "living room"];
    let hash: [u8; 32] = Sha256::digest(picture).into();
    let mut rng = ChaCha8Rng::from_seed(hash);
    let mut names = INVENTED_NAMES;
    let (names, _) = names.partial_shuffle(&mut rng, 4);
    let mut thing = |name: &&str| GalleryThing {
        name: (*name).to_owned(),
        third: rng.random_range(0..3),
        colour: None,
        is_far: false,
    };
    let things = names.iter().map(&mut thing).collect();
    let room = INVENTED_ROOMS[usize::from(hash[0]) % INVENTED_ROOMS.len()].to_owned();
    (rng.random(), PictureScenery { room: Some(room), things })
}

/// One picture with its contents, as one eye looks at it.
struct PictureLook<'a> {
    eye: &'a FlawedEye,
    /// The number of the picture, which all draws depend on.
    id: u64,
    scenery: &'a PictureScenery,
}

impl PictureLook<'_> {
    /// A generator for draws about this picture. Equal purposes draw the same.
    fn rng_for_purpose(&self, about: &str) -> ChaCha8Rng {
        let mut hash = Sha256::new();
        hash.update(self.eye.seed.to_le_bytes());
        hash.update(self.id.to_le_bytes());
        hash.update(about);
        ChaCha8Rng::from_seed(hash.finalize().into())
    }

    /// A draw that is true with probability `share`.
    fn draw_chance(&self, share: f64, about: &str) -> bool {
        self.rng_for_purpose(about).random_bool(share.clamp(0.0, 1.0))
    }

    /// The true things that a description names, each once, with the third of the picture that they are in.
    fn noticed_things(&self) -> Vec<(&str, u8)> {
        let mut noticed: Vec<(&str, u8)> = Vec::new();
        for GalleryThing { name, third, .. } in &self.scenery.things {
            if !noticed.iter().any(|(before, _)| before == name)
                && noticed.len() < MAX_NAMED_OBJECTS
                && !self.draw_chance(self.eye.miss_share, &format!("miss {name}"))
            {
                noticed.push((name, *third));
            }
        }
        noticed
    }

    /// The objects that it hallucinates in this picture, with the third that it places them in.
    fn hallucinated_things(&self) -> Vec<(&'static str, u8)> {
        let is_there = |object: &str| {
            let last_word = object.rsplit(' ').next().unwrap_or(object);
            self.scenery
                .things
                .iter()
                .any(|thing| thing.name.contains(last_word) || object.contains(thing.name.as_str()))
        };
        let mut rng = self.rng_for_purpose("ghosts");
        let share = self.eye.hallucinated_share.clamp(0.0, 0.9);
        let mean = self.noticed_things().len() as f64 * share / (1.0 - share);
        let count = mean.floor() as usize + usize::from(rng.random_bool(mean.fract()));
        let mut candidates: Vec<&'static str> =
            HALLUCINATED_NAMES.into_iter().filter(|object| !is_there(object)).collect();
        candidates.shuffle(&mut rng);
        candidates.into_iter().take(count).map(|object| (object, rng.random_range(0..3))).collect()
    }

    /// The answer to a question in lower case. The words of the question decide its kind.
    fn answer_question(&self, question: &str) -> String {
        let starts = |leads: &[&str]| leads.iter().any(|lead| question.starts_with(lead));
        if starts(&["is there", "are there", "do you see", "can you see", "is the", "are the", "does the"]) {
            return self.answer_presence(question);
        }
        if question.contains("colour") || question.contains("color") {
            return self.answer_colour(question);
        }
        if question.contains("room") && !question.contains("objects") {
            return self.scenery.room.as_ref().map_or("I am not sure.".to_owned(), |room| format!("This is a {room}."));
        }
        match () {
            () if question.contains("left") => self.describe_third(0, "On the left"),
            () if question.contains("right") => self.describe_third(2, "On the right"),
            () if question.contains("middle") || question.contains("centre") => self.describe_third(1, "In the middle"),
            () if question.contains("describe") || question.contains("objects") || question.contains("see") => {
                self.describe_picture()
            }
            () => "I am not sure.".to_owned(),
        }
    }

    /// A sentence that lists true and hallucinated objects, in random order.
    fn describe_picture(&self) -> String {
        let mut named: Vec<(&str, u8)> = self.noticed_things();
        named.extend(self.hallucinated_things());
        named.shuffle(&mut self.rng_for_purpose("order"));
        let items: Vec<String> =
            named.iter().map(|(name, third)| format!("{} {}", with_article(name), place_phrase(*third))).collect();
        match items.as_slice() {
            [] => "I cannot see anything of note.".to_owned(),
            [only] => format!("I can see {only}."),
            [before @ .., last] => format!("I can see {} and {last}.", before.join(", ")),
        }
    }

    /// The answer to a structured request: JSON with all things. If the first answer for a view is misshapen, `again` gives one
    /// in the right form.
    fn structured_reply(&self, again: bool) -> String {
        if !again && self.draw_chance(self.eye.misshapen_share, "form") {
            return self.describe_picture();
        }
        let side = |third: u8| ["left", "middle", "right"][usize::from(third.min(2))];
        let item = |thing: &GalleryThing, guessed: bool| {
            let name = &thing.name;
            // 30 % of the uncertain things come as two alternatives.
            let name = if guessed && self.draw_chance(0.3, &format!("or {name}")) {
                format!("{name} or cabinet")
            } else {
                name.clone()
            };
            json!({
                "name": name, "colours": thing.colour.iter().collect::<Vec<_>>(), "material": "", "detail": "",
                "side": side(thing.third), "distance": if thing.is_far { "far" } else { "near" },
                "sure": if guessed { "perhaps" } else { "sure" },
            })
        };
        let noticed = self.noticed_things();
        // Who sees several of a kind lists two.
        let real = noticed.iter().flat_map(|(name, _)| {
            let is_hedged = self.draw_chance(self.eye.hedge_share, &format!("hedge {name}"));
            let alike = self.scenery.things.iter().filter(|thing| thing.name == *name).take(2);
            alike.map(|thing| item(thing, is_hedged)).collect::<Vec<_>>()
        });
        let hallucinated = self.hallucinated_things();
        let hallucinated = hallucinated.iter().map(|(name, third)| {
            let thing = GalleryThing { name: (*name).to_owned(), third: *third, colour: None, is_far: false };
            item(&thing, self.draw_chance(self.eye.doubt_share, &format!("doubt {name}")))
        });
        let mut things: Vec<Value> = real.chain(hallucinated).collect();
        things.shuffle(&mut self.rng_for_purpose("order"));
        let ways: Vec<Value> = noticed
            .iter()
            .filter(|(name, _)| name.contains("door"))
            .map(|(name, third)| json!({ "kind": name, "side": side(*third), "leads_to": "unknown" }))
            .collect();
        let stands_out: Vec<&str> = noticed.first().map(|(name, _)| *name).into_iter().collect();
        let room = self.scenery.room.as_deref().unwrap_or("unknown");
        let answer =
            json!({ "room": room, "room_sure": "sure", "ways_out": ways, "things": things, "stands_out": stands_out });
        // Models put JSON into a fence now and then; here a fifth of the answers.
        if self.draw_chance(0.2, "fence") { format!("```json\n{answer}\n```") } else { answer.to_string() }
    }

    /// A sentence about the objects in a third of the picture.
    fn describe_third(&self, third: u8, lead: &str) -> String {
        let all = self.noticed_things().into_iter().chain(self.hallucinated_things());
        let there: Vec<String> = all.filter(|(_, at)| *at == third).map(|(name, _)| with_article(name)).collect();
        if there.is_empty() { "I am not sure.".to_owned() } else { format!("{lead} there is {}.", there.join(" and ")) }
    }

    /// The answer to whether an object is there.
    fn answer_presence(&self, question: &str) -> String {
        let real = self.scenery.things.iter().find(|thing| mentions_name(question, &thing.name));
        let object = self.hallucinated_things().into_iter().find(|(name, _)| mentions_name(question, name));
        let (affirms, third) = match (real, object) {
            (Some(GalleryThing { name, third, .. }), _) => {
                (!self.draw_chance(self.eye.blindness_share, &format!("blind {name}")), *third)
            }
            (None, Some((name, third))) => {
                (!self.draw_chance(self.eye.contradiction_share, &format!("admit {name}")), third)
            }
            (None, None) => (false, 0),
        };
        match (affirms, self.rng_for_purpose(question).random_range(0..3)) {
            (true, 0) => format!("Yes, it is {}.", place_phrase(third)),
            (true, _) => "Yes.".to_owned(),
            (false, 0) => "No.".to_owned(),
            (false, 1) => "No, I don't see one.".to_owned(),
            (false, _) => "No, there isn't.".to_owned(),
        }
    }

    /// The answer to a question about the colour of a thing.
    fn answer_colour(&self, question: &str) -> String {
        let thing = self.scenery.things.iter().find(|thing| mentions_name(question, &thing.name));
        match thing {
            Some(GalleryThing { name, colour: Some(colour), .. }) => format!("The {name} is {colour}."),
            _ => "I am not sure.".to_owned(),
        }
    }
}

/// Whether a question contains the words of a name, in singular or plural.
fn mentions_name(question: &str, name: &str) -> bool {
    let words = |text: &str| {
        let words = text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
        words.map(|word| word.trim_end_matches('s').to_owned()).collect::<Vec<_>>()
    };
    let (question, name) = (words(question), words(&name.to_lowercase()));
    !name.is_empty() && question.windows(name.len()).any(|window| window == name)
}

/// A name with its article.
fn with_article(name: &str) -> String {
    if name.starts_with(['a', 'e', 'i', 'o', 'u']) { format!("an {name}") } else { format!("a {name}") }
}

/// The words for a third of a picture: 0 left, 1 middle, 2 right.
fn place_phrase(third: u8) -> &'static str {
    match third {
        0 => "on the left",
        1 => "in the middle",
        _ => "on the right",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thing(name: &str) -> GalleryThing {
        GalleryThing { name: name.to_owned(), third: 1, colour: None, is_far: false }
    }

    fn eye(hallucinated_share: f64) -> FlawedEye {
        let gallery = PictureGallery::default();
        for id in 0..500 {
            let names = ["bed", "lamp", "wardrobe", "mirror", "door", "table"];
            let things = names.iter().take(2 + id as usize % 5).map(|name| thing(name)).collect();
            gallery.add_picture(id, PictureScenery { room: Some("bedroom".into()), things });
        }
        FlawedEye::new(gallery, 3, hallucinated_share)
    }

    fn look<T>(eye: &FlawedEye, id: u64, see: impl FnOnce(&PictureLook<'_>) -> T) -> T {
        let scenery = eye.gallery.find_scenery(id).unwrap();
        see(&PictureLook { eye, id, scenery: &scenery })
    }

    #[test]
    fn hallucinated_objects_have_their_share_of_all_named_objects() {
        let eye = eye(0.15);
        let counts =
            (0..500).map(|id| look(&eye, id, |look| (look.hallucinated_things().len(), look.noticed_things().len())));
        let (hallucinated, real) = counts.fold((0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
        let share = hallucinated as f64 / (hallucinated + real) as f64;
        assert!((0.12..0.18).contains(&share), "{share}");
    }

    #[test]
    fn eye_admits_most_hallucinated_objects_and_denies_absent_ones() {
        let eye = eye(0.3);
        let (mut admitted, mut asked) = (0, 0);
        for id in 0..500 {
            look(&eye, id, |look| {
                for (object, _) in look.hallucinated_things() {
                    asked += 1;
                    admitted += i32::from(
                        look.answer_question(&format!("is there really {}?", with_article(object))).starts_with("No"),
                    );
                }
                assert!(look.answer_question("is there an elephant?").starts_with("No"));
            });
        }
        assert!(asked > 200 && (60..80).contains(&(100 * admitted / asked)), "{admitted} of {asked}");
    }

    #[test]
    fn the_same_question_has_the_same_answer() {
        let eye = eye(0.15);
        for question in ["describe what you see", "is there a bed?", "which room is this?", "what is on the left?"] {
            assert_eq!(
                look(&eye, 7, |look| look.answer_question(question)),
                look(&eye, 7, |look| look.answer_question(question))
            );
        }
        assert_eq!(look(&eye, 7, |look| look.answer_question("which room is this?")), "This is a bedroom.");
    }
}
