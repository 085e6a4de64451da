#!/usr/bin/python3
"""ragdoll_lab falls: the same bytes whatever the threads; labels and IMUs computed anew in another way."""

import contextlib
import csv
import os
import resource
import shutil
import subprocess
import tempfile
import unittest

import h5py
import numpy as np
import ragdoll

LAB = os.environ['RAGDOLL_LAB']
SENSORS = ['low_back', 'wrist', 'thigh', 'head']


def falls(*words, status=0, **more):
    run = subprocess.run([LAB, 'falls', '--quiet'] + [str(w) for w in words], stdout=subprocess.PIPE,
                         stderr=subprocess.STDOUT, **more)
    text = run.stdout.decode()
    assert run.returncode == status, text
    return text


@contextlib.contextmanager
def small_disk(test, megabytes):
    """A file system of its own, where the user may mount one."""
    folder = tempfile.mkdtemp()
    test.addCleanup(os.rmdir, folder)
    mount = ['mount', '-t', 'tmpfs', '-o', 'size=%dm' % megabytes, 'tmpfs', folder]
    if subprocess.run(mount, stderr=subprocess.DEVNULL).returncode != 0:
        test.skipTest('may not mount a disk')
    try:
        yield folder
    finally:
        subprocess.run(['umount', folder], check=True)


def contents(path):
    """All data and attributes by name."""
    all_of = {}

    def keep(name, thing):
        data = thing[()].tobytes() if isinstance(thing, h5py.Dataset) else b''
        all_of[name] = (data, sorted((k, np.asarray(v).tobytes()) for k, v in thing.attrs.items()))

    with h5py.File(path, 'r') as file:
        file.visititems(keep)
    return all_of


class FallsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.path = os.path.join(cls.folder, 'falls.h5')
        falls('--first', 1, '--count', 40, '--out', cls.path, '--csv', os.path.join(cls.folder, 'csv'),
              '--set', 'solver.preset=fast', '--threads', 2)
        cls.file = h5py.File(cls.path, 'r')
        cls.labels = cls.file['labels'][()]
        cls.names = cls.file.attrs['particles'].split(',')

    @classmethod
    def tearDownClass(cls):
        cls.file.close()
        shutil.rmtree(cls.folder)

    def out(self, name):
        return os.path.join(self.folder, self.id().split('.')[-1] + name)

    def each(self):
        for row in self.labels:
            group = self.file['falls/%08d' % row['seed']]
            yield row, group, group['positions'][()].astype(float), group['time'][()]

    def at(self, positions, name):
        return positions[..., self.names.index(name), :]

    def test_layout(self):
        self.assertEqual(len(self.labels), 40)
        for row, group, positions, time in self.each():
            self.assertEqual(sorted(group), ['imu', 'positions', 'time'])
            self.assertEqual(sorted(group['imu']), sorted(SENSORS))
            np.testing.assert_allclose(time, np.arange(1, 501) / 100)
            self.assertEqual(positions.shape, (500, len(self.names), 3))
            for sensor in SENSORS:
                self.assertEqual(group['imu'][sensor].shape, (500, 6))
            for name in self.labels.dtype.names:  # attributes are the table's row
                np.testing.assert_array_equal(group.attrs[name], row[name])

    def test_every_kind_is_there(self):
        kinds = {(r['kind'].decode(), r['start'].decode()) for r in self.labels}
        self.assertEqual({k for k, _ in kinds}, {'push', 'trip', 'slip', 'faint'})
        self.assertEqual({s for _, s in kinds}, {'standing', 'sitting', 'chair', 'bed', 'stairs'})
        self.assertGreater(len(set(self.labels['height'])), 30)
        np.testing.assert_allclose(self.labels['mass'], 75 * (self.labels['height'] / 1.75) ** 3)
        self.assertGreater(np.mean(np.isfinite(self.labels['impact_time'])), 0.9)

    def test_bodies_are_similar(self):
        for row, _, positions, _ in self.each():
            thigh = np.linalg.norm(self.at(positions, 'left_leg') - self.at(positions, 'left_knee'), axis=-1)
            np.testing.assert_allclose(thigh, 0.4244 * row['height'] / 1.75, atol=2e-4)

    def test_onset_is_where_the_body_leaves_its_quiet_motion(self):
        for row, _, positions, time in self.each():
            jerk = np.abs(np.diff(positions, 2, axis=0)).max(axis=(1, 2))  # 0 at rest and at even speed
            first = time[np.argmax(jerk > 2e-5) + 2]
            self.assertGreaterEqual(first, row['onset_time'] - 1e-9)
            self.assertLessEqual(first, row['onset_time'] + 0.06, row['seed'])

    def heights_above_floors(self, row, positions):
        """Of particles over the floor or the stairs: by where they are, not by boxes."""
        if row['start'] != b'stairs':
            return positions[..., 2]
        x, y = positions[..., 0], positions[..., 1]
        step = np.clip(np.floor(x / 0.3) + 1, 0, 7)
        return positions[..., 2] - np.where((x > -2) & (np.abs(y) < 1.5), (7 - step) * 0.17, 0)

    def test_impact_is_the_first_touch(self):
        radius = dict(zip(self.names, self.radii()))
        body = [i for i, n in enumerate(self.names) if not n.endswith('foot')]
        checked = 0
        for row, _, positions, time in self.each():
            scale = row['height'] / 1.75
            after = time > row['onset_time'] + 1e-9
            gaps = self.heights_above_floors(row, positions) - [radius[n] * scale for n in self.names]
            touched = (gaps[:, body] < 0.002).any(axis=1) & after
            if not np.isfinite(row['impact_time']):
                self.assertFalse(touched.any(), row['seed'])
                continue
            if row['start'] == b'stairs' or row['kind'] == b'slip':  # edges: not before it
                self.assertFalse((gaps[:, body] < -0.05)[time < row['impact_time'] - 0.05].any())
                continue
            first = np.argmax(touched)
            self.assertAlmostEqual(time[first], row['impact_time'], delta=0.0101)
            hit = self.names.index(row['impact_body'].decode())
            before, speed = (np.linalg.norm(positions[k, hit] - positions[k - 1, hit]) * 100
                             for k in (first - 2, first - 1))
            slowed = max(0, before - speed)  # its neighbour was hit
            self.assertAlmostEqual(speed, row['impact_speed'], delta=0.2 * row['impact_speed'] + 0.2 + slowed)
            checked += 1
        self.assertGreater(checked, 15)

    def radii(self):
        import re
        text = ragdoll.World('fall').scene
        return [float(re.search(r'%s: \{position: [^}]*radius: ([0-9.e-]+)' % n, text).group(1))
                for n in self.names]

    def test_pose_is_how_it_lies(self):
        for row, _, positions, _ in self.each():
            end = positions[-1]
            hips = (self.at(end, 'left_hip') + self.at(end, 'right_hip')) / 2
            trunk = self.at(end, 'neck') - hips
            lean = np.degrees(np.arctan2(np.linalg.norm(trunk[:2]), trunk[2]))
            # The chest's direction by the plane through neck, shoulder and hip of one side each.
            chest = np.zeros(3)
            for a, b in (('left_shoulder', 'right_shoulder'), ('left_hip', 'right_hip')):
                chest += np.cross(self.at(end, a) - self.at(end, b), trunk)
            tilt = np.degrees(np.arcsin(chest[2] / np.linalg.norm(chest)))
            pose = row['end_pose'].decode()
            self.assertAlmostEqual(self.at(end, 'head')[2], row['end_head_height'], places=4)
            if lean < 40:
                self.assertEqual(pose, 'upright')
            elif lean > 50 and tilt > 55:
                self.assertEqual(pose, 'supine')
            elif lean > 50 and tilt < -55:
                self.assertEqual(pose, 'prone')
            elif lean > 50 and abs(tilt) < 20:
                self.assertIn('side', pose)

    def test_quiet_imus_feel_one_g_and_do_not_turn(self):
        for row, group, _, time in self.each():
            quiet = time <= row['onset_time'] + 1e-9
            for sensor in SENSORS:
                imu = group['imu'][sensor][()][quiet]
                self.assertAlmostEqual(np.linalg.norm(imu[:, :3].mean(axis=0)), 9.81, delta=0.02)
                self.assertLess(np.abs(imu[:, 3:]).max(), 0.012)

    def test_the_heads_imu_is_the_second_difference_of_its_way(self):
        """Specific force, twice integrated from positions: the head's particle is near its sensor."""
        row, group, positions, time = next(e for e in self.each() if e[0]['kind'] == b'faint')
        fall = (time > row['onset_time'] + 0.05) & (time < row['impact_time'] - 0.05)
        head = self.at(positions, 'head')
        acceleration = np.gradient(np.gradient(head, 0.01, axis=0), 0.01, axis=0) + [0, 0, 9.81]
        felt = np.linalg.norm(group['imu/head'][()][:, :3], axis=1)
        np.testing.assert_allclose(np.median(felt[fall]), np.median(
            np.linalg.norm(acceleration, axis=1)[fall]), atol=3)

    def test_the_same_bytes_whatever_threads_and_neighbours(self):
        for preset in ('fast', 'balanced'):
            whole, part = self.out(preset + '_whole.h5'), self.out(preset + '_part.h5')
            falls('--first', 1, '--count', 43, '--out', whole, '--seconds', 1.5, '--set',
                  'solver.preset=' + preset, '--threads', 2)
            falls('--first', 42, '--count', 1, '--out', part, '--seconds', 1.5, '--set',
                  'solver.preset=' + preset)
            a, b = contents(whole), contents(part)
            for name in b:
                if name.startswith('falls/'):
                    self.assertEqual(a[name], b[name], name)

    def test_the_fall_of_the_module_has_the_same_states(self):
        path = self.out('.h5')
        falls('--first', 1, '--count', 10, '--out', path, '--seconds', 2)
        with h5py.File(path, 'r') as file:
            for seed in (1, 2, 3, 4):
                fall = ragdoll.Fall(seed)
                world = ragdoll.World(fall.scene)
                group = file['falls/%08d' % seed]
                self.assertEqual(group.attrs['kind'].decode(), fall.labels['kind'])
                quiet = int(round(group.attrs['onset_time'] * 100))
                for k in range(quiet, 200):
                    for _ in range(2):
                        if abs(world.time - fall.release) < 1e-9:
                            for name in fall.held:
                                world.detach(name)
                        world.step()
                    np.testing.assert_array_equal(group['positions'][k], world.positions.astype(np.float32))

    def test_csv_has_the_columns_of_kfall(self):
        folder = os.path.join(self.folder, 'csv')
        with open(os.path.join(folder, 'labels.csv'), newline='') as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([int(r['seed']) for r in rows], list(range(1, 41)))
        self.assertEqual(float(rows[6]['impact_time']), self.labels['impact_time'][6])
        with open(os.path.join(folder, 'fall_00000003.csv')) as file:
            head = file.readline().strip()
        self.assertEqual(head, 'TimeStamp(s),FrameCounter,AccX,AccY,AccZ,GyrX,GyrY,GyrZ,EulerX,EulerY,EulerZ')
        data = np.loadtxt(os.path.join(folder, 'fall_00000003.csv'), delimiter=',', skiprows=1)
        imu = self.file['falls/00000003/imu/low_back'][()]
        np.testing.assert_allclose(data[:, 2:5] * 9.80665, imu[:, :3], atol=1e-4)
        np.testing.assert_allclose(np.radians(data[:, 5:8]), imu[:, 3:], atol=2e-6)

    def test_files_are_small(self):
        path = self.out('.h5')
        falls('--first', 1, '--count', 20, '--out', path, '--no-positions', '--set', 'solver.preset=fast')
        self.assertLess(os.path.getsize(path) / 20, 60000)

    def test_bad_input(self):
        there = self.path
        cases = [(['--out', there], 'is there already'),
                 (['--out', self.out('x/y.h5')], 'is not there'),
                 (['--first', 99999990, '--count', 100, '--out', self.out('.h5')], '99999999'),
                 (['--first', -1, '--out', self.out('.h5')], '--first'),
                 (['--first', '18446744073709551615', '--out', self.out('.h5')], '--first'),
                 (['--count', 0, '--out', self.out('.h5')], '--count'),
                 (['--rate', 60, '--out', self.out('.h5')], '66.6667 Hz'),
                 (['--rate', -5, '--out', self.out('.h5')], '--rate'),
                 (['--seconds', 0, '--out', self.out('.h5')], '--seconds'),
                 (['--model', 'nobody', '--out', self.out('.h5')], 'human_lumped'),
                 (['--set', 'solver.preset=quick', '--out', self.out('.h5')], 'quick'),
                 (['--set', 'solver', '--out', self.out('.h5')], 'key=value'),
                 (['--csv', os.path.join(self.folder, 'csv')], 'labels.csv'),
                 ([], '--out')]
        before = sorted(os.listdir(self.folder))
        for words, text in cases:
            self.assertIn(text, falls(*words, status=2), words)
        self.assertEqual(sorted(os.listdir(self.folder)), before)

    def test_a_disk_that_takes_no_more_leaves_nothing(self):
        def small_files():
            resource.setrlimit(resource.RLIMIT_FSIZE, (200000, 200000))
            import signal
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        path = self.out('.h5')
        text = falls('--count', 20, '--out', path, '--set', 'solver.preset=fast', status=2,
                     preexec_fn=small_files)
        self.assertIn('cannot be written', text)
        self.assertIn('free on the disk', text)
        self.assertEqual([f for f in os.listdir(self.folder) if f.startswith(os.path.basename(path))], [])

    def test_a_full_disk_is_named_and_has_no_file(self):
        with small_disk(self, 2) as disk:
            path = os.path.join(disk, 'falls.h5')
            text = falls('--count', 20, '--out', path, '--set', 'solver.preset=fast', status=2)
            self.assertIn('the disk is full', text)
            self.assertIn('free on the disk of ' + disk, text)
            self.assertEqual(os.listdir(disk), [])
            text = falls('--count', 100, '--csv', disk, '--set', 'solver.preset=fast', status=2)
            self.assertIn('is the disk full?', text)
            self.assertIn(disk, text)


if __name__ == '__main__':
    unittest.main()
