"""How a panel shows what one sensor measured."""
from matplotlib.colors import LogNorm
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

INK, TRUTH, ACCENT = "#1b3a57", "#c9c9c9", "#d55e00"
HIT_SIZE = 5


def bare(axes):
    axes.set_xticks([])
    axes.set_yticks([])
    axes.grid(False)
    for spine in axes.spines.values():
        spine.set_visible(False)


def show_image(axes, image, crop=None):
    """`crop`: (left, top, width, height) in pixels, which is shown in place of the whole, each pixel as a square."""
    if crop:
        left, top, width, height = crop
        image = image[top:top + height, left:left + width]
    axes.imshow(image, interpolation="nearest" if crop else "antialiased")
    bare(axes)


def magnify(axes, image, crop, place):
    """The image, with the part `crop` magnified in a frame at `place` (left, bottom, width, height; shares of axes)."""
    show_image(axes, image)
    left, top, width, height = crop
    axes.add_patch(Rectangle((left, top), width, height, fill=False, color="white", linewidth=1))
    inset = axes.inset_axes(place)
    show_image(inset, image, crop)
    for spine in inset.spines.values():
        spine.set_visible(True)
        spine.set_color("white")
        spine.set_linewidth(1.2)


def hits(scan):
    return [row for row in scan if row["x_m"] is not None]


def _scatter(axes, rows, **look):
    return axes.scatter([row["x_m"] for row in rows], [row["y_m"] for row in rows], linewidths=0, **look)


def show_scan(axes, scan, view, truth=(), lost=(), names=(), color_by="", color_range=()):
    """Hits from above in the sensor's frame: x to the right, y up, metres.

    `view`: least x, greatest x, least y, greatest y. `truth`: a scan that is drawn in grey below. `lost`: hits that are
    marked as lost. `names`: (x, y, text). `color_by`: the column that hits are coloured by, on a logarithmic scale over
    color_range. Returns what a colour bar needs."""
    _scatter(axes, hits(truth), s=3, color=TRUTH, zorder=1)
    look = {"color": INK}
    if color_by:
        look = {"c": [row[color_by] for row in hits(scan)], "cmap": "turbo", "norm": LogNorm(*color_range)}
    points = _scatter(axes, hits(scan), s=HIT_SIZE, zorder=3, **look)
    axes.scatter([row["x_m"] for row in hits(lost)], [row["y_m"] for row in hits(lost)], s=9, facecolors="none",
                 edgecolors=ACCENT, linewidths=0.7, zorder=2)
    axes.plot(0, 0, marker=">", color=ACCENT, markersize=6, zorder=4)
    for x, y, text in names:
        axes.text(x, y, text, fontsize=6.5, color="#444444", ha="center", va="center", zorder=5)
    axes.set_xlim(view[0], view[1])
    axes.set_ylim(view[2], view[3])
    axes.set_aspect("equal")
    axes.tick_params(labelsize=6.5, length=2, pad=1.5)
    axes.locator_params(nbins=5)
    return points


def key(marks_lost):
    """Handles of a legend for show_scan()."""
    handles = [Line2D([], [], linestyle="", marker="o", markersize=3, color=INK, label="hit"),
               Line2D([], [], linestyle="-", linewidth=2, color=TRUTH, label="the surfaces, by an ideal scan"),
               Line2D([], [], linestyle="", marker=">", markersize=6, color=ACCENT, label="scanner, looks along x")]
    if marks_lost:
        handles.append(Line2D([], [], linestyle="", marker="o", markersize=4, markerfacecolor="none",
                              markeredgecolor=ACCENT, label="lost"))
    return handles
