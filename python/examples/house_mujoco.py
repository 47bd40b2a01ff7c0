#!/usr/bin/env python3
"""Makes MuJoCo models of generated houses, for mujoco_world.py: `house_mujoco.py HOUSES OUT`.

HOUSES is a folder that `wayword house` wrote, or the folder `houses` that `wayword robustness --change platform=habitat`
wrote. It needs NumPy. OUT gets a model for each house, NAME.rooms.json with the rooms of its plan, and a world file for
`--platform process`."""
import collections, json, pathlib, struct, sys  # noqa: E401
import numpy as np
SHELL = {"wall", "floor", "ceiling", "roof"}  # what gets no label
EXAMPLES = pathlib.Path(__file__).resolve().parent


def painted(file):
    """The triangles of each colour of a GLB whose vertices have the colours of their objects; metres, z up."""
    data = file.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document, binary = json.loads(data[20 : 20 + length]), data[28 + length :]

    def values(accessor):
        accessor = document["accessors"][accessor]
        view = document["bufferViews"][accessor["bufferView"]]
        kind, wide = {5126: "<f4", 5125: "<u4", 5123: "<u2"}[accessor["componentType"]], {"VEC3": 3, "SCALAR": 1}[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return np.frombuffer(binary, kind, accessor["count"] * wide, start).reshape(-1, wide)

    found = collections.defaultdict(list)
    for primitive in document["meshes"][0]["primitives"]:
        place, paint = (values(primitive["attributes"][name]) for name in ("POSITION", "COLOR_0"))
        corners = place[values(primitive["indices"]).ravel()]
        colour = "".join(f"{round(255 * float(channel)):02X}" for channel in paint[0])
        found[colour].append(np.stack([corners[:, 0], -corners[:, 2], corners[:, 1]], 1))
    return {colour: np.concatenate(parts) for colour, parts in found.items()}


def model(house):
    """The MuJoCo model of a house's semantic files, as XML. What follows a # in a name only tells namesakes apart."""
    lines = house.with_suffix(".txt").read_text().splitlines()[1:]
    fields = (line.split(",") for line in lines)
    name_of = {colour: (number, name.strip('"')) for number, colour, name, _ in fields}
    meshes, bodies, low, high = [], [], np.full(3, np.inf), np.full(3, -np.inf)
    for colour, corners in painted(house).items():
        number, name = name_of.get(colour, (colour, "wall"))
        low, high = np.minimum(low, corners.min(0)), np.maximum(high, corners.max(0))
        middle = (corners.min(0) + corners.max(0)) / 2
        vertices, faces = np.unique(np.round(corners - middle, 5), axis=0, return_inverse=True)
        if len(vertices) < 4:
            continue
        text = [" ".join(f"{value:g}" for value in array.ravel()) for array in (vertices, faces)]
        meshes.append(f'<mesh name="m{number}" inertia="shell" vertex="{text[0]}" face="{text[1]}"/>')
        rgba = " ".join(f"{int(colour[at:at + 2], 16) / 255:.3f}" for at in (0, 2, 4))
        geom = f'<geom type="mesh" mesh="m{number}" contype="0" conaffinity="0" rgba="{rgba} 1"/>'
        place = " ".join(f"{value:.5f}" for value in middle)
        called = "" if name in SHELL else f' name="{name}#{number}"'
        bodies.append(f'<body{called} pos="{place}">{geom}</body>')
    (x, y, _), (wide, long, _) = (low + high) / 2, (high - low) / 2
    floor = f'<geom name="floor" type="plane" pos="{x:.3f} {y:.3f} 0.002" size="{wide:.3f} {long:.3f} 1"/>'
    return (
        f'<mujoco model="{house.name.split(".")[0]}"><compiler balanceinertia="true"/><statistic extent="10"/><visual><map znear="0.002"/></visual>\n'
        f"<asset>\n{chr(10).join(meshes)}\n</asset>\n<worldbody>\n{floor}\n{chr(10).join(bodies)}\n</worldbody></mujoco>\n"
    )


def save_rooms(house, file):
    """The rooms of the house's plan, for mujoco_world.py: name, height of the floor, and [x from, y from, x to, y to]."""
    plan = house.with_name(f'{house.name.split(".")[0]}.navigation.json')
    if plan.exists():
        rooms = json.loads(plan.read_text())["rooms"]
        file.write_text(json.dumps([{key: room[key] for key in ("name", "floor_m", "area_m")} for room in rooms]))


def main(houses, out):
    out = pathlib.Path(out)
    out.mkdir(parents=True, exist_ok=True)
    files = []
    for house in sorted(pathlib.Path(houses).rglob("*.semantic.glb")):
        file = out.resolve() / f'{house.name.split(".")[0]}.xml'
        file.write_text(model(house))
        save_rooms(house, file.with_suffix(".rooms.json"))
        files.append(str(file))
    if not files:
        sys.exit(f"{houses}: there is no *.semantic.glb; name the folder that `wayword house` wrote")
    world = {"command": [sys.executable, str(EXAMPLES / "mujoco_world.py"), *files]}
    (out / "mujoco.json").write_text(json.dumps(world, indent=1))
    print(f"{len(files)} houses; use --platform process --data {out / 'mujoco.json'}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: house_mujoco.py HOUSES OUT")
    main(*sys.argv[1:])
