//! A world program with four viewpoints that can do everything wrong. In scene `good` it behaves; in any other it plays
//! its role.

use serde_json::{Value, json};
use std::{
    fs::File,
    io::{BufRead, Cursor, Write},
    time::Duration,
};

pub(crate) const WIDTH_PX: u32 = 32;
pub(crate) const HEIGHT_PX: u32 = 24;
/// Positions of the viewpoints: a line with a bend.
pub(crate) const PLACES: [(&str, [f64; 3]); 4] =
    [("a", [0.0, 0.0, 1.5]), ("b", [0.0, 2.0, 1.5]), ("c", [2.0, 2.0, 1.5]), ("d", [2.0, 4.0, 1.5])];
/// Position of its only object.
pub(crate) const LAMP: [f64; 3] = [0.5, 3.0, 1.0];

struct Actor {
    role: String,
    out: File,
}

/// Answers until its input ends.
pub(crate) fn play(role: &str) {
    let out = File::options().write(true).open("/dev/fd/3").unwrap();
    let mut actor = Actor { role: role.to_owned(), out };
    for line in std::io::stdin().lock().lines() {
        let request: Value = serde_json::from_str(&line.unwrap()).unwrap();
        actor.answer(&request);
    }
    if actor.role == "stays" {
        hang();
    }
    std::process::exit(0);
}

fn hang() -> ! {
    loop {
        std::thread::sleep(Duration::from_secs(1000));
    }
}

impl Actor {
    fn say(&mut self, line: &str) {
        // The reader may have closed the pipe.
        if self.out.write_all(line.as_bytes()).is_err() {
            std::process::exit(1);
        }
    }

    fn answer(&mut self, request: &Value) {
        let params = &request["params"];
        let result = match request["method"].as_str().unwrap() {
            "hello" => self.greeting(),
            "scenes" if self.role == "repeats" => json!({"scenes": ["good", "bad", "good"]}),
            "scenes" => json!({"scenes": ["good", "bad"]}),
            "graph" if self.role == "loops" => {
                let mut graph = graph();
                graph["edges"][1] = json!(["b", "b"]);
                graph
            }
            "graph" => graph(),
            "points" => json!({"points": self.points()}),
            "neighbours" => json!({"viewpoints": neighbours(params["viewpoint"].as_str().unwrap())}),
            "walkable" => json!({"walkable": walkable(&params["pairs"])}),
            "sample_path" => self.path(params),
            _ => match params["scene"].as_str() {
                Some("good") => observation(params),
                _ => return self.misbehave(request),
            },
        };
        if result.is_null() {
            return;
        }
        self.say(&format!("{}\n", json!({"id": request["id"], "result": result})));
    }

    fn greeting(&mut self) -> Value {
        let mut greeting = json!({
            "protocol": 1,
            "frame": "z-up, metres, radians clockwise from +y",
            "name": "actor",
            "offers": ["graph", "pictures", "labels", "rooms"],
        });
        match self.role.as_str() {
            "next version" => greeting = json!({"protocol": 2}),
            "y up" => greeting["frame"] = json!("y-up"),
            "sees nothing" => greeting["offers"] = json!(["graph"]),
            "no such folder" => greeting["images"] = json!("/nowhere/at/all"),
            "changes" => {
                let mark = std::path::PathBuf::from(std::env::var("WAYWORD_TEST_FOLDER").unwrap()).join("was here");
                if mark.exists() {
                    greeting["offers"] = json!(["graph", "labels"]);
                }
                std::fs::write(mark, "").unwrap();
            }
            "never greets" => return Value::Null,
            "escapes" | "leaves pictures" => greeting["images"] = json!(std::env::var("WAYWORD_TEST_FOLDER").unwrap()),
            "neighbours" => greeting["offers"] = json!(["points", "neighbours", "pictures", "labels", "rooms"]),
            "walkable" => greeting["offers"] = json!(["points", "walkable", "labels", "rooms"]),
            role if role.starts_with("draws ") => greeting["offers"] = json!(["graph", "sample_path", "pictures"]),
            _ => {}
        }
        greeting
    }

    fn points(&self) -> Vec<Value> {
        if self.role == "neighbours" {
            return PLACES.iter().map(|(id, position)| json!({"id": id, "position": position})).collect();
        }
        // Two rooms on a grid of 1 m, with a wall at x = 4.5 that has a door at y = 2.
        (0..50).map(|n| json!({"position": [f64::from(n % 10), f64::from(n / 10), 1.5]})).collect()
    }

    fn path(&self, params: &Value) -> Value {
        let stops = |names: &[&str]| names.iter().map(|name| json!({"viewpoint": name})).collect::<Vec<_>>();
        match self.role.as_str() {
            "draws viewpoints" => {
                json!({"path": {"stops": stops(&["a", "b", "c"]), "heading_rad": params["seed"].as_u64().unwrap() as f64}})
            }
            "draws places" => {
                json!({"path": {"stops": [{"position": [0, 0, 1.5]}, {"position": [3, 4, 1.5], "level": 1}]}})
            }
            "draws a ghost" => json!({"path": {"stops": stops(&["a", "b", "c"]), "target": "ghost"}}),
            "draws a spin" => json!({"path": {"stops": stops(&["a", "b", "c"]), "heading_rad": 1e308}}),
            "draws a tower" => {
                json!({"path": {"stops": [{"position": [0, 0, 1.5]}, {"position": [3, 4, 1.5], "level": 99_999}]}})
            }
            "draws strangers" => json!({"path": {"stops": stops(&["a", "nobody"])}}),
            "draws stubs" => json!({"path": {"stops": stops(&["a"])}}),
            _ => json!({"path": null}),
        }
    }

