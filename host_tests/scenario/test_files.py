"""Files that cannot be lost: killed at every call that changes files, failing disks, many runs at once.

usage: test_files.py PROGRAM DATA_DIRECTORY [unittest arguments]; EMAX_SHIM names the library of interrupted_calls.cpp
"""

import json
import os
import pty
import resource
import signal
import time
import unittest

from program_test import DATA, MODEL, QUICK, ProgramTest, TcpInstrument, main

SHIM = os.environ.get("EMAX_SHIM", "")
TABLES = DATA / "tables"
HANDHELD = ["report", "--points", TABLES / "handheld_160hz.csv", *QUICK]
FEW_POINTS = [*QUICK, "--frequencies", "100,300,1000,2000,3000,4000,5000,6000"]
OTHER = "f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg"


def shim(**settings):
    return {"env": {**os.environ, "LD_PRELOAD": SHIM, **{name: str(value) for name, value in settings.items()}}}


@unittest.skipIf(not SHIM, "no library to preload")
class FilesOfInterruptedRuns(ProgramTest):
    """The short report of S alone has two files, so that every call can be tried."""

    def table(self, factor):
        rows = [[float(cell) for cell in line.split(",")]
                for line in (TABLES / "handheld_160hz.csv").read_text().splitlines()[1:]]
        lines = [OTHER] + [",".join(map(repr, [f, factor * a, p, factor * ua, up])) for f, a, p, ua, up in rows]
        return self.write(lines, name=f"table_{factor}.csv")

    def content(self):
        return {path.name: path.read_bytes() for path in (self.directory / "out").iterdir() if path.is_file()}

    def run_through(self, setting, codes):
        """Every call is struck once, until the run ends by itself."""
        first, second, bad = self.table(1.0), self.table(1.1), self.write(["1,2,3"], "bad.csv")
        self.succeed("report", "--points", first, *QUICK, "--out", "out")
        old = self.content()
        self.succeed("report", "--points", second, *QUICK, "--out", "new")
        new = {path.name: path.read_bytes() for path in (self.directory / "new").iterdir()}
        self.assertNotEqual(old, new)
        for number in range(1, 200):
            self.succeed("report", "--points", first, *QUICK, "--out", "out")
            self.assertEqual(self.content(), old)  # And no leftovers of the run before.
            result = self.run_program("report", "--points", second, *QUICK, "--out", "out", **shim(**{setting: number}))
            found = self.content()
            for name, text in found.items():
                self.assertIn(text, [old[name], new[name]], (number, name))
            self.assertEqual(sorted(found), sorted(old))
            # Whoever comes next finds all of one run.
            self.run_program("report", "--points", bad, "--out", "out")
            settled = self.content()
            self.assertIn(settled, [old, new], number)
            if result.returncode == 0 and (settled == new or number > 100):
                return number
            self.assertIn(result.returncode, codes, result.stderr)
        return self.fail("the run never ended by itself")

    def test_killed_at_every_call(self):
        self.assertGreater(self.run_through("EMAX_KILL_AT", [-signal.SIGKILL]), 8)

    def test_disk_full_at_every_call(self):
        # Leftovers that cannot be removed are no failure of the run, so some of these runs succeed.
        self.assertGreater(self.run_through("EMAX_FAIL_AT", [0, 2, 3]), 8)


    def test_killed_while_a_measurement_is_set_aside(self):
        first, second, bad = self.table(1.0), self.table(1.1), self.write(["1,2,3"], "bad.csv")
        for number in range(1, 200):
            for path in (self.directory / "out").glob("frequency_response*"):
                path.unlink()
            self.succeed("report", "--points", first, *QUICK, "--out", "out")
            (self.directory / "out/frequency_response.csv").write_text("measured")
            old = self.content()
            result = self.run_program("report", "--points", second, *QUICK, "--out", "out",
                                      **shim(EMAX_KILL_AT=number))
            self.run_program("report", "--points", bad, "--out", "out")
            found = self.content()
            if found != old:
                self.assertEqual(sorted(found), ["frequency_response.1.csv", "report.txt", "results.json"], number)
                self.assertEqual(found["frequency_response.1.csv"], b"measured")
                self.assertNotEqual(found["results.json"], old["results.json"])
            if result.returncode == 0:
                self.assertNotEqual(found, old)
                self.assertGreater(number, 8)
                return
        self.fail("the run never ended by itself")


