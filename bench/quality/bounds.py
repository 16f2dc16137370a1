#!/usr/bin/env python3
"""Prints how near F faces can come to a smooth surface: vertices kept on it, and vertices anywhere.

J.-M. Mirebeau: Optimal meshes for finite elements of arbitrary order. Constructive Approximation 32(2), 2010 (and, for
convex functions, L. Chen, P. Sun, J. Xu: Optimal anisotropic meshes for minimizing interpolation errors in L^p-norm.
Mathematics of Computation 76, 2007): over all triangulations, the error is to leading order that of the best triangle
for the surface's quadratic form at each point, with areas shared out so that the sum is least.

On a triangle of area A where the Gaussian curvature is K, the best triangle's mean and rms distances are c · sqrt|K| · A;
`constants` finds c by a search over triangles. Faces of areas A(x) with F = ∫ dx / A(x) then have, at best,
mean = (∫ sqrt(c sqrt|K|))² / (F · area) and rms = (∫ cbrt(c² |K|))^(3/2) / (F · sqrt(area)), by Hölder's inequality.
"""

import math
import random

# The best triangle's mean and rms over sqrt|K| · A, for K > 0 and K < 0; `main` checks them.
KEPT = {+1: (math.sqrt(3) / 6, math.sqrt(4 / 45)), -1: (1 / 12, math.sqrt(1 / 90))}
FREE_RMS = {+1: math.sqrt(1 / 180), -1: 1 / 15}
FORMS = {+1: lambda x, y: (x * x + y * y) / 2, -1: lambda x, y: x * y}  # |K| = 1
EQUILATERAL = ((0, 0), (1, 0), (0.5, math.sqrt(0.75)))


def samples(n):
    """Centroids of n² equal triangles, as barycentric coordinates."""
    up = [((i + 1 / 3) / n, (j + 1 / 3) / n) for i in range(n) for j in range(n - i)]
    down = [((i + 2 / 3) / n, (j + 2 / 3) / n) for i in range(n) for j in range(n - i - 1)]
    return [(1 - u - v, u, v) for u, v in up + down]


