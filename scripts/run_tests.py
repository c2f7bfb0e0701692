#!/usr/bin/env python3
"""Runs ctest and the fuzz targets, and counts what happened.

A GoogleTest program counts as its test cases, any other ctest test and each fuzz target as one. A program that dies
before it reports counts as one failure. The last line is 'N passed, N failed, N skipped'; the exit code is 0 only
when something passed and nothing failed.

usage: run_tests.py BUILD [--fuzz FUZZ_BUILD --fuzz-seconds S] [-- ctest options]
"""

import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parent.parent


def count_googletest(report):
    """(passed, failed, skipped) of a GoogleTest JSON report, and the names of the failed cases."""
    passed = failed = skipped = 0
    failures = []
    for suite in json.loads(report.read_text())["testsuites"]:
        for case in suite["testsuite"]:
            if case.get("result") == "SKIPPED":
                skipped += 1
            elif case.get("status") == "NOTRUN":
                pass
            elif "failures" in case:
                failed += 1
                failures.append(f'{suite["name"]}.{case["name"]}')
            else:
                passed += 1
    return passed, failed, skipped, failures


def run_ctest(build, options):
    """Runs all of ctest's tests; returns (passed, failed, skipped, failures)."""
    reports = build / "test_reports"
    shutil.rmtree(reports, ignore_errors=True)
    reports.mkdir(parents=True)
    environment = dict(os.environ, GTEST_OUTPUT=f"json:{reports}/", GTEST_COLOR="no")
    jobs = str(os.cpu_count() or 1)
    command = ["ctest", "--test-dir", str(build), "-j", jobs, "--output-on-failure", "--timeout", "1200",
               "--no-tests=ignore", "--output-junit", str(reports / "ctest.xml"), *options]
    subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, check=False)

    # Which program each test runs, to find its GoogleTest report.
    listing = subprocess.run(["ctest", "--test-dir", str(build), "--show-only=json-v1"], capture_output=True, text=True,
                             check=False)
    programs = {}
    for test in json.loads(listing.stdout or '{"tests": []}')["tests"]:
        programs[test["name"]] = pathlib.Path(test.get("command", ["?"])[0]).name

    total = [0, 0, 0]
    failures = []
    junit = reports / "ctest.xml"
    if not junit.exists():
        return total, ["ctest made no report"]
    for case in xml.etree.ElementTree.parse(junit).getroot().iter("testcase"):
        name, status = case.get("name"), case.get("status")
        report = reports / f"{programs.get(name, name)}.json"
        counted = None
        if report.exists():
            try:
                counted = count_googletest(report)
            except (ValueError, KeyError):
                counted = None
        if counted:
            for i in range(3):
                total[i] += counted[i]
            failures += [f"{name}: {failure}" for failure in counted[3]]
            if status == "fail" and counted[1] == 0:
                total[1] += 1
                failures.append(f"{name}: the program failed outside its test cases")
        elif status == "run":
            total[0] += 1
        elif status in ("notrun", "disabled"):
            total[2] += 1
        else:
            total[1] += 1
            failures.append(name)
    return total, failures


def run_fuzz(build, seconds):
    """Runs each fuzz target from its kept corpus; a crash, a hang or an over-use of memory fails it."""
    total = [0, 0, 0]
    failures = []
    running = []
    # The undefined-behaviour sanitizer only speaks, unless it is told to stop.
    environment = dict(os.environ, UBSAN_OPTIONS="halt_on_error=1:print_stacktrace=1")
    for program in sorted(build.rglob("fuzz_*")):
        if not program.is_file() or not os.access(program, os.X_OK) or program.suffix:
            continue
        name = program.name
        work = build / "fuzz_work" / name
        shutil.rmtree(work, ignore_errors=True)
        (work / "corpus").mkdir(parents=True)
        kept = ROOT / "tests" / "fuzz" / "corpus" / name.removeprefix("fuzz_")
        command = [str(program), f"-max_total_time={seconds}", "-timeout=10", "-rss_limit_mb=2048", "-print_final_stats=1",
                   f"-artifact_prefix={work}/", str(work / "corpus")]
        if kept.is_dir():
            command.append(str(kept))
        log = open(work / "log.txt", "w")
        running.append((name, work, subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                                                      env=environment)))
    for name, work, process in running:
        good = process.wait() == 0
        log = (work / "log.txt").read_text(errors="replace").splitlines()
        runs = [line.split()[-1] for line in log if line.startswith("stat::number_of_executed_units")]
        print(f"{name}: {'passed' if good else 'FAILED'} after {runs[0] if runs else '?'} inputs")
        if not good:
            print("\n".join(log[-60:]))
            failures.append(f"{name} (input kept in {work})")
        total[0 if good else 1] += 1
    if not running:
        total[1] += 1
        failures.append("no fuzz target was built")
    return total, failures


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--fuzz", type=pathlib.Path)
    parser.add_argument("--fuzz-seconds", type=int, default=60)
    # What stands behind `--` is ctest's; argparse would not tell it from our own words.
    words = sys.argv[1:]
    cut = words.index("--") if "--" in words else len(words)
    arguments = parser.parse_args(words[:cut])

    total, failures = run_ctest(arguments.build.resolve(), words[cut + 1:])
    if arguments.fuzz:
        fuzz_total, fuzz_failures = run_fuzz(arguments.fuzz.resolve(), arguments.fuzz_seconds)
        total = [a + b for a, b in zip(total, fuzz_total)]
        failures += fuzz_failures

    if failures:
        print("\nfailed:")
        for failure in failures:
            print(f"  {failure}")
    if total[0] + total[1] == 0:
        print("no test ran")
    print(f"{total[0]} passed, {total[1]} failed, {total[2]} skipped", flush=True)
    return 0 if total[0] > 0 and total[1] == 0 and not failures else 1


if __name__ == "__main__":
    sys.exit(main())
