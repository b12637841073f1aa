"""Curves over time as SVG, and as a line of text."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robophm.report.markup import Html, element, number, shorten, text_width
from robophm.report.svg import svg, text
from robophm.report.words import number_text

Array = NDArray[np.float64]

_SIZE, _TITLE = 11.0, 13.0  # font sizes
_BLOCKS = "▁▂▃▄▅▆▇█"
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

_STYLE = (
    f".curve text{{font-size:{_SIZE:g}px;fill:var(--quiet)}}"
    f".curve .title{{font-size:{_TITLE:g}px;font-weight:600;fill:var(--ink)}}"
    ".curve .legend{fill:var(--ink)}.curve .back{fill:var(--paper);fill-opacity:.85}"
    ".curve .axis,.curve .grid{fill:none;stroke:var(--line)}.curve .grid{stroke-opacity:.3}"
    ".curve .line{fill:none;stroke-width:1.6;stroke-linejoin:round;stroke-linecap:round}"
    ".curve .dashed{stroke-dasharray:5 4;stroke-linecap:butt}"
    ".curve .middle{text-anchor:middle}.curve .right{text-anchor:end}"
    + "".join(f".curve .c{i}{{stroke:var(--c{i})}}" for i in range(6))
)


@dataclass(frozen=True)
class Line:
    """One curve, y over x, shape (n,) each; NaN is a gap. By habit nominal is solid, sensor-based dashed."""

    name: str
    x: ArrayLike
    y: ArrayLike
    dashed: bool = False


def curve_svg(
    lines: Sequence[Line],
    *,
    title: str,
    x_label: str,
    y_label: str,
    width: float = 460,
    height: float = 280,
    log_y: bool = False,
    one_minus: bool = False,
    standalone: bool = False,
) -> Html:
    """Curves in one frame of ``width`` × ``height`` [px] whose range fits the data; labels carry the units.

    ``log_y`` leaves out what is not positive; ``one_minus`` draws 1 − y on a logarithmic axis, where
    reliabilities near 1 can be told apart. Infinite values are gaps. Raises ``ValueError`` where x and y
    differ in shape.
    """
    if one_minus:
        y_label = f"1 − {y_label}"
    log_y = log_y or one_minus
    data = [_points(line, one_minus, log_y) for line in lines]
    x_range = _range([x for x, _ in data], pad=0)
    y_range = _range([y for _, y in data], pad=0.06, from_zero=not log_y)
    x_ticks, x_texts, x_power = _axis(x_range, int(width // 90))
    y_ticks, y_texts, y_power = _axis(y_range, int(height // 50), log=log_y)

    left = 12 + max((text_width(says, _SIZE) for says in y_texts), default=0)
    right, top, bottom = width - 14, 48, height - 40
    x_at = _scale(x_range, (left, right))
    y_at = _scale(y_range, (bottom, top))
    paths = [_path(x_at(x), y_at(y), right - left) for x, y in data]
    y_name, x_name = (" ".join(filter(None, pair)) for pair in ((y_label, y_power), (x_label, x_power)))
    grid = "".join(f"M{number(left)} {number(y)}H{number(right)}" for y in y_at(y_ticks))
    marks = "".join(f"M{number(x)} {number(bottom)}v4" for x in x_at(x_ticks))
    empty = not any(path for path, _ in paths)
    content = [
        text(2, 14, shorten(title, width - 8, _TITLE, bold=True), "title"),
        text(2, 34, shorten(y_name, width - 8, _SIZE)),
        element("path", class_="grid", d=grid),
        element("path", class_="axis", d=f"M{number(left)} {top}V{number(bottom)}H{number(right)}{marks}"),
        *(text(left - 6, y + 4, says, "right") for y, says in zip(y_at(y_ticks), y_texts, strict=True)),
        *(text(x, bottom + 17, says, "middle") for x, says in zip(x_at(x_ticks), x_texts, strict=True)),
        text((left + right) / 2, height - 6, shorten(x_name, right - left, _SIZE), "middle"),
        *(_stroke(i, line, path) for i, (line, (path, _)) in enumerate(zip(lines, paths, strict=True)) if path),
        text((left + right) / 2, (top + bottom) / 2, "no data", "middle") if empty else Html(),
        _legend(lines, [spots for _, spots in paths], (left, right, top, bottom)),
    ]
    return svg(
        "curve",
        content,
        title=title,
        description=_words(lines, data, x_label, y_label, log_y),
        style=_STYLE,
        view=(0, 0, width, height),
        standalone=standalone,
    )


def sparkline(values: ArrayLike, width: int = 20) -> str:
    """Values as at most ``width`` characters ▁▂▃▄▅▆▇█, means of equal shares; NaN and infinite are gaps."""
    y = np.asarray(values, dtype=float).ravel()
    y = np.where(np.isfinite(y), y, np.nan)
    shares = np.array_split(y, min(width, y.size)) if y.size and width > 0 else []
    means = [float(np.mean(share[np.isfinite(share)])) if np.isfinite(share).any() else math.nan for share in shares]
    seen = [mean for mean in means if not math.isnan(mean)]
    low, high = min(seen, default=0.0), max(seen, default=0.0)

    def block(mean: float) -> str:
        if math.isnan(mean):
            return " "
        return _BLOCKS[round(7 * (mean - low) / (high - low))] if high > low else _BLOCKS[3]

    return "".join(map(block, means))


def ticks(low: float, high: float, about: int = 5) -> Array:
    """Round values in [low, high], their step 1, 2 or 5 times a power of ten, at most about that many."""
    if not low < high:
        return np.array([low])
    power = 10.0 ** math.floor(math.log10((high - low) / about))
    step = next(s for s in (1, 2, 5, 10, 20) if s * power * about >= (high - low) * (1 - 1e-9)) * power
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    # to 15 digits: 0.3, not 0.30000000000000004
    return np.array([float(f"{i * step:.15g}") for i in range(first, last + 1)])


def tick_texts(values: ArrayLike) -> tuple[list[str], str]:
    """Texts of equidistant ticks, and the power of ten taken out of them: (["0", "0.5", "1.0"], "×10⁻⁵")."""
    at = np.asarray(values, dtype=float)
    largest = float(np.abs(at).max(initial=0))
    power = math.floor(math.log10(largest) + 1e-9) if largest and not 1e-2 <= largest < 1e5 else 0
    at = at / 10.0**power
    step = float(np.diff(at).min()) if at.size > 1 else abs(float(at[0])) if at.size and at[0] else 1.0
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    return [f"{value + 0.0:.{decimals}f}" for value in at], f"×{_ten(power)}" if power else ""


def _ten(power: int) -> str:
    return "10" + str(power).translate(_RAISED)


def log_ticks(low: float, high: float) -> tuple[Array, list[str]]:
    """Decades in [low, high] of logarithms, with 2 and 5 between where they are few."""
    decades = range(math.floor(low), math.ceil(high) + 1)
    steps = (1,) if high - low > 3 else (1, 2, 5) if high - low > 0.7 else range(1, 10)
    every = max(1, len(decades) // 6)
    found = [(m, d) for d in decades if d % every == 0 for m in steps if low <= d + math.log10(m) <= high]
    if len(found) < 2:  # less than a step: plain numbers say more
        plain = ticks(10**low, 10**high)
        return np.log10(plain), [number_text(float(value)) for value in plain]
    texts = [_ten(d) if m == 1 else f"{m}·{_ten(d)}" for m, d in found]
    return np.array([d + math.log10(m) for m, d in found]), texts


def _axis(span: tuple[float, float], about: int, *, log: bool = False) -> tuple[Array, list[str], str]:
    """The ticks of an axis, their texts, and the power of ten taken out of them."""
    if log:
        return *log_ticks(*span), ""
    at = ticks(*span, max(2, about))
    return at, *tick_texts(at)


def _points(line: Line, one_minus: bool, log_y: bool) -> tuple[Array, Array]:
    """The line where x is finite, in the axes' own coordinates; NaN where y cannot be drawn."""
    x, y = np.asarray(line.x, dtype=float), np.asarray(line.y, dtype=float)
    if x.shape != y.shape or x.ndim != 1:
        raise ValueError(f"line '{line.name}': x {x.shape} and y {y.shape}; expected the same shape (n,)")
    x, y = x[np.isfinite(x)], (1 - y if one_minus else y)[np.isfinite(x)]
    y = np.where(np.isfinite(y) & (y > 0 if log_y else True), y, np.nan)
    return x, np.log10(y) if log_y else y


