"""Pictures for the documents: bakes beside each other, light only, each with its name."""
import os
import sys

from PIL import Image, ImageDraw

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "reference"))
import render       # noqa: E402


def sheet(views, camera, exposure, size, columns):
    """`views`: name -> render.View, all from one camera with one exposure; `size`: of a panel, pixels."""
    lines = -(-len(views) // columns)
    picture = Image.new("RGB", (size[0] * columns, size[1] * lines))
    for number, (name, view) in enumerate(views.items()):
        panel = Image.fromarray(render.draw(view, camera, *size, exposure, True))
        ImageDraw.Draw(panel).text((6, size[1] - 16), name, fill=(255, 255, 255), stroke_width=2, stroke_fill=(0, 0, 0))
        picture.paste(panel, (number % columns * size[0], number // columns * size[1]))
    return picture


def save(picture, target, most_bytes):
    """A JPEG as good as `most_bytes` allow, or a PNG of 128 colours."""
    if target.endswith(".png"):
        picture.quantize(128).save(target, optimize=True)
        return
    for quality in range(92, 20, -6):
        picture.save(target, quality=quality, optimize=True)
        if os.path.getsize(target) <= most_bytes:
            break
