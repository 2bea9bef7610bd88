"""Light that a bake is told of beside its scene: sky and sizes of lamps, under the names of luxel's own options.

The sky is Mitsuba's: `constant`, or `envmap` of the picture. Mitsuba shows the middle of a picture at +Z, luxel, Blender and
three.js at +X: a quarter turn about Y. Mitsuba interpolates between pixels, luxel's pixels are areas of one luminance: each
becomes many equal ones.
"""
import dataclasses

import numpy as np

FINE_COLUMNS = 4096


@dataclasses.dataclass
class Light:
    sky: str = ""              # .exr or .hdr
    sky_color: tuple = ()      # nits
    sky_rotate: float = 0.0    # degrees, counter-clockwise seen from above
    sky_scale: float = 1.0
    lamp_radius: float = 0.0   # metres
    sun_angle: float = 0.0     # degrees

    def emitter(self):
        """A dictionary for Mitsuba, or None."""
        import mitsuba as mi   # the variant is the caller's choice
        if self.sky_color:
            return {"type": "constant", "radiance": {"type": "rgb", "value": [c * self.sky_scale for c in self.sky_color]}}
        if not self.sky:
            return None
        pixels = np.array(mi.Bitmap(self.sky).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False))
        each = max(1, FINE_COLUMNS // pixels.shape[1])
        return {"type": "envmap", "bitmap": mi.Bitmap(np.ascontiguousarray(pixels.repeat(each, 0).repeat(each, 1))),
                "scale": self.sky_scale, "to_world": mi.ScalarTransform4f().rotate([0, 1, 0], 90 + self.sky_rotate)}


def add_options(parser):
    parser.add_argument("--sky", default="", metavar="FILE")
    parser.add_argument("--sky-color", default="", metavar="R,G,B")
    parser.add_argument("--sky-rotate", type=float, default=0.0, metavar="DEG")
    parser.add_argument("--sky-scale", type=float, default=1.0)
    parser.add_argument("--lamp-radius", type=float, default=0.0, metavar="M")
    parser.add_argument("--sun-angle", type=float, default=0.0, metavar="DEG")


def from_options(options):
    color = tuple(float(c) for c in options.sky_color.split(",")) if options.sky_color else ()
    return Light(options.sky, color * 3 if len(color) == 1 else color, options.sky_rotate, options.sky_scale,
                 options.lamp_radius, options.sun_angle)