@unittest.skipIf(not SHIM, "no library to preload")
class CertificateOfInterruptedRuns(ProgramTest):
    def prove(self, order, **options):
        certify = ["certify", "--model", "1.037,4073,0.3182", "--order", order, "--time", "0.0005", "--effort", "0.001",
                   "--out", "out/proof"]
        return self.run_program(*certify, **options)

    def proven_order(self):
        return json.loads((self.directory / "out/proof").read_text())["model"]["order"]

    def run_through(self, setting, codes):
        (self.directory / "out").mkdir()
        (self.directory / "out/.emax.proof.notes").write_text("not ours")
        for number in range(1, 10_000):
            self.assertEqual(self.prove("10").returncode, 0)
            self.assertEqual(sorted(os.listdir(self.directory / "out")), [".emax.proof.notes", "proof"])
            result = self.prove("4", **shim(**{setting: number}))
            # Killed behind the last call that matters, it has its new name already.
            whole = {0: [4], -signal.SIGKILL: [10, 4]}.get(result.returncode, [10])
            self.assertIn(self.proven_order(), whole, number)
            if result.returncode == 0:
                return number
            self.assertIn(result.returncode, codes, result.stderr)
            if result.returncode == 3:
                self.assertIn(b"Gap", result.stdout)  # What has been proven is printed all the same.
        return self.fail("the run never ended by itself")

    def test_killed_at_every_call(self):
        self.assertGreater(self.run_through("EMAX_KILL_AT", [-signal.SIGKILL]), 4)

    def test_disk_full_at_every_call(self):
        self.assertGreater(self.run_through("EMAX_FAIL_AT", [2, 3]), 4)


