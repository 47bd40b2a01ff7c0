//! Closed lists of words that steer the reading of answers.

use std::sync::LazyLock;

/// A list of words.
type Words = LazyLock<Vec<&'static str>>;
/// A list of runs of words.
type Phrases = LazyLock<Vec<Vec<&'static str>>>;

/// Verbs that take a "not".
pub(super) static AUXILIARIES: Words =
    LazyLock::new(|| split("do does did can could would should will cannot is are was"));

/// Auxiliaries with their "not", and what does as they do.
pub(super) static SHORT: Words =
    LazyLock::new(|| split("don't doesn't didn't can't cannot couldn't won't wouldn't unable"));

/// Verbs whose negation denies what follows.
pub(super) static PERCEIVING: Words = LazyLock::new(|| {
    split(
        "see find spot notice detect identify observe recognize recognise have contain show include feature depict \
         display think believe be out any look appear seem discern perceive",
    )
});

/// Words that may stand between a "not" and such a verb.
pub(super) static MEANWHILE: Words = LazyLock::new(|| {
    split("actually really currently even to make also personally directly that there is are clearly appear seem")
});

/// What a "no" before denies nothing with.
pub(super) static NO_DENIAL: Words = LazyLock::new(|| {
    split("doubt longer one matter idea problem wonder more less fewer way need means reason question place")
});

/// What is not seen, where it is no object: "I cannot see what is on the table", "I see nothing on it".
pub(super) static NO_OBJECT: Words = LazyLock::new(|| {
    split(
        "what how whether if where which who why anything nothing everything much all one it them this that enough \
         well clearly only",
    )
});

/// Words with which another thought begins: no reach goes beyond.
pub(super) static STOPPERS: Words = LazyLock::new(|| {
    split(
        "but however although though except instead only just while whereas because since so which who where yet \
         than rather i it they we then",
    )
});

/// Marks that end every reach.
pub(super) static ENDS: Words = LazyLock::new(|| split(". ! ? ; : ( ) – —"));

/// Words after a noun with which something else is spoken of.
pub(super) static AFTER_NOUN: Words = LazyLock::new(|| {
    split(
        "on in at by near next behind under above over beside between to from with of against along around across \
         inside outside opposite is are was there has have can that i below",
    )
});

/// Words before "of" that keep the reach going: "no sign of a piano".
pub(super) static SIGNS: Words = LazyLock::new(|| {
    split("sign signs evidence trace kind kinds type sort presence hint indication pieces piece pair")
});

/// Words that begin a noun phrase of its own.
pub(super) static NEW_NOUN: Words =
    LazyLock::new(|| split("a an the two three four five six several some many multiple one both"));

/// Words after which a noun that the lexicon lacks is one that is said to be there.
pub(super) static BRINGS_IN: Words =
    LazyLock::new(|| split("there there's see has have contains with features includes without no not any"));

/// Heads of noun phrases in descriptions that are no objects.
pub(super) static NO_OBJECTS: Words = LazyLock::new(|| {
    split(
        "image picture photo photograph scene atmosphere ambiance ambience sense feeling variety design style decor \
         layout arrangement combination mix touch feel look appearance setting environment color colour hue tone \
         pattern texture material surface furniture piece item object thing kind type sort number collection array \
         range background foreground shot angle perspective focus theme vibe finish size shape sign evidence \
         question answer bit interior series",
    )
});

/// Words that say that there are several.
pub(super) static NUMBERS: Words = LazyLock::new(|| {
    split(
        "two three four five six seven eight nine ten several many multiple numerous various few couple rows both \
         dozen pairs pair lots",
    )
});

/// Words that may stand before a noun and do not tell which of its kind is meant.
pub(super) static TELLS_NOTHING: Words = LazyLock::new(|| {
    split(
        "a an the any no not some visible clear obvious apparent actual real really single large big small little \
         tall of sign signs evidence or nor and , see have one such kind type sort pair notable prominent \
         traditional modern",
    )
});

