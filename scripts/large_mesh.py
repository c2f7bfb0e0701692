#!/usr/bin/env python3
"""Writes a binary PLY file of a hilly square, as large as a scan: two triangles a cell.

usage: large_mesh.py OUT.ply [TRIANGLES] [--normals]     (10 million triangles unless told otherwise)
"""
import array
import math
import sys


def main():
    words = [word for word in sys.argv[1:] if not word.startswith("-")]
    if not words:
        sys.exit(__doc__)
    side = max(1, math.ceil(math.sqrt(int(words[1] if len(words) > 1 else 10_000_000) / 2)))
    normals = "--normals" in sys.argv
    waves = [(0.11, 2.3, 1.1, 0.3), (0.05, 5.2, -4.1, 1.7), (0.02, 13.0, 11.0, 0.9),
             (0.004, 71.0, -53.0, 2.2), (0.001, 211.0, 307.0, 0.1)]
    with open(words[0], "wb") as out:
        names = ["x", "y", "z"] + (["nx", "ny", "nz"] if normals else [])
        out.write(("ply\nformat binary_%s_endian 1.0\nelement vertex %d\n" %
                   (sys.byteorder, (side + 1) ** 2) +
                   "".join("property float %s\n" % name for name in names) +
                   "element face %d\nproperty list uchar uint vertex_indices\nend_header\n" %
                   (2 * side * side)).encode())
        for row in range(side + 1):
            z = 2 * row / side - 1
            values = array.array("f")
            for column in range(side + 1):
                x = 2 * column / side - 1
                y = sum(a * math.sin(f * x + g * z + p) for a, f, g, p in waves)
                values.extend((x, y, z))
                if normals:
                    slopes = [a * math.cos(f * x + g * z + p) for a, f, g, p in waves]
                    values.extend((-sum(s * w[1] for s, w in zip(slopes, waves)), 1.0,
                                   -sum(s * w[2] for s, w in zip(slopes, waves))))
            out.write(values.tobytes())
        for row in range(side):
            block = bytearray()
            for column in range(side):
                at = row * (side + 1) + column
                below = at + side + 1
                for corners in ((at, below, at + 1), (at + 1, below, below + 1)):
                    block += b"\x03" + array.array("I", corners).tobytes()
            out.write(block)


if __name__ == "__main__":
    main()
