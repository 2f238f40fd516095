# SPDX-License-Identifier: GPL-2.0-or-later
"""Outlines of tools and workpieces in the meridian plane: fillets, .geo files, heights, volumes."""
import math


class Outline:
    """An open chain of straight lines; each corner has a radius (0: sharp), less where there is no room."""

    def __init__(self, points, radii=0.0):
        # Corners that lie on each other are one.
        self.points, self.radii = [], []
        radii = [radii] * len(points) if isinstance(radii, (int, float)) else radii
        size = max(max(abs(r), abs(z)) for r, z in points)
        for point, radius in zip(points, radii):
            if not self.points or math.dist(point, self.points[-1]) > 1e-9 * size:
                self.points.append(point)
                self.radii.append(radius)
        self.curves = self._curves()

    def _curves(self):
        """("line", from, to) and ("arc", from, centre, to)."""
        points, curves, last = self.points, [], self.points[0]
        for i in range(1, len(points) - 1):
            before, here, after = points[i - 1], points[i], points[i + 1]
            lengths = math.dist(before, here), math.dist(here, after)
            u = [(before[k] - here[k]) / lengths[0] for k in (0, 1)]
            w = [(after[k] - here[k]) / lengths[1] for k in (0, 1)]
            half = 0.5 * math.acos(max(-1.0, min(1.0, u[0] * w[0] + u[1] * w[1])))
            # No more than 45 % of each line, so that neighbours have room.
            cut = min(self.radii[i] / math.tan(half), 0.45 * min(lengths)) if half < 1.56 else 0.0
            if cut <= 1e-6 * min(lengths):
                curves.append(("line", last, here))
                last = here
                continue
            begin = tuple(here[k] + cut * u[k] for k in (0, 1))
            end = tuple(here[k] + cut * w[k] for k in (0, 1))
            middle = [u[k] + w[k] for k in (0, 1)]
            way = cut / math.cos(half) / math.hypot(*middle)
            centre = tuple(here[k] + way * middle[k] for k in (0, 1))
            curves += [("line", last, begin), ("arc", begin, centre, end)]
            last = end
        return curves + [("line", last, points[-1])]

    def moved(self, dz):
        return Outline([(r, z + dz) for r, z in self.points], self.radii)

    def mirrored(self):
        """z -> -z."""
        return Outline([(r, -z) for r, z in self.points], self.radii)

    def samples(self, n=12):
        """Points along it, ends of curves included."""
        result = [self.points[0]]
        for curve in self.curves:
            if curve[0] == "arc":
                _, begin, centre, end = curve
                radius = math.dist(begin, centre)
                a, b = (math.atan2(p[1] - centre[1], p[0] - centre[0]) for p in (begin, end))
                turn = (b - a + math.pi) % (2 * math.pi) - math.pi
                for k in range(1, n):
                    ray = math.cos(a + turn * k / n), math.sin(a + turn * k / n)
                    result.append((centre[0] + radius * ray[0], centre[1] + radius * ray[1]))
            result.append(curve[-1])
        return result

    def heights(self, r):
        """All z that it has at this radius."""
        samples, found = self.samples(), []
        for (r0, z0), (r1, z1) in zip(samples, samples[1:]):
            if min(r0, r1) <= r <= max(r0, r1):
                found += [z0, z1] if r0 == r1 else [z0 + (z1 - z0) * (r - r0) / (r1 - r0)]
        return found

    def write(self, path):
        """The .geo of a tool."""
        lines, n = ["Point(1) = {%.12g, %.12g, 0};" % self.points[0]], 1
        for i, curve in enumerate(self.curves, 1):
            for r, z in curve[2:]:
                n += 1
                lines.append(f"Point({n}) = {{{r:.12g}, {z:.12g}, 0}};")
            arc = curve[0] == "arc"
            ends = f"{n - 2}, {n - 1}, {n}" if arc else f"{n - 1}, {n}"
            lines.append(f"{'Circle' if arc else 'Line'}({i}) = {{{ends}}};")
        numbers = ", ".join(str(i) for i in range(1, len(self.curves) + 1))
        lines.append(f'Physical Curve("tool") = {{{numbers}}};')
        path.write_text("\n".join(lines) + "\n")


def volume_between(lower, upper, radius, n=400):
    """Of the space between two outlines that have one height at each radius, inside this radius."""
    total, step = 0.0, radius / n
    for i in range(n):
        r = (i + 0.5) * step
        total += 2 * math.pi * r * step * max(0.0, min(upper.heights(r)) - max(lower.heights(r)))
    return total


def way_down(upper, lower, n=200):
    """The least distance along z: how far the upper outline can come down until it touches the lower one."""
    radii = {r for outline in (upper, lower) for r, _ in outline.samples()}
    outer = min(max(r for r, _ in outline.points) for outline in (upper, lower))
    radii |= {outer * i / n for i in range(n + 1)}
    ways = []
    for r in radii:
        if r <= outer:
            below, above = lower.heights(r), upper.heights(r)
            if below and above:
                ways.append(min(above) - max(below))
    return min(ways)


def volume_of(points):
    """Of the body of revolution of a closed chain of corners, counter-clockwise."""
    total = 0.0
    for (r0, z0), (r1, z1) in zip(points, points[1:] + points[:1]):
        total += math.pi / 3 * (r0 * r0 + r0 * r1 + r1 * r1) * (z1 - z0)
    return total


def area_of(points):
    return 0.5 * sum(r0 * z1 - r1 * z0 for (r0, z0), (r1, z1) in zip(points, points[1:] + points[:1]))


def write_workpiece(path, points, n_cells, symmetry=False):
    """The .geo of a workpiece of these corners, counter-clockwise; rows of cells if it has four."""
    size = math.sqrt(area_of(points) / n_cells)
    n = len(points)
    lines = [f"Point({i}) = {{{r:.12g}, {z:.12g}, 0, {size:.6g}}};" for i, (r, z) in enumerate(points, 1)]
    lines += [f"Line({i}) = {{{i}, {i % n + 1}}};" for i in range(1, n + 1)]
    lines += [f"Curve Loop(1) = {{{', '.join(str(i) for i in range(1, n + 1))}}};", "Plane Surface(1) = {1};"]
    if n == 4:
        along = [max(math.dist(points[0], points[1]), math.dist(points[2], points[3])),
                 max(math.dist(points[1], points[2]), math.dist(points[3], points[0]))]
        cells = [max(2, round(length / size)) for length in along]
        lines += [f"Transfinite Curve{{1, 3}} = {cells[0] + 1};",
                  f"Transfinite Curve{{2, 4}} = {cells[1] + 1};",
                  "Transfinite Surface{1};", "Recombine Surface{1};"]
    lines.append('Physical Surface("workpiece") = {1};')
    for i in range(n):
        if points[i][0] == 0 and points[(i + 1) % n][0] == 0:
            lines.append(f'Physical Curve("axis") = {{{i + 1}}};')
    if symmetry:
        lines.append('Physical Curve("symmetry") = {1};')
    path.write_text("\n".join(lines) + "\n")
    return size
