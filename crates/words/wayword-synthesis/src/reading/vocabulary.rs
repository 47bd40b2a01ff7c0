//! Closed lists of words that steer the reading of an instruction.

use std::sync::LazyLock;

/// A list of words.
type Words = LazyLock<Vec<&'static str>>;

/// Verbs of walking: a clause that begins with one is no task.
pub(super) static WALKING: Words = LazyLock::new(|| {
    split(
        "go walk turn head stop wait enter exit leave continue proceed pass move step make veer bear keep stay follow \
     cross climb ascend descend travel come reach approach stand face start begin navigate return run hang rotate \
     pause halt end finish hook curve cut advance march stroll swing pivot circle round back remain steer slip \
     carry get pop hurry drop arrive have see find be is are visit",
    )
});

/// Verbs after which "left" or "right" is a turn.
pub(super) static TURNING: Words = LazyLock::new(|| {
    split(
        "turn turning veer veering bear bearing take taking make making hang hook rotate rotating curve curving swing \
     pivot cut steer turns turned angle bend spin",
    )
});

/// Those of them that say by themselves what is done to a thing: "take the left door".
pub(super) static DOING: Words = LazyLock::new(|| split("take taking make making hang hook cut do doing pull"));

/// Verbs after which "around" and "180 degrees" are a turn around.
pub(super) static SPINNING: Words =
    LazyLock::new(|| split("turn turns turned turning spin spinning rotate rotating pivot swing whirl"));

/// Words that may stand between such a verb and its "around".
pub(super) static BEFORE_ABOUT: Words = LazyLock::new(|| {
    split(
        "all the way completely fully right back yourself your body a full about just quickly once 180 degrees to in \
     toward towards and face facing",
    )
});

/// Verbs after which "left" or "right" is a turn when it follows at once, or after "to the" and "to your".
pub(super) static GOING: Words = LazyLock::new(|| {
    split(
        "go going head heading walk walking move moving step keep face exit leave proceed enter continue continuing \
     advance travel",
    )
});

/// Verbs of going: "upstairs" behind one is a command.
pub(super) static CLIMBING: Words = LazyLock::new(|| {
    split(
        "go goes going walk walking head heading move moving continue continuing proceed proceeding come coming run \
     climb climbing return travel get getting take taking bring advance step hurry keep",
    )
});

/// Words that may stand between such a verb and its "upstairs".
pub(super) static BEFORE_CLIMB: Words =
    LazyLock::new(|| split("back straight all the way right directly then immediately again on further just"));

/// Words that tell how many steps, where they are fewer than a flight.
pub(super) static FEW: Words = LazyLock::new(|| split("one two three four five few couple 2 3 4 5"));

/// Words behind such a verb that say to walk on.
pub(super) static ONWARD: Words =
    LazyLock::new(|| split("straight ahead forward forwards onward onwards past through along across down"));

/// Words that make a storey of a "floor".
pub(super) static STOREYS: Words = LazyLock::new(|| {
    split("one two another main upper lower same next other ground top bottom whole entire middle upstairs downstairs")
});

/// Verbs that tell a floor from which a walk comes.
pub(super) static LEAVING: Words =
    LazyLock::new(|| split("leave leaving exit exiting start starting starts begin beginning begins"));

/// Words that may stand between a verb and its side.
pub(super) static BEFORE_SIDE: Words = LazyLock::new(|| {
    split(
        "a an the your to first second third next immediate immediately slight slightly sharp sharply hard quick \
     another then and but again towards toward back around small gentle soft far one more",
    )
});

/// Words that may stand between a verb of turning and its side besides.
pub(super) static BEFORE_SIDE_OF_TURN: Words = LazyLock::new(|| {
    split(
        "degree degrees about approximately roughly completely fully body yourself off corner available possible full \
     quarter it out face facing very just",
    )
});

/// Words that may follow a side that is a turn by itself: "then left at the sofa".
pub(super) static AFTER_SIDE: Words = LazyLock::new(|| {
    split("at into through onto down past towards toward after before when once until and then out around")
});

/// Words after which "right" is no side ("stop right before the sofa").
pub(super) static AFTER_ADVERB_RIGHT: Words = LazyLock::new(|| {
    split("before next in outside beside there here inside beyond above up through past along by to over under after")
});

/// What has a left and a right one, and is in no lexicon.
pub(super) static HAVE_SIDES: Words = LazyLock::new(|| {
    split("end part half one ones path room area direction fork branch wing edge section lane doors rooms")
});

