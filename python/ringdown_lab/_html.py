"""What a notebook shows of a diagnosis: verdict, classes as bars, errors, observed beside simulated motion."""

from __future__ import annotations

from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

_WIDTH, _HEIGHT, _POINTS = 640, 180, 900


def diagnosis_html(content: dict[str, Any], series: dict[str, NDArray[np.float64]]) -> str:
    """The diagnosis as a fragment of HTML that loads nothing."""
    return (
        '<div style="font-family:sans-serif;max-width:44em">'
        f"<p><strong>{escape(content['verdict']['summary'])}</strong></p>"
        f"<p>{escape(_origin(content['records']))}</p>"
        f"{_bars(content['classes'])}{_errors(content['gap'])}{_plots(series, content['gap']['unit'])}</div>"
    )


def _origin(records: list[dict[str, Any]]) -> str:
    """Origin of the records, which a reader is always told."""
    return "; ".join(f"{row['path']}: {row['origin'].upper()}, {row['samples']} samples" for row in records)


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


def _plots(series: dict[str, NDArray[np.float64]], unit: str) -> str:
    own = series["record"] == 1.0
    time = series["time_s"][own]
    if time.size < 2:
        return ""
    observed, nominal, repaired = (series[name][own] for name in ("observed", "nominal", "repaired"))
    seconds = f"first record, {escape(unit)} over {time[-1] - time[0]:.3g} s"
    motion = _panel(time, [("observed", "#888", observed), ("repaired", "#27c", repaired)], 0.6 * _HEIGHT)
    errors = [("error as given", "#c44", observed - nominal), ("error repaired", "#27c", observed - repaired)]
    return f"{motion}{_panel(time, errors, _HEIGHT)}<p>{seconds}</p>"


def _panel(time: NDArray[np.float64], curves: list[tuple[str, str, NDArray[np.float64]]], height: float) -> str:
    """Curves over time as a picture with their names and the range that it spans."""
    finite = [curve for curve in curves if np.isfinite(curve[2]).all()]
    if not finite:
        return ""
    low, high = min(values.min() for *_, values in finite), max(values.max() for *_, values in finite)
    span = (high - low) or 1.0
    bins = np.array_split(np.arange(time.size), min(_POINTS // 2, time.size))
    drawn = ""
    for _, color, values in finite:
        # The largest and the smallest value of every bin: no spike is lost.
        extremes = (sorted((part[values[part].argmin()], part[values[part].argmax()])) for part in bins)
        chosen = np.array([at for pair in extremes for at in pair])
        x = (time[chosen] - time[0]) / (time[-1] - time[0]) * _WIDTH
        y = (high - values[chosen]) / span * (height - 2) + 1
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
        drawn += f'<polyline points="{points}" fill="none" stroke="{color}"/>'
    names = " · ".join(f'<span style="color:{color}">{name}</span>' for name, color, _ in finite)
    return (
        f"<p>{names}, {low:.3g} to {high:.3g}</p>"
        f'<svg viewBox="0 0 {_WIDTH} {height:.0f}" width="{_WIDTH}" role="img" aria-label="over time">{drawn}</svg>'
    )
