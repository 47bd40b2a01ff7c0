CREATE TABLE IF NOT EXISTS meta (key TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT;

-- Somebody who consented. `link` is the hash of what the person came with, so that the same link leads to the same person.
CREATE TABLE IF NOT EXISTS person (
    id INTEGER PRIMARY KEY,
    name TEXT NOT NULL UNIQUE,
    link BLOB NOT NULL UNIQUE,
    status TEXT NOT NULL,
    consent TEXT NOT NULL,
    consented_ms INTEGER NOT NULL,
    finished_ms INTEGER,
    recruiter_status TEXT,
    seen_ms INTEGER NOT NULL,
    misunderstood INTEGER NOT NULL DEFAULT 0,
    understood INTEGER NOT NULL DEFAULT 0,
    expected INTEGER NOT NULL
) STRICT;

-- What the recruiter calls them: apart from the answers, and dropped when the study is closed.
CREATE TABLE IF NOT EXISTS recruit (
    person INTEGER PRIMARY KEY REFERENCES person (id) ON DELETE CASCADE,
    id TEXT NOT NULL UNIQUE,
    study TEXT NOT NULL,
    session TEXT NOT NULL
) STRICT;

-- Personal links that were made, by the hash of their token.
CREATE TABLE IF NOT EXISTS link (hash BLOB PRIMARY KEY, made_ms INTEGER NOT NULL) STRICT;

-- Those who had everything deleted: hashes of what they came with, until the study is closed.
CREATE TABLE IF NOT EXISTS gone (hash BLOB PRIMARY KEY) STRICT;

-- The words that people consented to, by their hash.
CREATE TABLE IF NOT EXISTS consent (hash TEXT PRIMARY KEY, words TEXT NOT NULL) STRICT;

CREATE TABLE IF NOT EXISTS session (
    hash BLOB PRIMARY KEY,
    person INTEGER NOT NULL REFERENCES person (id) ON DELETE CASCADE,
    made_ms INTEGER NOT NULL
) STRICT;
CREATE INDEX IF NOT EXISTS session_of ON session (person);

-- An item in somebody's hands. `position` is null for practice. Nobody gets an item or a route twice.
CREATE TABLE IF NOT EXISTS slot (
    id INTEGER PRIMARY KEY,
    name TEXT NOT NULL UNIQUE,
    person INTEGER NOT NULL REFERENCES person (id) ON DELETE CASCADE,
    item INTEGER NOT NULL,
    route INTEGER NOT NULL,
    position INTEGER,
    state TEXT NOT NULL,
    lease_ms INTEGER NOT NULL,
    given_ms INTEGER NOT NULL,
    is_turned INTEGER NOT NULL,
    own_text TEXT,
    stopped_ms INTEGER,
    looks INTEGER NOT NULL DEFAULT 0,
    answer TEXT,
    answered_ms INTEGER,
    UNIQUE (person, item),
    UNIQUE (person, route)
) STRICT;
CREATE INDEX IF NOT EXISTS slot_by_item ON slot (item, state, lease_ms) WHERE position IS NOT NULL;

CREATE TABLE IF NOT EXISTS move (
    slot INTEGER NOT NULL REFERENCES slot (id) ON DELETE CASCADE,
    seq INTEGER NOT NULL,
    viewpoint TEXT NOT NULL,
    at_ms INTEGER NOT NULL,
    PRIMARY KEY (slot, seq)
) STRICT, WITHOUT ROWID;

CREATE TABLE IF NOT EXISTS attention (
    person INTEGER NOT NULL REFERENCES person (id) ON DELETE CASCADE,
    number INTEGER NOT NULL,
    passed INTEGER NOT NULL,
    at_ms INTEGER NOT NULL,
    PRIMARY KEY (person, number)
) STRICT, WITHOUT ROWID;

-- How many different pictures of a film the page showed, as it counted them.
CREATE TABLE IF NOT EXISTS viewing (
    slot INTEGER PRIMARY KEY REFERENCES slot (id) ON DELETE CASCADE,
    pictures INTEGER NOT NULL
) STRICT;

-- The answers to the questions at the end, as JSON.
CREATE TABLE IF NOT EXISTS end_answers (
    person INTEGER PRIMARY KEY REFERENCES person (id) ON DELETE CASCADE,
    answers TEXT NOT NULL,
    at_ms INTEGER NOT NULL
) STRICT;
