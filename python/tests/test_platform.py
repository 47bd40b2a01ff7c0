"""Tests of the kit: run `python3 -m unittest tests/test_platform.py` in the folder `python`. They need nothing else."""

import base64
import contextlib
import io
import json
import math
import os
import subprocess
import sys
import textwrap
import unittest

KIT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
# Behind what is installed, if anything is.
sys.path.append(KIT)

import wayword.platform as kit  # noqa: E402

LOOK = dict(scene="room", position=[1, 2, 1.5], heading_rad=0.5, horizontal_fov_rad=1.5, vertical_fov_rad=1.2,
            width_px=4, height_px=2, viewpoint=None, picture=True)


class Room(kit.OpenPlatform):
    """A room of 4 x 4 m with a pillar in the middle."""

    name, has_labels = "room", True

    def scenes(self):
        return ["room"]

    def bounds(self, scene):
        return (0, 0, 1.5), (4, 4, 1.5)

    def is_free(self, scene, place):
        return math.dist(place[:2], (2, 2)) > 0.5

    def observe(self, scene, look):
        if scene != "room":
            raise kit.UnknownScene("there is one: room")
        return kit.View(bytes(range(24)), [kit.Label("1", "pillar", position=(2, 2, 1))], room="hall")


def ask(world, method, **params):
    return json.loads(kit.answer(world, {"id": 7, "method": method, "params": params}))


class Answers(unittest.TestCase):
    def test_a_world_offers_what_it_has(self):
        greeting = ask(Room(), "hello", protocol=1, frame=kit.FRAME)["result"]
        self.assertEqual(greeting["offers"], ["points", "walkable", "pictures", "labels"])
        self.assertEqual((greeting["protocol"], greeting["frame"]), (1, kit.FRAME))
        self.assertIn("version 2", ask(Room(), "hello", protocol=2)["error"]["message"])

    def test_free_places_give_points_and_ways(self):
        points = ask(Room(), "points", scene="room", count=100, seed=3)["result"]["points"]
        self.assertGreater(len(points), 80)
        self.assertEqual(points, ask(Room(), "points", scene="room", count=100, seed=3)["result"]["points"])
        ways = [[[0, 0, 1.5], [4, 0, 1.5]], [[0, 0, 1.5], [4, 4, 1.5]], [[1, 1, 1.5], [1, 1, 1.5]]]
        self.assertEqual(ask(Room(), "walkable", scene="room", pairs=ways)["result"]["walkable"], [True, False, True])

    def test_a_view_is_sent_with_its_picture_labels_and_room(self):
        seen = ask(Room(), "observe", **LOOK)["result"]
        self.assertTrue(base64.b64decode(seen["image"]["base64"]).startswith(b"\x89PNG"))
        self.assertEqual((seen["labels"][0]["position"], seen["room"]), ([2.0, 2.0, 1.0], "hall"))
        self.assertNotIn("image", ask(Room(), "observe", **dict(LOOK, picture=False))["result"])

    def test_what_goes_wrong_is_an_error_with_the_id_of_its_request(self):
        unknown = ask(Room(), "observe", **dict(LOOK, scene="attic"))
        self.assertEqual((unknown["id"], unknown["error"]["code"]), (7, "unknown_scene"))
        self.assertIn("teleport", ask(Room(), "teleport")["error"]["message"])
        with contextlib.redirect_stderr(io.StringIO()) as told:
            failed = ask(Room(), "observe", **dict(LOOK, width_px=5))
        self.assertIn("30 bytes, not 24", failed["error"]["message"])
        self.assertIn("Traceback", told.getvalue())

    def test_a_number_that_json_does_not_have_is_an_error_and_not_the_end(self):
        world = Room()
        world.points = lambda scene, count, seed: [(math.nan, 0, 0)]
        with contextlib.redirect_stderr(io.StringIO()):
            self.assertIn("ValueError", ask(world, "points", scene="room", count=1, seed=1)["error"]["message"])

    def test_pictures_are_told_from_pixels(self):
        png = kit.png(bytes(24), 4, 2)
        self.assertEqual(base64.b64decode(kit._image(png, 4, 2)["base64"]), png)
        white = b"\xff\xd8\xff" * 8  # begins as a JPEG file does
        self.assertEqual(base64.b64decode(kit._image(white, 4, 2)["base64"]), kit.png(white, 4, 2))
        self.assertEqual(kit._image("view.png", 4, 2), {"file": "view.png"})


class Frames(unittest.TestCase):
    def test_frames_are_converted_there_and_back(self):
        for there, back in [
            (kit.wayword_from_y_up, kit.y_up_from_wayword),
            (kit.wayword_from_unity, kit.unity_from_wayword),
            (kit.wayword_from_unreal, kit.unreal_from_wayword),
        ]:
            for place in [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1.5, -2, 3)]:
                for turned, original in zip(back(there(place)), place):
                    self.assertAlmostEqual(turned, original)

    def test_a_heading_points_where_the_converted_direction_does(self):
        """Checks for each frame that the converted direction of an angle has the heading of the converted angle."""
        for degrees in range(0, 360, 30):
            angle = math.radians(degrees)
            cos, sin = math.cos(angle), math.sin(angle)
            for place, heading in [
                (kit.wayword_from_y_up((-sin, 0, -cos)), kit.wayword_from_yaw(angle)),
                (kit.wayword_from_y_up((cos, 0, -sin)), kit.wayword_from_angle(angle)),
                (kit.wayword_from_unity((sin, 0, cos)), kit.wayword_from_unity_yaw(degrees)),
                (kit.wayword_from_unreal((cos, sin, 0)), kit.wayword_from_unreal_yaw(degrees)),
                ((cos, sin, 0), kit.wayword_from_angle(angle)),
            ]:
                length = math.hypot(place[0], place[1])
                self.assertAlmostEqual(place[0] / length, math.sin(heading))
                self.assertAlmostEqual(place[1] / length, math.cos(heading))
                self.assertTrue(0 <= heading < math.tau)
            heading = kit.wayword_from_yaw(angle)
            self.assertAlmostEqual(math.cos(kit.yaw_from_wayword(heading)), cos)
            self.assertAlmostEqual(math.sin(kit.angle_from_wayword(kit.wayword_from_angle(angle))), sin)
            self.assertAlmostEqual(kit.unity_yaw_from_wayword(kit.wayword_from_unity_yaw(degrees)) % 360, degrees)


class Serving(unittest.TestCase):
    def test_what_is_printed_does_not_reach_the_protocol(self):
        script = textwrap.dedent("""
            import os, wayword.platform as kit
            class Noisy(kit.Platform):
                def __init__(self):
                    print("loading"); os.write(1, b"from C\\n")
                def scenes(self):
                    print("asked for scenes")
                    os.system("echo from a child; read line && echo stolen")
                    return ["a"]
            kit.serve(Noisy)
        """)
        requests = '{"id": 1, "method": "scenes", "params": {}}\n{"id": 2, "method": "scenes", "params": {}}\n'
        done = subprocess.run([sys.executable, "-c", script], input=requests, capture_output=True, text=True, cwd=KIT)
        answers = [json.loads(line) for line in done.stdout.splitlines()]
        self.assertEqual(answers, [{"id": n, "result": {"scenes": ["a"]}} for n in (1, 2)])
        self.assertEqual(done.returncode, 0)
        for words in ("loading", "from C", "asked for scenes", "from a child"):
            self.assertIn(words, done.stderr)
        self.assertNotIn("stolen", done.stderr)


if __name__ == "__main__":
    unittest.main()