def _range(columns: list[Array], pad: float, from_zero: bool = False) -> tuple[float, float]:
    """A range around the data, never of no width; ``from_zero`` where they come near it."""
    values = np.concatenate([np.empty(0), *columns])
    seen = values[np.isfinite(values)]
    if not seen.size:
        return 0.0, 1.0
    low, high = float(seen.min()), float(seen.max())
    if high - low <= 1e-12 * max(abs(low), abs(high)):
        return low - (0.05 * abs(low) or 1.0), high + (0.05 * abs(high) or 1.0)
    pad *= high - low
    return (0.0 if from_zero and 0 <= low < 0.25 * high else low - pad), high + pad


def _scale(values: tuple[float, float], pixels: tuple[float, float]) -> Callable[[Array], Array]:
    (low, high), (start, stop) = values, pixels
    return lambda at: start + (at - low) / (high - low) * (stop - start)


def _path(x: Array, y: Array, width: float) -> tuple[str, Array]:
    """The SVG path of a line in pixels, and the spots it passes; long lines by each pixel's extremes."""
    if x.size > 2 * width and np.all(np.diff(x) >= 0):
        x, y = _thin(x, y)
    path: list[str] = []
    pen_down = False
    for at, to in zip(x.tolist(), y.tolist(), strict=True):
        if math.isnan(to):
            if pen_down and path[-1].startswith("M"):
                path.append("h0")  # a point alone is a dot, thanks to round ends
            pen_down = False
            continue
        path.append(f"{'L' if pen_down else 'M'}{number(at)} {number(to)}")
        pen_down = True
    if path and path[-1].startswith("M"):
        path.append("h0")
    seen = ~np.isnan(y)
    return "".join(path), np.column_stack([x[seen], y[seen]])


