#!/usr/bin/env python3
"""How fast hypertexture is marched from the language, and how much of that is noise.

usage: bench/hypertexture/bench_hypertexture.py [--pse PROGRAM] [--res N] [--runs N]

Renders the fire ball and the tribble of gallery/1989 as they are, from compiled kernels. Noise's share is told
in three ways. In operations that run: the same picture with every noise computed twice (the second, at another
place, is added times a number too small to change anything) runs more of them by those of noise; this does not
depend on the machine. In processor time of one thread, in place: the same pair of pictures. And alone: the time
that as many noises take in a loop of nothing else, whose vectors are full. Samples are densities that were asked
for, those of normals and shadows among them: counted by a density whose place is moved by three operations more. Two threads over
one is by the clock. Runs in turn, medians with the lowest and highest. Two threads must give the bytes of one; a
doubled noise must leave the picture as it was, or nothing is reported.
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


def counting(program):
    """The program with three operations more at each density."""
    text = re.sub(r"\bfunction density\(p\)", "function density_itself(p)", program)
    return "Tiny = 1e-30\n" + text + "\nfunction density(p)\n    return density_itself(p + Tiny)\n"


# Noises of nothing else, `count` in each pixel, far enough apart to be new ones.
ALONE = """t = 0
p = [9 * u, 9 * v, 0.37]
for i in [1 .. %d]
    t += Noise(p)
    p *= 1.0625
color = t
"""


def render(pse, program, out, res, threads):
    """Renders once: seconds by the clock, the processor's seconds, operations for each pixel, the picture's hash."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run = subprocess.run([pse, "render", program, "-o", out, "--res", f"{res}x{res}", "-t", str(threads),
                          "--stats=json", "--no-provenance", "-q", "--antialias", "none", "--tier", "optimised"],
                         stdout=subprocess.PIPE, text=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    stats = json.loads(run.stdout)
    compile_seconds = sum(stats["compile"][k] for k in ["parse", "lower", "passes", "codegen"])
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
        folder = pathlib.Path(folder)
        out = str(folder / "out.png")
        run = lambda program, threads=1, res=options.res: render(options.pse, program, out, res, threads)
        # What a noise alone takes: 64 in a pixel, less one.
        alone = [folder / "alone_64.pse", folder / "alone_1.pse"]
        for program, count in zip(alone, [64, 1]):
            program.write_text(ALONE % count)
            run(program, res=64)
        each = [run(program, res=512) for program in alone for _ in range(options.runs)]
        many, few = each[:options.runs], each[options.runs:]
        noise_ns = 1e9 * (min(m[0] for m in many) - min(f[0] for f in few)) / (63 * 512 ** 2)
        noise_operations = (many[0][2] - few[0][2]) / 63 - 4  # the sum, and p
        print(f"noise alone: {noise_ns:.2f} ns, {noise_operations:.0f} operations")
        for name in PICTURES:
            source = ROOT / "gallery" / "1989" / f"{name}.pse"
            twice, counted = folder / f"{name}_twice.pse", folder / f"{name}_counted.pse"
            twice.write_text(doubled(source.read_text()))
            counted.write_text(counting(source.read_text()))
            # Fill the cache with kernels.
            for program in [source, twice]:
                run(program, res=16)
            one, two, ratio, share, alone_share, rate = [], [], [], [], [], []
            pixels = options.res ** 2
            for _ in range(options.runs):
                wall1, cpu1, operations, hash1 = run(source)
                wall2, _, _, hash2 = run(source, threads=2)
                _, cpu_twice, operations_twice, hash_twice = run(twice)
                if hash1 != hash2 or hash1 != hash_twice:
                    print(f"WRONG: {name}: two threads or doubled noise give another picture")
                    wrong = 1
                    break
                # A noise more is its own operations, three for the place and two for the sum.
                noises = (operations_twice - operations) / (noise_operations + 5)
                one.append(wall1)
                two.append(wall2)
                ratio.append(wall1 / wall2)
                share.append(100 * (cpu_twice - cpu1) / cpu1)
                alone_share.append(100 * 1e-9 * noise_ns * noises * pixels / wall1)
                rate.append(wall1)
            else:
                samples = (run(counted, res=options.res)[2] - operations) / 3
                print(f"{name}, {options.res} x {options.res}")
                print(f"  one thread            {spread(one, '%.2f')} s")
                print(f"  two threads           {spread(two, '%.2f')} s")
                print(f"  two over one          {spread(ratio, '%.2f')}   (aim: 1.9)")
                print(f"  a pixel               {samples:.0f} samples, {noises:.0f} noises, {operations:.0f} operations")
                per_second = [1e-6 * samples * pixels / seconds for seconds in rate]
                print(f"  million samples a second {spread(per_second, '%.1f')}   (one thread)")
                print(f"  share of noise        {100 * (operations_twice / operations - 1):.0f} % of the operations")
                print(f"    in place            {spread(share, '%.0f')} % of the time   (aim: 70)")
                print(f"    alone               {spread(alone_share, '%.0f')} % of the time")
    return wrong


if __name__ == "__main__":
    sys.exit(main())
