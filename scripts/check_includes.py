#!/usr/bin/env python3
"""Checks that the folders of src/ include only what they may.

A folder may include the folders named after USES in its pse_folder(), and each of those must stand above it in
src/CMakeLists.txt. A third-party library's headers stay in the folder named below; the public headers in include/pse
have none. `--self-test` checks this script on made-up trees.
"""

import pathlib
import re
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent

# Header prefix -> folders of src/ that may include it; None: every folder, but no public header.
THIRD_PARTY = {
    "llvm/": ["codegen/llvm"],
    "llvm-c/": ["codegen/llvm"],
    "OpenEXR/": ["image"],
    "Imf": ["image"],
    "Imath": ["image"],
    "png.h": ["image"],
    "zlib.h": ["image"],
    "OpenImageIO/": ["image"],
    "OpenColorIO/": ["image"],
    "embree3/": ["surface"],
    "assimp/": ["surface"],
    "oneapi/": ["stream"],
    "tbb/": ["stream"],
    "openvdb/": ["volume/modules"],
    "CLI/": ["app"],
    "toml++/": ["app"],
    "fmt/": None,
    "nlohmann/": None,
}
# Headers of the operating system and the compiler, which are no library.
SYSTEM = re.compile(r"^(sys/\w+|unistd|fcntl|signal|dlfcn|spawn|poll|elf|link|termios|pthread|cpuid|immintrin|x86intrin|errno|"
                    r"pwd|locale|langinfo|time|stdio|stdlib|string|math)\.h$")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def read_folders(root):
    """Folder -> the folders it may include, in the order of the flow."""
    order = []
    text = (root / "src" / "CMakeLists.txt").read_text()
    listed = re.search(r"foreach\(folder ([^)]*)\)", text)
    if listed:
        order = listed.group(1).split()
    uses = {}
    for file in sorted((root / "src").rglob("CMakeLists.txt")):
        for match in re.finditer(r"pse_folder\((\w+)([^)]*)\)", file.read_text()):
            words = match.group(2).split()
            names = []
            if "USES" in words:
                for word in words[words.index("USES") + 1:]:
                    if word.isupper():
                        break
                    names.append(word)
            uses[match.group(1)] = names
    return order, uses


def top_folder(path):
    return path.split("/")[0]


def check(root):
    """All breaches, as text."""
    breaches = []
    order, uses = read_folders(root)
    for folder, used in uses.items():
        for name in used:
            if folder in order and name in order and order.index(name) >= order.index(folder):
                breaches.append(f"src/{folder}/CMakeLists.txt: {name} does not stand above {folder} in src/CMakeLists.txt")

    sources = [*(root / "src").rglob("*"), *(root / "include").rglob("*")]
    for file in sorted(path for path in sources if path.suffix in (".h", ".cpp", ".inc")):
        relative = file.relative_to(root).as_posix()
        public = relative.startswith("include/")
        folder_path = "" if public else file.parent.relative_to(root / "src").as_posix()
        folder = top_folder(folder_path)
        for number, line in enumerate(file.read_text(errors="replace").splitlines(), 1):
            match = INCLUDE.match(line)
            if not match:
                continue
            place = f"{relative}:{number}"
            kind, header = match.groups()
            library = next((prefix for prefix in THIRD_PARTY if header.startswith(prefix)), None)
            if library is not None:
                allowed = THIRD_PARTY[library]
                if public:
                    breaches.append(f"{place}: a public header includes {header}")
                elif allowed is not None and not any((folder_path + "/").startswith(a + "/") for a in allowed):
                    breaches.append(f"{place}: {header} belongs to src/{', src/'.join(allowed)}")
            elif kind == "<":
                if ("/" in header or header.endswith(".h")) and not SYSTEM.match(header) and not header.startswith("pse/"):
                    breaches.append(f"{place}: {header} is of no library known to scripts/check_includes.py")
            elif "/" not in header:
                if not (file.parent / header).exists():
                    breaches.append(f'{place}: write "{header}" with its folder')
            elif public:
                if not header.startswith("pse/"):
                    breaches.append(f"{place}: a public header includes {header}")
            else:
                other = top_folder(header)
                if other not in ("pse", folder) and other not in uses.get(folder, []):
                    breaches.append(f"{place}: src/{folder} may not include {header} (not among its USES)")
    return breaches


def self_test():
    """Plants each kind of breach in a small tree and expects it to be found, and nothing else."""
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        for folder, uses in {"base": "", "lang": "USES base", "image": "USES base LINKS PNG::PNG"}.items():
            (root / "src" / folder).mkdir(parents=True)
            (root / "src" / folder / "CMakeLists.txt").write_text(f"pse_folder({folder} {uses})\n")
        (root / "include" / "pse").mkdir(parents=True)
        (root / "src" / "CMakeLists.txt").write_text("foreach(folder base lang image)\n")
        good = root / "src" / "lang" / "a.cpp"
        good.write_text('#include <vector>\n#include <unistd.h>\n#include "base/b.h"\n#include "lang/a.h"\n')
        assert check(root) == [], check(root)
        for text, expected in [('#include "image/i.h"', "may not include"), ("#include <png.h>", "belongs to"),
                               ("#include <boost/any.hpp>", "no library known"), ('#include "b.h"', "with its folder")]:
            good.write_text(text + "\n")
            found = check(root)
            assert len(found) == 1 and expected in found[0], (text, found)
        good.unlink()
        (root / "include" / "pse" / "p.h").write_text("#include <fmt/core.h>\n")
        assert "public header" in check(root)[0]
        (root / "include" / "pse" / "p.h").unlink()
        (root / "src" / "base" / "CMakeLists.txt").write_text("pse_folder(base USES lang)\n")
        assert "does not stand above" in check(root)[0]
    print("check_includes: the self-test passed")


def main():
    if "--self-test" in sys.argv:
        self_test()
        return 0
    breaches = check(ROOT)
    for breach in breaches:
        print(breach)
    print(f"check_includes: {len(breaches)} breaches")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
