#!/usr/bin/python3
"""falls_cluster.py on real processes: workers and schedulers that die lose and double nothing."""

import glob
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

import h5py
from falls_test import LAB, contents, falls, small_disk

SCRIPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'scripts', 'falls_cluster.py')
LIMIT = 240  # [s]
try:
    import distributed
except ImportError:
    distributed = None


def wait_for(condition, what):
    end = time.monotonic() + LIMIT
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.02)
    raise AssertionError('no %s in %d s' % (what, LIMIT))


@unittest.skipUnless(distributed, 'needs python3-distributed')
class ClusterTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.out = os.path.join(self.folder, 'out')
        self.processes = []
        self.addCleanup(self.end)

    def end(self):
        for process in self.processes:
            if process.poll() is None:
                process.kill()
            process.wait()

    def start(self, *words):
        log = open(os.path.join(self.folder, 'log%d' % len(self.processes)), 'w+')
        self.addCleanup(log.close)
        process = subprocess.Popen([sys.executable] + [str(w) for w in words], stdout=log,
                                   stderr=subprocess.STDOUT, cwd=self.folder,
                                   env=dict(os.environ, RAGDOLL_LAB=LAB))
        process.log = log
        self.processes.append(process)
        return process

    def text(self, process):
        process.log.seek(0)
        return process.log.read()

    def scheduler(self, name):
        path = os.path.join(self.folder, name)
        process = self.start('-m', 'distributed.cli.dask_scheduler', '--host', '127.0.0.1', '--port', 0,
                             '--no-dashboard', '--scheduler-file', path)

        def address():
            try:
                with open(path) as file:
                    return json.load(file)['address']
            except (OSError, ValueError):
                return None
        return process, wait_for(address, 'scheduler')

    def worker(self, address):
        return self.start('-m', 'distributed.cli.dask_worker', address, '--nthreads', 1, '--no-nanny',
                          '--no-dashboard', '--host', '127.0.0.1', '--local-directory',
                          tempfile.mkdtemp(dir=self.folder), '--death-timeout', 60)

    def cluster(self, *words):
        return self.start(SCRIPT, '--out', self.out, '--seconds', 2, '--set', 'solver.preset=fast', *words)

    def shards(self):
        return sorted(os.path.basename(p) for p in glob.glob(os.path.join(self.out, 'falls_*.h5')))

    def assert_same_as_one_process(self, first, count):
        one = os.path.join(self.folder, 'one.h5')
        falls('--first', first, '--count', count, '--out', one, '--seconds', 2, '--set', 'solver.preset=fast')
        whole = {k: v for k, v in contents(one).items() if k.startswith('falls/')}
        found = {}
        for shard in self.shards():
            for name, value in contents(os.path.join(self.out, shard)).items():
                if name.startswith('falls/'):
                    self.assertNotIn(name, found)
                    found[name] = value
        self.assertEqual(set(found), set(whole))
        self.assertTrue(all(found[name] == whole[name] for name in whole))
        self.assertEqual([n for n in os.listdir(self.out) if n.startswith('.')], [])

    def writer(self, workers):
        """The worker that is in the middle of a shard."""
        for path in glob.glob(os.path.join(self.out, '.falls_*')):
            pid = int(re.search(r'_(\d+)\.h5', path).group(1))
            for worker in workers:
                if worker.pid == pid:
                    return worker
        return None

    def test_deaths_of_workers_and_of_the_scheduler(self):
        first_scheduler, address = self.scheduler('a.json')
        workers = [self.worker(address) for _ in range(3)]
        run = self.cluster('--count', 480, '--shard', 40, '--scheduler', address)
        victim = wait_for(lambda: self.writer(workers), 'shard in the making')
        victim.send_signal(signal.SIGKILL)
        workers.append(self.worker(address))
        wait_for(lambda: len(self.shards()) >= 3, 'shards')
        first_scheduler.send_signal(signal.SIGKILL)
        run.wait(LIMIT)
        self.assertEqual(run.returncode, 1, self.text(run))
        self.assertIn('scheduler is gone', self.text(run))
        done = self.shards()
        self.assertGreaterEqual(len(done), 3)
        for worker in workers:
            worker.kill()
        _, address = self.scheduler('b.json')
        for _ in range(2):
            self.worker(address)
        kept = {s: os.stat(os.path.join(self.out, s)).st_mtime_ns for s in done}
        merged = os.path.join(self.folder, 'all.h5')
        again = self.cluster('--count', 480, '--shard', 40, '--scheduler', address, '--merge', merged)
        again.wait(LIMIT)
        self.assertEqual(again.returncode, 0, self.text(again))
        for shard, written in kept.items():
            self.assertEqual(os.stat(os.path.join(self.out, shard)).st_mtime_ns, written)
        self.assertEqual(len(self.shards()), 12)
        self.assert_same_as_one_process(1, 480)
        with h5py.File(merged, 'r') as file:
            self.assertEqual(list(file['labels']['seed']), list(range(1, 481)))
            self.assertEqual(len(file['falls']), 480)
            self.assertEqual(file['falls/00000333/imu/wrist'].shape, (200, 6))

    def test_local_workers(self):
        run = self.cluster('--count', 50, '--shard', 20, '--workers', 2, '--first', 7)
        run.wait(LIMIT)
        self.assertEqual(run.returncode, 0, self.text(run))
        self.assertIn('50 of 50 falls', self.text(run))
        self.assertEqual(self.shards(), ['falls_00000007_00000026.h5', 'falls_00000027_00000046.h5',
                                         'falls_00000047_00000056.h5'])
        self.assert_same_as_one_process(7, 50)
        other = self.start(SCRIPT, '--out', self.out, '--count', 50, '--workers', 1)
        other.wait(LIMIT)
        self.assertEqual(other.returncode, 1)
        self.assertIn('other options', self.text(other))

    def test_ctrl_c_leaves_only_whole_shards(self):
        run = self.cluster('--count', 4000, '--shard', 40, '--workers', 2)
        wait_for(lambda: len(self.shards()) >= 2, 'shards')
        run.send_signal(signal.SIGINT)
        run.wait(LIMIT)
        self.assertEqual(run.returncode, 1, self.text(run))
        self.assertIn('start again', self.text(run))
        self.assertEqual([n for n in os.listdir(self.out) if n.startswith('.')], [])
        for shard in self.shards():
            with h5py.File(os.path.join(self.out, shard), 'r') as file:
                self.assertEqual(len(file['labels']), 40)

    def test_bad_input(self):
        for words, text in ((['--count', 1, '--scheduler', '127.0.0.1:9'], 'no scheduler at 127.0.0.1:9'),
                            (['--count', 1, '--scheduler-file', 'nothing.json'], 'nothing.json'),
                            (['--count', 0], '--count'),
                            (['--count', 100, '--first', 99999990], '99999999'),
                            (['--count', 1, '--workers', 1, '--rate', 60], '66.6667 Hz'),
                            (['--count', 1, '--workers', 1, '--lab', '/bin/false'], 'ended with 1')):
            run = self.cluster(*words)
            run.wait(LIMIT)
            self.assertNotEqual(run.returncode, 0)
            self.assertIn(text, self.text(run), words)
        self.assertEqual(self.shards(), [])

    def test_a_scheduler_that_does_not_answer_is_not_there(self):
        with socket.socket() as silent:
            silent.bind(('127.0.0.1', 0))
            silent.listen(5)
            name = '127.0.0.1:%d' % silent.getsockname()[1]
            run = self.cluster('--count', 1, '--scheduler', name)
            run.wait(LIMIT)
        self.assertEqual(run.returncode, 1)
        self.assertIn('no scheduler at ' + name, self.text(run))
        self.assertEqual(self.shards(), [])

    def test_a_full_disk_ends_the_run_and_leaves_whole_shards(self):
        with small_disk(self, 8) as disk:
            self.out = os.path.join(disk, 'out')
            run = self.cluster('--count', 400, '--shard', 40, '--workers', 1)
            run.wait(LIMIT)
            self.assertEqual(run.returncode, 1, self.text(run))
            self.assertIn('free on the disk of ' + self.out, self.text(run))
            self.assertEqual([n for n in os.listdir(self.out) if n.startswith('.')], [])
            self.assertGreater(len(self.shards()), 0)
            for shard in self.shards():
                with h5py.File(os.path.join(self.out, shard), 'r') as file:
                    self.assertEqual(len(file['labels']), 40)

    def test_without_dask_a_line_says_what_to_install(self):
        code = ("import sys, runpy\nsys.modules['dask'] = None\n"
                "sys.argv = ['x', '--count', '1', '--out', 'o']\nrunpy.run_path(%r, run_name='__main__')" % SCRIPT)
        run = self.start('-c', code)
        run.wait(LIMIT)
        self.assertEqual(run.returncode, 1)
        self.assertIn('python3-distributed', self.text(run))


if __name__ == '__main__':
    unittest.main()
