//! Messages between programs, and files: JSON and text.

/// A home with two rooms, a door and a sofa, as VirtualHome sends it.
pub const HOME: &str = r#"{"nodes":[
{"id":1,"class_name":"kitchen","category":"Rooms","bounding_box":{"center":[-1,1.25,0],"size":[2,2.5,2]}},
{"id":2,"class_name":"bedroom","category":"Rooms","bounding_box":{"center":[1,1.25,0],"size":[2,2.5,2]}},
{"id":3,"class_name":"doorjamb","category":"Doors","bounding_box":{"center":[0,1,0],"size":[0.2,2,1]}},
{"id":4,"class_name":"sofa","category":"Furniture","bounding_box":{"center":[1,0.4,0.5],"size":[0.5,0.8,0.5]}}],"edges":[]}"#;

/// All answers of a child process that offers a graph, labels and paths.
pub const CHILD: &str = r#"{"id":1,"result":{"protocol":1,"frame":"z-up, metres, radians clockwise from +y","name":"w","offers":["graph","pictures","labels","rooms","sample_path","object_name","visible_from"]}}
{"id":2,"result":{"scenes":["s"]}}
{"id":3,"result":{"viewpoints":[{"id":"a","position":[0,0,1.5],"level":1},{"id":"b","position":[2,0,1.5]}],"edges":[["a","b"]]}}
{"id":4,"result":{"image":{"base64":"iVBORw0KGgo="},"labels":[{"object":"7","name":"lamp","position":[2,5,1.5],"box_px":[1,1,2,2],"colour":"red"},{"object":"8","name":"rug","heading_rad":0.1,"elevation_rad":-0.2,"distance_m":2}],"room":"kitchen"}}
{"id":5,"result":{"labels":[{"object":"7","name":"lamp","position":[2,5,1.5]}],"room":null}}
{"id":6,"result":{"path":{"stops":[{"viewpoint":"a"},{"viewpoint":"b"}],"heading_rad":1.5,"target":"7"}}}
{"id":7,"result":{"name":"lamp"}}
{"id":8,"result":{"viewpoints":["a"]}}
"#;

/// The same for one that offers points, and says between which of them one can walk.
pub const WALKER: &str = r#"{"id":1,"result":{"protocol":1,"frame":"z-up, metres, radians clockwise from +y","name":"w","offers":["points","walkable","labels"]}}
{"id":2,"result":{"scenes":["s","t"]}}
{"id":3,"result":{"points":[{"position":[0,0,1.5]},{"position":[1.5,0,1.5]},{"position":[0,1.5,1.5],"level":2}]}}
{"id":4,"result":{"walkable":[true,true,false]}}
{"id":5,"result":{"labels":[{"object":"7","name":"lamp","position":[2,5,1.5]}]}}
{"id":6,"error":{"code":"unknown_scene","message":"no"}}
"#;

/// The same for one that offers points and their neighbours.
pub const NEIGHBOUR: &str = r#"{"id":1,"result":{"protocol":1,"frame":"z-up, metres, radians clockwise from +y","name":"w","offers":["points","neighbours","pictures"],"images":"/tmp"}}
{"id":2,"result":{"scenes":["s"]}}
{"id":3,"result":{"points":[{"id":"a","position":[0,0,1.5]},{"id":"b","position":[1.5,0,1.5]}]}}
{"id":4,"result":{"viewpoints":["b"]}}
{"id":5,"result":{"viewpoints":["a"]}}
{"id":6,"result":{"image":{"file":"none.png"}}}
"#;

/// Two viewpoints of a building.
pub const CONNECTIVITY: &str = r#"[{"image_id":"a","pose":[0,-1,0,0,0,0,-1,0,1,0,0,1.6,0,0,0,1],"included":true,"visible":[false,true],"unobstructed":[false,true],"height":1.5},
{"image_id":"b","pose":[0,-1,0,2,0,0,-1,0,1,0,0,1.6,0,0,0,1],"included":true,"visible":[true,false],"unobstructed":[true,false],"height":1.5}]"#;
/// Its storeys, rooms and objects.
pub const HOUSE: &str = "ASCII 1.1\nL 0 1 - 0 0 0.0 0 0 0 1 1 1 0\nR 0 0 0 0 b 0 0 0 0 0 0 1 1 1 2.5\nP a 0 0 0 1 2 1.5\nP b 0 0 0 1 2 1.5\n\
    O 5 0 9 1 1 0.5 1 0 0 0 1 0 1 1 1\nC 9 3 coffee#table 5 table\n";
/// Its rooms.
pub const ROOMS: &str = "0 a 0 b\n1 b 0 k\n";
/// REVERIE's boxes at its first viewpoint.
pub const BOXES: &str =
    r#"{"a":{"5":{"name":"coffee table","visible_pos":[13,14],"bbox2d":[[10,20,100,50],[0,0,30,40]]}}}"#;
/// REVERIE's centres.
pub const CENTRES: &str = r#"{"s":{"5":[1,1,0.5]}}"#;

/// Files of a building. The first byte of each says which one it is.
pub fn building() -> Vec<Vec<u8>> {
    let texts = [CONNECTIVITY, HOUSE, ROOMS, BOXES, CENTRES].map(|text| text.as_bytes().to_vec());
    let pictures = [super::picture::png(12, 2), super::picture::jpeg(48, 8)];
    let files = (0..).zip(texts).chain(pictures.map(|picture| (5, picture)));
    files.map(|(which, file)| [vec![which], file].concat()).collect()
}
