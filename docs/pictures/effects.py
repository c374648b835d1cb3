#!/usr/bin/env python3
"""What effects look like: `effects.py FOLDER` writes three sheets there, of the scenes in effect_scenes.py."""
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2] / "bench/plots"))

import figure  # first: it chooses how matplotlib draws
from matplotlib.pyplot import figure as new_drawing

import panels
from effect_scenes import CAMERA, SCANNER_ERRORS, SCANNER_LIGHT
from runs import Bench

WIDTH_INCHES, DOTS_PER_INCH = 9.0, 180
IMAGE_PX = (320, 213)
GREY = "#555555"
FINE_BEAMS = 'samples="3601" min_angle="-90" max_angle="90"'


def head(x, y, z, pitch=0, yaw=0):
    """What carries the sensor, and what trajectories move."""
    return f'<element type="pose" name="HEAD" insert_at="ROOT" x="{x}" y="{y}" z="{z}" pitch="{pitch}" yaw="{yaw}"/>'


def camera_image(bench, picture, setting):
    commands, attributes = setting
    width, height = IMAGE_PX
    camera = (f'<sensor type="camera" name="CAMERA" insert_at="ROOT" width="{width}" height="{height}" '
              f'hfov="{picture.hfov}" supersampling="4" {attributes}/>')
    return bench.run(picture.scene + commands + head(*picture.pose) + camera, picture.frames,
                     picture.trajectory).image("CAMERA")


def scan_rows(bench, picture, setting, beams):
    commands, attributes = setting
    scanner = (f'<sensor type="laser_scanner" name="SCANNER" insert_at="ROOT" method="raycast" {beams} '
               f'{attributes}/>')
    return bench.run(picture.scene + commands + head(*picture.place) + scanner, picture.frames,
                     picture.trajectory).scan("SCANNER", picture.overlaid)


def draw_camera(bench, picture, block):
    for axes, setting, label in zip(block.subplots(1, 2), (picture.off, picture.on), ("off", "on")):
        image = camera_image(bench, picture, setting)
        if picture.crop:
            panels.magnify(axes, image, picture.crop, (0.44, 0.02, 0.55, 0.55))
        else:
            panels.show_image(axes, image)
        axes.set_title(label, loc="left", fontsize=7.5, pad=2)


def lost_beams(ideal, scan):
    missing = {row["beam"] for row in scan if row["x_m"] is None}
    return [row for row in ideal if row["beam"] in missing]


def draw_scans(bench, picture, block):
    pair = block.subplots(1, 2, sharey=True)
    truth = scan_rows(bench, picture, (picture.off[0], ""), FINE_BEAMS)
    off, on = (scan_rows(bench, picture, setting, picture.beams) for setting in (picture.off, picture.on))
    lost = lost_beams(off, on) if picture.marks_lost else ()
    names = (picture.names, picture.names + picture.names_on)
    for axes, scan, label, gone, texts in zip(pair, (off, on), picture.labels, ((), lost), names):
        color_by = picture.color_by if picture.color_by in scan[0] else ""
        points = panels.show_scan(axes, scan, picture.view, truth, gone, texts, color_by, picture.color_range)
        axes.set_title(label, loc="left", fontsize=7.5, pad=2)
        axes.set_xlabel("x in m", fontsize=6.5, labelpad=1)
    pair[0].set_ylabel("y in m", fontsize=6.5, labelpad=4)
    if picture.color_by:
        bar = block.colorbar(points, ax=list(pair), shrink=0.85, aspect=25, pad=0.02)
        bar.set_label(f"{picture.color_by} in 1/m²", fontsize=6.5, labelpad=2)
        bar.ax.tick_params(labelsize=6.5, length=2, pad=1.5)


def blocks_of(drawing, count):
    """As many parts of the drawing, two beside each other; the last of an odd number has a row of its own."""
    rows = -(-count // 2)
    parts = []
    for row, strip in enumerate(drawing.subfigures(rows, 1, squeeze=False)[:, 0]):
        parts += list(strip.subfigures(1, min(2, count - 2 * row), wspace=0.03, squeeze=False)[0])
    return parts


def entitle(block, picture):
    name = picture.effect.replace("_", r"\_")
    block.suptitle(f"$\\bf{{{name}}}$\n{picture.caption}", x=0.01, ha="left", fontsize=8)


def draw_sheet(path, pictures, draw_block, block_inches, key, **format_options):
    height = -(-len(pictures) // 2) * block_inches
    key_inches = 0.3 if key else 0
    drawing = new_drawing(figsize=(WIDTH_INCHES, height + key_inches), layout="constrained")
    drawing.get_layout_engine().set(w_pad=0.03, h_pad=0.05)
    body = drawing
    if key:
        head, body = drawing.subfigures(2, 1, height_ratios=(key_inches, height))
        head.legend(handles=key, loc="center", ncols=len(key), fontsize=7.5)
    with Bench() as bench:
        for block, picture in zip(blocks_of(body, len(pictures)), pictures):
            print("effects:", picture.effect, file=sys.stderr)
            entitle(block, picture)
            draw_block(bench, picture, block)
    drawing.savefig(path, dpi=DOTS_PER_INCH, **format_options)


def main():
    folder = Path(sys.argv[1])
    draw_sheet(folder / "effects_camera.jpg", CAMERA, draw_camera, 1.95, (), pil_kwargs={"quality": 85})
    for name, pictures in (("light", SCANNER_LIGHT), ("errors", SCANNER_ERRORS)):
        key = panels.key(any(picture.marks_lost for picture in pictures))
        draw_sheet(folder / f"effects_scanner_{name}.png", pictures, draw_scans, 2.7, key, metadata={"Software": None})


if __name__ == "__main__":
    main()
