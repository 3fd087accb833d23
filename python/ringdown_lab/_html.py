"""What a notebook shows of a diagnosis: verdict, classes as bars, errors, observed beside simulated."""

from __future__ import annotations

from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

_WIDTH, _HEIGHT, _POINTS = 640, 180, 900
_LINES = (("observed", "#888"), ("nominal", "#c44"), ("repaired", "#27c"))


def diagnosis_html(content: dict[str, Any], series: dict[str, NDArray[np.float64]]) -> str:
    """The diagnosis as a fragment of HTML that loads nothing."""
    return (
        '<div style="font-family:sans-serif;max-width:44em">'
        f"<p><strong>{escape(content['verdict']['summary'])}</strong></p>"
        f"{_bars(content['classes'])}{_errors(content['gap'])}{_plot(series, content['gap']['unit'])}</div>"
    )


def _bars(classes: list[dict[str, Any]]) -> str:
    rows = "".join(
        f"<tr><td>{escape(row['id'])}</td>"
        f'<td style="width:14em"><div style="background:#27c;height:.8em;width:{100 * row["probability"]:.1f}%"></div></td>'
        f"<td>{row['probability']:.2f}</td><td>{_share(row)}</td></tr>"
        for row in classes
        if row["probability"] >= 0.01
    )
    if not rows:
        return ""
    return f"<table><tr><th>class</th><th colspan=2>probability</th><th>share of the gap</th></tr>{rows}</table>"


def _share(row: dict[str, Any]) -> str:
    share = row["gap_share"]
    return "" if share is None or share["value"] is None else f"{100 * share['value']:.0f} %"


def _errors(gap: dict[str, Any]) -> str:
    names = (("as given", "nominal"), ("recalibrated", "recalibrated"), ("repaired", "repaired"), ("noise", "noise_floor"))
    told = (f"{label} {gap[key]:.3g}" for label, key in names if gap[key] is not None)
    return f"<p>held-out error in {escape(gap['unit'])}: {' · '.join(told)}</p>"


def _plot(series: dict[str, NDArray[np.float64]], unit: str) -> str:
    own = series["record"] == 1.0
    time = series["time_s"][own]
    if time.size < 2:
        return ""
    # A point for each pixel and extreme: the largest and the smallest value of every bin.
    bins = np.array_split(np.arange(time.size), min(_POINTS // 2, time.size))
    low, high = np.inf, -np.inf
    lines: list[tuple[str, str, NDArray[np.int64]]] = []
    for name, color in _LINES:
        values = series[name][own]
        if not np.isfinite(values).all():
            continue
        extremes = (sorted((part[values[part].argmin()], part[values[part].argmax()])) for part in bins)
        chosen = np.array([at for pair in extremes for at in pair])
        lines.append((name, color, chosen))
        if name != "nominal":
            low, high = min(low, values.min()), max(high, values.max())
    margin = 0.1 * (high - low) or 1.0
    low, high = low - margin, high + margin

    def points(name: str, chosen: NDArray[np.int64]) -> str:
        x = (time[chosen] - time[0]) / (time[-1] - time[0]) * _WIDTH
        # A simulator that runs away is cut at the frame.
        y = (high - np.clip(series[name][own][chosen], low, high)) / (high - low) * _HEIGHT
        return " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))

    drawn = "".join(
        f'<polyline points="{points(name, chosen)}" fill="none" stroke="{color}"/>' for name, color, chosen in lines
    )
    legend = " · ".join(f'<span style="color:{color}">{name}</span>' for name, color, _ in lines)
    return (
        f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" width="{_WIDTH}" role="img" aria-label="observed and simulated">{drawn}</svg>'
        f"<p>{legend}, first record, {escape(unit)} over {time[-1] - time[0]:.3g} s</p>"
    )