    fn misbehave(&mut self, request: &Value) {
        eprintln!("about to do something: \u{1b}[31m{}", self.role);
        let id = request["id"].as_u64().unwrap();
        let mut good = json!({"id": id, "result": observation(&request["params"])});
        match self.role.as_str() {
            "dies" | "changes" => std::process::exit(3),
            "aborts" => std::process::abort(),
            "hangs" => hang(),
            "floods" => loop {
                self.say(&"x".repeat(1 << 16));
            },
            "floods lines" => loop {
                self.say("{\"id\": 0, \"result\": {}}\n");
            },
            "prints" => self.say("Loading textures...\n"),
            "half" => {
                self.say("{\"id\": 3, \"resu");
                std::process::exit(0);
            }
            "wrong id" => good["id"] = json!(id + 1),
            "twice" => self.say(&format!("{good}\n")),
            "leaves" => {
                self.say(&format!("{good}\n"));
                std::process::exit(0);
            }
            "refuses" => good = json!({"id": id, "error": {"message": "the floor is\nlava"}}),
            "no such scene" => good = json!({"id": id, "error": {"code": "unknown_scene", "message": "there are two"}}),
            "blind" => good["result"]["image"] = Value::Null,
            "unlabelled" => drop(good["result"].as_object_mut().unwrap().remove("labels")),
            "wrong shape" => good["result"]["labels"] = json!([{"name": "lamp"}]),
            "other size" => good["result"]["image"] = json!({"base64": base64(&png(WIDTH_PX + 1, HEIGHT_PX))}),
            "no picture" => good["result"]["image"] = json!({"base64": base64(b"not a picture")}),
            "escapes" => good["result"]["image"] = json!({"file": "../secret.png"}),
            "leaves pictures" => good["result"]["image"] = json!({"file": "view.png"}),
            "mutates" => {
                let line = mutated(&good.to_string(), id);
                self.say(&line);
                return;
            }
            _ => {}
        }
        self.say(&format!("{good}\n"));
    }
}

fn graph() -> Value {
    let viewpoints: Vec<Value> =
        PLACES.iter().map(|(id, position)| json!({"id": id, "position": position, "level": 1})).collect();
    json!({"viewpoints": viewpoints, "edges": [["a", "b"], ["b", "c"], ["c", "d"]]})
}

fn neighbours(of: &str) -> Vec<&'static str> {
    let here = PLACES.iter().position(|(id, _)| *id == of).unwrap();
    let beside = |n: usize| n + 1 == here || n == here + 1;
    PLACES.iter().enumerate().filter(|(n, _)| beside(*n)).map(|(_, (id, _))| *id).collect()
}

fn walkable(pairs: &Value) -> Vec<bool> {
    let through_door = |pair: &Value| {
        let at = |end: usize, axis: usize| pair[end][axis].as_f64().unwrap();
        let same_side = (at(0, 0) < 4.5) == (at(1, 0) < 4.5);
        same_side || (at(0, 1) == 2.0 && at(1, 1) == 2.0)
    };
    pairs.as_array().unwrap().iter().map(through_door).collect()
}

fn observation(params: &Value) -> Value {
    let picture = params["picture"].as_bool().unwrap();
    json!({
        "image": picture.then(|| json!({"base64": base64(&png(WIDTH_PX, HEIGHT_PX))})),
        "labels": [{"object": "7", "name": "lamp", "position": LAMP}],
        "room": std::process::id().to_string(),
    })
}

pub(crate) fn png(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image::RgbImage::from_pixel(width, height, image::Rgb([10, 200, 30]))
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

fn base64(bytes: &[u8]) -> String {
    base64::Engine::encode(&base64::engine::general_purpose::STANDARD, bytes)
}

/// An answer with one to three mutations.
fn mutated(line: &str, seed: u64) -> String {
    use rand::Rng;
    let odd =
        ["null", "[]", "{}", "-1", "1e999", "\"\"", "\"../x\"", "true", "99999999999999999999", "\u{0}", "\n", "[[[[["];
    let mut rng = wayword_core::seeded_rng(seed, &["mutation"]);
    let mut chars: Vec<char> = line.chars().collect();
    for _ in 0..rng.random_range(1..4) {
        let at = rng.random_range(0..chars.len());
        match rng.random_range(0..4) {
            0 => chars.truncate(at + 1),
            1 => chars[at] = char::from(rng.random_range(1..127u8)),
            2 => drop(chars.splice(at..at, odd[rng.random_range(0..odd.len())].chars())),
            _ => drop(chars.splice(at..(at + rng.random_range(1..30)).min(chars.len() - 1).max(at), [])),
        }
    }
    let mut line: String = chars.into_iter().collect();
    line.push('\n');
    line
}
