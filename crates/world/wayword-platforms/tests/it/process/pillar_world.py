"""A yard with a pillar, for a test: each of the four directions has its own colour."""
import math
import sys

sys.path.insert(0, sys.argv[1])
import wayword.platform as kit

COLOURS = [(255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 255)]


class Yard(kit.OpenPlatform):
    name, has_labels = "yard", True

    def scenes(self):
        return ["yard"]

    def bounds(self, scene):
        if scene != "yard":
            raise kit.UnknownScene("there is one, yard")
        return (0, 0, 1.5), (8, 8, 1.5)

    def is_free(self, scene, place):
        return math.dist(place[:2], (4, 4)) > 1

    def observe(self, scene, look):
        side = round(look.heading_rad / (math.pi / 2)) % 4
        pillar = kit.Label("1", "pillar", position=(4, 4, 1), colour="grey")
        return kit.View(bytes(COLOURS[side]) * (look.width_px * look.height_px), [pillar])


print("this goes to standard error", file=sys.stderr)
kit.serve(Yard)
