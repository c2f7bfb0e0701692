"""Installs pse into a folder of its own and uses it there as somebody else's project would.

usage: install_test.py BUILD_FOLDER

Checks the installed program, its manual page, and the example beside this file, built with find_package(pse) and by the
flags that pkg-config gives.
"""

import os
import pathlib
import subprocess
import sys
import tempfile

EXAMPLE = pathlib.Path(__file__).resolve().parent / "example"
EXPECTED = "0.375 0.3 0.1875\n"  # Noise is -1/4 at (0.5, 0.5, 0.5)


def run(*words, **options):
    return subprocess.run([str(word) for word in words], check=True, text=True, stdout=subprocess.PIPE, **options).stdout


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        prefix = pathlib.Path(folder) / "prefix"
        environment = dict(os.environ, PKG_CONFIG_PATH=str(prefix / "lib/pkgconfig"), XDG_CACHE_HOME=folder)
        run("cmake", "--install", build, "--prefix", prefix)

        # The program.
        (pathlib.Path(folder) / "a.pse").write_text("color = [u v 0.5]\n")
        run(prefix / "bin/pse", "render", "a.pse", "-o", "a.png", "--res", "8x8", cwd=folder, env=environment)
        assert (pathlib.Path(folder) / "a.png").read_bytes().startswith(b"\x89PNG")
        assert ".TH" in (prefix / "share/man/man1/pse-render.1").read_text()
        assert "_pse" in (prefix / "share/bash-completion/completions/pse").read_text()

        # The library, by CMake.
        run("cmake", "-S", EXAMPLE, "-B", f"{folder}/by_cmake", f"-DCMAKE_PREFIX_PATH={prefix}")
        run("cmake", "--build", f"{folder}/by_cmake")
        assert run(f"{folder}/by_cmake/example", env=environment) == EXPECTED

        # The library, by hand.
        flags = [f"-I{prefix}/include", f"-L{prefix}/lib", "-lpse"]
        if subprocess.run(["which", "pkg-config"], stdout=subprocess.DEVNULL).returncode == 0:
            flags = run("pkg-config", "--define-prefix", "--cflags", "--libs", "pse", env=environment).split()
        run("c++", "-std=c++23", EXAMPLE / "main.cpp", "-o", f"{folder}/by_hand", *flags, f"-Wl,-rpath,{prefix}/lib")
        assert run(f"{folder}/by_hand", env=environment) == EXPECTED


main()
