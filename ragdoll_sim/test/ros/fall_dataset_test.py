#!/usr/bin/python3
"""fall_dataset: labelled bags of random falls; the same seed gives the same bits."""

import csv
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import ragdoll
import rosbag
import roslib.packages
import rospy
import rostest
from bags import contents
from client import LIMIT

SECONDS, RATE = 3, 60
SCRIPT = os.path.join(roslib.packages.get_pkg_dir('ragdoll_sim'), 'scripts', 'fall_dataset.py')


def load_script():
    spec = importlib.util.spec_from_file_location('fall_dataset', SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class FallDatasetTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def record(self, name, falls, seed, status=0):
        out = os.path.join(self.folder, name)
        run = subprocess.run(
            [sys.executable, SCRIPT, '--falls', str(falls), '--seed', str(seed), '--seconds',
             str(SECONDS), '--rate', str(RATE), '--out', out, '__name:=fall_dataset_' + name],
            timeout=4 * LIMIT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            universal_newlines=True)
        self.assertEqual(run.returncode, status, run.stdout)
        return out, run.stdout

    def rows(self, out):
        with open(os.path.join(out, 'labels.csv'), newline='') as file:
            return list(csv.DictReader(file))

    def test_the_same_seeds_give_the_same_bits(self):
        first, second, third = (self.record(name, falls, seed)[0] for name, falls, seed in
                                [('first', 2, 7), ('second', 2, 7), ('third', 1, 8)])
        self.assertEqual(self.rows(first), self.rows(second))
        self.assertEqual([r['seed'] for r in self.rows(first)], ['7', '8'])
        for row in self.rows(first):
            self.assertEqual(contents(os.path.join(first, row['bag'])),
                             contents(os.path.join(second, row['bag'])))
        # A seed alone, or after others: the same fall. Another seed: another fall.
        self.assertEqual(self.rows(third), self.rows(first)[1:])
        self.assertEqual(contents(os.path.join(third, 'fall_000008.bag')),
                         contents(os.path.join(first, 'fall_000008.bag')))
        self.assertNotEqual(self.rows(first)[0]['kind'], self.rows(first)[1]['kind'])

    def test_a_bag_holds_its_fall_and_its_labels(self):
        out, _ = self.record('labels', 1, 3)
        row = self.rows(out)[0]
        path = os.path.join(out, row['bag'])
        with rosbag.Bag(path) as bag:
            messages = [(topic, m, t) for topic, m, t in bag.read_messages()]
        states = [m for topic, m, _ in messages if topic == '/ragdoll/state']
        model = [m for topic, m, _ in messages if topic == '/ragdoll/model'][0]
        labels = [json.loads(m.data) for topic, m, _ in messages if topic == '/ragdoll/label'][0]
        self.assertEqual({k: str(v) for k, v in labels.items()}, row)
        self.assertEqual(len(states), SECONDS * RATE + 1)
        self.assertEqual((states[0].time, states[0].header.stamp.to_sec()), (0, 1))
        self.assertAlmostEqual(states[-1].time, SECONDS)

        # The impact: what touched has come down, and the head has not been there before.
        time = float(row['impact_time'])
        names = model.ragdolls[0].particles
        hit = names.index(row['impact_body'])
        before = [s for s in states if s.time < time - 1e-9]
        at = next(s for s in states if abs(s.time - time) < 1e-9)
        self.assertLess(at.ragdolls[0].positions[hit].z, before[0].ragdolls[0].positions[hit].z)
        self.assertLess(at.ragdolls[0].positions[hit].z, 0.15)
        for state in before:
            self.assertGreater(state.ragdolls[0].positions[names.index('head')].z, 0.11)
        fall = before[-1].ragdolls[0].velocities[hit]
        self.assertAlmostEqual(float(row['impact_speed']),
                               (fall.x ** 2 + fall.y ** 2 + fall.z ** 2) ** 0.5)
        self.assertAlmostEqual(float(row['end_head_height']),
                               states[-1].ragdolls[0].positions[names.index('head')].z)
        self.assert_replays(path)

    def assert_replays(self, path):
        lab = roslib.packages.find_node('ragdoll_sim', 'ragdoll_lab')[0]
        replayed = subprocess.run([lab, 'replay', path], stdout=subprocess.PIPE, timeout=2 * LIMIT,
                                  universal_newlines=True)
        self.assertEqual(replayed.returncode, 0, replayed.stdout)

    def test_a_foot_that_is_held_is_let_go_and_replays(self):
        out, _ = self.record('trip', 1, 1)
        row = self.rows(out)[0]
        self.assertEqual(row['kind'], 'trip')
        with rosbag.Bag(os.path.join(out, row['bag'])) as bag:
            messages = [(topic, m) for topic, m, _ in bag.read_messages()]
        models = [m for topic, m in messages if topic == '/ragdoll/model']
        self.assertEqual([m.run for m in models], [0, 1])
        foot = models[0].ragdolls[0].particles.index(row['foot'])
        states = [m for topic, m in messages if topic == '/ragdoll/state']
        held = [s.ragdolls[0].positions[foot] for s in states if s.time < float(row['foot_hold']) - 1e-2]
        for position in held:
            self.assertEqual(position, held[0])
        self.assertNotEqual(states[-1].ragdolls[0].positions[foot], held[0])
        self.assert_replays(os.path.join(out, row['bag']))

    def test_the_states_are_those_of_the_labs_falls(self):
        out = os.path.join(self.folder, 'same')
        subprocess.run([sys.executable, SCRIPT, '--falls', '2', '--seed', '3', '--seconds', '1', '--rate', '100',
                        '--step', '0.005', '--out', out], timeout=4 * LIMIT, check=True)
        for seed in (3, 4):
            fall = ragdoll.Fall(seed, step=0.005)
            world = ragdoll.World(fall.scene)
            self.assertEqual(len(fall.held), len(fall.particles))  # a faint: it stands by pins
            for name in fall.held:
                world.detach(name)
            with rosbag.Bag(os.path.join(out, 'fall_%06d.bag' % seed)) as bag:
                states = [m for _, m, _ in bag.read_messages(topics=['/ragdoll/state'])]
            for state in states:
                world.step(int(round((state.time - world.time) / 0.005)))
                self.assertEqual([(p.x, p.y, p.z) for p in state.ragdolls[0].positions],
                                 [tuple(p) for p in world.positions])

    def test_what_is_there_is_not_overwritten(self):
        out, _ = self.record('again', 1, 5)
        kept = contents(os.path.join(out, 'fall_000005.bag'))
        _, text = self.record('again', 1, 5, status=1)
        self.assertIn('labels.csv', text)
        self.assertEqual(contents(os.path.join(out, 'fall_000005.bag')), kept)

    def test_a_rate_that_does_not_fit_the_steps_is_refused(self):
        for rate, words in ((50, ['60 or 40 Hz']), (1000, ['120 Hz'])):
            out = os.path.join(self.folder, 'uneven')
            run = subprocess.run(
                [sys.executable, SCRIPT, '--falls', '1', '--rate', str(rate), '--out', out],
                timeout=2 * LIMIT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                universal_newlines=True)
            self.assertEqual(run.returncode, 1, run.stdout)
            for word in ['--rate %d' % rate] + words:
                self.assertIn(word, run.stdout)
            self.assertEqual(os.listdir(out), [])

    def test_pose_classes(self):
        pose_class = load_script().pose_class
        body = {'neck': (0, 0, 0.5), 'left_hip': (0, 0.1, 0), 'right_hip': (0, -0.1, 0),
                'left_shoulder': (0, 0.2, 0.5), 'right_shoulder': (0, -0.2, 0.5)}  # facing +x
        turns = {'upright': lambda x, y, z: (x, y, z),
                 'supine': lambda x, y, z: (-z, y, x),
                 'prone': lambda x, y, z: (z, y, -x),
                 'on_left_side': lambda x, y, z: (x, z, -y),
                 'on_right_side': lambda x, y, z: (x, -z, y)}
        for name, turn in turns.items():
            self.assertEqual(pose_class({k: turn(*p) for k, p in body.items()}), name)


if __name__ == '__main__':
    rospy.init_node('fall_dataset_test')
    rostest.rosrun('ragdoll_sim', 'dataset', FallDatasetTest, sys.argv)
