# SPDX-License-Identifier: GPL-2.0-or-later
"""Meshes of quadrilaterals as .msh files (format 2.2), and tools as polylines."""
import random


class Mesh:
    """A rectangle 0 <= r <= radius, lowest <= z <= lowest + height (or inner <= r)."""

    def __init__(self, radius, height, radial, axial, lowest=0.0, inner=0.0, symmetry=False):
        self.radius, self.height, self.lowest, self.inner = radius, height, lowest, inner
        self.symmetry = symmetry  # the lower end is a symmetry line
        self.size = ((radius - inner) / radial, height / axial)
        self.nodes = [
            (inner + (radius - inner) * i / radial, lowest + height * j / axial)
            for j in range(axial + 1) for i in range(radial + 1)
        ]
        n = radial + 1
        self.cells = [(j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i) for j in range(axial) for i in range(radial)]
        self.named = {"axis": [], "symmetry": []}
        if inner == 0:
            self.named["axis"] = [(j * n, (j + 1) * n) for j in range(axial)]
        if symmetry:
            self.named["symmetry"] = [(i, i + 1) for i in range(radial)]

    def map(self, function):
        self.nodes = [function(r, z) for r, z in self.nodes]
        return self

    def distort(self, share, seed):
        """Moves the inner nodes by up to this share of a cell in both directions, as good as at random."""
        generator = random.Random(seed)

        def move(r, z):
            inside = (
                1e-9 < r - self.inner < self.radius - self.inner - 1e-9
                and 1e-9 < z - self.lowest < self.height - 1e-9
            )
            a, b = generator.uniform(-share, share), generator.uniform(-share, share)
            return (r + a * self.size[0], z + b * self.size[1]) if inside else (r, z)

        return self.map(move)

    def mirror(self):
        """z -> -z; cells keep their sense of rotation."""
        self.map(lambda r, z: (r, -z))
        self.cells = [tuple(reversed(cell)) for cell in self.cells]
        return self

    def renumber(self, seed):
        """Nodes and cells in another order, cells beginning at another corner."""
        generator = random.Random(seed)
        order = list(range(len(self.nodes)))
        generator.shuffle(order)  # order[new] = old
        new = {old: position for position, old in enumerate(order)}
        self.nodes = [self.nodes[old] for old in order]

        def turned(cell):
            first = generator.randrange(4)
            return tuple(new[node] for node in cell[first:] + cell[:first])

        self.cells = [turned(cell) for cell in self.cells]
        generator.shuffle(self.cells)
        self.named = {name: [tuple(new[node] for node in edge) for edge in edges] for name, edges in self.named.items()}
        return self

    def smallest_jacobian(self):
        """Of the corners, over the area of an undistorted cell."""
        worst = float("inf")
        for cell in self.cells:
            corners = [self.nodes[node] for node in cell]
            for k in range(4):
                (r0, z0), (r1, z1), (r2, z2) = corners[k - 1], corners[k], corners[(k + 1) % 4]
                worst = min(worst, (r1 - r0) * (z2 - z1) - (z1 - z0) * (r2 - r1))
        return worst / (self.size[0] * self.size[1])

    def write(self, path):
        names = [(1, 1, "axis"), (1, 2, "symmetry"), (2, 3, "workpiece")]
        names = [entry for entry in names if entry[0] == 2 or self.named[entry[2]]]
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))]
        lines += [f'{dimension} {tag} "{name}"' for dimension, tag, name in names]
        lines += ["$EndPhysicalNames", "$Nodes", str(len(self.nodes))]
        lines += [f"{i} {r:.17g} {z:.17g} 0" for i, (r, z) in enumerate(self.nodes, 1)]
        elements = [(1, tag, edge) for _, tag, name in names if name != "workpiece" for edge in self.named[name]]
        elements += [(3, 3, cell) for cell in self.cells]
        lines += ["$EndNodes", "$Elements", str(len(elements))]
        for i, (kind, tag, nodes) in enumerate(elements, 1):
            lines.append(f"{i} {kind} 2 {tag} {tag} " + " ".join(str(node + 1) for node in nodes))
        lines.append("$EndElements")
        path.write_text("\n".join(lines) + "\n")


def polyline(path, points):
    path.write_text("r_mm, z_mm\n" + "".join(f"{r:.17g}, {z:.17g}\n" for r, z in points))