/// Words that speak of more things than those named: "no other chairs" denies no chair.
pub(super) static OTHERS: Words = LazyLock::new(|| split("other additional further more second another"));

/// Words that may begin a question and say nothing.
pub(super) static LEADS: Words = LazyLock::new(|| split("so and also please okay ok now then well but great ,"));

/// Words between the verb and what is asked for.
pub(super) static FILLERS: Words = LazyLock::new(|| {
    split(
        "really actually also still indeed any a an the some there visible single large small big little clearly \
         perhaps possibly notable kind type sort of one sign signs",
    )
});

/// Nouns that ask for nothing in particular.
pub(super) static ANYTHING: Words = LazyLock::new(|| {
    split(
        "anything something nothing anyone someone person people furniture object item thing more another other \
         else additional second enough way feature detail much",
    )
});

/// Words that begin a phrase of place.
pub(super) static PREPOSITIONS: Words = LazyLock::new(|| split("on to at in along against toward towards near from"));

/// Words between the preposition and the side. "Its left" is a side of something else.
pub(super) static BEFORE_SIDE: Words = LazyLock::new(|| {
    split("the your our my far upper lower bottom top back front immediate very image's room's viewer's")
});

/// What has a side: "on the left wall".
pub(super) static SIDE_PARTS: Words = LazyLock::new(|| {
    split("hand side wall part half corner edge portion third foreground background area section end")
});

/// Wholes of which a side is a side of the view.
pub(super) static WHOLES: Words = LazyLock::new(|| {
    split("image picture photo photograph room scene view frame space viewer camera it us you me shot")
});

/// Short forms of "is not".
pub(super) static IS_NOT: Words = LazyLock::new(|| split("isn't aren't wasn't weren't"));

/// Words that make a whole sentence behind them doubtful.
pub(super) static DOUBTS: Phrases = LazyLock::new(|| {
    phrases(
        "not sure, unsure, uncertain, not certain, unclear, not clear, can't tell, cannot tell, hard to say, hard \
         to tell, hard to see, difficult to say, difficult to tell, difficult to see, unknown, don't know, not \
         know, cannot determine, can't determine, not possible to",
    )
});

/// Beginnings of answers that say yes.
pub(super) static YES: Phrases = LazyLock::new(|| {
    phrases(
        "yes, yeah, yep, correct, indeed, certainly, definitely, absolutely, sure, of course, right, true, i think so, \
         no doubt, i believe so",
    )
});

/// Beginnings that say yes where no noun follows: "There are two on the left.", but not "There are two lamps."
pub(super) static YES_ALONE: Phrases = LazyLock::new(|| {
    phrases(
        "there is, there are, there is one, there are some, there are two, there are three, there are several, there \
         are many, it is, they are, it does, i do, i can, i see one, i can see one, i do see one, one is visible",
    )
});

/// Beginnings of answers that say no.
pub(super) static NO: Phrases = LazyLock::new(|| {
    phrases(
        "no, nope, none, not, neither, nothing, never, negative, zero, there is no, there are no, there is not, \
         there are not, there is none, there are none, there's no, there isn't, there aren't, i don't think so, i \
         do not think so, i do not see, i don't see, i can not see, i cannot see, i can't see, it does not, it \
         doesn't, there does not, there doesn't, there do not, there don't, unfortunately not, unfortunately no, \
         actually no",
    )
});

/// Beginnings of answers that say neither for sure.
pub(super) static MAYBE: Phrases = LazyLock::new(|| {
    phrases("maybe, perhaps, possibly, probably, it might, there might, there may, there could, it may, it could")
});

fn split(words: &'static str) -> Vec<&'static str> {
    words.split_whitespace().collect()
}

/// Runs of words with commas between them.
fn phrases(list: &'static str) -> Vec<Vec<&'static str>> {
    list.split(',').map(split).collect()
}