def area_of(t):
    (ax, ay), (bx, by), (cx, cy) = t
    return abs((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2


def errors(t, form, points):
    """Linear interpolation less the form."""
    at_corners = [form(*p) for p in t]
    for b in points:
        x, y = (sum(w * p[k] for w, p in zip(b, t)) for k in (0, 1))
        yield sum(w * f for w, f in zip(b, at_corners)) - form(x, y)


def without_affine(e, points):
    """The errors that the least-squares plane leaves."""
    n = len(e)
    mean = sum(e) / n
    var, cov = 1 / 18, -1 / 36  # of barycentric coordinates over a triangle
    du, dv = (sum(x * (b[k] - 1 / 3) for x, b in zip(e, points)) / n for k in (1, 2))
    det = var * var - cov * cov
    u, v = (var * du - cov * dv) / det, (var * dv - cov * du) / det
    return [x - mean - u * (b[1] - 1 / 3) - v * (b[2] - 1 / 3) for x, b in zip(e, points)]


def cost(t, form, points, order, free=False):
    area = area_of(t)
    if area < 1e-6:
        return math.inf
    e = list(errors(t, form, points))
    if free:
        e = without_affine(e, points)
    return (sum(abs(x) ** order for x in e) / len(e)) ** (1 / order) / area


def least(form, order, free):
    """The least cost over triangles, by random steps that shrink, from several starts."""
    coarse, fine = samples(16), samples(60)
    best = []
    for seed in range(8):
        rng = random.Random(seed)
        at = [rng.uniform(-1, 1) for _ in range(4)]
        triangle = lambda x: ((0, 0), (x[0], x[1]), (x[2], x[3]))
        value, step = cost(triangle(at), form, coarse, order, free), 0.5
        while step > 1e-4:
            to = [x + rng.gauss(0, step) for x in at]
            moved = cost(triangle(to), form, coarse, order, free)
            value, at, step = (moved, to, step * 1.3) if moved < value else (value, at, step * 0.95)
        best.append((value, cost(triangle(at), form, fine, order, free)))
    return min(best)[1]


def free_mean_of_equilateral():
    """Mean distance of the equilateral triangle from x² + y² over 2 after the offset that makes it least."""
    e = sorted(errors(EQUILATERAL, FORMS[+1], samples(200)))
    return sum(abs(x - e[len(e) // 2]) for x in e) / len(e) / area_of(EQUILATERAL)


def geodesic_sphere(k):
    """Mean and rms depth of an icosahedron's faces cut into k² and blown up to the unit sphere, and its faces."""
    g = (1 + math.sqrt(5)) / 2
    corners = [p for a in (-1, 1) for b in (-g, g) for p in ((0, a, b), (a, b, 0), (b, 0, a))]
    close = lambda p, q: math.dist(p, q) < 2.1
    ico = [(p, q, r) for i, p in enumerate(corners) for j, q in enumerate(corners[:i]) for r in corners[:j]
           if close(p, q) and close(q, r) and close(r, p)]
    unit = lambda p: tuple(x / math.hypot(*p) for x in p)
    total = [0, 0, 0]
    inside = samples(12)
    for face in ico:
        at = lambda i, j: unit(tuple((face[0][c] * (k - i - j) + face[1][c] * i + face[2][c] * j) for c in range(3)))
        small = [(at(i, j), at(i + 1, j), at(i, j + 1)) for i in range(k) for j in range(k - i)]
        small += [(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)) for i in range(k) for j in range(k - i - 1)]
        for t in small:
            u, v = ([q - p for p, q in zip(t[0], t[n])] for n in (1, 2))
            weight = math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
            for b in inside:
                depth = 1 - math.hypot(*(sum(w * p[c] for w, p in zip(b, t)) for c in range(3)))
                for order in range(3):
                    total[order] += weight * depth**order
    return total[1] / total[0], math.sqrt(total[2] / total[0]), 20 * k * k


def torus():
    """(K, dA) over the torus of quality's models."""
    n = 20000
    for i in range(n):
        c = math.cos(2 * math.pi * (i + 0.5) / n)
        yield c / (0.4 * (1 + 0.4 * c)), 0.4 * (1 + 0.4 * c) * (2 * math.pi) ** 2 / n


def saddle():
    """(K, dA) over the saddle of quality's models."""
    n = 300
    for i in range(n):
        for j in range(n):
            w = 1 + sum((2 * (k + 0.5) / n - 1) ** 2 for k in (i, j))
            yield -1 / w**2, math.sqrt(w) * 4 / n**2


def kept_bound(surface):
    """Mean and rms, times the number of faces."""
    area = m = s = 0
    for k, da in surface:
        mean, rms = KEPT[1 if k > 0 else -1]
        area += da
        m += math.sqrt(mean * math.sqrt(abs(k))) * da
        s += (rms**2 * abs(k)) ** (1 / 3) * da
    return m**2 / area, s**1.5 / math.sqrt(area)


def main():
    print("constants, by search:")
    for sign in (+1, -1):
        kept = [least(FORMS[sign], order, False) for order in (1, 2)]
        print(f"  K {sign:+}: kept {kept[0]:.4f} / {kept[1]:.4f}, free rms {least(FORMS[sign], 2, True):.4f};"
              f" in closed form {KEPT[sign][0]:.4f} / {KEPT[sign][1]:.4f}, {FREE_RMS[sign]:.4f}")
    free = free_mean_of_equilateral()
    print(f"  K +1: free mean of the equilateral triangle {free:.4f}")

    sphere_area = 4 * math.pi
    print("geodesic spheres, mean and rms over the bound:")
    for k in (2, 4, 8):
        mean, rms, faces = geodesic_sphere(k)
        print(f"  {faces} faces: {mean / (KEPT[1][0] * sphere_area / faces):.3f} /"
              f" {rms / (KEPT[1][1] * sphere_area / faces):.3f}")

    print("bounds, % of the diagonal, mean / rms:")
    sphere = KEPT[1][0] * sphere_area, KEPT[1][1] * sphere_area
    anywhere = free * sphere_area, FREE_RMS[1] * sphere_area
    for name, bound, diagonal, counts in (
        ("sphere, kept", sphere, math.sqrt(12), (1920, 384, 96)),
        ("sphere, free", anywhere, math.sqrt(12), (1920, 384, 96)),
        ("torus, kept", kept_bound(torus()), math.sqrt(2 * 2.8**2 + 0.8**2), (2048, 410, 102)),
        ("saddle, kept", kept_bound(saddle()), 3, (2000, 400, 100)),
    ):
        for faces in counts:
            print(f"  {name}@{faces}: {100 * bound[0] / faces / diagonal:.4f} / {100 * bound[1] / faces / diagonal:.4f}")


if __name__ == "__main__":
    main()
