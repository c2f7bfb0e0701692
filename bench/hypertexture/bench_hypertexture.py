#!/usr/bin/env python3
"""How fast hypertexture is marched from the language, and how much of that is noise.

usage: bench/hypertexture/bench_hypertexture.py [--pse PROGRAM] [--res N] [--runs N]

Renders the fire ball and the tribble of gallery/1989 as they are. Noise's share is measured in place: the same
picture with every noise computed twice (the second, at another place, is added times a number too small to
change anything) takes longer by what noise costs. That is told twice: in operations that run, which does not
depend on the machine, and in processor time of one thread. Two threads over one is by the clock. Runs in turn,
medians with the lowest and highest. Two threads must give the bytes of one; a doubled noise must leave the
picture as it was, or nothing is reported.
"""

import argparse
import hashlib
import json
import pathlib
import re
import resource
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PICTURES = ["fire_ball", "tribble"]
LIBRARY = ["turbulence", "modulation"]


def functions(text):
    """The functions of a library file, each as its text, by name."""
    parts = re.split(r"^(?=function )", text, flags=re.M)[1:]
    return {re.match(r"function (\w+)", part).group(1): re.sub(r"(?m)^#.*\n", "", part) for part in parts}


def doubled(program):
    """The program with every noise computed twice: its own calls, and those of the library functions it uses."""
    known = {}
    for name in LIBRARY:
        known.update(functions((ROOT / "library" / f"{name}.pse").read_text()))
    needed, text = [], program
    while more := [n for n in known if n not in needed and re.search(rf"\b{n}\(", text)]:
        needed += more
        text += "".join(known[n] for n in more)
    text = re.sub(r"\bunoise\(", "0.5 + 0.5 * Noise(", text)
    text = re.sub(r"\bNoise\(", "twice(", text)
    return "Tiny = 1e-30\n" + text + "\nfunction twice(p)\n    return Noise(p) + Tiny * Noise(p + 17.3)\n"


def render(pse, program, out, res, threads):
    """Renders once: seconds by the clock, the processor's seconds, operations for each pixel, the picture's hash."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run = subprocess.run([pse, "render", program, "-o", out, "--res", f"{res}x{res}", "-t", str(threads),
                          "--stats=json", "--no-provenance", "-q", "--antialias", "none"],
                         stdout=subprocess.PIPE, text=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    stats = json.loads(run.stdout)
    compile_seconds = sum(v for k, v in stats["compile"].items() if k != "from_cache")
    cpu = after.ru_utime - before.ru_utime - compile_seconds
    operations = stats["operations"]["run"]["sample"]
    return stats["compute_seconds"], cpu, operations, hashlib.sha256(pathlib.Path(out).read_bytes()).hexdigest()


def spread(values, form):
    return f"{form % statistics.median(values)} [{form % min(values)} .. {form % max(values)}]"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pse", default=str(ROOT / "build" / "release" / "bin" / "pse"))
    parser.add_argument("--res", type=int, default=512)
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        for name in PICTURES:
            source = ROOT / "gallery" / "1989" / f"{name}.pse"
            twice = pathlib.Path(folder) / f"{name}_twice.pse"
            twice.write_text(doubled(source.read_text()))
            out = str(pathlib.Path(folder) / "out.png")
            one, two, ratio, share, per_ray = [], [], [], [], []
            rays = options.res ** 2 * int((re.search(r"samples = (\d+)", source.read_text()) or [0, 4])[1])
            for _ in range(options.runs):
                wall1, cpu1, operations, hash1 = render(options.pse, source, out, options.res, 1)
                wall2, _, _, hash2 = render(options.pse, source, out, options.res, 2)
                _, cpu_twice, operations_twice, hash_twice = render(options.pse, twice, out, options.res, 1)
                if hash1 != hash2 or hash1 != hash_twice:
                    print(f"WRONG: {name}: two threads or doubled noise give another picture")
                    wrong = 1
                    break
                one.append(wall1)
                two.append(wall2)
                ratio.append(wall1 / wall2)
                share.append(100 * (cpu_twice - cpu1) / cpu1)
                per_ray.append(1e-6 * rays / cpu1)
            else:
                print(f"{name}, {options.res} x {options.res}")
                print(f"  one thread            {spread(one, '%.2f')} s")
                print(f"  two threads           {spread(two, '%.2f')} s")
                print(f"  two over one          {spread(ratio, '%.2f')}   (aim: 1.9)")
                print(f"  million rays a second {spread(per_ray, '%.3f')}   (one thread)")
                print(f"  operations a pixel    {operations:.0f}, noise {100 * (operations_twice / operations - 1):.0f} %")
                print(f"  share of noise        {spread(share, '%.0f')} % of the time   (aim: 70)")
    return wrong


if __name__ == "__main__":
    sys.exit(main())
