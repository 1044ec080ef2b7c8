"""Run: make experiment.

Draws docs/experiment.svg: the paper's Figure 5 (a) to (d) as the experiments in MuJoCo have it. Grey: the
first experiment, hard limits and a potential field. Black: the second, tope's default.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import tope

ROOT = Path(__file__).parents[1]
RUNS = {"#999": "youbot_experiment_potential_field", "#111": "youbot_experiment_velocity"}  # colour, scenario
PANELS = (
    ("(a) base_x [m]", "q.base_x", 0.35),
    ("(b) arm_joint_5 [rad]", "q.arm_joint_5", 2.897),
    ("(c) base_x, velocity [m/s]", "v.base_x", None),
    ("(d) arm_joint_5, velocity [rad/s]", "v.arm_joint_5", None),
)  # title, column of the log, limit
WIDTH, HEIGHT, MARGIN = 420, 200, 46  # of a panel [px]
SECONDS = 6.0  # drawn; later nothing can be seen
EVERY = 10  # cycles between points

Array = NDArray[np.float64]


def round_values(low: float, high: float) -> Array:
    """Two to five round numbers in a range."""
    step = 10 ** np.floor(np.log10(high - low))
    step *= next(share for share in (1, 0.5, 0.2) if (high - low) / (share * step) >= 3)
    return np.arange(np.ceil(low / step), np.floor(high / step) + 1) * step + 0.0


def panel(title: str, curves: list[tuple[str, Array, Array]], limit: float | None) -> str:
    """One plot as SVG, its corner at the origin."""
    values = np.concatenate([y for _, _, y in curves] + ([np.array([limit])] if limit else []))
    low, high = values.min(), values.max()
    low, high = low - 0.05 * (high - low), high + 0.05 * (high - low)

    def x_of(t: Array | float) -> Array:
        return np.asarray(MARGIN + t / SECONDS * (WIDTH - MARGIN - 10))

    def y_of(value: Array | float) -> Array:
        return np.asarray(24 + (high - value) / (high - low) * (HEIGHT - 48))

    def line(points: str, colour: str, style: str = "") -> str:
        return f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.3" {style}/>'

    def level(value: float, colour: str, style: str = "") -> str:
        return line(f"{x_of(0.0):.1f},{y_of(value):.1f} {x_of(SECONDS):.1f},{y_of(value):.1f}", colour, style)

    parts = [f'<text x="{MARGIN}" y="15" font-weight="bold">{title}</text>']
    for tick in round_values(low, high):
        parts.append(level(tick, "#e5e5e5"))
        parts.append(f'<text x="{MARGIN - 5}" y="{y_of(tick) + 4:.1f}" text-anchor="end">{tick:g}</text>')
    for second in range(int(SECONDS) + 1):
        at = f'x="{x_of(float(second)):.1f}" y="{HEIGHT - 8}"'
        parts.append(f'<text {at} text-anchor="middle">{second}{" s" if second == SECONDS else ""}</text>')
    if limit:
        parts.append(level(limit, "#c33", 'stroke-dasharray="5 4"'))
    for colour, t, y in curves:
        parts.append(
            line(" ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x_of(t), y_of(y), strict=True)), colour)
        )
    return "\n".join(parts)


def main() -> None:
    """Run both experiments and write the figure."""
    logs = {
        colour: tope.simulate(ROOT / f"scenarios/{name}.yaml", overrides={"duration": SECONDS}).log
        for colour, name in RUNS.items()
    }
    groups = []
    for place, (title, column, limit) in enumerate(PANELS):
        curves = [(colour, log["t"][::EVERY], log[column][::EVERY]) for colour, log in logs.items()]
        corner = f"translate({place % 2 * WIDTH} {place // 2 * HEIGHT})"
        groups.append(f'<g transform="{corner}">\n{panel(title, curves, limit)}\n</g>')
    size = f'width="{2 * WIDTH}" height="{2 * HEIGHT}"'
    style = '<rect width="100%" height="100%" fill="white"/>'
    out = ROOT / "docs/experiment.svg"
    out.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif" font-size="12">\n'
        f"{style}\n" + "\n".join(groups) + "\n</svg>\n",
        encoding="utf-8",
    )
    print(f"wrote {out}")


if __name__ == "__main__":
    main()