class FilesThatAreKept(ProgramTest):
    def test_parents_are_made_and_taken_away_again(self):
        self.succeed(*HANDHELD, "--out", "a/b/c")
        self.assertEqual(self.files(), ["a", "a/b", "a/b/c", "a/b/c/report.txt", "a/b/c/results.json"])
        self.refuse(["report", "--points", self.write(["1,2,3"]), "--out", "x/y/z"], "points.csv:1")

    def test_leftovers_of_killed_runs_go(self):
        (self.directory / "out/.emax.left00").mkdir(parents=True)
        (self.directory / "out/.emax.left00/report.txt").write_text("half")
        self.succeed(*HANDHELD, "--out", "out")
        self.assertEqual(sorted(os.listdir(self.directory / "out")), ["report.txt", "results.json"])

    def test_moves_of_a_killed_run_are_finished(self):
        complete = self.directory / "out/.emax-complete"
        complete.mkdir(parents=True)
        (complete / "mine.txt").write_text("complete")
        (complete / ".dropped").write_text("gone.txt\n../outside.txt\n")
        (self.directory / "out/gone.txt").write_text("old")
        (self.directory / "outside.txt").write_text("not ours")
        self.succeed(*HANDHELD, "--out", "out")
        self.assertEqual(self.files(), ["out", "out/mine.txt", "out/report.txt", "out/results.json", "outside.txt"])

    def test_only_regular_files_are_replaced(self):
        (self.directory / "out").mkdir()
        target = self.directory / "target"
        target.write_text("precious")
        for name, make in [("results.json", os.mkfifo), ("report.txt", lambda path: os.symlink(target, path))]:
            path = self.directory / "out" / name
            make(path)
            self.refuse([*HANDHELD, "--out", "out"], f"out/{name}: not a regular file")
            path.unlink()
        self.assertEqual(target.read_text(), "precious")
        # The certificate's target is looked at before the effort.
        os.mkfifo(self.directory / "fifo")
        self.refuse(["certify", *MODEL[:1], "1.037,4073,0.3182", "--effort", "50", "--out", "fifo"], "not a regular file")
        self.refuse(["certify", *MODEL[:1], "1.037,4073,0.3182", "--effort", "50", "--out", "out"], "not a regular file")

    def test_twenty_runs_at_once(self):
        tables = []
        for number in range(20):
            rows = [f"{f},{0.01 + 1e-4 * number!r},0,0.0001,1" for f in [10, 20, 40, 80]]
            tables.append(self.write([OTHER, *rows], name=f"{number}.csv"))
        runs = [self.start_program("report", "--points", table, *QUICK, "--out", "out") for table in tables]
        for run in runs:
            error = run.communicate(timeout=500)[1]
            self.assertEqual(run.returncode, 0, error)
        self.assertEqual(sorted(os.listdir(self.directory / "out")), ["report.txt", "results.json"])
        sensitivity = json.loads((self.directory / "out/results.json").read_text())["model"]["S"]
        name = f"{round((sensitivity - 0.01) / 1e-4)}.csv"
        self.assertIn(name, (self.directory / "out/report.txt").read_text())

    def test_a_model_keeps_the_points_of_an_earlier_measurement(self):
        self.succeed("report", "--points", TABLES / "plain.csv", *QUICK, "--out", "out")
        points = (self.directory / "out/frequency_response.csv").read_text()
        self.succeed("report", *MODEL, *QUICK, "--out", "out")
        self.assertFalse((self.directory / "out/frequency_response.csv").exists())
        self.assertEqual((self.directory / "out/frequency_response.1.csv").read_text(), points)

    def test_points_of_s_alone_keep_those_of_an_earlier_measurement(self):
        self.succeed("report", "--points", TABLES / "plain.csv", *QUICK, "--out", "out")
        points = (self.directory / "out/frequency_response.csv").read_text()
        self.succeed(*HANDHELD, "--out", "out")
        self.assertEqual(self.files(), ["out", "out/frequency_response.1.csv", "out/report.txt", "out/results.json"])
        self.assertEqual((self.directory / "out/frequency_response.1.csv").read_text(), points)

    @unittest.skipIf(os.geteuid() != 0, "only root can be somebody else")
    def test_files_of_another_user_in_a_sticky_directory(self):
        out = self.directory / "out"
        out.mkdir()
        self.directory.chmod(0o755)
        out.chmod(0o1777)
        (out / "report.txt").write_text("of another user")
        nobody = 65534
        before = self.files()
        result = self.run_program(*HANDHELD, "--out", "out", preexec_fn=lambda: os.setuid(nobody))
        self.assertEqual(result.returncode, 2)
        self.assert_one_line(result.stderr, "out/report.txt: belongs to another user", "sticky")
        self.assertEqual(self.files(), before)  # And no results.json beside the old report.
        self.assertEqual((out / "report.txt").read_text(), "of another user")

    def measure(self, *options, largest_file=None, **more):
        def limit_file_size():
            resource.setrlimit(resource.RLIMIT_FSIZE, (largest_file, largest_file))

        more |= {"preexec_fn": limit_file_size} if largest_file else {}
        return self.run_program("report", *FEW_POINTS, "--out", "out", *options, **more)

    def points(self, name="frequency_response.csv"):
        return (self.directory / "out" / name).read_bytes()

    def test_a_measurement_is_printed_where_no_file_holds_it(self):
        (self.directory / "out").mkdir()
        result = self.measure("--json", largest_file=500)
        self.assertEqual(result.returncode, 3)
        self.assert_one_line(result.stderr, "too large", "; the points are on standard output")
        self.assertEqual(json.loads(result.stdout)["model"]["source"], "bench")
        self.assertEqual(os.listdir(self.directory / "out"), [])
        result = self.measure(largest_file=500)
        self.assertEqual(result.returncode, 3)
        self.assertEqual(self.measure().returncode, 0)
        self.assertIn(b"\n" + self.points(), result.stdout)  # The same simulated bench, so the same bytes.

    def test_points_are_kept_where_there_is_room_for_them_alone(self):
        self.assertEqual(self.measure().returncode, 0)
        points, before = self.points(), self.files()
        self.assertLess(len(points), 4000)
        self.assertGreater((self.directory / "out/report.txt").stat().st_size, 4000)
        for path in (self.directory / "out").iterdir():
            path.unlink()
        result = self.measure(largest_file=4000)
        self.assertEqual(result.returncode, 3)
        self.assert_one_line(result.stderr, "; the points are on standard output and in frequency_response.csv")
        self.assertEqual(self.files(), ["out", "out/frequency_response.csv"])
        self.assertEqual(self.points(), points)
        # Those of another measurement stay.
        (self.directory / "out/frequency_response.csv").write_text("of another one")
        result = self.measure(largest_file=4000)
        self.assert_one_line(result.stderr, " and in failed_frequency_response.csv")
        self.assertEqual(self.points("failed_frequency_response.csv"), points)
        self.assertEqual(self.points(), b"of another one")
        self.assertIn("out/frequency_response.csv", before)

    def test_points_before_a_fault_are_kept_too(self):
        fault = ["--bench-fault", "unplugged-device@0.5"]
        self.assertEqual(self.measure(*fault).returncode, 3)
        points = self.points()
        (self.directory / "out/frequency_response.csv").unlink()
        result = self.measure(*fault, largest_file=200)
        self.assertEqual(result.returncode, 3)
        self.assertIn(b"\n" + points, result.stdout)

    @unittest.skipIf(not SHIM, "no library to preload")
    def test_disk_full_at_some_calls_of_a_measurement(self):
        self.assertEqual(self.measure().returncode, 0)
        points = self.points()
        for number in [2, 5, 9, 14, 20]:
            for path in (self.directory / "out").iterdir():
                path.unlink()
            result = self.measure(**shim(EMAX_FAIL_AT=number))
            kept = [self.points(name) for name in os.listdir(self.directory / "out") if "frequency_response" in name]
            self.assertTrue(points in kept or b"\n" + points in result.stdout, (number, result.stderr))


