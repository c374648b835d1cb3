"""The plot of stated bounds against errors, from the rows of bench/accuracy: how tight bounds are."""
from matplotlib.pyplot import subplots

from accuracy_table import is_peer

LOW, HIGH = 1e-9, 1e-1  # the axes; errors below stand at their foot
RATIOS = (1, 10, 100)


def draw_panel(axes, rows, series):
    for ratio in RATIOS:
        axes.plot([LOW, HIGH], [ratio * LOW, ratio * HIGH], color="#888888", linewidth=0.8,
                  linestyle="-" if ratio == 1 else ":", zorder=1)
        text = "bound = error" if ratio == 1 else f"{ratio} times"
        axes.annotate(text, (2 * LOW, 2 * ratio * LOW), fontsize=6.5, color="#666666", rotation=39, rotation_mode="anchor",
                      xytext=(0, 3), textcoords="offset points")
    for key, (label, color, marker) in series.items():
        points = [(max(float(row["error_rel_median"]), LOW), float(row["bound_rel_median"])) for row in rows
                  if (row["method"], row["max_error_rel"]) == key and row["bound_rel_median"]]
        if points:
            axes.scatter(*zip(*points), s=16, color=color, marker=marker, linewidths=0.6, label=label, zorder=3)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(LOW / 2, HIGH)
    axes.set_ylim(LOW / 2, HIGH)
    axes.minorticks_off()


def draw(rows, series):
    """`series`: label, colour and marker of each method."""
    rows = [row for row in rows if not is_peer(row)]
    scanners = list(dict.fromkeys(row["scanner"] for row in rows))
    drawing, panels = subplots(1, len(scanners), figsize=(4.5 * len(scanners), 3.9), sharey=True, layout="constrained")
    for axes, scanner in zip(panels, scanners):
        draw_panel(axes, [row for row in rows if row["scanner"] == scanner], series)
        axes.set_title(f"{scanner}: a point for each scene and resolution", loc="left")
        axes.set_xlabel("median error of all beams, relative to the range")
    panels[0].set_ylabel("median bound of all beams, relative to the range")
    panels[0].legend(fontsize=6.5, loc="lower right")
    return drawing
