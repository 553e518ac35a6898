#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""The pictures of docs/validated.md, drawn from the figures of its tables without any package.

    python3 data/published/pictures.py            # writes docs/validated/*.svg anew
    python3 data/published/pictures.py --check    # fails if one of them has other figures than the page
"""

import math
import re
import sys
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"
STYLE = ("text{font:13px system-ui,sans-serif;fill:#222}.back{fill:#fff}.grid{stroke:#e2e2e2;fill:none}"
         ".frame{stroke:#888;fill:none}.line{fill:none;stroke-width:1.4}.c0{stroke:#555;fill:#555}"
         ".c1{stroke:#0072b2;fill:#0072b2}.c2{stroke:#d55e00;fill:#d55e00}.c3{stroke:#009e73;fill:#009e73}"
         "path.line{fill:none}.open{fill:#fff;stroke-width:1.4}"
         "@media(prefers-color-scheme:dark){text{fill:#ddd}.back,.open{fill:#17191d}.grid{stroke:#30343a}"
         ".c0{stroke:#c4c4c4;fill:#c4c4c4}.c1{stroke:#56b4e9;fill:#56b4e9}.c2{stroke:#ff8f4d;fill:#ff8f4d}"
         ".c3{stroke:#34d1a2;fill:#34d1a2}path.line{fill:none}.open{fill:#17191d}}")


def tables():
    """The figures of the page: by problem and row the published and the computed one."""
    page = (DOCS / "validated.md").read_text(encoding="utf-8")
    found = {}
    for problem, table in re.findall(r"<!-- figures of (.*?) -->\n(.*?)<!-- end -->", page, re.DOTALL):
        rows = [[cell.strip() for cell in line.split("|")[1:4]] for line in table.splitlines()[2:]]
        found[problem] = {what: (float(published), float(computed)) for what, published, computed in rows}
    return found


def ticks(low, high):
    """Round numbers between two limits, four to eight of them."""
    step = 10 ** math.floor(math.log10((high - low) / 4))
    step *= max(factor for factor in (1, 2, 2.5, 5) if (high - low) / (factor * step) >= 4)
    return [i * step for i in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


class Picture:
    """Panels beside each other, whose curves have one legend."""

    def __init__(self, *panels):
        self.panels = panels

    def svg(self):
        width = 10 + 470 * len(self.panels)
        names = {name: kind for panel in self.panels for name, kind, _ in panel.curves}
        legend, x, y = [], 70, 22
        for name, kind in names.items():
            length = 56 + 7 * len(name)
            if x > 70 and x + length > width:
                x, y = 70, y + 20
            sample = [(x, y), (x + 24, y)] if kind.startswith("line") else [(x + 12, y)]
            legend += [*mark(sample, kind), f'<text x="{x + 32}" y="{y + 4.5}">{name}</text>']
            x += length
        height = y + 338
        parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">',
                 f'<style>{STYLE}</style>', f'<rect class="back" width="{width}" height="{height}"/>']
        parts += legend
        for index, panel in enumerate(self.panels):
            parts += panel.parts(70 + 470 * index, y + 22, 380, 262)
        return "\n".join([*parts, "</svg>", ""])


class Panel:
    """A panel: labels of its axes, and curves, each with a name, a kind (`line 0`, `open 1`, `dots 2` ...) and points."""

    def __init__(self, across, up, curves, marks=None, logarithmic=False):
        self.across, self.up, self.curves, self.marks = across, up, curves, marks
        self.scale = math.log10 if logarithmic else float

    def parts(self, left, top, width, height):
        xs = [self.scale(x) for _, _, points in self.curves for x, _ in points]
        ys = [y for _, _, points in self.curves for _, y in points]
        x0, x1, y0, y1 = min(xs), max(xs), min([0.0, *ys]), max([0.0, *ys])
        x0, x1 = x0 - 0.06 * (x1 - x0), x1 + 0.06 * (x1 - x0)
        y0, y1 = y0 - (0.05 * (y1 - y0) if y0 < 0 else 0), y1 + 0.08 * (y1 - y0)

        def at_x(x):
            return left + width * (self.scale(x) - x0) / (x1 - x0)

        def at_y(y):
            return top + height * (y1 - y) / (y1 - y0)

        parts = []
        for x, text in self.marks or [(x, f"{x:g}") for x in ticks(x0, x1)]:
            parts += [f'<path class="grid" d="M{at_x(x):.1f} {top}v{height}"/>',
                      f'<text x="{at_x(x):.1f}" y="{top + height + 18}" text-anchor="middle">{text}</text>']
        for y in ticks(y0, y1):
            parts += [f'<path class="grid" d="M{left} {at_y(y):.1f}h{width}"/>',
                      f'<text x="{left - 8}" y="{at_y(y) + 4.5:.1f}" text-anchor="end">{y:g}</text>']
        middle = top + height / 2
        parts += [f'<rect class="frame" x="{left}" y="{top}" width="{width}" height="{height}"/>',
                  f'<text x="{left + width / 2:.0f}" y="{top + height + 40}" text-anchor="middle">{self.across}</text>',
                  f'<text x="{left - 50}" y="{middle:.0f}" text-anchor="middle" '
                  f'transform="rotate(-90 {left - 50} {middle:.0f})">{self.up}</text>']
        for _, kind, points in self.curves:
            parts += mark([(at_x(x), at_y(y)) for x, y in points], kind)
        return parts


def mark(points, kind):
    """A line, or circles at the points."""
    form, colour = kind.split()
    if form == "line":
        path = "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
        return [f'<path class="c{colour} line" d="M{path}"/>']
    radius, style = (5.5, " open") if form == "open" else (3, "")
    return [f'<circle class="c{colour}{style}" cx="{x:.1f}" cy="{y:.1f}" r="{radius}"/>' for x, y in points]


def pairs(table, pattern, places=float):
    """Points of the rows that match, published and computed, ordered along the axis."""
    found = [(places(*match.groups()), figures) for what, figures in table.items() if (match := re.fullmatch(pattern, what))]
    found.sort()
    return [[(x, figures[i]) for x, figures in found] for i in (0, 1)]


def kupfer(table):
    found = [(float(match[1]), float(match[2]), figures) for what, figures in table.items()
             if (match := re.fullmatch(r"(-1) : (\S+)", what))]
    found.sort(key=lambda row: row[1])
    published, computed = ([(figures[i] * a, figures[i] * b) for a, b, figures in found] for i in (0, 1))
    envelope = []
    for k in range(101):  # where both stresses press: Kupfer & Gerstle 1973
        a = 1 - k / 100
        size = (1 + 3.65 * a) / (1 + a) ** 2
        envelope.append((-size, -size * a))
    for k in range(101):  # where one of them pulls, up to the tensile strength of a tenth
        a = math.tan(math.pi / 2 * k / 100) if k < 100 else math.inf
        pressure = 0.1 / (a + 0.08) if k else 1.0
        if pressure > 1:
            continue
        envelope.append((-pressure, 0.1 * (1 - 0.8 * pressure)))
    return Picture(Panel("stress over the compressive strength", "the other stress over it", [
        ("Kupfer's envelope", "line 0", envelope), ("its points of the table", "open 0", published),
        ("computed", "dots 2", computed)]))


def karsan(table):
    published, computed = pairs(table, r"strain that remains after (\S+) e0, over e0")
    return Picture(Panel("strain at which it is unloaded, over e0", "strain that remains, over e0", [
        ("Karsan &amp; Jirsa's fit", "line 0", [(s / 50, 0.145 * (s / 50) ** 2 + 0.13 * s / 50) for s in range(101)]),
        ("its points of the table", "open 0", published), ("computed", "dots 2", computed)]))


def gopalaratnam(table):
    published, computed = pairs(table, r"stress over strength at (\S+) um")
    fit = [(w / 2, math.exp(-0.063 * (w / 2) ** 1.01)) for w in range(121)]
    return Picture(Panel("width of the crack (um)", "stress over the strength", [
        ("Gopalaratnam &amp; Shah's fit", "line 0", fit), ("its points of the table", "open 0", published),
        ("computed", "dots 2", computed)]))


def petersson(table):
    places = {"load at 0.36 mm": 1, "greatest load": 2, "load at 0.60 mm": 3}
    curves = []
    for colour, size in enumerate((20, 10, 5), 1):
        published, computed = pairs(table, rf"{size} mm, (.*) \(N\)", lambda what: places[what])
        curves.append((f"bricks of {size} mm", f"dots {colour}", computed))
    marks = [(place, name.replace("load ", "")) for name, place in places.items()]
    return Picture(Panel("deflection", "load (N)", [("published", "open 0", published), *curves], marks))


def ring(found):
    """Thrust and moment of the lining against the flexibility ratio: both formulas, the exact ring, and what is computed."""
    panels = []
    for force, unit in (("thrust", "kN/m"), ("moment", "kN m/m")):
        def of(problem, bond):
            return pairs(found[problem], rf"F = (\S+), {bond}, {force} \(.*\)")

        curves = []
        for bond, colour in (("full slip", 1), ("bonded", 2)):
            exact, computed = of("Exact ring", bond)
            wang, _ = of("Wang", bond)
            curves += [(f"Wang, {bond}", f"open {colour}", wang), (f"exact ring, {bond}", f"line {colour}", exact),
                       (f"computed, {bond}", f"dots {colour}", computed)]
        curves.append(("Penzien, bonded", "open 3", of("Penzien", "bonded")[0]))
        ratios = [(x, f"{x:g}") for x, _ in curves[1][2]]
        panels.append(Panel("flexibility ratio F", f"{force} ({unit})", curves, ratios, logarithmic=True))
    return Picture(*panels)


def main():
    found = tables()
    pictures = {"kupfer": kupfer(found["Kupfer"]), "karsan_jirsa": karsan(found["Karsan & Jirsa"]),
                "gopalaratnam_shah": gopalaratnam(found["Gopalaratnam & Shah"]),
                "petersson": petersson(found["Petersson"]), "ovaling": ring(found)}
    differ = []
    for name, picture in pictures.items():
        file, text = DOCS / "validated" / f"{name}.svg", picture.svg()
        if "--check" not in sys.argv[1:]:
            file.parent.mkdir(exist_ok=True)
            file.write_text(text, encoding="utf-8")
        elif not file.exists() or file.read_text(encoding="utf-8") != text:
            differ.append(file.name)
    if differ:
        sys.exit(f"other figures than in docs/validated.md: {', '.join(differ)}; run this without --check")


if __name__ == "__main__":
    main()