/// Words that begin a noun phrase.
pub(super) static DETERMINERS: Words = LazyLock::new(|| split("the a an this that these those your its another some"));

/// Words besides that begin a noun phrase: whose it is, and how many.
pub(super) static COUNTING: Words = LazyLock::new(|| {
    split("my his her their our both several two three four five six seven eight nine ten 2 3 4 5 6 7 8 9")
});

/// Words that end a noun phrase.
pub(crate) static BREAKERS: Words = LazyLock::new(|| {
    split(
        "of on in at to and or with that which is are until till then into through past by near behind next before \
     after from for along towards toward between across under above over it you there straight ahead outside \
     inside beside as up down off out so when where while who whose below against around beyond the a an your its \
     be has have will should if without opposite facing leading hanging standing sitting closest nearest adjacent \
     adjoining attached located again not but please turn stop walk go wait leads more away back onto upon within",
    )
});

/// Heads of noun phrases that name no landmark.
pub(crate) static ABSTRACT: Words = LazyLock::new(|| {
    split(
        "way left right side end front back top bottom middle center centre room area space place direction other \
     first second third fourth last one next hand house building home level story storey path rest edge same \
     entire length distance turn bit few couple feet foot meter metre degree point part half line row set pair \
     group lot number view spot position inside outside far near opposite person robot ground main upper lower \
     wing base head moment time section region piece straight around surface dust minute upstairs downstairs goal \
     destination start floor angle",
    )
});

/// Words after which a place tells where something else is, and need not be where anybody goes.
pub(super) static BESIDE: Words = LazyLock::new(|| {
    split(
        "adjacent adjoining attached off beside near nearest closest close next opposite by outside connected overlooking \
     with under above below over behind between before beyond against facing leading leads lead opening opens",
    )
});

/// Verbs whose object is where the walker gets.
pub(super) static ARRIVING: Words = LazyLock::new(|| split("enter entering find reach reaching visit locate approach"));

/// Colours, sizes and the like: no verbs, whatever they look like.
pub(super) static ADJECTIVES: Words = LazyLock::new(|| {
    split(
        "black white grey gray brown red blue green yellow orange purple pink beige tan gold silver wooden wood metal \
     large small big little long tall short round square leather striped open two three four five several many \
     other dark light old new cream teal navy turquoise glass marble stone brick double single upper lower left \
     right first second third",
    )
});

/// Those adjectives that are colours.
pub(crate) static COLOURS: Words = LazyLock::new(|| {
    split(
        "black white grey gray brown red blue green yellow orange purple pink beige tan gold silver cream teal navy \
     turquoise",
    )
});

/// Words that can stand before a clause's verb.
pub(super) static ADVERBS: Words = LazyLock::new(|| {
    split(
        "then and please now also finally carefully quickly once just afterwards next there slowly immediately to you \
     can should will need must after that gently thoroughly",
    )
});

/// Words that begin no task.
pub(super) static FUNCTION: Words = LazyLock::new(|| {
    split(
        "closer further farther nearer on in at with of the a an by it its his her into through past near until when \
     where which while as if up down is are for from your my so straight forward ahead between across behind \
     under over before beside towards toward out off or not no this these those upstairs downstairs directly \
     slight slightly",
    )
});

fn split(words: &'static str) -> Vec<&'static str> {
    words.split_whitespace().collect()
}

/// The number that an ordinal or a numeral says: that of a floor.
pub(super) fn floor_number(word: &str) -> Option<u32> {
    const NUMBERS: [[&str; 2]; 12] = [
        ["one", "first"],
        ["two", "second"],
        ["three", "third"],
        ["four", "fourth"],
        ["five", "fifth"],
        ["six", "sixth"],
        ["seven", "seventh"],
        ["eight", "eighth"],
        ["nine", "ninth"],
        ["ten", "tenth"],
        ["eleven", "eleventh"],
        ["twelve", "twelfth"],
    ];
    if matches!(word, "ground" | "bottom") {
        return Some(1);
    }
    let digits = ["st", "nd", "rd", "th"].iter().find_map(|end| word.strip_suffix(end)).unwrap_or(word);
    let in_words = || NUMBERS.iter().zip(1..).find(|(words, _)| words.contains(&word)).map(|(_, number)| number);
    digits.parse().ok().filter(|number| (1..1000).contains(number)).or_else(in_words)
}