class StopsBehindTheSweep(ProgramTest):
    """Ctrl-C while the PC evaluates or writes: the sweep took time at a bench, and its points stay."""
    ENDLESS = ["--frequencies", FEW_POINTS[-1], "--trend", "none", "--trials", "100000000"]

    def stop(self, arguments, shown: bytes, **options):
        """Stopped once these words are on the terminal."""
        ours, theirs = pty.openpty()
        process = self.start_program(*arguments, stderr=theirs, **options)
        os.close(theirs)
        text = b""
        is_sent = False
        try:
            while piece := os.read(ours, 4096):
                text += piece
                if shown in text and not is_sent:
                    process.send_signal(signal.SIGINT)
                    is_sent = True
        except OSError:  # The other side has been closed.
            pass
        os.close(ours)
        output, _ = process.communicate(timeout=200)
        self.assertEqual(process.returncode, 130)
        lines = [line for line in text.decode("ascii").replace("\r\n", "\n").split("\r") if line.endswith("\n")]
        lines = [line for line in lines if not line.startswith("emax: fit: ")]
        self.assertEqual(len(lines), 1, text)
        return output, lines[0]

    def whole(self, *options) -> bytes:
        self.run_program("report", *FEW_POINTS, *options, "--out", "whole")
        return (self.directory / "whole/frequency_response.csv").read_bytes()

    def test_points_are_kept(self):
        whole = self.whole()
        report = ["report", *self.ENDLESS, "--out", "out"]
        output, line = self.stop(report, b"Monte Carlo")
        self.assertEqual(output, b"")
        self.assertEqual(line, "emax: stopped; the points of the sweep are kept in out/frequency_response.csv, which --points takes\n")
        self.assertEqual(os.listdir(self.directory / "out"), ["frequency_response.csv"])
        self.assertEqual((self.directory / "out/frequency_response.csv").read_bytes(), whole)
        self.succeed("report", "--points", "out/frequency_response.csv", *QUICK)
        # Whatever an earlier sweep has left stays, too.
        other = self.whole("--bench-seed", "2")
        _, line = self.stop([*report, "--bench-seed", "2"], b"Monte Carlo")
        self.assertIn("out/stopped_frequency_response.csv", line)
        self.stop(report, b"Monte Carlo")
        kept = {name: (self.directory / "out" / name).read_bytes() for name in os.listdir(self.directory / "out")}
        self.assertEqual(kept, {"frequency_response.csv": whole, "stopped_frequency_response.csv": whole,
                                "stopped_frequency_response.1.csv": other})

    def test_points_are_kept_while_pictures_are_drawn(self):
        program = self.directory / "bin/gnuplot"
        program.parent.mkdir()
        whole = self.whole()
        started = self.directory / "started"
        program.write_text(f"#!/bin/sh\nPATH=/usr/bin:/bin\necho > '{started}'; exec sleep 100\n")
        program.chmod(0o755)
        process = self.start_program("report", *FEW_POINTS, "--out", "out", env=os.environ | {"PATH": str(program.parent)})
        deadline = time.monotonic() + 60
        while not started.exists():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        output, error = process.communicate(timeout=200)
        self.assertEqual((process.returncode, output), (130, b""))
        self.assert_one_line(error, "stopped; ", "kept in out/frequency_response.csv")
        self.assertEqual((self.directory / "out/frequency_response.csv").read_bytes(), whole)
        self.assertEqual(os.listdir(self.directory / "out"), ["frequency_response.csv"])

    def test_points_before_a_fault_are_kept(self):
        fault = ["--bench-fault", "unplugged-device@0.8"]
        whole = self.whole(*fault)
        _, line = self.stop(["report", *self.ENDLESS, *fault, "--out", "out"], b"Monte Carlo")
        self.assertRegex(line, r"\Aemax: no device at .* of 8 points kept, drive at zero\); stopped; .* in out/frequency_response.csv")
        points = [row.split(",")[:5] for row in whole.decode().splitlines()]
        kept = [row.split(",")[:5] for row in (self.directory / "out/frequency_response.csv").read_text().splitlines()]
        self.assertEqual(kept, points)

    def test_what_no_file_holds_is_printed(self):
        whole = self.whole()
        (self.directory / "out").mkdir()
        os.mkfifo(self.directory / "out/stopped_frequency_response.csv")
        (self.directory / "out/frequency_response.csv").write_text("of an earlier sweep\n")
        output, line = self.stop(["report", *self.ENDLESS, "--out", "out"], b"Monte Carlo")
        self.assertEqual(output, whole)
        self.assertIn("on standard output", line)
        self.assertEqual((self.directory / "out/frequency_response.csv").read_text(), "of an earlier sweep\n")

    def test_what_is_lost_without_a_directory_is_said(self):
        output, line = self.stop(["report", *self.ENDLESS], b"Monte Carlo")
        self.assertEqual((output, self.files()), (b"", []))
        self.assertRegex(line, r"\Aemax: stopped; the sweep .* is lost: --out DIR keeps its points")

    def test_an_instrument_has_its_points_still(self):
        with TcpInstrument() as remote:
            _, line = self.stop(["report", *self.ENDLESS, "--instrument", remote.port], b"Monte Carlo")
            self.assertRegex(line, r"\Aemax: stopped; .* still in the instrument: FETC:TRAC\? answers them; --out DIR")
            self.assertEqual(len(remote.ask("FETC:TRAC?").split(",")), 5 * 8)
            _, line = self.stop(["report", *self.ENDLESS, "--instrument", remote.port, "--out", "out"], b"Monte Carlo")
            self.assertIn("kept in out/frequency_response.csv", line)
        rows = (self.directory / "out/frequency_response.csv").read_text().splitlines()
        self.assertEqual(len([row for row in rows[1:] if row[0] != "#"]), 8)


if __name__ == "__main__":
    main()