def _thin(x: Array, y: Array) -> tuple[Array, Array]:
    """Lowest and highest point of every pixel column, in the order they come; columns of NaN are gaps."""
    starts = np.flatnonzero(np.diff(np.floor(x), prepend=np.nan) != 0)
    low, high = np.fmin.reduceat(y, starts), np.fmax.reduceat(y, starts)
    ends = np.append(starts[1:], x.size) - 1
    rising = ~(y[starts] > y[ends])
    pairs = np.column_stack([np.where(rising, low, high), np.where(rising, high, low)])
    return np.repeat(x[starts], 2), pairs.ravel()


def _stroke(i: int, line: Line, path: str) -> Html:
    return element("path", class_=f"line c{i % 6}{' dashed' * line.dashed}", d=path)


def _legend(lines: Sequence[Line], spots: list[Array], frame: tuple[float, float, float, float]) -> Html:
    """The names in the corner where the lines leave most room."""
    if len(lines) < 2:
        return Html()
    left, right, top, bottom = frame
    passed = np.vstack(spots)
    names = [shorten(line.name, (right - left) / 2, _SIZE) for line in lines]
    wide, high = 40 + max(text_width(name, _SIZE) for name in names), 16 * len(names) + 6

    def crowd(corner: tuple[float, float]) -> int:
        inside = (passed >= corner) & (passed <= (corner[0] + wide, corner[1] + high))
        return int(inside.all(axis=1).sum())

    corners = [(x, y) for y in (top + 2, bottom - high - 4) for x in (right - wide - 2, left + 6)]
    x, y = min(corners, key=crowd)
    rows = [
        part
        for i, (line, name) in enumerate(zip(lines, names, strict=True))
        for part in (
            _stroke(i, line, f"M{number(x + 5)} {number(y + 11 + 16 * i)}h24"),
            text(x + 35, y + 15 + 16 * i, name, "legend"),
        )
    ]
    return element("g", element("rect", class_="back", x=x, y=y, width=wide, height=high, rx=3), *rows)


def _words(lines: Sequence[Line], data: Sequence[tuple[Array, Array]], x_label: str, y_label: str, log_y: bool) -> str:
    says = [f"{y_label} over {x_label}."]
    for line, (x, y) in zip(lines, data, strict=True):
        seen = np.flatnonzero(~np.isnan(y))
        if not seen.size:
            says.append(f"{line.name}: no data.")
            continue
        (x0, x1), (y0, y1) = x[seen[[0, -1]]], (10**y if log_y else y)[seen[[0, -1]]]
        says.append(f"{line.name}: {y0:.6g} at {x0:.4g} to {y1:.6g} at {x1:.4g}.")
    return " ".join(says)
