"""The plot of drawn depth against cast depth, from the rows of bench/camera_depth.py: the difference beside the stated bound."""
import sys
from pathlib import Path

from matplotlib.colors import LogNorm
from matplotlib.pyplot import subplots

from figure import rows, save

LOW, HIGH = -9, 1  # decades of metres
EDGE = "#c0392b"


def draw_panel(axes, scene, cells):
    axes.plot([LOW, HIGH], [LOW, HIGH], color="#888888", linewidth=0.8, zorder=1)
    axes.annotate("difference = bound", (LOW + 0.4, LOW + 0.4), fontsize=6.5, color="#666666", rotation=42, rotation_mode="anchor",
                  xytext=(0, 3), textcoords="offset points")
    kept = [(float(c["bound_log10_m"]), float(c["difference_log10_m"]), int(c["pixels"]), int(c["edge"])) for c in cells]
    inside = [(x, y, n - other) for x, y, n, other in kept if n > other]
    drawn = axes.scatter([x + 0.125 for x, _, _ in inside], [y + 0.125 for _, y, _ in inside], c=[n for _, _, n in inside], s=13, marker="s",
                         cmap="viridis_r", norm=LogNorm(1, 3e5), linewidths=0, zorder=2)
    edges = [(x, y) for x, y, _, other in kept if other]
    axes.scatter([x + 0.125 for x, _ in edges], [y + 0.125 for _, y in edges], s=10, marker="x", color=EDGE, linewidths=0.8, zorder=3,
                 label="beyond the bound at an edge")
    beyond = sum(int(c["beyond_bound"]) for c in cells)
    pixels, others = sum(n for _, _, n, _ in kept), sum(other for _, _, _, other in kept)
    axes.set_title(f"{scene}: {pixels:,} pixels\nbeyond the bound: {others} at edges, {beyond} others", loc="left")
    axes.set_xlim(LOW, HIGH)
    axes.set_ylim(LOW, HIGH)
    axes.set_xticks(range(LOW, HIGH + 1, 2), [f"$10^{{{k}}}$" for k in range(LOW, HIGH + 1, 2)])
    axes.set_yticks(range(LOW, HIGH + 1, 2), [f"$10^{{{k}}}$" for k in range(LOW, HIGH + 1, 2)])
    axes.set_xlabel("bound of the drawn depth, m")
    return drawn


def main():
    cells = rows(sys.argv[1])
    scenes = list(dict.fromkeys(row["scene"] for row in cells))
    drawing, panels = subplots(1, len(scenes), figsize=(3.6 * len(scenes) + 0.8, 3.9), sharey=True, layout="constrained")
    for axes, scene in zip(panels, scenes):
        drawn = draw_panel(axes, scene, [row for row in cells if row["scene"] == scene])
    panels[0].set_ylabel("difference of drawn and cast depth, m")
    panels[0].legend(fontsize=6.5, loc="upper left")
    drawing.colorbar(drawn, ax=panels, label="pixels", shrink=0.8)
    save(drawing, Path(sys.argv[2]) / "camera_depth")


if __name__ == "__main__":
    main()
